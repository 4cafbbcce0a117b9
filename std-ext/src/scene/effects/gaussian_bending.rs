//! Bending by the Gaussian modulus.

use super::super::keys::{Keys, any, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, SurfaceEffect,
};
use crate::scene::Boundary;
use serde::Serialize;

/// Bending by the Gaussian modulus, `E = κ_G ∫ K dS`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GaussianBending {
    /// Gaussian modulus κ_G, an energy.
    pub modulus: f64,
}

impl Described for GaussianBending {
    const SUMMARY: &'static str =
        "Bending by the Gaussian modulus, E = κ_G ∫ K dS; it acts at the edge of an open surface.";

    const KEYS: &'static Keys = &plain(&[required(
        "modulus",
        any(Dimension::ENERGY),
        "Gaussian modulus κ_G; −2κ to 0 for a membrane that is stable when flat.",
    )]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            modulus: table.needed("modulus"),
        }
    }
}

impl SurfaceEffect for GaussianBending {
    fn check(&self, check: &mut Check<'_, '_>) {
        super::refuse_on_lattice(Self::NAME, check);
        let bending = check.effects.bending.as_ref();
        let unstable = bending.is_none_or(|bending| self.modulus < -2.0 * bending.modulus.least());
        if unstable || self.modulus > 0.0 {
            let message = "with a Gaussian modulus below −2κ or above 0 the energy has no minimum: a \
                           membrane with a free edge bends without end";
            check.doubt("gaussian_bending.modulus", message.to_owned());
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        let reason = if check.mesh.boundary_edges == 0 {
            "is closed, so that its energy is the constant 2πχ κ_G"
        } else if check.boundary == Boundary::Clamped {
            "is clamped, so that its energy is constant"
        } else {
            return;
        };
        let message = format!(
            "`gaussian_bending` does nothing to \"{}\", which {reason}",
            check.name
        );
        check.doubt(Self::NAME, message);
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let modulus = number.of("modulus", self.modulus, Dimension::ENERGY);
        (String::new(), vec![modulus])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(modulus) = groups.bending_modulus() {
            groups.add(
                "Gaussian over bending modulus",
                "κ_G/κ",
                self.modulus / modulus,
            );
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let method = helfrich::GaussianBending::new(self.modulus);
        preparation.conservative(Self::NAME, method)
    }
}
