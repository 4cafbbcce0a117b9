//! Properties of a mesh: counts, topology, measures and quality.

use crate::orientation::{InsideOut, inside_out};
use helfrich::{Components, Functional, Prepared, Surface, TotalMeanCurvature, VertexKind};
use std::f64::consts::PI;

/// Properties of a mesh, by [`MeshInfo::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct MeshInfo {
    /// Vertices, including isolated ones.
    pub vertices: usize,
    /// Vertices in no triangle.
    pub isolated_vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Edges with only one triangle.
    pub boundary_edges: usize,
    /// Triangles.
    pub triangles: usize,
    /// Connected components, not counting isolated vertices.
    pub components: usize,
    /// V − E + F over the vertices in use.
    pub euler_characteristic: i64,
    /// Total area.
    pub area: f64,
    /// Enclosed volume of a closed mesh; negative if its triangles run clockwise.
    pub volume: Option<f64>,
    /// Smallest and largest angle, in degrees.
    pub angles: [f64; 2],
    /// Fewest and most neighbours of a vertex in use.
    pub valences: [usize; 2],
    /// Smallest and largest edge length.
    pub edge_lengths: [f64; 2],
    /// The lowest and the highest coordinates.
    pub corners: [[f64; 3]; 2],
    /// Triangles without area up to the rounding of f64, in ascending order.
    pub degenerate_triangles: Vec<usize>,
    /// Closed components that are inside out.
    pub inside_out: Vec<InsideOut>,
}

/// Edge of an equilateral triangle of the mean area, `√(4 A/(√3 F))`.
pub fn mean_edge(area: f64, triangles: usize) -> f64 {
    (4.0 * area / (3_f64.sqrt() * triangles as f64)).sqrt()
}

impl MeshInfo {
    /// Measures a surface.
    pub fn new(surface: Surface<'_, f64>) -> Self {
        let mesh = surface.mesh();
        let used = |vertex: &usize| mesh.vertex_kind(*vertex) != VertexKind::Isolated;
        let isolated_vertices = mesh.vertex_count() - (0..mesh.vertex_count()).filter(used).count();
        let length = |edge: &[u32; 2]| {
            let [x, y, z] = surface.difference(edge[0], edge[1]);
            x.hypot(y).hypot(z)
        };
        let edge_lengths = range(mesh.edges().iter().map(length));
        let all = 0..mesh.triangles().len();
        let angles = range(
            all.clone()
                .flat_map(|triangle| surface.triangle_angles(triangle)),
        );
        let valences = (0..mesh.vertex_count())
            .filter(used)
            .map(|vertex| mesh.valence(vertex));
        Self {
            vertices: mesh.vertex_count(),
            isolated_vertices,
            edges: mesh.edges().len(),
            boundary_edges: mesh.boundary_edge_count(),
            triangles: mesh.triangles().len(),
            components: mesh.components().1 - isolated_vertices,
            euler_characteristic: mesh.euler_characteristic(),
            area: surface.area(),
            volume: surface.volume(),
            angles: angles.map(f64::to_degrees),
            valences: [
                valences.clone().min().unwrap_or(0),
                valences.max().unwrap_or(0),
            ],
            edge_lengths,
            corners: corners(surface.positions()),
            degenerate_triangles: all
                .filter(|&triangle| is_degenerate(surface, triangle))
                .collect(),
            inside_out: inside_out(surface),
        }
    }

    /// Radius of the sphere of the same volume; of an open surface, of the same area.
    pub fn enclosed_radius(&self) -> f64 {
        match self.volume {
            Some(volume) if volume > 0.0 => (0.75 * volume / PI).cbrt(),
            _ => (self.area / (4.0 * PI)).sqrt(),
        }
    }
}

/// Measures of a connected component, by [`components`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComponentInfo {
    /// The first of its vertices, by its number in the whole mesh.
    pub first: usize,
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Edges with only one triangle.
    pub boundary_edges: usize,
    /// V − E + F.
    pub euler_characteristic: i64,
    /// Number of handles; `None` if there is a boundary.
    pub genus: Option<i64>,
    /// Area.
    pub area: f64,
    /// Enclosed volume, negative if the triangles run clockwise; `None` if there is a boundary.
    pub volume: Option<f64>,
    /// Integrated mean curvature `∫ H dS`, a length, 4πR on a sphere: see [`TotalMeanCurvature`].
    pub total_mean_curvature: f64,
}

/// The measures of each connected component, in the order of their first vertices; isolated vertices are left out.
pub fn components(surface: Surface<'_, f64>) -> Vec<ComponentInfo> {
    let parts = Components::new(surface.mesh()).parts(surface);
    let measured = parts.iter().filter_map(|part| {
        let (surface, first) = (part.surface()?, *part.vertices().first()?);
        let mesh = surface.mesh();
        let mut total = [0.0];
        Prepared::new(TotalMeanCurvature, mesh).with(|functional, execution, workspace| {
            functional.values(execution, surface, workspace, &mut total);
        });
        let euler_characteristic = mesh.euler_characteristic();
        Some(ComponentInfo {
            first: first as usize,
            vertices: mesh.vertex_count(),
            triangles: mesh.triangles().len(),
            boundary_edges: mesh.boundary_edge_count(),
            euler_characteristic,
            genus: mesh.is_closed().then_some(1 - euler_characteristic / 2),
            area: surface.area(),
            volume: surface.volume(),
            total_mean_curvature: total[0],
        })
    });
    measured.collect()
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

fn corners(positions: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let ranges: [_; 3] = std::array::from_fn(|axis| range(positions.iter().map(|x| x[axis])));
    [0, 1].map(|end| ranges.map(|range| range[end]))
}

/// Whether the area of a triangle is no larger than the rounding error of its cross product.
fn is_degenerate(surface: Surface<'_, f64>, triangle: usize) -> bool {
    let [a, b, c] = surface.mesh().triangles()[triangle];
    let squared = |from, to| {
        surface
            .difference(from, to)
            .iter()
            .map(|component| component * component)
            .sum::<f64>()
    };
    let longest = squared(a, b).max(squared(b, c)).max(squared(c, a));
    surface.triangle_area(triangle) <= 4.0 * f64::EPSILON * longest
}
