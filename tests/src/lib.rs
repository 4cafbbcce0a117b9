//! What the tests share.

pub mod accuracy;
pub mod invariants;
pub mod meshes;
pub mod operator_laws;
pub mod quadrature;
pub mod tolerance;
