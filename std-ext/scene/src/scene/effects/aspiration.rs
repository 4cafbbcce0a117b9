//! Suction into a pipette.

use super::super::keys::{Form, Keys, any, plain, positive, required};
use super::super::units::Dimension;
use super::{
    Builder, Described, EffectError, Groups, MeshSource, Named, Parameter, Parameters, Preparation,
    Reader, SurfaceEffect,
};
use glam::DVec3;
use serde::Serialize;

/// Suction behind the mouth of a pipette, `E = −Δp ∫ S(h/λ) dV` with `S(t) = 1/(1 + e^(−t))` at the depth h.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Aspiration {
    /// Δp, the pressure in front of the mouth minus that behind.
    pub pressure: f64,
    /// A point of the plane of the mouth.
    pub mouth: [f64; 3],
    /// Axis into the pipette, of any length above 0.
    pub axis: [f64; 3],
    /// Length λ over which the pressure falls.
    pub width: f64,
}

impl Described for Aspiration {
    const SUMMARY: &'static str = "Suction behind the mouth of a pipette, E = −Δp ∫ S(h/λ) dV with \
         S(t) = 1/(1 + e^(−t)) at the depth h. An obstacle with a repulsion stands for the walls of the pipette.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "pressure",
            any(Dimension::PRESSURE),
            "Suction Δp, the pressure in front of the mouth minus that behind.",
        ),
        required(
            "mouth",
            Form::Vector(Dimension::LENGTH),
            "A point of the plane of the mouth.",
        ),
        required("axis", Form::Direction, "Axis, into the pipette."),
        required(
            "width",
            positive(Dimension::LENGTH),
            "Length λ over which the pressure falls at the mouth, such as that of an edge.",
        ),
    ]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            pressure: table.needed("pressure"),
            mouth: table.vector("mouth").unwrap_or_default(),
            axis: table.vector("axis").unwrap_or([0.0, 0.0, 1.0]),
            width: table.needed("width"),
        }
    }
}

impl SurfaceEffect for Aspiration {
    fn needs_volume(&self) -> bool {
        true
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let [x, y, z] = self.axis;
        let names = ["mouth x", "y", "z"];
        let parameters = [
            number.of("pressure", self.pressure, Dimension::PRESSURE),
            number.of("width", self.width, Dimension::LENGTH),
        ];
        let mouth = number.vector(names, self.mouth, Dimension::LENGTH);
        (
            format!("along [{x}, {y}, {z}]"),
            parameters.into_iter().chain(mouth).collect(),
        )
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(modulus) = groups.bending_modulus() {
            let reduced = self.pressure * groups.radius().powi(3) / modulus;
            groups.add("reduced suction", "Δp R³/κ", reduced);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        preparation.conservative(
            Self::NAME,
            helfrich::Aspiration {
                pressure: self.pressure,
                mouth: self.mouth,
                axis: DVec3::from(self.axis).normalize().to_array(),
                width: self.width,
            },
        )
    }
}
