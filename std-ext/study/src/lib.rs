//! Studies of the methods of [`helfrich`], measurements of surfaces, and reports.
//!
//! * [`study`]: accuracy and cost of the methods; [`verdict`]: whether they converge;
//!   [`answer`]: the cheapest method for an accuracy; [`recommend`]: the cheapest method on a mesh
//!   of the user.
//! * [`measurement`]: curvatures with error bars, by jets whose scale is chosen from the noise.
//! * [`painting`]: their quantities as colours; [`remarks`]: what has to be said about them.
//! * [`provenance`]: program, compiler and machine of measurements.
//! * [`report`]: tables, CSV and HTML of results, also of runs and sweeps.

pub mod answer;
pub mod measurement;
pub mod painting;
pub mod provenance;
pub mod recommend;
pub mod remarks;
pub mod report;
pub mod study;
pub mod verdict;

// Modules of other packages, which the modules here name by `crate::`.
use helfrich_draw::picture;
use helfrich_evaluate::{method, scalar};
use helfrich_execute::{clock, execute};
use helfrich_mesh::{generate, info, io};
use helfrich_run::{findings, lock, plots, png, run, sweep};
use helfrich_scene::{series, six};
use helfrich_shape::noise;
use helfrich_solve::smoothing;
