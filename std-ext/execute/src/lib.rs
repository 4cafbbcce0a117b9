//! Threads and wide vectors for the loops of [`helfrich`].
//!
//! * [`execute`]: the loops of the core on several threads, in vectors chosen at run time.
//! * [`clock`]: time, also where the standard library has none.
//! * [`ordered`]: large meshes in a cache-friendly order.
//! * [`team`]: processes that work on one run.

pub mod clock;
pub mod execute;
pub mod ordered;
pub mod team;
