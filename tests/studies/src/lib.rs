//! Studies of helfrich itself, which its users need not run: hard cases, a capsule in flow beside what
//! was published, and what the effects of a scene cost. The program of this package makes their tables.
//!
//! * [`stability`]: whether methods and formulas stand hard cases.
//! * [`flow`]: one capsule by both solvers and every method, beside what was published.
//! * [`effects`]: what each effect of a scene costs.
//! * [`report`]: how all of this is shown.

pub mod effects;
pub mod flow;
pub mod report;
pub mod stability;
