//! Triangles as slices of indices.

use crate::mesh::{MeshError, TriangleMesh};
use alloc::vec::Vec;

/// The triangles of a mesh as renderers and solvers store them: `[u32; 3]` or `[u16; 3]` per
/// triangle, or three consecutive `u32` or `u16`; slices, arrays and vectors of these.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be read as triangles",
    label = "not a sequence of vertex numbers",
    note = "triangles are slices, arrays or vectors of `[u32; 3]`, `[u16; 3]`, `u32` or `u16`; convert other integers first"
)]
pub trait TriangleIndices {
    /// The three vertices of each triangle.
    ///
    /// # Errors
    /// If the number of indices is not a multiple of three.
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError>;
}

impl TriangleMesh {
    /// The mesh of the triangles `indices` over the vertices 0 … `vertices` − 1, counter-clockwise
    /// seen from outside: [`Self::new`] for any [`TriangleIndices`].
    ///
    /// ```
    /// use helfrich::TriangleMesh;
    ///
    /// let indices: &[u16] = &[0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    /// let mesh = TriangleMesh::from_indices(4, indices)?;
    /// assert_eq!(mesh.triangles()[1], [0, 1, 3]);
    /// # Ok::<(), helfrich::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// If the number of indices is not a multiple of three, and as [`Self::new`].
    pub fn from_indices(
        vertices: usize,
        indices: &(impl TriangleIndices + ?Sized),
    ) -> Result<Self, MeshError> {
        Self::new(vertices, indices.to_triangles()?)
    }
}

impl TriangleIndices for [[u32; 3]] {
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        Ok(self.to_vec())
    }
}

impl TriangleIndices for [[u16; 3]] {
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        Ok(self
            .iter()
            .map(|&triangle| triangle.map(u32::from))
            .collect())
    }
}

impl TriangleIndices for [u32] {
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        match self.as_chunks::<3>() {
            (triangles, []) => triangles.to_triangles(),
            _ => Err(MeshError::IncompleteTriangle {
                indices: self.len(),
            }),
        }
    }
}

impl TriangleIndices for [u16] {
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        match self.as_chunks::<3>() {
            (triangles, []) => triangles.to_triangles(),
            _ => Err(MeshError::IncompleteTriangle {
                indices: self.len(),
            }),
        }
    }
}

impl<I> TriangleIndices for Vec<I>
where
    [I]: TriangleIndices,
{
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        self.as_slice().to_triangles()
    }
}

impl<I, const N: usize> TriangleIndices for [I; N]
where
    [I]: TriangleIndices,
{
    fn to_triangles(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        self.as_slice().to_triangles()
    }
}
