//! Welding: one vertex for all corners at the same point.

use super::MeshFile;
use helfrich::{MeshError, TriangleMesh, VertexKind};
use std::collections::HashMap;

/// The vertices at points, by the bits of their coordinates.
#[derive(Default)]
pub(super) struct Weld {
    vertices: HashMap<[u64; 3], u32>,
}

impl Weld {
    /// Returns the vertex at this point, which is added to the positions if it is new.
    pub(super) fn vertex(&mut self, point: [f64; 3], positions: &mut Vec<[f64; 3]>) -> u32 {
        // Adding 0 turns −0 into 0 and changes nothing else.
        let point = point.map(|coordinate| coordinate + 0.0);
        *self
            .vertices
            .entry(point.map(f64::to_bits))
            .or_insert_with(|| {
                positions.push(point);
                (positions.len() - 1) as u32
            })
    }
}

impl MeshFile {
    /// Number of boundary vertices at the same point as another boundary vertex. Such vertices are
    /// split: renderers, for example, export separate corners for each face.
    pub fn split_vertices(&self) -> usize {
        let (mut weld, mut distinct) = (Weld::default(), Vec::new());
        let at_boundary = |vertex: &usize| self.mesh.vertex_kind(*vertex) == VertexKind::Boundary;
        let split = (0..self.positions.len())
            .filter(at_boundary)
            .filter(|&vertex| {
                let before = distinct.len();
                weld.vertex(self.positions[vertex], &mut distinct);
                distinct.len() == before
            });
        split.count()
    }

    /// Number of boundary vertices within this distance of another boundary vertex. Text with few digits, for
    /// example, leaves gaps between triangles.
    pub fn near_vertices(&self, distance: f64) -> usize {
        let mut near = Near {
            distance,
            cells: HashMap::new(),
        };
        let mut kept = Vec::new();
        let at_boundary = |vertex: &usize| self.mesh.vertex_kind(*vertex) == VertexKind::Boundary;
        let all = (0..self.positions.len()).filter(at_boundary);
        let merged = all.filter(|&vertex| {
            let before = kept.len();
            near.vertex(self.positions[vertex], &mut kept);
            kept.len() == before
        });
        merged.count()
    }

    /// The mesh with vertices merged that are at most this far apart: see [`weld`].
    ///
    /// # Errors
    /// As [`Self::welded`].
    pub fn welded_within(&self, distance: f64) -> Result<Self, MeshError> {
        Ok(weld(&self.positions, self.mesh.triangles(), distance)?.file)
    }

    /// The mesh with one vertex for all vertices at the same point, bit for bit (−0 counts as 0), numbered in
    /// the order of their first appearance. Triangles with two merged corners are left out.
    ///
    /// # Errors
    /// If the resulting triangles are not a manifold: more than two at an edge, or surfaces that
    /// touch.
    pub fn welded(&self) -> Result<Self, MeshError> {
        self.welded_within(0.0)
    }
}

/// A mesh whose vertices were merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    /// The mesh.
    pub file: MeshFile,
    /// Its vertex for each vertex that was given.
    pub vertices: Vec<u32>,
}

/// Merges vertices that are at most `distance` apart: a vertex becomes the nearest one that was kept
/// before it and is so close, or is kept itself. With a distance of 0 these are vertices at the same point, bit
/// for bit (−0 counts as 0). Triangles of which two corners are merged are left out; they need not form a mesh
/// before.
///
/// # Errors
/// If a triangle names a vertex that does not exist, or the resulting triangles are not a manifold.
pub fn weld(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    distance: f64,
) -> Result<Welded, MeshError> {
    let outside = |corner: &u32| *corner as usize >= positions.len();
    let all = triangles.as_flattened();
    if let Some(place) = all.iter().position(outside) {
        return Err(MeshError::VertexOutOfRange {
            triangle: (place / 3) as u32,
            vertex: all[place],
            vertices: positions.len(),
        });
    }
    let (kept, vertices) = merged(positions.iter().copied(), distance);
    let triangles = triangles.iter();
    let triangles = triangles.map(|triangle| triangle.map(|corner| vertices[corner as usize]));
    let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a);
    let mesh = TriangleMesh::new(kept.len(), triangles.collect())?;
    let file = MeshFile::new(kept, mesh);
    Ok(Welded { file, vertices })
}

/// The points that are kept, each the first of those that are merged, and the kept one of each point: see [`weld`].
pub(crate) fn merged(
    points: impl Iterator<Item = [f64; 3]>,
    distance: f64,
) -> (Vec<[f64; 3]>, Vec<u32>) {
    let mut kept = Vec::new();
    let vertices = if distance > 0.0 {
        let mut near = Near {
            distance,
            cells: HashMap::new(),
        };
        points.map(|point| near.vertex(point, &mut kept)).collect()
    } else {
        let mut weld = Weld::default();
        points.map(|point| weld.vertex(point, &mut kept)).collect()
    };
    (kept, vertices)
}

/// The vertices that were kept, by the cells of a grid as wide as the distance.
struct Near {
    distance: f64,
    cells: HashMap<[u64; 3], Vec<u32>>,
}

impl Near {
    /// The place of the cell of a coordinate. Beyond 2^53 neighbouring cells are the same number, but
    /// then only equal coordinates are so close.
    fn cell(&self, coordinate: f64) -> f64 {
        let cell = (coordinate / self.distance).floor();
        if cell.is_finite() { cell } else { coordinate }
    }

    /// The vertex for this point, added to the positions if none is near enough.
    fn vertex(&mut self, point: [f64; 3], positions: &mut Vec<[f64; 3]>) -> u32 {
        let cell = point.map(|coordinate| self.cell(coordinate));
        // Adding 0 turns −0 into 0 and changes nothing else.
        let key = |cell: [f64; 3]| cell.map(|place| (place + 0.0).to_bits());
        let mut nearest: Option<(f64, u32)> = None;
        for k in 0..27 {
            let beside = [k / 9, k / 3 % 3, k % 3].map(|step| f64::from(step) - 1.0);
            let beside = key([0, 1, 2].map(|axis| cell[axis] + beside[axis]));
            for &vertex in self.cells.get(&beside).into_iter().flatten() {
                let other = positions[vertex as usize];
                let [x, y, z] = [0, 1, 2].map(|axis| point[axis] - other[axis]);
                let apart = x.hypot(y).hypot(z);
                let is_nearest = nearest.is_none_or(|known| (apart, vertex) < known);
                if apart <= self.distance && is_nearest {
                    nearest = Some((apart, vertex));
                }
            }
        }
        if let Some((_, vertex)) = nearest {
            return vertex;
        }
        positions.push(point);
        let vertex = (positions.len() - 1) as u32;
        self.cells.entry(key(cell)).or_default().push(vertex);
        vertex
    }
}
