//! What a method of the list is made of, and what is done with it.

use super::MethodOptions;
use super::fields::Describe;
use helfrich::{Conservative, LaplaceBeltrami, Real, StrongForm, TriangleMesh};
use std::fmt;

/// A computation for any method.
pub(crate) trait Visitor<T: Real> {
    type Output;

    /// Takes a method with an energy.
    fn conservative<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + Describe<T> + fmt::Debug + 'static;

    /// Takes a method in strong form.
    fn strong_form<L>(self, method: StrongForm<T, L>) -> Self::Output
    where
        L: LaplaceBeltrami<T> + fmt::Debug + Sync + 'static;
}

/// Parameters from which methods are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings<'a, T> {
    /// Bending modulus κ.
    pub(crate) modulus: T,
    /// Spontaneous curvature H0; kantor-nelson (A) does not support it.
    pub(crate) spontaneous_curvature: T,
    pub(crate) options: &'a MethodOptions,
    pub(crate) mesh: &'a TriangleMesh,
}

impl<T: Real> Settings<'_, T> {
    /// A method in strong form over an operator.
    pub(super) fn strong_form<L>(&self, operator: L) -> StrongForm<T, L> {
        let mut method = StrongForm::new(self.modulus, operator);
        method.spontaneous_curvature = self.spontaneous_curvature.into();
        method
    }
}
