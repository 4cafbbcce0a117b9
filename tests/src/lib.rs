//! What the tests share.

pub mod invariants;
pub mod laws;
pub mod meshes;
pub mod quadrature;
pub mod refused;
pub mod tolerance;
