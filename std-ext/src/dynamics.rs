//! Equilibrium shapes: relaxation of membranes under any forces and exact constraints.
//!
//! [`Relaxation`] moves the vertices of all [`Membrane`]s step by step until the forces of a
//! [`Problem`] vanish but for what its constraints take up. One scheme serves problems with and
//! without an energy: limited-memory secants (L-BFGS) over a preconditioner made of the membranes'
//! own stiffness, so that the number of steps hardly depends on the number of vertices. With an
//! energy, no accepted step raises it beyond rounding; without one, steps are judged by the force
//! along them.
//!
//! A fluid membrane resists nothing along itself: its vertices move along their normals only, and
//! are spread anew along the surface where that costs nothing.
//!
//! Everything is serial and depends on the positions alone: a state that was stored and taken up
//! again continues bit for bit.

mod cholesky;
mod coordinates;
mod frame;
mod held;
pub mod integrate;
mod preconditioner;
mod redistribution;
mod relaxation;
mod secants;
mod vector;

pub use held::Held;
pub use relaxation::{Failure, Outcome, Relaxation, SetupError, State, StepReport};

use helfrich::TriangleMesh;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What is relaxed: forces and constraints over the positions of all membranes, one after the
/// other.
///
/// Results must depend on the positions alone, to the last bit, for a run to continue bit for bit.
pub trait Problem {
    /// Whether forces are the exact negative gradient of the energy.
    fn is_conservative(&self) -> bool;

    /// Sets `force` to the nodal forces F_i and returns the energy that goes with them.
    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation;

    /// Number of functionals that are held at their targets in each group of vertices: 2 for area
    /// and volume.
    fn constraint_count(&self) -> usize {
        0
    }

    /// The group of each vertex, usually its connected component; read only if there are
    /// constraints.
    fn groups(&self) -> &[u32] {
        &[]
    }

    /// Sets `gradients`, one field a functional, to ∂C/∂x_i, C being that of the vertex's group; 0
    /// where it is not held.
    fn constraint_gradients(&mut self, _positions: &[[f64; 3]], _gradients: &mut [Vec<[f64; 3]>]) {}

    /// Moves positions back to where every functional has its target; returns the largest relative
    /// error that is left.
    fn restore(&mut self, _positions: &mut [[f64; 3]]) -> f64 {
        0.0
    }
}

/// What an evaluation says besides forces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The energy E; for forces that have none any number that goes with them: it is passed on.
    pub energy: f64,
    /// The sum of the sizes of what E is the sum of, which says how far E is rounded; |E| at least.
    pub energy_scale: f64,
}

impl Evaluation {
    /// An energy that is no difference of larger ones.
    pub fn new(energy: f64) -> Self {
        Self {
            energy,
            energy_scale: energy.abs(),
        }
    }
}

/// How the vertices of a membrane may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// Along the vertex normals: for fluid membranes, whose shape alone matters. Forces along the
    /// surface, which are errors of discretisation then, do nothing.
    AlongNormals,
    /// In all directions: for membranes with in-plane elasticity.
    Free,
}

/// One of the surfaces that are relaxed.
#[derive(Clone, Debug)]
pub struct Membrane {
    /// Connectivity.
    pub mesh: Arc<TriangleMesh>,
    /// Bending modulus κ, in units of energy: how far forces are from zero is measured by it, and
    /// steps are preconditioned with it. It need not be exact.
    pub bending_modulus: f64,
    /// In-plane modulus, energy per area: the largest of those of shear, area, and tension; 0 for a
    /// membrane that only bends. It need not be exact.
    pub in_plane_modulus: f64,
    /// How vertices may move.
    pub motion: Motion,
}

/// How a relaxation proceeds and where it stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The residual below which shapes are in equilibrium: see [`StepReport::residual`].
    pub tolerance: f64,
    /// The number of steps after which relaxation stops.
    pub iteration_limit: usize,
    /// The relative error of constraints that is allowed after each step.
    pub constraint_tolerance: f64,
    /// Steps without a lower residual, nor an energy that falls, after which nothing more is
    /// expected.
    pub patience: usize,
    /// Number of steps that are remembered.
    pub memory: usize,
    /// Whether steps are preconditioned with the membranes' stiffness. Without, their number grows
    /// with the number of vertices; for comparison.
    pub preconditioned: bool,
    /// Whether the vertices of fluid membranes are spread anew along the surface.
    pub redistribution: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-5,
            iteration_limit: 10_000,
            constraint_tolerance: 1e-10,
            patience: 300,
            memory: 12,
            preconditioned: true,
            redistribution: true,
        }
    }
}
