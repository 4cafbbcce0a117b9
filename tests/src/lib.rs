//! Laws, meshes and tolerances that the tests share, for methods of your own, too: `laws::check` and
//! `laws::check_conservative` run the laws, [`meshes`] and [`exact`] have strategies of proptest, and
//! [`tolerance`] the bounds with their reasons.

pub mod accuracy;
pub mod allocation;
pub mod exact;
pub mod invariants;
pub mod isosurface;
pub mod laws;
pub mod meshes;
pub mod potentials;
pub mod quadrature;
pub mod refused;
pub mod star;
pub mod tolerance;

/// The README's examples, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
#[derive(Debug)]
pub struct Readme;

/// The examples of the guide to embedding, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/EMBEDDING.md")]
#[derive(Debug)]
pub struct Embedding;
