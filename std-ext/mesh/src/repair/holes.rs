//! Holes and their filling.

use crate::polygon::triangulate;
use glam::DVec3;
use helfrich::TriangleMesh;
use std::collections::HashSet;

/// Triangles that fill holes.
pub(super) struct Filled {
    pub(super) triangles: Vec<[u32; 3]>,
    /// Number of holes that they fill.
    pub(super) holes: usize,
    /// Number of other borders with so few edges.
    pub(super) left: usize,
}

/// Largest part of the area of a component that fills a hole: a border that spans more is the outline.
const LARGEST: f64 = 0.5;

/// Fills the borders with at most this number of edges, unless they are outlines, have a vertex at the place of
/// another one, or an edge across would be one that exists.
pub(super) fn fill(
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
    is_double: &[bool],
    most: usize,
) -> Filled {
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| DVec3::from(positions[vertex as usize]));
        (b - a).cross(c - a).length()
    };
    let (component_of, components) = mesh.components();
    let mut areas = vec![0.0; components];
    for triangle in mesh.triangles() {
        areas[component_of[triangle[0] as usize] as usize] += area(triangle);
    }
    let mut across = HashSet::new();
    let mut filled = Filled {
        triangles: Vec::new(),
        holes: 0,
        left: 0,
    };
    for border in borders(mesh).filter(|border| border.len() <= most) {
        let places = Vec::from_iter(border.iter().map(|&vertex| positions[vertex as usize]));
        let Ok(division) = triangulate(&places) else {
            filled.left += 1;
            continue;
        };
        let triangles = division
            .iter()
            .map(|triangle| triangle.map(|at| border[at as usize]));
        let triangles = Vec::from_iter(triangles);
        let is_border = |[one, other]: [u32; 2]| {
            let apart = one.abs_diff(other);
            apart == 1 || apart as usize == border.len() - 1
        };
        let edges = division
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let inner = edges.filter(|&edge| !is_border(edge));
        let inner = inner.map(|edge| edge.map(|at| border[at as usize]));
        let inner = Vec::from_iter(inner.filter(|[from, to]| from < to));
        let is_taken = |&[from, to]: &[u32; 2]| {
            mesh.one_ring(from as usize).contains(&to) || across.contains(&[from, to])
        };
        let component = component_of[border[0] as usize] as usize;
        let spanned: f64 = triangles.iter().map(area).sum();
        // A component without area has no holes.
        let is_hole = spanned < LARGEST * areas[component];
        let touches = border.iter().any(|&vertex| is_double[vertex as usize]);
        if !is_hole || touches || inner.iter().any(is_taken) {
            filled.left += 1;
            continue;
        }
        across.extend(inner);
        filled.triangles.extend(triangles);
        filled.holes += 1;
    }
    filled
}

/// The borders, each as it runs around a hole, against its triangles, in the order of their lowest vertices.
pub(crate) fn borders(mesh: &TriangleMesh) -> impl Iterator<Item = Vec<u32>> {
    // An edge of the border runs against that of its triangle.
    let mut after = vec![u32::MAX; mesh.vertex_count()];
    for (edge, &[from, to]) in mesh.edges().iter().enumerate() {
        if mesh.edge_triangles(edge).1.is_none() {
            after[to as usize] = from;
        }
    }
    (0..mesh.vertex_count()).filter_map(move |start| {
        let mut border = Vec::new();
        let mut at = start;
        while after[at] != u32::MAX {
            border.push(at as u32);
            at = std::mem::replace(&mut after[at], u32::MAX) as usize;
        }
        (!border.is_empty()).then_some(border)
    })
}
