//! Companion of [`helfrich`]: everything that opens files, draws random numbers, starts threads or
//! prints.
//!
//! * [`io`]: mesh files. [`generate`]: mesh families on exact shapes.
//!   [`subdivide`]: refined meshes.
//! * [`method`] and [`scalar`]: the bending methods and number types, chosen at run time.
//!   [`info`]: properties of a mesh. [`orientation`]: components
//!   that are inside out. [`packing`]: bodies placed at random in a box. [`polygon`]: polygons divided into triangles. [`repair`]: meshes made of
//!   triangles that are none.
//! * [`measurement`]: curvatures with error bars, by jets that choose their scale from the noise.
//!   [`painting`]: their quantities as colours; [`remarks`]: what has to be said about them.
//! * [`execute`]: threads and wide vectors for the core's loops.
//! * [`team`]: processes that work on one run.
//! * [`study`]: accuracy and cost of the methods; [`verdict`]: whether they converge;
//!   [`answer`]: the cheapest method for an accuracy; [`recommend`]: the cheapest method on a mesh
//!   of the user. [`provenance`]: program, compiler and machine of measurements.
//! * [`scene`]: scene files, validated: surfaces, the effects on each, the driver, the outputs.
//! * [`effect`] and [`simulation`]: surfaces and effects of a scene, prepared for evaluation.
//!   [`dynamics`]: relaxation of membranes under any forces, and integration in time. [`flow`]:
//!   membranes in viscous fluid. [`smoothing`]: smoother positions. [`deformation`]: deformation and orientation of bodies in flow;
//!   [`rheology`]: their stress, and where they are between walls;
//!   [`section`]: sections by planes; [`enclosure`]: points inside surfaces.
//! * [`run`]: a run of a scene in a folder; [`sweep`]: a scene with every combination of some
//!   values. [`checkpoint`] and [`series`]: the stored state of a run, and its numbers over time.
//!   [`lock`]: exclusive access to folders and files. [`picture`]: surfaces coloured by a field,
//!   and plots.
//! * [`report`]: tables, CSV and HTML of results.
//!
//! The feature `pictures` writes pictures and plots as PNG files, also those of runs, sweeps and
//! pages. Without it there is no encoder among the dependencies, and a run of a scene that asks for
//! such files is refused ([`run::RunError::NoPictures`]).

pub use helfrich_draw::picture;
pub use helfrich_evaluate::{effect, method, scalar};
pub use helfrich_execute::{clock, execute, ordered, team};
pub use helfrich_mesh::{
    enclosure, generate, info, io, orientation, packing, parting, polygon, repair, section,
    subdivide,
};
pub use helfrich_run::{checkpoint, lock, plots, run, sweep};
pub use helfrich_scene::{scene, series, simulation};
pub use helfrich_shape::{checked, contact, held, noise, remesh};
pub use helfrich_solve::{deformation, dynamics, flow, rheology, smoothing};
pub use helfrich_study::{
    answer, measurement, painting, provenance, recommend, remarks, report, study, verdict,
};
