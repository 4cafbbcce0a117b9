//! The methods and effects of [`helfrich`], compiled and chosen at run time.
//!
//! * [`method`] and [`scalar`]: the bending methods and number types by name.
//! * [`effect`]: the effects that act on one surface, behind one dynamic call.
//!
//! This is a separate crate with one codegen unit, because its loops are compiled twice, for
//! baseline vectors and for AVX2, and need no recompilation when other code changes.

mod act;

pub mod effect;
pub mod method;
pub mod scalar;

// Modules of another package, which the modules here name by `crate::`.
use helfrich_execute::{execute, ordered};
