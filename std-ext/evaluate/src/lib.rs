//! The methods and effects of [`helfrich`], compiled and chosen at run time.
//!
//! * [`execute`]: threads and wide vectors for the core's loops.
//! * [`method`] and [`scalar`]: the bending methods and number types by name.
//! * [`noise`]: noise of positions, and its smoothing.
//! * [`contact`]: repulsion between surfaces.
//! * [`effect`]: anything that acts on one surface, behind one dispatch.
//!
//! A crate of its own, in one codegen unit: its loops are compiled twice, for every processor and for
//! AVX2, and need not be again when anything else changes.

pub mod contact;
pub mod effect;
pub mod execute;
pub mod method;
pub mod noise;
pub mod scalar;
