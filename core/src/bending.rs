//! The bending methods.

mod gompper_kroll;
mod kantor_nelson;
mod strong_form;

pub use gompper_kroll::{GompperKroll, GompperKrollMemory};
pub use kantor_nelson::{Hinges, KantorNelson};
pub use strong_form::{StrongForm, StrongFormMemory};
