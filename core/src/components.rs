//! Connected components of a mesh.

use crate::mesh::TriangleMesh;
use alloc::vec::Vec;

/// The connected component of each vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    of_vertex: Vec<u32>,
    count: usize,
}

impl Components {
    /// The components of a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let (of_vertex, count) = mesh.components();
        Self { of_vertex, count }
    }

    /// Number of components; an isolated vertex is a component of its own.
    #[inline]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The component of each vertex. Components are numbered from 0 in the order of their lowest
    /// vertices.
    #[inline]
    pub fn of_vertex(&self) -> &[u32] {
        &self.of_vertex
    }
}
