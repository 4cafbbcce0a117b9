//! Layers of Stokes flow on triangulated surfaces.
//!
//! C. Pozrikidis, Boundary Integral and Singularity Methods for Linearized Viscous Flow, Cambridge
//! University Press 1992, chapters 2, 4 and 5.

pub mod alone;
mod beside;
mod clusters;
mod double_layer;
mod far;
mod geometry;
mod interpolation;
mod kernel;
mod panel;
mod partial_sums;
mod single_layer;
mod sums;

pub use double_layer::DoubleLayer;
pub use single_layer::SingleLayer;
