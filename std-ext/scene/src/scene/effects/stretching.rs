//! Opposite forces at the two ends of a surface.

use super::super::keys::{Form, Keys, Range, optional, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshSource, Named, Parameter, Parameters,
    Preparation, Reader, SurfaceEffect,
};
use helfrich::{LoadError, PointLoads, Surface};
use serde::Serialize;

/// Opposite forces at the two ends of a surface, as by optical tweezers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stretching {
    /// The direction of the forces, of any length above 0.
    pub axis: [f64; 3],
    /// Total force on each end. Several forces are a sequence of loads; each starts from the
    /// equilibrium under the previous one.
    pub forces: Vec<f64>,
    /// Fraction of the vertices over which the force on an end is spread.
    pub fraction: f64,
}

impl Stretching {
    fn largest(&self) -> f64 {
        self.forces.iter().copied().fold(0.0, f64::max)
    }
}

impl Described for Stretching {
    const SUMMARY: &'static str = "Opposite forces spread over the vertices at the surface's two ends, \
         as by optical tweezers (Mills et al. 2004).";

    const KEYS: &'static Keys = &plain(&[
        required("axis", Form::Direction, "Direction of the forces."),
        required(
            "force",
            Form::Numbers(Dimension::FORCE, Range::NotNegative),
            "Total force on each end. A list is a sequence of loads, each starting from the \
             equilibrium under the previous one.",
        ),
        optional(
            "fraction",
            Form::Number(Dimension::NONE, Range::Half),
            "Fraction of the vertices over which the force on an end is spread; by default 0.05.",
        ),
    ]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            axis: table.vector("axis").unwrap_or_default(),
            forces: table.numbers("force"),
            fraction: table.number("fraction").unwrap_or(0.05),
        }
    }
}

impl SurfaceEffect for Stretching {
    fn check(&self, check: &mut Check<'_, '_>) {
        if let Some(driver) = check.fluid()
            && self.forces.len() > 1
        {
            let message = format!(
                "a sequence of forces goes from equilibrium to equilibrium, and the driver \"{}\" \
                 advances in time: give one force, which acts throughout, or choose the driver \
                 \"relax\"",
                driver.name()
            );
            check.contradiction("stretching.force", message);
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let [x, y, z] = self.axis;
        let count = match self.forces.len() {
            1 => String::new(),
            count => format!(", {count} forces one after the other"),
        };
        let largest = number.of("largest force", self.largest(), Dimension::FORCE);
        let fraction = number.plain("fraction", self.fraction);
        let choice = format!("along [{x}, {y}, {z}]{count}");
        (choice, vec![largest, fraction])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let radius = groups.radius();
        if let Some(elasticity) = &groups.effects.elasticity {
            let value = self.largest() / (elasticity.law.shear_modulus() * radius);
            groups.add("largest stretching force over shear", "F/(G R)", value);
        } else if let Some(modulus) = groups.bending_modulus() {
            let value = self.largest() * radius / modulus;
            groups.add("largest stretching force over bending", "F R/κ", value);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let mut stretch = Stretch::new(preparation.surface, self)?;
        preparation.conservative(Self::NAME, stretch.set(0))?;
        preparation.stretch = Some(stretch);
        Ok(())
    }
}

/// The sequence of loads of a stretched surface.
#[derive(Debug)]
pub(crate) struct Stretch {
    axis: [f64; 3],
    forces: Vec<f64>,
    loads: Vec<PointLoads<f64>>,
    current: usize,
}

impl Stretch {
    fn new(surface: Surface<'_, f64>, scene: &Stretching) -> Result<Self, LoadError> {
        let loads = scene
            .forces
            .iter()
            .map(|&force| PointLoads::opposite_ends(surface, scene.axis, scene.fraction, force));
        Ok(Self {
            axis: glam::DVec3::from_array(scene.axis).normalize().to_array(),
            forces: scene.forces.clone(),
            loads: loads.collect::<Result<_, _>>()?,
            current: 0,
        })
    }

    /// The direction of the forces, of length 1.
    pub(crate) fn axis(&self) -> [f64; 3] {
        self.axis
    }

    /// The force on each end.
    pub(crate) fn force(&self) -> f64 {
        self.forces[self.current]
    }

    /// The number of the present load.
    pub(crate) fn current(&self) -> usize {
        self.current
    }

    /// The number of loads.
    pub(crate) fn count(&self) -> usize {
        self.forces.len()
    }

    /// The loads with this number, or the last.
    pub(crate) fn set(&mut self, load: usize) -> PointLoads<f64> {
        self.current = load.min(self.count() - 1);
        self.loads[self.current].clone()
    }
}
