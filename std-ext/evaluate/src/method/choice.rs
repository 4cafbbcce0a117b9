//! Visitor of methods, and the settings from which methods are made.

use super::MethodOptions;
use helfrich::{
    Conservative, Curvatures, ForceDensity, LaplaceBeltrami, MaterialParameter, Real, StrongForm,
    TriangleMesh,
};
use std::fmt;

/// A computation for any method.
pub(crate) trait Visitor<T: Real> {
    type Output;

    /// Takes a method with an energy that defines no curvatures.
    fn energy<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + fmt::Debug + Send + 'static;

    /// Takes a method with an energy that defines H, or H and K.
    fn energy_and_curvatures<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + Curvatures<T> + fmt::Debug + Send + 'static;

    /// Takes a method with an energy that defines curvatures and a force density.
    fn energy_and_density<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + Curvatures<T> + ForceDensity<T> + fmt::Debug + Send + 'static;

    /// Takes a method in strong form.
    fn strong_form<L>(self, method: StrongForm<T, L>) -> Self::Output
    where
        L: LaplaceBeltrami<T> + fmt::Debug + Send + Sync + 'static;

    /// Takes an operator for curvatures only.
    fn curvatures<M>(self, method: M) -> Self::Output
    where
        M: Curvatures<T> + fmt::Debug + Send + 'static;
}

/// Parameters from which methods are made.
#[derive(Clone, Debug)]
pub struct Settings<'a, T> {
    /// Bending modulus κ; kantor-nelson (A) takes that of the first vertex.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0; kantor-nelson (A) does not support it.
    pub spontaneous_curvature: MaterialParameter<T>,
    /// Options; a method uses those that it has.
    pub options: &'a MethodOptions,
    /// The mesh, on which the choice of some methods depends.
    pub mesh: &'a TriangleMesh,
}

impl<T: Real> Settings<'_, T> {
    /// A method in strong form over an operator.
    pub(super) fn strong_form<L>(self, operator: L) -> StrongForm<T, L> {
        StrongForm {
            modulus: self.modulus,
            spontaneous_curvature: self.spontaneous_curvature,
            operator,
        }
    }
}
