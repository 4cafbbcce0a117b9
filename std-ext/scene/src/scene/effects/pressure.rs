//! Osmotic pressure.

use super::super::keys::{Keys, any, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Geometry, Groups, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, SurfaceEffect,
};
use helfrich::{AnyFunctional, OsmoticPressure};
use serde::Serialize;

/// Pressure inside minus pressure outside, `E = −Δp V`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pressure {
    /// Δp, force per area.
    pub value: f64,
}

impl Described for Pressure {
    const SUMMARY: &'static str = "Osmotic pressure, E = −Δp V.";

    const KEYS: &'static Keys = &plain(&[required(
        "value",
        any(Dimension::PRESSURE),
        "Pressure inside minus pressure outside, Δp.",
    )]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            value: table.needed("value"),
        }
    }
}

impl SurfaceEffect for Pressure {
    fn quantity(&self, _: Geometry) -> Option<AnyFunctional> {
        Some(AnyFunctional::Volume)
    }

    fn check(&self, check: &mut Check<'_, '_>) {
        let volume = check.effects.volume;
        if volume.is_some_and(|volume| volume.hold.is_exact()) {
            let message = super::held::idle(Self::NAME, check.name, "volume");
            check.doubt(Self::NAME, message);
        }
        if check.fluid().is_some() {
            let message = format!(
                "`pressure` does nothing to \"{}\", whose volume the fluid inside keeps: leave it out",
                check.name
            );
            check.doubt(Self::NAME, message);
        }
    }

    fn needs_volume(&self) -> bool {
        true
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let value = number.of("value", self.value, Dimension::PRESSURE);
        (String::new(), vec![value])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(modulus) = groups.bending_modulus() {
            let reduced = self.value * groups.radius().powi(3) / modulus;
            groups.add("reduced pressure", "Δp R³/κ", reduced);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        preparation.conservative(Self::NAME, OsmoticPressure::new(self.value))
    }
}
