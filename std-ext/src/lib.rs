//! Companion of [`helfrich`]: whatever opens a file, draws a random number, starts a thread or
//! prints.
//!
//! * [`io`]: mesh files. [`generate`]: mesh families on exact shapes.
//!   [`subdivide`]: refined meshes.
//! * [`method`] and [`scalar`]: the bending methods and number types, chosen at run time.
//!   [`info`]: what a mesh is like.
//! * [`execute`]: threads and wide vectors for the core's loops.
//! * [`study`]: accuracy and cost of the methods; [`verdict`]: whether they converge;
//!   [`answer`]: which is the cheapest for an accuracy; [`recommend`]: which is on a
//!   mesh of one's own. [`provenance`]: program, compiler and machine of all that.
//! * [`scene`]: scene files, validated: surfaces, the effects on each, the driver, the outputs.
//! * [`effect`] and [`simulation`]: exactly what a scene names, made ready; nothing moves or is
//!   written. [`dynamics`]: membranes relax to equilibrium, whatever acts on them. [`flow`]: what
//!   their forces do to viscous fluid. [`deformation`]: how bodies in flow are deformed and turned;
//!   [`section`]: where a plane cuts them; [`enclosure`]: what is inside of them.
//! * [`run`]: a scene driven in a folder; [`sweep`]: one with every combination of some values. [`checkpoint`] and [`series`]: what a run leaves to go on
//!   from, and its numbers over time. [`lock`]: what one process at a time writes to. [`picture`]: surfaces coloured by a field, and plots, as PNG
//!   files.
//! * [`report`]: how all of this is shown.

pub use helfrich_draw::picture;
pub use helfrich_evaluate::{contact, effect, execute, method, noise, scalar};
pub use helfrich_mesh::{enclosure, generate, info, io, section, subdivide};
pub use helfrich_solve::{deformation, dynamics, flow};

pub mod answer;
pub mod checkpoint;
pub mod lock;
pub mod plots;
pub mod provenance;
pub mod recommend;
pub mod report;
pub mod run;
pub mod scene;
pub mod series;
mod sha256;
pub mod simulation;
mod six;
pub mod study;
pub mod sweep;
pub mod verdict;
