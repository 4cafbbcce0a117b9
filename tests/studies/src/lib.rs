//! Studies of helfrich itself, which its users need not run: hard cases, a capsule in flow compared
//! with published results, and the cost of the effects of a scene. The program of this package makes
//! their tables.
//!
//! * [`stability`]: methods and formulas on hard cases.
//! * [`flow`]: one capsule by both solvers and every method, compared with published results.
//! * [`effects`]: the cost of each effect of a scene.
//! * [`report`]: presentation of the results.

pub mod effects;
pub mod flow;
pub mod report;
pub mod stability;
