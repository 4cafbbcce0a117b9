//! Opposite forces at the two ends of a surface.

use super::super::keys::{Form, Keys, Range, optional, positive, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshSource, Named, Parameter, Parameters,
    Preparation, Reader, SurfaceEffect,
};
use crate::effect::Effect;
use helfrich::{EndPull, Energy, LoadError, PointLoads, Prepared, Surface, TriangleMesh};
use serde::Serialize;

/// Opposite forces at the two ends of a surface, as by optical tweezers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stretching {
    /// The direction of the forces, of any length above 0.
    pub axis: [f64; 3],
    /// The forces on each end.
    pub pull: Pull,
    /// The parts over which the force on an end is spread.
    pub ends: Ends,
}

/// The forces by which the ends are pulled. Several are a sequence of loads; each starts from the equilibrium under the
/// previous one.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pull {
    /// Total forces on each end.
    Forces(Vec<f64>),
    /// Distances at which the ends are held by a spring.
    Lengths {
        /// The distances.
        lengths: Vec<f64>,
        /// The stiffness of the spring, force per length.
        stiffness: f64,
    },
}

impl Pull {
    /// Forces or lengths, one for each load.
    fn numbers(&self) -> &[f64] {
        match self {
            Self::Forces(forces) => forces,
            Self::Lengths { lengths, .. } => lengths,
        }
    }

    fn largest(&self) -> f64 {
        self.numbers().iter().copied().fold(0.0, f64::max)
    }
}

/// The parts of a surface that are its ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// A fraction of the vertices, which stay the same.
    Fraction(f64),
    /// The outermost layers of these thicknesses, ahead and behind, wherever vertices are.
    Depth([f64; 2]),
}

impl Stretching {
    /// Whether the distance of the ends is a column.
    pub fn has_distance(&self) -> bool {
        matches!(self.ends, Ends::Depth(_))
    }
}

impl Described for Stretching {
    const SUMMARY: &'static str = "Opposite forces spread over the vertices at the surface's two ends, \
         as by optical tweezers (Mills et al. 2004), or a spring between the ends, which pulls tethers.";

    const KEYS: &'static Keys = &Keys {
        keys: &[
            required("axis", Form::Direction, "Direction of the forces."),
            optional(
                "force",
                Form::Numbers(Dimension::FORCE, Range::NotNegative),
                "Total force on each end. A list is a sequence of loads, each starting from the \
                 equilibrium under the previous one.",
            ),
            optional(
                "length",
                Form::Numbers(Dimension::LENGTH, Range::NotNegative),
                "Distance at which the ends are held along `axis` by a spring, whose pull is in the column `force`. A list is a \
                 sequence, as of forces.",
            ),
            optional(
                "stiffness",
                positive(Dimension::TENSION),
                "Stiffness of the spring that holds `length`, force per length.",
            ),
            optional(
                "fraction",
                Form::Number(Dimension::NONE, Range::Half),
                "Fraction of the vertices over which the force on an end is spread; by default 0.05.",
            ),
            optional(
                "depth",
                Form::Numbers(Dimension::LENGTH, Range::Positive),
                "Thickness of the outermost layer along `axis` over which the force on an end is spread instead, wherever \
                 vertices are: for tethers of fluid membranes. Two numbers are for the ends ahead and behind: a thin layer \
                 becomes a tether, a thick one does not. The column `end_distance` has the distance of the ends.",
            ),
        ],
        exactly_one: &[&["force", "length"]],
        at_most_one: &[&["fraction", "depth"]],
        needs: &[
            ["length", "stiffness"],
            ["length", "depth"],
            ["stiffness", "length"],
        ],
        kinds: &[],
    };

    fn read(table: Reader<'_>, _: &MeshSource, builder: &mut Builder<'_>) -> Self {
        let lengths = table.numbers("length");
        let pull = match table.number("stiffness") {
            Some(stiffness) => Pull::Lengths { lengths, stiffness },
            None => Pull::Forces(table.numbers("force")),
        };
        let fraction = table.number("fraction").unwrap_or(0.05);
        let depth = match table.numbers("depth")[..] {
            [] => None,
            [both] => Some([both; 2]),
            [ahead, behind] => Some([ahead, behind]),
            _ => {
                let message = "`depth` is one number, or one for each of the two ends".to_owned();
                builder.contradiction(&table.origin_of("depth"), message);
                None
            }
        };
        Self {
            axis: table.vector("axis").unwrap_or_default(),
            pull,
            ends: depth.map_or(Ends::Fraction(fraction), Ends::Depth),
        }
    }
}

