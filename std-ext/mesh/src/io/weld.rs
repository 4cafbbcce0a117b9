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
    /// The vertex at this point, added to the positions if it is a new one.
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

    /// The mesh with one vertex for all vertices at the same point, bit for bit (−0 counts as 0),
    /// in the order in which they first appear. Triangles of which two corners are merged are left
    /// out.
    ///
    /// # Errors
    /// If the resulting triangles are not a manifold: more than two at an edge, or surfaces that
    /// touch.
    pub fn welded(&self) -> Result<Self, MeshError> {
        let (mut weld, mut positions) = (Weld::default(), Vec::new());
        let vertices = self.positions.iter();
        let vertices = Vec::from_iter(vertices.map(|&point| weld.vertex(point, &mut positions)));
        let triangles = self.mesh.triangles().iter();
        let triangles = triangles.map(|triangle| triangle.map(|corner| vertices[corner as usize]));
        let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a);
        let mesh = TriangleMesh::new(positions.len(), triangles.collect())?;
        Ok(Self { positions, mesh })
    }
}
