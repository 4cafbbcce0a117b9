//! The shape of membranes of [`helfrich`], in f64.
//!
//! * [`noise`]: noise of positions, and its smoothing.
//! * [`remesh`]: new meshes of smooth surfaces.
//! * [`contact`]: repulsion between surfaces.
//! * [`held`]: area, volume and other functionals, and exact constraints on them.
//! * [`checked`]: surfaces whose positions have been checked.
//!
//! The loops are compiled here and not in the crates that call them, at the same time as the methods of
//! `helfrich-evaluate`.

pub mod checked;
pub mod contact;
pub mod held;
pub mod noise;
pub mod remesh;

// Modules of another package, which the modules here name by `crate::`.
use helfrich_execute::{execute, ordered};
