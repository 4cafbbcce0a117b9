//! The setup of a lattice.

use crate::flow::lattice_boltzmann::LatticeError;
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;

/// The two sides of the box at the ends of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// Periodic: fluid that leaves on one side enters on the other.
    Periodic,
    /// Plane walls, half a cell beyond the outermost nodes. Links through an edge between walls
    /// belong to the wall of the first axis.
    Walls {
        /// Velocity of the wall at 0, along the wall.
        low: [f64; 3],
        /// Velocity of the other wall.
        high: [f64; 3],
    },
}

impl Sides {
    /// Two walls at rest.
    pub const RESTING: Self = Self::Walls {
        low: [0.0; 3],
        high: [0.0; 3],
    };
}

/// A box of fluid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Number of nodes along each axis. Multiples of 8 along x are fastest.
    pub cells: [usize; 3],
    /// The sides of the box, for each axis.
    pub sides: [Sides; 3],
    /// Kinematic viscosity ν = (τ − ½)/3. Best between 0.02 and 1.
    pub viscosity: f64,
    /// Whether there is inertia; without it, no term is quadratic in the velocity.
    pub inertia: bool,
    /// Number of threads. No result depends on it.
    pub threads: NonZeroUsize,
}

impl Setup {
    /// Whether viscosity and walls are possible.
    pub(super) fn check(&self) -> Result<(), LatticeError> {
        checked_viscosity(self.viscosity)?;
        for (axis, sides) in self.sides.iter().enumerate() {
            if let Sides::Walls { low, high } = *sides {
                for (velocity, high) in [(low, false), (high, true)] {
                    let squared: f64 = velocity.iter().map(|u| u * u).sum();
                    let subsonic = (0.0..1.0).contains(&(3.0 * squared));
                    if velocity[axis] != 0.0 || !subsonic {
                        return Err(LatticeError::WallVelocity {
                            axis,
                            high,
                            velocity,
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

pub(super) fn checked_viscosity(viscosity: f64) -> Result<f64, LatticeError> {
    if viscosity > 0.0 && viscosity.is_finite() {
        Ok(viscosity)
    } else {
        Err(LatticeError::Viscosity { viscosity })
    }
}
