//! Total area.

use super::super::keys::{Form, Keys, optional, positive};
use super::super::units::Dimension;
use super::held::{CONSTRAINT, EITHER, LEAST_RATIO, no_constraint_in_flow};
use super::{
    Builder, Check, Described, EffectError, Geometry, Groups, Hold, MeshCheck, MeshSource, Named,
    Parameter, Parameters, Preparation, Reader, Stiffness, SurfaceEffect,
};
use helfrich::{AnyFunctional, Targets};
use serde::Serialize;

/// Total area of each connected component, held at a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldArea {
    /// Constraint or penalty.
    pub hold: Hold,
    /// The target.
    pub target: Target,
}

/// A target area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// The initial area.
    Initial,
    /// This value, for each connected component.
    Value(f64),
}

impl HeldArea {
    /// The target as a number, or the area of the mesh.
    pub(in crate::scene) fn target_or(this: Option<Self>, mesh_area: f64) -> f64 {
        match this.map(|area| area.target) {
            Some(Target::Value(area)) => area,
            _ => mesh_area,
        }
    }

    /// The target areas of the components of the surface, or their areas at the start.
    pub(super) fn targets(preparation: &Preparation<'_>) -> Targets<f64> {
        let own = preparation.siblings.area;
        let is_exact = own.is_some_and(|area| area.hold.is_exact());
        match own.map(|area| area.target) {
            Some(Target::Value(area)) => Targets::Same(area),
            _ => preparation.present(preparation.geometry.area, is_exact),
        }
    }
}

impl Described for HeldArea {
    const SUMMARY: &'static str = "Total area, held exactly or by a penalty E = k/2 (A − A0)²/A0.";

    const KEYS: &'static Keys = &Keys {
        keys: &[
            CONSTRAINT,
            optional(
                "modulus",
                positive(Dimension::TENSION),
                "Modulus k of the penalty, instead of a constraint.",
            ),
            optional(
                "target",
                Form::Either(&[Form::Choice(|| vec!["initial"]), positive(Dimension::AREA)]),
                "Area of each connected component: \"initial\", the default, or a number.",
            ),
        ],
        exactly_one: EITHER,
        at_most_one: &[],
        needs: &[],
        kinds: &[],
    };

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        let target = table.number("target");
        Self {
            hold: Hold::read(table),
            target: target.map_or(Target::Initial, Target::Value),
        }
    }
}

impl SurfaceEffect for HeldArea {
    fn quantity(&self, geometry: Geometry) -> Option<AnyFunctional> {
        Some(geometry.area)
    }

    fn check(&self, check: &mut Check<'_, '_>) {
        if self.hold.is_exact() && check.fluid().is_some() {
            let message = no_constraint_in_flow(Self::NAME, check.name);
            check.contradiction("area.constraint", message);
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        self.hold.check_support(Self::NAME, check);
        if let Target::Value(target) = self.target {
            let has = check.mesh.area;
            check.compare("area.target", "target area", target, has, LEAST_RATIO);
        }
    }

    fn stiffness(&self) -> Stiffness {
        Stiffness {
            area: self.hold.modulus().unwrap_or(0.0),
            ..Stiffness::default()
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let target = match self.target {
            Target::Initial => None,
            Target::Value(value) => Some(number.of("target", value, Dimension::AREA)),
        };
        self.hold.explain(target, number, Dimension::TENSION)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let (Some(bending), Some(modulus)) = (groups.bending_modulus(), self.hold.modulus()) {
            let ratio = modulus * groups.radius().powi(2) / bending;
            groups.add("area over bending modulus", "k R²/κ", ratio);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let targets = Self::targets(preparation);
        preparation.hold(Self::NAME, self.hold, preparation.geometry.area, targets)
    }
}
