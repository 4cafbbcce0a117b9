//! Studies of helfrich itself, which its users need not run: hard cases, a capsule in flow compared
//! with published results, the costs of methods, and those of the effects of a scene. The program of this package
//! makes their tables.
//!
//! * [`stability`]: methods and formulas on hard cases.
//! * [`costs`]: the cost of each method, for the program and the guides.
//! * [`effects`]: the cost of each effect of a scene.
//! * [`report`]: presentation of the results.

pub mod costs;
pub mod effects;
pub mod report;
pub mod stability;
