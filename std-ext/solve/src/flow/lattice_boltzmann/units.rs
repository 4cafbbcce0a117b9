//! Conversion between lattice units and other units.

use crate::flow::lattice_boltzmann::stencil::Layout;
use crate::flow::lattice_boltzmann::{LatticeError, Precision};
use serde::{Deserialize, Serialize};

/// Lattice units in other units, physical or dimensionless: a quantity in those units is its number on
/// the lattice times the value that the method of its name returns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Units {
    /// Distance of nodes, a length.
    pub spacing: f64,
    /// Time of a step.
    pub step: f64,
    /// Density of the fluid at rest, mass per volume.
    pub density: f64,
}

impl Units {
    /// The units in which a fluid of this density and kinematic viscosity has `lattice_viscosity`
    /// on the lattice. A step is then `lattice_viscosity spacing²/viscosity`.
    ///
    /// # Errors
    /// If a parameter, or the step, is not a number above 0.
    pub fn with_viscosity(
        spacing: f64,
        density: f64,
        viscosity: f64,
        lattice_viscosity: f64,
    ) -> Result<Self, LatticeError> {
        let step = lattice_viscosity * spacing * spacing / viscosity;
        for (name, value) in [
            ("spacing of the nodes", spacing),
            ("density", density),
            ("viscosity", viscosity),
            ("lattice viscosity", lattice_viscosity),
            ("time of a step", step),
        ] {
            if !(value.is_normal() && value > 0.0) {
                return Err(LatticeError::Unit { name, value });
            }
        }
        Ok(Self {
            spacing,
            step,
            density,
        })
    }

    /// Length per time.
    pub fn velocity(&self) -> f64 {
        self.spacing / self.step
    }

    /// Rates of shear, 1/time.
    pub fn rate(&self) -> f64 {
        self.step.recip()
    }

    /// Squared length per time.
    pub fn kinematic_viscosity(&self) -> f64 {
        self.spacing * self.velocity()
    }

    /// Pressure times time.
    pub fn dynamic_viscosity(&self) -> f64 {
        self.density * self.kinematic_viscosity()
    }

    /// Force per area. The pressure of the fluid at rest is 1/3 of it.
    pub fn pressure(&self) -> f64 {
        self.density * self.velocity() * self.velocity()
    }

    /// Force per length: tensions, and moduli of membranes.
    pub fn tension(&self) -> f64 {
        self.pressure() * self.spacing
    }

    /// Force, on points and on nodes.
    pub fn force(&self) -> f64 {
        self.tension() * self.spacing
    }

    /// Force times length: bending rigidities.
    pub fn energy(&self) -> f64 {
        self.force() * self.spacing
    }

    /// Force per volume, which on the lattice is the force on a node.
    pub fn force_density(&self) -> f64 {
        self.pressure() / self.spacing
    }
}

/// Ma, the ratio of a speed on the lattice to that of sound, 1/√3. Errors by compressibility are
/// proportional to its square; 0.1 is large.
pub fn mach(speed: f64) -> f64 {
    3.0_f64.sqrt() * speed
}

/// Re = U L/ν, in any units.
pub fn reynolds(speed: f64, length: f64, viscosity: f64) -> f64 {
    speed * length / viscosity
}

/// Bytes that a lattice of this size takes, before nodes have forces, kept velocities, viscosities or
/// obstacles of their own; these add 3, 3 and 1 numbers and 2 bytes a node.
///
/// # Errors
/// If an axis has no nodes, or there are too many nodes to address.
pub fn memory<T: Precision>(cells: [usize; 3]) -> Result<usize, LatticeError> {
    Ok(Layout::new::<T>(cells)?.slots() * size_of::<T>())
}
