//! A penalty on the area of each triangle.

use super::super::keys::{Keys, optional, plain, positive, required};
use super::super::units::Dimension;
use super::reference::FORM;
use super::{
    Builder, Described, EffectError, Groups, MeshSource, Parameter, Parameters, Preparation,
    Reader, Reference, Stiffness, SurfaceEffect,
};
use crate::info::MeshInfo;
use serde::Serialize;

/// A penalty on the area of each triangle, `E = k/2 Σ (A − A0)²/A0`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocalArea {
    /// k, force per length.
    pub modulus: f64,
    /// The positions at which A0 is measured.
    pub reference: Reference,
}

impl Described for LocalArea {
    const SUMMARY: &'static str =
        "Area of each triangle, held by a penalty E = k/2 Σ (A − A0)²/A0.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "modulus",
            positive(Dimension::TENSION),
            "Modulus k of the penalty.",
        ),
        optional(
            "reference",
            FORM,
            "The reference of the triangles' areas: \"initial\", which is the default, or a \
             table.",
        ),
    ]);

    fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self {
        Self {
            modulus: table.needed("modulus"),
            reference: Reference::read(table, source, builder),
        }
    }
}

impl SurfaceEffect for LocalArea {
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
            area: self.modulus,
            ..Stiffness::default()
        }
    }

    fn bytes(&self, _: &MeshInfo) -> u64 {
        super::elasticity::BYTES
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let modulus = number.of("modulus", self.modulus, Dimension::TENSION);
        (format!("penalty, A0 {}", self.reference), vec![modulus])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(bending) = groups.bending_modulus() {
            let ratio = self.modulus * groups.radius().powi(2) / bending;
            groups.add("local area over bending modulus", "k R²/κ", ratio);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let law = helfrich::LocalArea {
            area_modulus: self.modulus,
        };
        preparation.in_plane::<Self, _>(law, &self.reference)
    }
}
