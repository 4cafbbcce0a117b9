//! Enclosed volume.

use super::super::Driver;
use super::super::keys::{Form, Keys, Range, optional, positive};
use super::super::start::start_for;
use super::super::units::Dimension;
use super::area::HeldArea;
use super::held::{CONSTRAINT, EITHER, LEAST_RATIO, map};
use super::{
    Builder, Check, Described, EffectError, Geometry, Groups, Hold, MeshCheck, MeshSource, Named,
    Parameter, Parameters, Preparation, Reader, SurfaceEffect, Target,
};
use crate::generate::AnyShape;
use crate::six::Six;
use helfrich::{AnyFunctional, Targets};
use serde::Serialize;
use std::f64::consts::PI;

/// Enclosed volume of each connected component, held at a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldVolume {
    /// Constraint or penalty.
    pub hold: Hold,
    /// The target.
    pub target: VolumeTarget,
}

/// A target volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VolumeTarget {
    /// The initial volume.
    Initial,
    /// This value, for each connected component.
    Value(f64),
    /// The reduced volume `v = 6√π V/A^{3/2}`, with the target area, or the initial area if the area
    /// is not held.
    Reduced(f64),
}

/// v = 6√π V/A^{3/2}.
pub(crate) fn reduced_volume(volume: f64, area: f64) -> f64 {
    6.0 * PI.sqrt() * volume / area.powf(1.5)
}

impl Described for HeldVolume {
    const SUMMARY: &'static str =
        "Enclosed volume, held exactly or by a penalty E = k/2 (V − V0)²/V0.";

    const KEYS: &'static Keys = &Keys {
        keys: &[
            CONSTRAINT,
            optional(
                "modulus",
                positive(Dimension::PRESSURE),
                "Modulus k of the penalty, instead of a constraint.",
            ),
            optional(
                "target",
                Form::Either(&[
                    Form::Choice(|| vec!["initial"]),
                    positive(Dimension::VOLUME),
                ]),
                "Volume of each connected component: \"initial\", the default, or a number.",
            ),
            optional(
                "reduced",
                Form::Number(Dimension::NONE, Range::Fraction),
                "Reduced volume v = 6√π V/A^(3/2), instead of target; A is the target area or, if \
                 there is none, the initial area.",
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
                (Some(reduced), _) => VolumeTarget::Reduced(reduced),
                (_, Some(value)) => VolumeTarget::Value(value),
                _ => VolumeTarget::Initial,
            },
        }
    }
}

impl HeldVolume {
    /// Reports exactly held area and volume that no surface can have together. Only surfaces of one
    /// component are checked.
    fn check_enclosed(&self, check: &mut MeshCheck<'_>) {
        let area = check.effects.area;
        let both_exact = self.hold.is_exact() && area.is_some_and(|area| area.hold.is_exact());
        let volume = match self.target {
            VolumeTarget::Value(volume) => Some(volume),
            VolumeTarget::Initial => check.mesh.volume,
            VolumeTarget::Reduced(_) => None,
        };
        let (true, 1, Some(volume)) = (both_exact, check.mesh.components, volume) else {
            return;
        };
        let area = HeldArea::target_or(area, check.mesh.area);
        let reduced = reduced_volume(volume, area);
        if reduced > 1.0 {
            let message = format!(
                "area {} and volume {} are both held, and their reduced volume is {reduced:.4}: no \
                 surface of that area encloses more than {:.6}",
                Six(area),
                Six(volume),
                volume / reduced
            );
            check.contradiction(Self::NAME, message);
        }
    }
}

impl HeldVolume {
    /// Warns about a sphere that is to have another reduced volume: its forces have no direction in which
    /// it could become longer or flatter, except by errors of the mesh.
    fn check_sphere(&self, check: &mut MeshCheck<'_>) {
        let (VolumeTarget::Reduced(target), Driver::Relax(_)) = (self.target, check.driver) else {
            return;
        };
        let both_exact =
            self.hold.is_exact() && check.effects.area.is_some_and(|it| it.hold.is_exact());
        // Exactly held, both are an error of their own.
        if let (
            MeshSource::Shape {
                shape: AnyShape::Sphere(_),
                ..
            },
            false,
        ) = (check.source, both_exact)
            && target < 1.0
            && let Some(start) = start_for(check.source, target, 0.0)
        {
            let message = format!(
                "\"{}\" begins as a sphere, whose reduced volume is 1, and is to have {target}: on a sphere \
                 no force has a direction in which it becomes longer or flatter: begin with shape = \
                 \"{start}\"",
                check.name
            );
            check.doubt("volume.reduced", message);
        }
    }
}

impl SurfaceEffect for HeldVolume {
    fn quantity(&self, geometry: Geometry) -> Option<AnyFunctional> {
        Some(geometry.volume)
    }

    fn check(&self, check: &mut Check<'_, '_>) {
        let area = check.effects.area.map(|area| area.target);
        if let (Some(Target::Value(area)), VolumeTarget::Value(volume)) = (area, self.target) {
            let reduced = reduced_volume(volume, area);
            if reduced > 1.0 {
                let message = format!(
                    "the reduced volume of these targets is {reduced:.4}: no surface of area {area} \
                     encloses more than a sphere, {:.6}",
                    volume / reduced
                );
                check.contradiction("volume.target", message);
            }
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        if let Some(has) = check.mesh.volume.filter(|has| *has > 0.0) {
            match self.target {
                VolumeTarget::Initial => {}
                VolumeTarget::Value(target) => {
                    check.compare("volume.target", "target volume", target, has, LEAST_RATIO);
                }
                VolumeTarget::Reduced(reduced) => {
                    let area = HeldArea::target_or(check.effects.area, check.mesh.area);
                    let has = reduced_volume(has, area);
                    let what = "reduced volume";
                    check.compare("volume.reduced", what, reduced, has, LEAST_RATIO);
                }
            }
        }
        self.check_enclosed(check);
        self.check_sphere(check);
    }

    fn needs_volume(&self) -> bool {
        true
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let target = match self.target {
            VolumeTarget::Initial => None,
            VolumeTarget::Value(value) => Some(number.of("target", value, Dimension::VOLUME)),
            VolumeTarget::Reduced(reduced) => Some(number.plain("reduced", reduced)),
        };
        self.hold.explain(target, number, Dimension::PRESSURE)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let area = HeldArea::target_or(groups.effects.area, groups.mesh.area);
        let reduced = match self.target {
            VolumeTarget::Initial => None,
            VolumeTarget::Value(volume) => Some(reduced_volume(volume, area)),
            VolumeTarget::Reduced(reduced) => Some(reduced),
        };
        if let Some(reduced) = reduced {
            groups.add("reduced volume of the target", "6√π V0/A^(3/2)", reduced);
        }
        if let (Some(bending), Some(modulus)) = (groups.bending_modulus(), self.hold.modulus()) {
            let ratio = modulus * groups.radius().powi(3) / bending;
            groups.add("volume over bending modulus", "k R³/κ", ratio);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let volume = preparation.geometry.volume;
        let targets = match self.target {
            VolumeTarget::Initial => preparation.present(volume, self.hold.is_exact()),
            VolumeTarget::Value(volume) => Targets::Same(volume),
            VolumeTarget::Reduced(reduced) => {
                let areas = HeldArea::targets(preparation);
                map(&areas, |area| reduced * area.powf(1.5) / (6.0 * PI.sqrt()))
            }
        };
        preparation.hold(Self::NAME, self.hold, volume, targets)
    }
}
