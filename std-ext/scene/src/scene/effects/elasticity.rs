//! Elasticity in the surface's plane.

use super::super::keys::{Form, Keys, Range, optional, plain, positive, required};
use super::super::units::Dimension;
use super::reference::FORM;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, Reference, Stiffness, SurfaceEffect, capillary_number,
};
use crate::info::MeshInfo;
use helfrich::{NeoHookean, Skalak};
use serde::Serialize;

/// In-plane elasticity over a reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Elasticity {
    /// The law.
    pub law: InPlaneLaw,
    /// The stress-free mesh.
    pub reference: Reference,
}

/// A law of in-plane elasticity, with its moduli in force per length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "name")]
pub enum InPlaneLaw {
    /// `W = G/2 (I1 − 1 + 1/(I2 + 1))`.
    NeoHookean {
        /// G.
        shear_modulus: f64,
    },
    /// `W = G/4 (I1² + 2 I1 − 2 I2 + C I2²)`.
    Skalak {
        /// G.
        shear_modulus: f64,
        /// C.
        area_ratio: f64,
    },
}

impl InPlaneLaw {
    /// Shear modulus G.
    pub fn shear_modulus(&self) -> f64 {
        match *self {
            Self::NeoHookean { shear_modulus } | Self::Skalak { shear_modulus, .. } => {
                shear_modulus
            }
        }
    }

    /// Area modulus at small strain: 3 G for neo-Hookean, (1 + 2 C) G for Skalak.
    pub fn area_modulus(&self) -> f64 {
        match *self {
            Self::NeoHookean { shear_modulus } => 3.0 * shear_modulus,
            Self::Skalak {
                shear_modulus,
                area_ratio,
            } => (1.0 + 2.0 * area_ratio) * shear_modulus,
        }
    }

    fn read(table: Reader<'_>, builder: &mut Builder<'_>) -> Self {
        let shear_modulus = table.needed("shear_modulus");
        let area_ratio = table.number("area_ratio");
        let given = table.has("area_ratio");
        match table.text("law") {
            Some("skalak") => {
                if !given {
                    builder.contradiction(
                        &table.origin_of("law"),
                        "Skalak's law lacks `area_ratio`: C, such as 1, for an area modulus of \
                         (1 + 2 C) G"
                            .to_owned(),
                    );
                }
                Self::Skalak {
                    shear_modulus,
                    area_ratio: area_ratio.unwrap_or(f64::NAN),
                }
            }
            law => {
                if given && law == Some("neo-hookean") {
                    builder.contradiction(
                        &table.origin_of("area_ratio"),
                        "`area_ratio` is the C of Skalak's law, and the neo-Hookean has none: leave \
                         it out, or choose law = \"skalak\""
                            .to_owned(),
                    );
                }
                Self::NeoHookean { shear_modulus }
            }
        }
    }
}

/// Memory of a law with a reference: three numbers for each of two triangles per vertex, forces,
/// energies.
pub(super) const BYTES: u64 = 130;

/// Below this Ca_G neo-Hookean capsules without bending wrinkle at the scale of their mesh:
/// E. Lac, D. Barthès-Biesel, N. A. Pelekasis, J. Tsamopoulos, J. Fluid Mech. 516 (2004) 303.
const WRINKLING: f64 = 0.45;

impl Described for Elasticity {
    const SUMMARY: &'static str = "In-plane elasticity relative to a stress-free reference.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "law",
            Form::Choice(|| vec!["neo-hookean", "skalak"]),
            "The law of in-plane elasticity.",
        ),
        required(
            "shear_modulus",
            positive(Dimension::TENSION),
            "Shear modulus G; one third of the E_s that some articles give.",
        ),
        optional(
            "area_ratio",
            Form::Number(Dimension::NONE, Range::Above(-0.5)),
            "C of Skalak's law, which requires it; the area modulus is (1 + 2 C) G.",
        ),
        optional(
            "reference",
            FORM,
            "The stress-free reference: \"initial\", which is the default, or a table.",
        ),
    ]);

    fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self {
        Self {
            law: InPlaneLaw::read(table, builder),
            reference: Reference::read(table, source, builder),
        }
    }
}

