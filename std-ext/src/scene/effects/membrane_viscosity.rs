//! Viscosity of the membrane.

use super::super::keys::{Form, Keys, Range, optional, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshSource, Named, Parameter, Parameters,
    Preparation, Reader, SurfaceEffect,
};
use crate::effect::Viscosity;
use serde::Serialize;

/// Viscosities of the membrane: force times time over length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MembraneViscosity {
    /// Shear viscosity.
    pub shear: f64,
    /// Dilational viscosity.
    pub dilational: f64,
}

impl Described for MembraneViscosity {
    const SUMMARY: &'static str = "Viscosity of the membrane; for drivers with a time.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "shear",
            Form::Number(Dimension::SURFACE_VISCOSITY, Range::NotNegative),
            "Shear viscosity of the membrane.",
        ),
        optional(
            "dilational",
            Form::Number(Dimension::SURFACE_VISCOSITY, Range::NotNegative),
            "Dilational viscosity of the membrane; by default 0.",
        ),
    ]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            shear: table.needed("shear"),
            dilational: table.number("dilational").unwrap_or(0.0),
        }
    }
}

impl SurfaceEffect for MembraneViscosity {
    fn check(&self, check: &mut Check<'_, '_>) {
        if check.relaxes() {
            check.contradiction(
                Self::NAME,
                "the driver \"relax\" has no time, and nothing that a viscosity slows down: leave \
                 [surface.membrane_viscosity] out, or choose the driver \"boundary-integral\""
                    .to_owned(),
            );
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let dimension = Dimension::SURFACE_VISCOSITY;
        let parameters = vec![
            number.of("shear", self.shear, dimension),
            number.of("dilational", self.dilational, dimension),
        ];
        (String::new(), parameters)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let Some(viscosity) = groups.driver.viscosity() else {
            return;
        };
        let across = viscosity * groups.mesh.enclosed_radius();
        groups.add("Boussinesq number, shear", "η_s/(μa)", self.shear / across);
        let dilational = self.dilational / across;
        groups.add("Boussinesq number, dilation", "η_d/(μa)", dilational);
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let viscosity = helfrich::MembraneViscosity {
            shear: self.shear,
            dilational: self.dilational,
        };
        preparation.viscosity = Some(Viscosity::new(viscosity, preparation.mesh()));
        Ok(())
    }
}
