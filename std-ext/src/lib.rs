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
//!   mesh of one's own; [`flow_study`]: what they make of a capsule in
//!   flow; [`effect_study`]: what the effects of a scene cost; [`stability`]: whether methods stand
//!   hard cases. [`provenance`]: program, compiler and machine of all that.
//! * [`scene`]: scene files, validated: surfaces, the effects on each, the driver, the outputs.
//! * [`effect`] and [`simulation`]: exactly what a scene names, made ready; nothing moves or is
//!   written. [`dynamics`]: membranes relax to equilibrium, whatever acts on them. [`flow`]: what
//!   their forces do to viscous fluid. [`deformation`]: how bodies in flow are deformed and turned;
//!   [`section`]: where a plane cuts them; [`enclosure`]: what is inside of them.
//! * [`run`]: a scene driven in a folder; [`sweep`]: one with every combination of some values. [`checkpoint`] and [`series`]: what a run leaves to go on
//!   from, and its numbers over time. [`picture`]: surfaces coloured by a field, and plots, as PNG
//!   files.
//! * [`report`]: how all of this is shown.

pub use helfrich_evaluate::{effect, execute, method, scalar};

pub mod answer;
pub mod checkpoint;
pub mod deformation;
pub mod dynamics;
pub mod effect_study;
pub mod enclosure;
pub mod flow;
pub mod flow_study;
pub mod generate;
pub mod info;
pub mod io;
pub mod picture;
pub mod plots;
pub mod provenance;
pub mod recommend;
pub mod report;
pub mod run;
pub mod scene;
pub mod section;
pub mod series;
pub mod simulation;
pub mod stability;
pub mod study;
pub mod subdivide;
pub mod sweep;
pub mod verdict;
