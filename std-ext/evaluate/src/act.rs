//! The interface of prepared methods and effects that are chosen at run time.

use crate::method::Fields;
use helfrich::{Finding, Real, Surface};
use std::fmt;

/// A prepared method or effect. They are handed from thread to thread.
pub(crate) trait Act<T: Real>: fmt::Debug + Send {
    /// Adds nodal forces to `force`, and returns the energy. An evaluator of a method in strong form sets force
    /// densities instead, and one of a method without forces leaves `force` as it is.
    fn add_force(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) -> T;

    /// See [`helfrich::Energy::energy`].
    fn energy(&mut self, surface: Surface<'_, T>) -> T;

    /// See [`helfrich::Method::inspect`].
    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding));

    /// Whether the results of [`Self::collect`] follow from the force of [`Self::add_force`].
    fn has_fields_of_force(&self) -> bool {
        true
    }

    /// Whether forces follow from curvatures, so that there are none where these are unknown.
    fn is_strong_form(&self) -> bool {
        false
    }

    /// Sets the results in `fields` from `force`, as set by [`Self::add_force`]; without it normals and curvatures
    /// only, which it measures.
    fn collect(&mut self, _: Surface<'_, T>, _force: Option<&[[T; 3]]>, _: &mut Fields<T>) {}
}
