//! Viscosity of the membrane.

use super::super::keys::{Form, Keys, Range, optional, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, SurfaceEffect,
};
use crate::effect::Viscosity;
use crate::scene::Driver;
use crate::six::Six;
use serde::Serialize;

/// The largest η_d/η_s at which a membrane is taken for one that resists shear alone.
const MOST_DILATIONAL: f64 = 0.1;

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

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        let Some(viscosity) = check.driver.viscosity() else {
            return;
        };
        let number = self.shear / (viscosity * check.mesh.enclosed_radius());
        let on_lattice = matches!(check.driver, Driver::LatticeBoltzmann(_));
        let (least, measured) = if on_lattice {
            let growths = "0.99, 0.83, 0.55 and 0.22";
            let place = "with 5 nodes per radius and 642 vertices";
            (2.0, (growths, "1, 5, 20 and 200", place))
        } else {
            (5.0, ("0.90 and 0.73", "5 and 20", "with 162 vertices"))
        };
        if self.dilational >= MOST_DILATIONAL * self.shear || number < least {
            return;
        }
        let (growths, numbers, place) = measured;
        let more = if on_lattice {
            "more nodes per radius (0.78 with 10 at 20), or the driver \"boundary-integral\" on a fine \
             mesh"
        } else {
            "more vertices (0.97 and 0.92 with 642)"
        };
        let message = format!(
            "the membrane of \"{}\" resists shear with η_s/(μa) = {} and changes of area with \
             η_d/(μa) = {}: it deforms by dilation alone, for which coarse meshes and lattices are too \
             stiff. Small deformations of a membrane with η_d = 0 grew with {growths} of the rate of \
             theory at η_s/(μa) = {numbers} {place}: choose a `dilational` of the order of `shear`, \
             or {more}",
            check.name,
            Six(number),
            Six(number * self.dilational / self.shear),
        );
        check.doubt(Self::NAME, message);
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
