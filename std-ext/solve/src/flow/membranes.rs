//! The interface between a fluid and membranes.

use std::time::{Duration, Instant};

/// Forces of membranes on the fluid, for the positions of all of them, one after the other.
pub trait Membranes {
    /// Sets `forces` to the nodal forces F_i. F_i over a third of the area of the triangles around
    /// is the force per area that acts on the fluid.
    ///
    /// # Errors
    /// The reason why forces cannot be computed.
    fn set_forces(&mut self, positions: &[[f64; 3]], forces: &mut [[f64; 3]])
    -> Result<(), String>;

    /// Whether some forces depend on velocities.
    fn are_viscous(&self) -> bool {
        false
    }

    /// Adds the forces that depend on velocities, linearly.
    fn add_viscous_forces(
        &mut self,
        _positions: &[[f64; 3]],
        _velocities: &[[f64; 3]],
        _forces: &mut [[f64; 3]],
    ) {
    }
}

/// Number of evaluations and time so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Number of evaluations.
    pub evaluations: u64,
    /// Their total time.
    pub time: Duration,
}

/// The fluid at some points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fluid {
    /// The velocity u at each point.
    pub velocity: Vec<[f64; 3]>,
    /// The pressure p at each point; 0 far away, if the ambient flow is linear.
    pub pressure: Vec<f64>,
}

impl Effort {
    pub(super) fn add(&mut self, start: Instant) {
        self.evaluations += 1;
        self.time += start.elapsed();
    }
}
