//! What the tests share.

pub mod invariants;
