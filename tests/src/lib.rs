//! What the tests share.

pub mod quadrature;
pub mod tolerance;
