//! Spontaneous curvature.

use crate::mesh::TriangleMesh;
use crate::mesh_identity::WithoutPaths;
use crate::method::ParameterError;
use crate::real::Real;
use alloc::vec::Vec;

/// The spontaneous curvature H0 = c0/2, 1/length, in `E = 2κ ∫ (H − H0)² dS`: positive for a
/// membrane that prefers the curvature of the outside of a sphere.
#[derive(Clone, Debug, PartialEq)]
pub enum SpontaneousCurvature<T> {
    /// One value for all vertices.
    Constant(T),
    /// One value per vertex, which belongs to the material there and moves with it.
    ///
    /// An evaluation panics unless there are as many as the mesh has vertices; the message names both.
    PerVertex(Vec<T>),
}

impl<T: Real> Default for SpontaneousCurvature<T> {
    /// No spontaneous curvature.
    fn default() -> Self {
        Self::Constant(T::zero())
    }
}

impl<T: Real> From<T> for SpontaneousCurvature<T> {
    fn from(constant: T) -> Self {
        Self::Constant(constant)
    }
}

impl<T: Real> SpontaneousCurvature<T> {
    /// H0 at a vertex.
    ///
    /// # Panics
    /// If there is one value per vertex, but none for this one.
    #[inline]
    pub fn at(&self, vertex: usize) -> T {
        match self {
            Self::Constant(constant) => *constant,
            Self::PerVertex(values) => values[vertex],
        }
    }

    /// Checks these numbers and a bending modulus, see [`Method::check`](crate::Method::check).
    pub(super) fn check_with(&self, modulus: T) -> Result<(), ParameterError> {
        let limit = ParameterError::largest_modulus::<T>();
        ParameterError::unless_within("bending modulus", modulus, limit)?;
        // κ H0² is an energy per area, with the same limit as κ and H0².
        let limit = (limit / modulus.abs().max(T::one())).sqrt();
        let parameter = "spontaneous curvature";
        match self {
            Self::Constant(constant) => ParameterError::unless_within(parameter, *constant, limit),
            Self::PerVertex(values) => values
                .iter()
                .try_for_each(|&value| ParameterError::unless_within(parameter, value, limit)),
        }
    }

    /// Refuses a mesh with another number of vertices; the message names the method.
    pub(super) fn expect<M>(&self, _method: &M, mesh: &TriangleMesh) {
        if let Self::PerVertex(values) = self {
            assert!(
                values.len() == mesh.vertex_count(),
                "{} has {} spontaneous curvatures, one per vertex, and is used with a mesh of {} \
                 vertices: give one for each vertex, or a constant",
                WithoutPaths(core::any::type_name::<M>()),
                values.len(),
                mesh.vertex_count(),
            );
        }
    }

    /// Whether it is zero everywhere.
    pub(super) fn is_zero(&self) -> bool {
        *self == Self::Constant(T::zero())
    }
}
