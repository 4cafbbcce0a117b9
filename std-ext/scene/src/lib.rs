//! Scenes for [`helfrich`]: files that describe surfaces, what acts on them and what moves them.
//!
//! * [`scene`]: scene files, validated: surfaces, the effects on each, the driver, the outputs.
//! * [`simulation`]: surfaces and effects of a scene, prepared for evaluation.
//! * [`series`]: the numbers of a run over time.

pub mod scene;
pub mod series;
pub mod simulation;
#[doc(hidden)]
pub mod six;

// Modules of other packages, which the modules here name by `crate::`.
use helfrich_evaluate::{effect, method, scalar};
use helfrich_execute::{execute, ordered};
use helfrich_mesh::{enclosure, generate, info, io};
use helfrich_shape::{checked, contact, held, noise};
use helfrich_solve::{dynamics, flow, rheology};
