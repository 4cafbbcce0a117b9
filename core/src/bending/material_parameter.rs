//! Parameters of the material of a membrane.

use crate::mesh::TriangleMesh;
use crate::mesh_identity::WithoutPaths;
use crate::method::ParameterError;
use crate::real::Real;
use alloc::vec::Vec;

/// A parameter in `E = 2 ∫ κ (H − H0)² dS + ∫ κ_G K dS`: the bending modulus κ or the Gaussian modulus
/// κ_G, energies, or the spontaneous curvature H0 = c0/2, 1/length, which is positive for a membrane that
/// prefers the curvature of the outside of a sphere.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialParameter<T> {
    /// One value for all vertices.
    Constant(T),
    /// One value per vertex, which belongs to the material there and moves with it.
    ///
    /// An evaluation panics unless there are as many as the mesh has vertices; the message names both.
    PerVertex(Vec<T>),
}

impl<T: Real> Default for MaterialParameter<T> {
    /// Zero: no spontaneous curvature.
    fn default() -> Self {
        Self::Constant(T::zero())
    }
}

impl<T: Real> From<T> for MaterialParameter<T> {
    fn from(constant: T) -> Self {
        Self::Constant(constant)
    }
}

impl<T: Real> MaterialParameter<T> {
    /// The value at a vertex.
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

    /// All values: one, or one per vertex.
    pub fn values(&self) -> &[T] {
        match self {
            Self::Constant(constant) => core::slice::from_ref(constant),
            Self::PerVertex(values) => values,
        }
    }

    /// Whether two vertices have different values.
    pub fn varies(&self) -> bool {
        self.values().windows(2).any(|pair| pair[0] != pair[1])
    }

    /// Checks a bending modulus and a spontaneous curvature, see
    /// [`Method::check`](crate::Method::check).
    pub(super) fn check(modulus: &Self, spontaneous: &Self) -> Result<(), ParameterError> {
        let limit = ParameterError::largest_modulus::<T>();
        let mut largest = T::one();
        for &value in modulus.values() {
            ParameterError::unless_within("bending modulus", value, limit)?;
            largest = largest.max(value.abs());
        }
        // κ H0² is an energy per area, with the same limit as κ and H0².
        let limit = (limit / largest).sqrt();
        let mut values = spontaneous.values().iter();
        values.try_for_each(|&value| {
            ParameterError::unless_within("spontaneous curvature", value, limit)
        })
    }

    /// Refuses a mesh with another number of vertices than a bending modulus or a spontaneous curvature
    /// has values; the message names the method.
    pub(super) fn expect<M>(method: &M, modulus: &Self, spontaneous: &Self, mesh: &TriangleMesh) {
        modulus.expect_each(method, "bending moduli", mesh);
        spontaneous.expect_each(method, "spontaneous curvatures", mesh);
    }

    /// Refuses a mesh with another number of vertices than values, which are `what`; the message names
    /// the method.
    pub(crate) fn expect_each<M>(&self, _method: &M, what: &str, mesh: &TriangleMesh) {
        if let Self::PerVertex(values) = self {
            assert!(
                values.len() == mesh.vertex_count(),
                "{} has {} {what}, one per vertex, and is used with a mesh of {} vertices: give one \
                 for each vertex, or a constant",
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
