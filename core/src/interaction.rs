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
/// Laws: the force is the exact negative gradient of the energy with respect to every position of
/// every surface. The energy is invariant under translation, rotation and relabelling of all
/// surfaces together, so that the forces on all surfaces have neither sum nor torque. With
/// [`Images`] there is no invariance under rotation, because a periodic box has directions; the
/// energy is then that of one box, and does not change if a surface is moved by a period. Nothing
/// is allocated once memory has grown to the largest evaluation.
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
    /// If there are fewer slices than surfaces, or a slice has fewer entries than its surface has
    /// vertices.
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut Self::Memory,
        forces: &mut [&mut [[T; 3]]],
    ) -> T;
}
