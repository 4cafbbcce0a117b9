//! Forces between surfaces.

mod cells;
mod images;
mod repulsion;

pub use images::Images;
pub use repulsion::{Repulsion, RepulsionMemory};

use crate::element::Execution;
use crate::real::Real;
use crate::surface::Surface;

/// An energy of several surfaces together, with its nodal forces.
///
/// Laws: the force is the exact negative gradient of the energy by every position of every surface;
/// moving and relabelling all surfaces together leaves the energy as it is, so that the forces on
/// all of them have no sum; so does turning them, and the forces have no torque, but for surfaces
/// that have [`Images`]: a periodic box has directions. There the energy is that of one box, and
/// does not change if a surface is moved by a period. Nothing is allocated again once memory has
/// grown to the largest evaluation.
pub trait Interaction<T: Real> {
    /// Memory for one evaluation at a time.
    type Memory: Default;

    /// The energy.
    fn energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut Self::Memory,
    ) -> T;

    /// Adds to `forces[k]` the nodal forces on surface k, and returns the energy.
    ///
    /// # Panics
    /// If there are fewer slices than surfaces, or one has fewer entries than its surface vertices.
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut Self::Memory,
        forces: &mut [&mut [[T; 3]]],
    ) -> T;
}
