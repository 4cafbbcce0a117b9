//! Quantities of each connected component that are kept at a target.

use super::super::Driver;
use super::super::keys::{Form, Key, optional};
use super::super::units::Dimension;
use super::{
    EffectError, Effects, Geometry, MeshCheck, Parameter, Parameters, Preparation, Reader,
};
use crate::effect::MembranePart;
use crate::held::Quantity;
use crate::six::Six;
use helfrich::{AnyFunctional, Surface, Targets};
use serde::Serialize;

/// The way in which a quantity is kept at its target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// As a constraint.
    Exact,
    /// By a penalty with this modulus. Area and volume F: `E = k/2 (F − F0)²/F0`, k a force per
    /// length or a pressure. Area difference: `E = 2π k (M − M0)²/A` with `M = ∫H dS`, k an energy.
    Penalty(f64),
}

impl Hold {
    /// Whether the quantity is held as a constraint.
    pub fn is_exact(self) -> bool {
        self == Self::Exact
    }

    /// The modulus of the penalty, if there is one.
    pub fn modulus(self) -> Option<f64> {
        match self {
            Self::Exact => None,
            Self::Penalty(modulus) => Some(modulus),
        }
    }

    /// Refuses a constraint on a surface with a supported edge.
    pub(super) fn check_support(self, effect: &'static str, check: &mut MeshCheck<'_>) {
        if self.is_exact() && check.is_supported() {
            let message = format!(
                "a constraint would move the supported edge of \"{}\": hold `{effect}` by a penalty, with \
                 a `modulus`",
                check.name
            );
            check.contradiction(&format!("{effect}.constraint"), message);
        }
    }

    pub(super) fn read(table: Reader<'_>) -> Self {
        table.number("modulus").map_or(Self::Exact, Self::Penalty)
    }

    /// Constraint or penalty, and the target; without a target, the initial value.
    pub(super) fn explain(
        self,
        target: Option<Parameter>,
        number: &Parameters,
        dimension: Dimension,
    ) -> (String, Vec<Parameter>) {
        let kind = if self.is_exact() { "exact" } else { "penalty" };
        let initial = match target {
            None => ", at its initial value",
            Some(_) => "",
        };
        let modulus = self.modulus();
        let modulus = modulus.map(|modulus| number.of("modulus", modulus, dimension));
        let parameters = modulus.into_iter().chain(target);
        (format!("{kind}{initial}"), parameters.collect())
    }
}

/// The targets of a held quantity of a surface.
#[derive(Clone, Debug)]
pub struct HeldTargets {
    /// The effect that holds it.
    pub effect: &'static str,
    /// The quantity.
    pub quantity: AnyFunctional,
    /// A target for each component, or one for all.
    pub targets: Targets<f64>,
}

impl HeldTargets {
    /// The targets of the parts of a surface that has parted or joined: each part gets as much of the target of each
    /// component from which it comes as it has of the quantity.
    pub fn of_parts(&self, parents: &[Vec<u32>], parts: Surface<'_, f64>) -> Self {
        let present = Quantity::targets(self.quantity, parts);
        let all = |parent: u32| -> f64 {
            let siblings = parents.iter().enumerate();
            let siblings = siblings.filter(|(_, others)| others.contains(&parent));
            siblings.map(|(part, _)| present.at(part)).sum()
        };
        let targets = parents.iter().enumerate().map(|(part, parents)| {
            let of_parent = parents.iter().map(|&parent| {
                let share = present.at(part) / all(parent);
                let target = self.targets.at(parent as usize);
                if share.is_finite() {
                    share * target
                } else {
                    target
                }
            });
            of_parent.sum()
        });
        Self {
            targets: Targets::PerComponent(targets.collect()),
            ..*self
        }
    }
}

impl Effects {
    /// The functionals for area and volume of the surface. In a flow nodal forces over areas act, and those of
    /// patches do not converge.
    pub fn geometry(&self, driver: &Driver) -> Geometry {
        let bending = self.bending.iter().map(|bending| bending.method);
        Geometry::new(bending.filter(|_| matches!(driver, Driver::Relax(_))))
    }
}

/// The key that chooses a constraint instead of a penalty.
pub(super) const CONSTRAINT: Key = optional(
    "constraint",
    Form::Choice(|| vec!["exact"]),
    "\"exact\": held as a constraint, instead of by a modulus.",
);

/// The keys of which exactly one is required.
pub(super) const EITHER: &[&[&str]] = &[&["constraint", "modulus"]];

/// The message about an effect that works against a quantity that is held exactly.
pub(super) fn idle(effect: &str, surface: &str, held: &str) -> String {
    format!(
        "`{effect}` does nothing to \"{surface}\", whose {held} is held exactly: leave one of them out"
    )
}

/// The message about a constraint where only forces move membranes.
pub(super) fn no_constraint_in_flow(effect: &str, surface: &str) -> String {
    format!(
        "in a flow the `{effect}` of \"{surface}\" cannot be held exactly: only forces move membranes \
         there; give a `modulus`, as large as needed"
    )
}

/// Least ratio of a target to the value on the mesh, because sums over a mesh are rounded by ε of
/// the initial value, while constraints hold to 1e-10 of their targets.
pub(super) const LEAST_RATIO: f64 = f64::EPSILON / 1e-10;

impl MeshCheck<'_> {
    /// Reports a target so far from the value of the mesh that it is lost in rounding or cannot be
    /// reached.
    pub(super) fn compare(&mut self, key: &str, what: &str, target: f64, has: f64, least: f64) {
        let ratio = target.abs() / has;
        if ratio < least || ratio > LEAST_RATIO.recip() {
            let message = format!(
                "the {what} of {} is {} times {}, that of the mesh of \"{}\" where it starts: such a \
                 target is lost in rounding or never reached: choose a target that is nearer",
                Six(target),
                Six(ratio),
                Six(has),
                self.name
            );
            self.contradiction(key, message);
        }
    }
}

impl Preparation<'_> {
    /// Holds a quantity at targets, or at those that are known for it from an earlier mesh.
    pub(super) fn hold(
        &mut self,
        name: &'static str,
        hold: Hold,
        quantity: AnyFunctional,
        targets: Targets<f64>,
    ) -> Result<(), EffectError> {
        let mut known = self.targets.iter();
        let targets = match known.find(|known| known.effect == name) {
            Some(known) => known.targets.clone(),
            None => {
                self.targets.push(HeldTargets {
                    effect: name,
                    quantity,
                    targets: targets.clone(),
                });
                targets
            }
        };
        let targets = match hold {
            Hold::Exact => self.of_triangles(quantity, &targets),
            Hold::Penalty(_) => targets,
        };
        match MembranePart::keeping(name, quantity, hold.modulus(), targets, self.mesh())? {
            MembranePart::Held(constraint) => self.constraints.push((name, constraint)),
            MembranePart::Acting(effect) => self.forces.push(effect),
        }
        Ok(())
    }
}

/// Targets that follow from others, component by component.
pub(super) fn map(targets: &Targets<f64>, f: impl Fn(f64) -> f64) -> Targets<f64> {
    match targets {
        Targets::Same(target) => Targets::Same(f(*target)),
        Targets::PerComponent(targets) => {
            Targets::PerComponent(targets.iter().map(|&target| f(target)).collect())
        }
    }
}
