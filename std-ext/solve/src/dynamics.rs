//! Equilibrium shapes: relaxation of membranes under any forces and exact constraints.
//!
//! [`Relaxation`] moves the vertices of all [`Membrane`]s step by step until the forces of a
//! [`Problem`] vanish, except for those that the constraints balance. The same scheme serves problems
//! with and without an energy: limited-memory secants (L-BFGS) with a preconditioner made from the
//! stiffness of the membranes, so that the number of steps hardly depends on the number of vertices.
//! With an energy, no accepted step raises it beyond rounding. Without one, steps are judged by the
//! force along them, and Newton steps follow where secants do not converge.
//!
//! A fluid membrane has no in-plane resistance: its vertices move along their normals only, and are
//! redistributed along the surface, which does not change the shape. Vertices at a free edge also move
//! across the edge, because this motion changes the shape. Fixed vertices do not move by a single bit,
//! and forces on them do not count, because the support balances them.
//!
//! [`modes`] finds the normal modes of least stiffness of what was found, and with them its stability.
//!
//! Everything but forces and constraints is serial, results do not depend on the number of threads, and all
//! depends on the positions alone, so that a stored and restored state continues bit for bit.

pub(crate) mod cholesky;
mod coordinates;
pub(crate) mod cotangents;
mod frame;
pub mod integrate;
mod lobpcg;
pub mod multipliers;
mod place;
mod preconditioner;
pub(crate) mod quadric;
mod redistribution;
mod relaxation;
mod secants;
pub(crate) mod vector;

pub use helfrich_shape::held::Held;
pub use relaxation::{
    Failure, Mode, ModesError, Outcome, Relaxation, SetupError, State, StepReport, modes,
};

use helfrich::TriangleMesh;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A problem to relax: forces and constraints as functions of the positions of all membranes, one
/// after the other.
///
/// For a run to continue bit for bit, results must depend on the positions alone, to the last bit.
pub trait Problem {
    /// Whether forces are the exact negative gradient of the energy.
    fn is_conservative(&self) -> bool;

    /// Sets `force` to the nodal forces F_i and returns the energy at these positions.
    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation;

    /// Number of exact constraints in each group of vertices: 2 for area and volume.
    fn constraint_count(&self) -> usize {
        0
    }

    /// The group of each vertex, usually its connected component; read only if there are
    /// constraints.
    fn groups(&self) -> &[u32] {
        &[]
    }

    /// Sets `gradients`, one field per functional, to ∂C/∂x_i, where C is the functional of the
    /// vertex's group; 0 at vertices without this constraint.
    fn constraint_gradients(&mut self, _positions: &[[f64; 3]], _gradients: &mut [Vec<[f64; 3]>]) {}

    /// Moves positions so that every functional has its target value; returns the largest remaining
    /// relative error.
    fn restore(&mut self, _positions: &mut [[f64; 3]]) -> f64 {
        0.0
    }
}

/// Results of an evaluation besides forces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The energy E; for forces without an energy any number, which is only reported.
    pub energy: f64,
    /// The sum of the magnitudes of the terms of E, which determines its rounding error; at least |E|.
    pub energy_scale: f64,
}

impl Evaluation {
    /// An energy without cancellation between its terms.
    pub fn new(energy: f64) -> Self {
        Self {
            energy,
            energy_scale: energy.abs(),
        }
    }
}

/// Freedom of the vertices of a membrane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// Along the vertex normals and, at an edge, across the edge; for fluid membranes. Other tangential
    /// forces, which are discretisation errors, have no effect.
    AlongNormals,
    /// In all directions: for membranes with in-plane elasticity.
    Free,
}

/// One of the surfaces of a problem.
#[derive(Clone, Debug)]
pub struct Membrane {
    /// Connectivity.
    pub mesh: Arc<TriangleMesh>,
    /// Bending modulus κ, in units of energy. It scales the residual and the preconditioner, and need not
    /// be exact.
    pub bending_modulus: f64,
    /// In-plane modulus, energy per area: the largest of shear modulus, area modulus and tension; 0 for a
    /// membrane with bending only. It need not be exact.
    pub in_plane_modulus: f64,
    /// The freedom of its vertices.
    pub motion: Motion,
    /// Whether each vertex is fixed, as those of a supported edge are; empty if none is. Exact
    /// constraints of the [`Problem`] must not move fixed vertices either.
    pub fixed: Vec<bool>,
}

impl Membrane {
    /// Whether a vertex is fixed.
    fn is_fixed(&self, vertex: usize) -> bool {
        self.fixed.get(vertex).is_some_and(|&fixed| fixed)
    }

    /// Whether any vertex is fixed.
    fn has_support(&self) -> bool {
        self.fixed.contains(&true)
    }
}

/// Settings of a relaxation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The residual below which a shape counts as an equilibrium: see [`StepReport::residual`].
    pub tolerance: f64,
    /// The largest number of steps.
    pub iteration_limit: usize,
    /// The largest relative error of constraints after each step.
    pub constraint_tolerance: f64,
    /// Number of steps without a lower residual and without a lower energy after which the relaxation
    /// counts as stagnated.
    pub patience: usize,
    /// Number of secants kept.
    pub memory: usize,
    /// Whether steps are preconditioned with the stiffness of the membranes. Without preconditioning,
    /// which serves for comparisons, the number of steps grows with the number of vertices.
    pub preconditioned: bool,
    /// Whether the vertices of fluid membranes are redistributed along the surface.
    pub redistribution: bool,
    /// The residual from which on Newton steps are tried for forces without an energy. They lead to an equilibrium that
    /// is near, and may lead far away from one that is not.
    pub newton: f64,
    /// Number of steps after which secants of forces without an energy, and the intervals between redistributions, begin
    /// anew. Such forces have no symmetric stiffness, and many secants lead away from an equilibrium that is far.
    pub restart: usize,
    /// The sine of the smallest angle that triangles may have, and the part of the smallest sine at the start that they
    /// may have where this is less.
    pub least_sine: [f64; 2],
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
            newton: f64::INFINITY,
            restart: usize::MAX,
            // 3°.
            least_sine: [0.052, 0.5],
        }
    }
}