impl SurfaceEffect for Elasticity {
    fn check(&self, check: &mut Check<'_, '_>) {
        if check.relaxes() && check.effects.bending.is_none() {
            let message = format!(
                "\"{}\" is elastic and has no bending: where it is compressed it wrinkles at the \
                 scale of its mesh, more so on a finer one: add [surface.bending]",
                check.name
            );
            check.doubt(Self::NAME, message);
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        if let InPlaneLaw::NeoHookean { .. } = self.law
            && check.effects.bending.is_none()
            && let Some(capillary) = capillary_number(check.effects, check.mesh, check.driver)
            && capillary < WRINKLING
        {
            let message = format!(
                "\"{}\" is neo-Hookean and has no bending, and with Ca_G = {capillary:.3}, below about \
                 {WRINKLING}, the flow compresses it: it wrinkles at the scale of its mesh, more so on \
                 a finer one: add [surface.bending]",
                check.name
            );
            check.doubt(Self::NAME, message);
        }
    }

    fn reference(&self) -> Option<&Reference> {
        Some(&self.reference)
    }

    fn reference_mut(&mut self) -> Option<&mut Reference> {
        Some(&mut self.reference)
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn stiffness(&self) -> Stiffness {
        Stiffness {
            area: self.law.area_modulus(),
            shear: self.law.shear_modulus(),
            ..Stiffness::default()
        }
    }

    fn bytes(&self, _: &MeshInfo) -> u64 {
        BYTES
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let shear = self.law.shear_modulus();
        let mut parameters = vec![number.of("shear_modulus", shear, Dimension::TENSION)];
        let name = match self.law {
            InPlaneLaw::NeoHookean { .. } => "neo-hookean",
            InPlaneLaw::Skalak { area_ratio, .. } => {
                parameters.push(number.plain("area_ratio", area_ratio));
                "skalak"
            }
        };
        let choice = format!("{name}, without stress {}", self.reference);
        (choice, parameters)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let [shear, area] = [self.law.shear_modulus(), self.law.area_modulus()];
        groups.add("area over shear modulus", "K_s/G", area / shear);
        let capillary = capillary_number(groups.effects, groups.mesh, groups.driver);
        if let Some(capillary) = capillary {
            groups.add("capillary number by G", "Ca_G = μγ̇a/G", capillary);
            let name = "capillary number by E_s = 3 G";
            groups.add(name, "Ca_E = μγ̇a/E_s", capillary / 3.0);
        }
        let Some(modulus) = groups.bending_modulus() else {
            return;
        };
        let squared = groups.radius().powi(2);
        if groups.driver.viscosity().is_some() {
            let b = modulus / (groups.mesh.enclosed_radius().powi(2) * shear);
            groups.add("bending number by G", "b = κ/(a² G)", b);
            groups.add("bending number by E_s = 3 G", "κ/(a² E_s)", b / 3.0);
        } else {
            let b = modulus / (squared * shear);
            groups.add("bending number by G", "b = κ/(R² G)", b);
            groups.add("bending number by E_s = 3 G", "κ/(R² 3 G)", b / 3.0);
        }
        let young = 4.0 * area * shear / (area + shear);
        groups.add(
            "Föppl–von Kármán number",
            "γ = Y R²/κ, Y = 4 K_s G/(K_s + G)",
            young * squared / modulus,
        );
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        match self.law {
            InPlaneLaw::NeoHookean { shear_modulus } => {
                let law = NeoHookean { shear_modulus };
                preparation.in_plane::<Self, _>(law, &self.reference)
            }
            InPlaneLaw::Skalak {
                shear_modulus,
                area_ratio,
            } => {
                let law = Skalak {
                    shear_modulus,
                    area_ratio,
                };
                preparation.in_plane::<Self, _>(law, &self.reference)
            }
        }
    }
}
