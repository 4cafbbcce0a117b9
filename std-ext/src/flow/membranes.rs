//! What a fluid sees of membranes, and membranes of a fluid.

use std::time::{Duration, Instant};

/// What membranes exert on the fluid, over the positions of all of them, one after the other.
pub trait Membranes {
    /// Sets `forces` to the nodal forces F_i. F_i over a third of the area of the triangles around
    /// is the force per area that acts on the fluid.
    ///
    /// # Errors
    /// The reason why there are none.
    fn set_forces(&mut self, positions: &[[f64; 3]], forces: &mut [[f64; 3]])
    -> Result<(), String>;

    /// Whether there are forces that depend on velocities.
    fn are_viscous(&self) -> bool {
        false
    }

    /// Adds those, linear in the velocities.
    fn add_viscous_forces(
        &mut self,
        _positions: &[[f64; 3]],
        _velocities: &[[f64; 3]],
        _forces: &mut [[f64; 3]],
    ) {
    }
}

/// What something took so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// How often it was done.
    pub evaluations: u64,
    /// The time that this took.
    pub time: Duration,
}

/// The fluid at some points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fluid {
    /// u at each.
    pub velocity: Vec<[f64; 3]>,
    /// p at each; 0 far away, if the ambient flow is linear.
    pub pressure: Vec<f64>,
}

impl Effort {
    pub(super) fn add(&mut self, start: Instant) {
        self.evaluations += 1;
        self.time += start.elapsed();
    }
}
