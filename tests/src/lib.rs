//! What the tests share.

pub mod invariants;
pub mod quadrature;
pub mod tolerance;
