//! The methods and effects of [`helfrich`], compiled and chosen at run time.
//!
//! * [`execute`]: threads and wide vectors for the core's loops.
//! * [`method`] and [`scalar`]: the bending methods and number types by name.
//! * [`noise`]: noise of positions, and its smoothing.
//! * [`contact`]: repulsion between surfaces.
//! * [`remesh`]: new meshes of smooth surfaces.
//! * [`ordered`]: large meshes in a cache-friendly order.
//! * [`checked`]: surfaces whose positions have been checked.
//! * [`effect`]: the effects that act on one surface, behind one dynamic call.
//! * [`held`]: area, volume and other functionals, and exact constraints on them.
//!
//! This is a separate crate with one codegen unit, because its loops are compiled twice, for
//! baseline vectors and for AVX2, and need no recompilation when other code changes.

mod act;

pub mod checked;
pub mod contact;
pub mod effect;
pub mod execute;
pub mod held;
pub mod method;
pub mod noise;
pub mod ordered;
pub mod remesh;
pub mod scalar;
