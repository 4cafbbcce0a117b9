//! Membranes in flow: the ambient flow and the flow due to the forces of membranes.
//!
//! Two solvers compute velocities from forces; neither knows files, scenes or effects:
//!
//! * boundary integrals, for Stokes flow in unbounded fluid: no inertia, velocities linear in the
//!   forces. [`SingleLayer`] is the velocity due to forces in fluid of one viscosity, inside and
//!   outside; [`DoubleLayer`] is the contribution of other viscosities inside, and [`Gmres`] solves
//!   the resulting equation. [`Suspension`] combines them.
//! * [`lattice_boltzmann`]: fluid with walls and inertia on a lattice. [`Immersion`] couples membranes
//!   to it.
//!
//! Both get forces from [`Membranes`], keep volumes with [`KeptVolumes`], and keep the meshes of fluid
//! membranes even with [`Redistribution`].

mod boundary_integral;
mod channel;
mod contact_stiffness;
mod course;
mod gmres;
mod immersion;
pub mod lattice_boltzmann;
mod local_mobility;
mod membranes;
mod recent;
mod redistribution;
mod suspension;
mod vectors;
mod volume;

pub use boundary_integral::{DoubleLayer, SingleLayer, alone};
pub use channel::Channel;
pub use contact_stiffness::{AdhesiveWall, Barrier};
pub use course::Course;
pub use gmres::{Gmres, Product, Solved};
pub use immersion::{Immersion, ImmersionError, ImmersionPrecision, ImmersionState, Ripples};
use local_mobility::LocalMobility;
pub use membranes::{Effort, Fluid, Membranes};
pub use recent::Recent;
pub use redistribution::Redistribution;
pub use suspension::{Moving, SOLUTION_TOLERANCE, Suspension};
pub use volume::KeptVolumes;

use glam::{DMat3, DVec3};

/// The ambient flow u∞, without membranes. Lengths and times are in the units of the positions and of
/// the moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ambient {
    /// `u = L·x`.
    Linear {
        /// L, 1/time: `gradient[i][j]` is ∂u_i/∂x_j. Its trace is 0 in an incompressible fluid.
        gradient: [[f64; 3]; 3],
    },
    /// `u = U (1 − ρ²/R²) t`, ρ the distance from an axis along the unit vector t: the flow in a
    /// round tube of radius R, without the tube. The same paraboloid continues beyond ρ = R.
    Poiseuille {
        /// U, the velocity on the axis.
        centre_velocity: f64,
        /// R, a length.
        radius: f64,
        /// The direction of the axis and the flow, of any length.
        direction: [f64; 3],
        /// A point of the axis.
        through: [f64; 3],
    },
}

impl Ambient {
    /// Simple shear, `u = (γ̇ y, 0, 0)`. The long axis of a soft capsule is between x and y.
    pub fn shear(rate: f64) -> Self {
        let gradient = [[0.0, rate, 0.0], [0.0; 3], [0.0; 3]];
        Self::Linear { gradient }
    }

    /// Uniaxial extension, `u = ε̇ (x, −y/2, −z/2)`.
    pub fn extension(rate: f64) -> Self {
        let [along, across] = [rate, -0.5 * rate];
        let gradient = [[along, 0.0, 0.0], [0.0, across, 0.0], [0.0, 0.0, across]];
        Self::Linear { gradient }
    }

    /// Plane extension, `u = ε̇ (x, −y, 0)`.
    pub fn plane_extension(rate: f64) -> Self {
        let gradient = [[rate, 0.0, 0.0], [0.0, -rate, 0.0], [0.0; 3]];
        Self::Linear { gradient }
    }

    /// u∞ at a point.
    pub fn velocity(&self, point: [f64; 3]) -> [f64; 3] {
        match *self {
            Self::Linear { gradient } => {
                let columns = DMat3::from_cols_array_2d(&gradient);
                (columns.transpose() * DVec3::from(point)).to_array()
            }
            Self::Poiseuille {
                centre_velocity,
                radius,
                direction,
                through,
            } => {
                let direction = DVec3::from(direction).normalize_or_zero();
                let away = (DVec3::from(point) - DVec3::from(through)) / radius;
                let across = away - away.dot(direction) * direction;
                (centre_velocity * (1.0 - across.length_squared()) * direction).to_array()
            }
        }
    }

    /// The pressure that drives u∞, at a point of fluid of viscosity μ: `∇p = μ ∇²u∞`.
    ///
    /// It is 0 for linear flows, by choice of a constant, and `−4μU/R² t·(x − x_axis)` in
    /// the paraboloid, 0 at the point of the axis.
    pub fn pressure(&self, point: [f64; 3], viscosity: f64) -> f64 {
        match *self {
            Self::Linear { .. } => 0.0,
            Self::Poiseuille {
                centre_velocity,
                radius,
                direction,
                through,
            } => {
                let direction = DVec3::from(direction).normalize_or_zero();
                let along = (DVec3::from(point) - DVec3::from(through)).dot(direction) / radius;
                -4.0 * viscosity * centre_velocity / radius * along
            }
        }
    }

    /// Adds u∞ at every point.
    ///
    /// # Panics
    /// If there are more points than velocities.
    pub fn add_velocity(&self, points: &[[f64; 3]], velocity: &mut [[f64; 3]]) {
        for (&point, sum) in points.iter().zip(&mut velocity[..points.len()]) {
            *sum = (DVec3::from(*sum) + DVec3::from(self.velocity(point))).to_array();
        }
    }
}
