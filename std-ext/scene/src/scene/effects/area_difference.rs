//! Difference of the areas of the bilayer's leaflets.

use super::super::keys::{Form, Keys, any, optional, positive};
use super::super::units::Dimension;
use super::area::HeldArea;
use super::held::{CONSTRAINT, EITHER, map, no_constraint_in_flow};
use super::{
    Builder, Check, Described, EffectError, Geometry, Groups, Hold, MeshCheck, MeshSource, Named,
    Parameter, Parameters, Preparation, Reader, SurfaceEffect,
};
use crate::held::Quantity;
use helfrich::{AnyFunctional, Targets};
use serde::Serialize;
use std::f64::consts::PI;

/// Difference of the areas of the bilayer's leaflets, through `M = ∫H dS` of each connected component,
/// held at a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldAreaDifference {
    /// Constraint or penalty.
    pub hold: Hold,
    /// The target of M.
    pub target: AreaDifferenceTarget,
}

/// A target of ∫H dS.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AreaDifferenceTarget {
    /// The initial ∫H dS.
    Initial,
    /// This value, a length, for each connected component.
    Value(f64),
    /// `∫H dS/√(4πA)`, 1 for a sphere, with the target area, or the initial area if the area is not
    /// held.
    Reduced(f64),
}

impl Described for HeldAreaDifference {
    const SUMMARY: &'static str = "Difference of the leaflets' areas by M = ∫H dS, held exactly \
         (bilayer coupling) or by a penalty E = 2π k (M − M0)²/A.";

    const KEYS: &'static Keys = &Keys {
        keys: &[
            CONSTRAINT,
            optional(
                "modulus",
                positive(Dimension::ENERGY),
                "Modulus k of the penalty, instead of a constraint.",
            ),
            optional(
                "target",
                Form::Either(&[Form::Choice(|| vec!["initial"]), any(Dimension::LENGTH)]),
                "∫H dS of each connected component: \"initial\", the default, or a number.",
            ),
            optional(
                "reduced",
                any(Dimension::NONE),
                "Reduced target ∫H dS/√(4πA), 1 for a sphere, instead of target; A is the target area \
                 or, if there is none, the initial area.",
            ),
        ],
        exactly_one: EITHER,
        at_most_one: &[&["target", "reduced"]],
        needs: &[],
        kinds: &[],
    };

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            hold: Hold::read(table),
            target: match (table.number("reduced"), table.number("target")) {
                (Some(reduced), _) => AreaDifferenceTarget::Reduced(reduced),
                (_, Some(value)) => AreaDifferenceTarget::Value(value),
                _ => AreaDifferenceTarget::Initial,
            },
        }
    }
}

impl SurfaceEffect for HeldAreaDifference {
    fn quantity(&self, _: Geometry) -> Option<AnyFunctional> {
        Some(AnyFunctional::MeanCurvature)
    }

    fn check(&self, check: &mut Check<'_, '_>) {
        if self.hold.is_exact() && check.fluid().is_some() {
            let message = no_constraint_in_flow(Self::NAME, check.name);
            check.contradiction("area_difference.constraint", message);
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        let what = "target of ∫H dS, compared with √(4πA),";
        match self.target {
            AreaDifferenceTarget::Initial => {}
            AreaDifferenceTarget::Value(target) => {
                let area = HeldArea::target_or(check.effects.area, check.mesh.area);
                let length = (4.0 * PI * area).sqrt();
                check.compare("area_difference.target", what, target, length, 0.0);
            }
            AreaDifferenceTarget::Reduced(target) => {
                check.compare("area_difference.reduced", what, target, 1.0, 0.0);
            }
        }
    }

    fn needs_volume(&self) -> bool {
        true
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let target = match self.target {
            AreaDifferenceTarget::Initial => None,
            AreaDifferenceTarget::Value(value) => {
                Some(number.of("target", value, Dimension::LENGTH))
            }
            AreaDifferenceTarget::Reduced(reduced) => Some(number.plain("reduced", reduced)),
        };
        self.hold.explain(target, number, Dimension::ENERGY)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let reduced = match self.target {
            AreaDifferenceTarget::Initial => None,
            AreaDifferenceTarget::Value(value) => Some(value / (4.0 * PI * groups.radius())),
            AreaDifferenceTarget::Reduced(reduced) => Some(reduced),
        };
        if let Some(reduced) = reduced {
            groups.add("reduced area difference of the target", "M0/(4πR)", reduced);
        }
        if let (Some(bending), Some(modulus)) = (groups.bending_modulus(), self.hold.modulus()) {
            let name = "area difference over bending modulus";
            groups.add(name, "α = k/κ", modulus / bending);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let surface = preparation.surface;
        let targets = match self.target {
            AreaDifferenceTarget::Initial => {
                Quantity::targets(AnyFunctional::MeanCurvature, surface)
            }
            AreaDifferenceTarget::Value(integral) => Targets::Same(integral),
            AreaDifferenceTarget::Reduced(reduced) => {
                let areas = HeldArea::targets(preparation);
                map(&areas, |area| reduced * (4.0 * PI * area).sqrt())
            }
        };
        preparation.hold(Self::NAME, self.hold, AnyFunctional::MeanCurvature, targets)
    }
}