impl SurfaceEffect for Stretching {
    fn check(&self, check: &mut Check<'_, '_>) {
        let (key, one, many) = match self.pull {
            Pull::Forces(_) => ("stretching.force", "force", "forces"),
            Pull::Lengths { .. } => ("stretching.length", "length", "lengths"),
        };
        if let Some(driver) = check.fluid()
            && self.pull.numbers().len() > 1
        {
            let message = format!(
                "a sequence of {many} goes from equilibrium to equilibrium, and the driver \"{}\" \
                 advances in time: give one {one}, which acts throughout, or choose the driver \
                 \"relax\"",
                driver.name()
            );
            check.contradiction(key, message);
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let [x, y, z] = self.axis;
        let largest = self.pull.largest();
        let (what, mut parameters) = match self.pull {
            Pull::Forces(_) => {
                let largest = number.of("largest force", largest, Dimension::FORCE);
                ("forces", vec![largest])
            }
            Pull::Lengths { stiffness, .. } => {
                let largest = number.of("largest length", largest, Dimension::LENGTH);
                let stiffness = number.of("stiffness", stiffness, Dimension::TENSION);
                ("lengths", vec![largest, stiffness])
            }
        };
        let count = match self.pull.numbers().len() {
            1 => String::new(),
            count => format!(", {count} {what} one after the other"),
        };
        match self.ends {
            Ends::Fraction(fraction) => parameters.push(number.plain("fraction", fraction)),
            Ends::Depth([ahead, behind]) => parameters.extend([
                number.of("depth ahead", ahead, Dimension::LENGTH),
                number.of("depth behind", behind, Dimension::LENGTH),
            ]),
        }
        (format!("along [{x}, {y}, {z}]{count}"), parameters)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let Pull::Forces(_) = self.pull else {
            return;
        };
        let (radius, largest) = (groups.radius(), self.pull.largest());
        if let Some(elasticity) = &groups.effects.elasticity {
            let value = largest / (elasticity.law.shear_modulus() * radius);
            groups.add("largest stretching force over shear", "F/(G R)", value);
        } else if let Some(modulus) = groups.bending_modulus() {
            let value = largest * radius / modulus;
            groups.add("largest stretching force over bending", "F R/κ", value);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let stretch = Stretch::new(preparation.surface, self)?;
        match stretch.load() {
            Load::Vertices(loads) => preparation.conservative(Self::NAME, loads)?,
            Load::Ends(pull) => preparation.conservative(Self::NAME, pull)?,
        }
        preparation.stretch = Some(stretch);
        Ok(())
    }
}

/// The sequence of loads of a stretched surface.
#[derive(Debug)]
pub(crate) struct Stretch {
    axis: [f64; 3],
    loads: Vec<(f64, Load)>,
    current: usize,
}

/// One load of a stretched surface.
#[derive(Clone, Debug)]
enum Load {
    Vertices(PointLoads<f64>),
    Ends(EndPull<f64>),
}

impl Stretch {
    fn new(surface: Surface<'_, f64>, scene: &Stretching) -> Result<Self, LoadError> {
        let axis = glam::DVec3::from_array(scene.axis).normalize().to_array();
        let load = |number: f64| {
            let depths = match scene.ends {
                Ends::Fraction(fraction) => {
                    let loads = PointLoads::opposite_ends(surface, scene.axis, fraction, number);
                    return loads.map(Load::Vertices);
                }
                Ends::Depth(depths) => depths,
            };
            let (force, stiffness, length) = match scene.pull {
                Pull::Forces(_) => (number, 0.0, 0.0),
                Pull::Lengths { stiffness, .. } => (0.0, stiffness, number),
            };
            Ok(Load::Ends(EndPull {
                axis,
                depths,
                force,
                stiffness,
                length,
            }))
        };
        let numbers = scene.pull.numbers().iter();
        let loads = numbers.map(|&number| Ok((number, load(number)?)));
        Ok(Self {
            axis,
            loads: loads.collect::<Result<_, LoadError>>()?,
            current: 0,
        })
    }

    /// The direction of the forces, of length 1.
    pub(crate) fn axis(&self) -> [f64; 3] {
        self.axis
    }

    fn load(&self) -> Load {
        self.loads[self.current].1.clone()
    }

    /// The force on each end of a surface, and the distance of the ends unless these are vertices; NaN without the surface.
    pub(crate) fn measured(&self, surface: Option<Surface<'_, f64>>) -> (f64, Option<f64>) {
        let Load::Ends(pull) = self.load() else {
            return (self.loads[self.current].0, None);
        };
        let measured = surface.map(|surface| {
            let mut prepared = Prepared::new(pull, surface.mesh());
            prepared.with(|pull, execution, workspace| {
                pull.energy(execution, surface, workspace);
                pull.measured(workspace)
            })
        });
        let (force, distance) = measured.unwrap_or([f64::NAN; 2].into());
        (force, Some(distance))
    }

    /// The number of the present load.
    pub(crate) fn current(&self) -> usize {
        self.current
    }

    /// The number of loads.
    pub(crate) fn count(&self) -> usize {
        self.loads.len()
    }

    /// Lets the load with this number, or the last, act as the effect of a surface.
    pub(crate) fn set(&mut self, load: usize, effect: &mut Effect, mesh: &TriangleMesh) {
        self.current = load.min(self.count() - 1);
        match self.load() {
            Load::Vertices(loads) => effect.replace(loads, mesh),
            Load::Ends(pull) => effect.replace(pull, mesh),
        }
    }
}
