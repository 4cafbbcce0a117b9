//! Laws, meshes and tolerances that the tests share, and that tests of your own methods can use:
//! `laws::check` and `laws::check_conservative` run the laws, [`meshes`] and [`exact`] have proptest
//! strategies, and [`tolerance`] has the bounds with their reasons.

pub mod accuracy;
pub mod allocation;
pub mod axisymmetric;
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

/// The examples of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
#[derive(Debug)]
pub struct Readme;

/// The examples of the guide to embedding, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../docs/EMBEDDING.md")]
#[derive(Debug)]
pub struct Embedding;
