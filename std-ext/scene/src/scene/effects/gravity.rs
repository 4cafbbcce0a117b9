//! Gravity and buoyancy.

use super::super::keys::{Form, Keys, any, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshSource, Named, Parameter, Parameters,
    Preparation, Reader, SurfaceEffect,
};
use crate::scene::Driver;
use serde::Serialize;

/// Weight of the enclosed fluid minus that of the fluid that it displaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gravity {
    /// Mass density inside minus outside.
    pub density_difference: f64,
    /// Acceleration, pointing down.
    pub acceleration: [f64; 3],
}

impl Described for Gravity {
    const SUMMARY: &'static str =
        "Weight of the enclosed fluid minus that of the fluid that it displaces.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "density_difference",
            any(Dimension::DENSITY),
            "Mass density inside minus outside.",
        ),
        required(
            "acceleration",
            Form::Vector(Dimension::ACCELERATION),
            "Gravitational acceleration, pointing down.",
        ),
    ]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            density_difference: table.needed("density_difference"),
            acceleration: table.vector("acceleration").unwrap_or_default(),
        }
    }
}

impl SurfaceEffect for Gravity {
    fn check(&self, check: &mut Check<'_, '_>) {
        let name = check.name;
        let message = match check.driver {
            Some(Driver::Relax(_)) => format!(
                "\"{name}\" has a weight and nothing that carries it: the driver \"relax\" finds no \
                 equilibrium, and ends at its limit of iterations"
            ),
            Some(Driver::LatticeBoltzmann(lattice)) if lattice.walls() == [false; 3] => format!(
                "\"{name}\" has a weight, and in a box without walls nothing carries it: fluid and \
                 surface fall faster and faster; choose the flow \"channel\", or the driver \
                 \"boundary-integral\""
            ),
            _ => return,
        };
        check.doubt(Self::NAME, message);
    }

    fn needs_volume(&self) -> bool {
        true
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let difference = number.of(
            "density_difference",
            self.density_difference,
            Dimension::DENSITY,
        );
        let names = ["acceleration x", "y", "z"];
        let acceleration = number.vector(names, self.acceleration, Dimension::ACCELERATION);
        let parameters = [difference].into_iter().chain(acceleration);
        (String::new(), parameters.collect())
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let Some(modulus) = groups.bending_modulus() else {
            return;
        };
        let [x, y, z] = self.acceleration;
        let weight = self.density_difference * x.hypot(y).hypot(z);
        let bond = weight * groups.radius().powi(4) / modulus;
        groups.add("bending Bond number", "Δρ g R⁴/κ", bond);
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let density = self.density_difference;
        preparation.conservative(
            Self::NAME,
            helfrich::Gravity {
                weight: self.acceleration.map(|acceleration| density * acceleration),
                level: preparation.position,
            },
        )
    }
}
