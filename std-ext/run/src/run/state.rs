//! States of drivers and outputs, as checkpoints store them. Their fields are the layout of a checkpoint.

use super::End;
use super::clock::Schedule;
use super::costs::OutputCosts;
use super::deformed::Deformed;
use super::remeshing::RemeshingState;
use super::rheology::Profile;
use crate::dynamics::{self, integrate};
use crate::flow::{ImmersionState, Recent};
use crate::io::Collection;
use serde::{Deserialize, Serialize};

/// The content of a checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Stored {
    pub(super) drive: DriveState,
    pub(super) remeshing: RemeshingState,
    pub(super) outputs: Outputs,
}

/// The state of the outputs.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Outputs {
    pub(super) rows: u64,
    pub(super) files: Collection,
    pub(super) slices: Collection,
    pub(super) volumes: Collection,
    pub(super) profiles: Vec<Profile>,
    /// The number of the last row, as files have it.
    pub(super) written: Option<u64>,
    /// Number of rows so far.
    pub(super) sets: u64,
    pub(super) costs: Vec<(u64, f64)>,
    pub(super) output_costs: OutputCosts,
    /// Number of pictures so far.
    pub(super) pictures: u64,
    pub(super) seconds: f64,
    /// Warnings about the surfaces' quality, at most one per surface.
    pub(super) doubts: Vec<(String, String)>,
}

/// The state of some driver.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum DriveState {
    Relaxing(RelaxingState),
    Flowing(FlowingState),
    ImmersingF32(ImmersingState<f32>),
    ImmersingF64(ImmersingState<f64>),
}

/// State of a relaxation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RelaxingState {
    pub(super) relaxation: dynamics::State,
    pub(super) progress: RelaxingProgress,
}

/// The position in the sequence of loads.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct RelaxingProgress {
    pub(super) load: usize,
    /// Iterations of the previous loads, and of the current one.
    pub(super) before: u64,
    pub(super) iteration: u64,
    /// The residual with which the load began.
    pub(super) first_residual: Option<f64>,
    /// The residual and the number of iterations at which loads end.
    pub(super) limits: (f64, u64),
    /// The way to the targets of exactly held quantities, if it takes more than one step.
    pub(super) approach: Option<Approach>,
    /// The end of the first load that did not reach equilibrium, and messages about all such loads.
    pub(super) unfinished: Option<End>,
    pub(super) notes: Vec<String>,
}

/// Exactly held quantities on the way to their targets, at which a relaxation cannot begin at once.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Approach {
    /// Their initial values: for each surface and constraint, one for each component.
    pub(super) starts: Vec<Vec<Vec<f64>>>,
    /// The fraction of the way that has been reached, and that of the next step.
    pub(super) fraction: f64,
    pub(super) step: f64,
    /// Number of steps so far.
    pub(super) steps: u32,
    /// The reason why one step is not enough.
    pub(super) reason: String,
}

/// State of a run with boundary integrals.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct FlowingState {
    pub(super) schedule: Schedule,
    pub(super) integrator: integrate::State,
    /// Recent solutions, from which the next initial guess is computed.
    pub(super) recent: Recent,
    pub(super) progress: FlowingProgress,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct FlowingProgress {
    pub(super) deformed: Deformed,
    /// Number of outputs so far, without the first.
    pub(super) outputs: u64,
    pub(super) steps: u64,
    pub(super) right_hand_sides: u64,
    /// Number of consecutive last steps that were too short.
    pub(super) short_steps: u64,
    /// Matrix products of the linear solutions before the run was resumed.
    pub(super) products: u64,
    /// Growth of the stiffest mode since it last decayed, in factors of e.
    pub(super) folds: f64,
    pub(super) notes: Vec<String>,
}

/// State of a run on a lattice.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ImmersingState<T> {
    pub(super) schedule: Schedule,
    pub(super) immersion: ImmersionState<T>,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) progress: ImmersingProgress,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ImmersingProgress {
    pub(super) deformed: Deformed,
    pub(super) steps: u64,
    /// Number of outputs so far, without the first.
    pub(super) outputs: u64,
    /// The mean shear stress on the walls in the last two steps, for scenes that measure it.
    pub(super) wall_stresses: [f64; 2],
    pub(super) notes: Vec<String>,
}
