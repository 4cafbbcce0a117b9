//! Bending by the Gaussian modulus.

use super::super::keys::{Form, Keys, any, plain, required};
use super::super::material::{COLUMN, Material};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, SurfaceEffect,
};
use crate::io::Column;
use crate::scene::Boundary;
use serde::Serialize;
use std::sync::Arc;

/// Bending by the Gaussian modulus, `E = ∫ κ_G K dS`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaussianBending {
    /// Gaussian modulus κ_G, an energy.
    pub modulus: Material,
}

impl Described for GaussianBending {
    const SUMMARY: &'static str = "Bending by the Gaussian modulus, E = ∫ κ_G K dS; it acts at the edge of an open surface, and where κ_G \
         varies.";

    const KEYS: &'static Keys = &plain(&[required(
        "modulus",
        Form::Either(&[any(Dimension::ENERGY), COLUMN]),
        "Gaussian modulus κ_G; −2κ to 0 for a membrane that is stable when flat. A number, or a column \
         of the mesh file with a number for each vertex.",
    )]);

    fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self {
        let modulus = Material::read(table, "modulus", source, builder);
        Self {
            modulus: modulus.unwrap_or(Material::Number(f64::NAN)),
        }
    }
}

impl SurfaceEffect for GaussianBending {
    fn check(&self, check: &mut Check<'_, '_>) {
        super::refuse_on_lattice(Self::NAME, check);
        let bending = check.effects.bending.as_ref();
        let unstable =
            bending.is_none_or(|bending| self.modulus.least() < -2.0 * bending.modulus.least());
        if unstable || self.modulus.largest() > 0.0 {
            let message = "with a Gaussian modulus below −2κ or above 0 the energy has no minimum: a \
                           membrane with a free edge bends without end";
            check.doubt("gaussian_bending.modulus", message.to_owned());
        }
        if self.modulus.uniform().is_none() {
            check.doubt_unheld_parts(Self::NAME);
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        if self.modulus.uniform().is_none() {
            return;
        }
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

    fn columns(&self) -> Vec<&Arc<Column>> {
        self.modulus.column().into_iter().collect()
    }

    fn columns_mut(&mut self) -> Vec<&mut Arc<Column>> {
        self.modulus.column_mut().into_iter().collect()
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        match &self.modulus {
            Material::Number(modulus) => {
                let modulus = number.of("modulus", *modulus, Dimension::ENERGY);
                (String::new(), vec![modulus])
            }
            column => {
                let range = column.range().unwrap_or_default();
                (format!("modulus {range}"), Vec::new())
            }
        }
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let (Some(bending), Some(gaussian)) = (groups.bending_modulus(), self.modulus.uniform())
        {
            groups.add("Gaussian over bending modulus", "κ_G/κ", gaussian / bending);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        match self.modulus.uniform() {
            Some(modulus) => {
                let method = helfrich::GaussianBending::new(modulus);
                preparation.conservative(Self::NAME, method)
            }
            None => {
                let modulus = preparation.parameter(&self.modulus);
                preparation.conservative(Self::NAME, helfrich::GaussianDomains { modulus })
            }
        }
    }
}
