//! Repulsion between surfaces in f64, compiled once here for all other crates.

use crate::execute::Parallel;
use helfrich::interaction::RepulsionMemory;
use helfrich::{Interaction, Repulsion, Surface};

/// Adds the forces of a repulsion and returns its energy: see [`Interaction::add_force_and_energy`].
///
/// # Panics
/// If there are fewer slices of forces than surfaces, or one is too short.
pub fn repel(
    execution: &Parallel,
    repulsion: &Repulsion<f64>,
    surfaces: &[Surface<'_, f64>],
    memory: &mut RepulsionMemory<f64>,
    forces: &mut [&mut [[f64; 3]]],
) -> f64 {
    repulsion.add_force_and_energy(execution, surfaces, memory, forces)
}
