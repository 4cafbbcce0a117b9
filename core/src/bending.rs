//! The bending methods.

mod gompper_kroll;
mod kantor_nelson;
mod loop_subdivision;
mod strong_form;

pub use gompper_kroll::{GompperKroll, GompperKrollMemory};
pub use kantor_nelson::{Hinges, KantorNelson};
pub use loop_subdivision::{
    ConsistentMemory, ControlPoints, LoopSubdivision, LoopSubdivisionMemory, LoopSubdivisionPlan,
};
pub use strong_form::{StrongForm, StrongFormMemory};
