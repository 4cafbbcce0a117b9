//! Runs of the scenes of [`helfrich`] in folders.
//!
//! * [`run`]: a run of a scene in a folder; [`sweep`]: a scene with every combination of some
//!   values.
//! * [`checkpoint`]: the stored state of a run. [`plots`]: plots of numbers of runs over time, with
//!   published curves.
//! * [`lock`]: exclusive access to folders and files.

pub mod checkpoint;
#[doc(hidden)]
pub mod findings;
pub mod lock;
pub mod plots;
#[doc(hidden)]
pub mod png;
pub mod run;
pub mod sweep;

// Modules of other packages, which the modules here name by `crate::`.
use helfrich_draw::picture;
use helfrich_evaluate::{effect, method, scalar};
use helfrich_execute::execute;
use helfrich_mesh::{enclosure, generate, info, io, parting};
use helfrich_scene::{scene, series, simulation, six};
use helfrich_shape::{held, remesh};
use helfrich_solve::{deformation, dynamics, flow, rheology};
