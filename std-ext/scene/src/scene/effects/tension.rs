//! Surface tension.

use super::super::keys::{Keys, any, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Geometry, Groups, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, Stiffness, SurfaceEffect,
};
use helfrich::{AnyFunctional, SurfaceTension};
use serde::Serialize;

/// Surface tension, `E = σ A`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tension {
    /// σ, force per length.
    pub value: f64,
}

impl Described for Tension {
    const SUMMARY: &'static str = "Surface tension, E = σ A.";

    const KEYS: &'static Keys = &plain(&[required(
        "value",
        any(Dimension::TENSION),
        "Surface tension σ.",
    )]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            value: table.needed("value"),
        }
    }
}

impl SurfaceEffect for Tension {
    fn quantity(&self, _: Geometry) -> Option<AnyFunctional> {
        Some(AnyFunctional::Area)
    }

    fn check(&self, check: &mut Check<'_, '_>) {
        let area = check.effects.area;
        if area.is_some_and(|area| area.hold.is_exact()) {
            let message = super::held::idle(Self::NAME, check.name, "area");
            check.doubt(Self::NAME, message);
        }
    }

    fn stiffness(&self) -> Stiffness {
        Stiffness {
            tension: self.value,
            ..Stiffness::default()
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let value = number.of("value", self.value, Dimension::TENSION);
        (String::new(), vec![value])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(modulus) = groups.bending_modulus() {
            let reduced = self.value * groups.radius().powi(2) / modulus;
            groups.add("reduced tension", "σ R²/κ", reduced);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        preparation.conservative(Self::NAME, SurfaceTension::new(self.value))
    }
}
