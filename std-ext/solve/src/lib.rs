//! Solvers for the membranes of [`helfrich`].
//!
//! * [`dynamics`]: relaxation to equilibrium and integration in time, for any forces.
//! * [`flow`]: viscous fluids, set in motion by the forces of membranes.
//! * [`smoothing`]: smoother positions, by fits or by mean-curvature flow.
//! * [`deformation`]: deformation and orientation of bodies in flow.
//! * [`rheology`]: stress of membranes in a sheared fluid, and where they are between its walls.

pub mod deformation;
pub mod dynamics;
pub mod flow;
pub mod rheology;
pub mod smoothing;
