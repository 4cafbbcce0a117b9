//! Laws, meshes and tolerances that the tests share.

pub mod accuracy;
pub mod allocation;
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
