//! The undisturbed flow of a scene.

use super::course::COURSE;
use super::keys::{
    Form, Key, Keys, Kind, Range, any, count_of, kinds, of_kinds, optional, positive, required,
};
use super::parameter::{Parameter, Parameters};
use super::units::Dimension;
use crate::flow::{Ambient, Channel};
use glam::DVec3;
use serde::Serialize;

/// A flow without membranes, over all space or in a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Flow {
    /// Fluid at rest.
    Quiescent,
    /// Simple shear, `u = (γ̇ y, 0, 0)`.
    Shear {
        /// γ̇, 1/time; not 0.
        rate: f64,
    },
    /// Uniaxial extension, `u = ε̇ (x, −y/2, −z/2)`; biaxial if ε̇ < 0.
    Extension {
        /// ε̇, 1/time; not 0.
        rate: f64,
    },
    /// Plane extension, `u = ε̇ (x, −y, 0)`.
    PlaneExtension {
        /// ε̇, 1/time; not 0.
        rate: f64,
    },
    /// `u = L·x`.
    Linear {
        /// L, 1/time: `gradient[i][j]` is ∂u_i/∂x_j. Its trace is 0 up to rounding.
        gradient: [[f64; 3]; 3],
    },
    /// `u = U (1 − ρ²/R²) t`, ρ the distance from an axis along the unit vector t: see
    /// [`Ambient::Poiseuille`].
    Poiseuille {
        /// U, the velocity on the axis; not 0.
        centre_velocity: f64,
        /// R, a length.
        radius: f64,
        /// The direction of the axis and the flow, of any length above 0.
        direction: [f64; 3],
        /// A point of the axis.
        through: [f64; 3],
    },
    /// Flow along x between walls at rest, driven by a body force; on lattices only.
    Channel {
        /// U, the velocity in the middle of a channel without surfaces and obstacles; not 0.
        centre_velocity: f64,
        /// H, the distance between the walls at the ends of y.
        width: f64,
        /// The distance between the walls at the ends of z; `None` if z is periodic.
        depth: Option<f64>,
    },
}

impl Flow {
    /// The rate, 1/time and above 0, that defines strain and capillary numbers.
    ///
    /// The absolute value of γ̇ of a shear and of ε̇ of an extension; `√(2 E:E)` of a linear flow
    /// with `E = (L + Lᵀ)/2`, which is γ̇ if the flow is a shear; `2U/R` of a Poiseuille flow, the
    /// shear rate at its wall; `4U/H` of a channel, the shear rate at the walls of plates. `None`
    /// if the fluid is at rest or rotates rigidly.
    pub fn rate(&self) -> Option<f64> {
        let rate = match *self {
            Self::Quiescent => 0.0,
            Self::Shear { rate } | Self::Extension { rate } | Self::PlaneExtension { rate } => {
                rate.abs()
            }
            Self::Linear { gradient } => {
                let strain = |i: usize, j: usize| 0.5 * (gradient[i][j] + gradient[j][i]);
                let entries = (0..9).map(|entry| strain(entry / 3, entry % 3));
                (2.0 * entries.map(|entry| entry * entry).sum::<f64>()).sqrt()
            }
            Self::Poiseuille {
                centre_velocity,
                radius,
                ..
            } => 2.0 * centre_velocity.abs() / radius,
            Self::Channel {
                centre_velocity,
                width,
                ..
            } => 4.0 * centre_velocity.abs() / width,
        };
        (rate > 0.0).then_some(rate)
    }

    /// Force per volume along x that drives the flow in a channel of fluid with this viscosity;
    /// `None` for other flows.
    pub fn driving_force(&self, viscosity: f64) -> Option<f64> {
        let Self::Channel {
            centre_velocity,
            width,
            depth,
        } = *self
        else {
            return None;
        };
        let channel = Channel { width, depth };
        Some(viscosity * centre_velocity / channel.response(0.0, 0.0))
    }

    /// The flow as a function of the point; `None` without flow, and for flows of a box.
    pub fn ambient(&self) -> Option<Ambient> {
        Some(match *self {
            Self::Quiescent | Self::Channel { .. } => return None,
            Self::Shear { rate } => Ambient::shear(rate),
            Self::Extension { rate } => Ambient::extension(rate),
            Self::PlaneExtension { rate } => Ambient::plane_extension(rate),
            Self::Linear { gradient } => Ambient::Linear { gradient },
            Self::Poiseuille {
                centre_velocity,
                radius,
                direction,
                through,
            } => Ambient::Poiseuille {
                centre_velocity,
                radius,
                direction,
                through,
            },
        })
    }

    /// The plane in which a flow deforms bodies, as two unit vectors: along the velocity and its
    /// gradient for a shear, along stretching and compression for a plane extension. A linear flow has
    /// a plane only if it is a shear `L = γ̇ t nᵀ` with `t·n = 0`. Other flows have none.
    pub fn plane(&self) -> Option<[[f64; 3]; 2]> {
        match *self {
            Self::Shear { .. } | Self::PlaneExtension { .. } => {
                Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
            }
            Self::Linear { gradient } => shear_plane(gradient),
            Self::Quiescent
            | Self::Extension { .. }
            | Self::Poiseuille { .. }
            | Self::Channel { .. } => None,
        }
    }

    /// A description of the flow, and the parameters.
    pub(crate) fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let rate = |value: f64| vec![number.of("rate", value, Dimension::RATE)];
        let (formula, parameters) = match *self {
            Self::Quiescent => ("", Vec::new()),
            Self::Shear { rate: value } => (", u = (γ̇ y, 0, 0)", rate(value)),
            Self::Extension { rate: value } => (", u = ε̇ (x, −y/2, −z/2)", rate(value)),
            Self::PlaneExtension { rate: value } => (", u = ε̇ (x, −y, 0)", rate(value)),
            Self::Linear { .. } => (
                ", u = L·x, rate √(2 E:E)",
                self.rate().map(rate).unwrap_or_default(),
            ),
            Self::Poiseuille {
                centre_velocity,
                radius,
                ..
            } => {
                let mut parameters = vec![
                    number.of("centre_velocity", centre_velocity, Dimension::VELOCITY),
                    number.of("radius", radius, Dimension::LENGTH),
                ];
                parameters.extend(self.rate().into_iter().flat_map(rate));
                (", u = U (1 − ρ²/R²), rate 2U/R", parameters)
            }
            Self::Channel {
                centre_velocity,
                width,
                depth,
            } => {
                let mut parameters = vec![
                    number.of("centre_velocity", centre_velocity, Dimension::VELOCITY),
                    number.of("H", width, Dimension::LENGTH),
                ];
                parameters.extend(depth.map(|depth| number.of("depth", depth, Dimension::LENGTH)));
                parameters.extend(self.rate().into_iter().flat_map(rate));
                (", along x between walls, rate 4U/H", parameters)
            }
        };
        (format!("{}{formula}", self.name()), parameters)
    }

    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Quiescent => "quiescent",
            Self::Shear { .. } => "shear",
            Self::Extension { .. } => "extension",
            Self::PlaneExtension { .. } => "plane-extension",
            Self::Linear { .. } => "linear",
            Self::Poiseuille { .. } => "poiseuille",
            Self::Channel { .. } => "channel",
        }
    }
}

/// Rounding of a matrix's entries, relative to the largest.
const ROUNDING: f64 = 1e-12;

/// t and n of `L = γ̇ t nᵀ` with γ̇ > 0.
fn shear_plane(gradient: [[f64; 3]; 3]) -> Option<[[f64; 3]; 2]> {
    let rows = gradient.map(DVec3::from);
    let normal = rows
        .into_iter()
        .max_by(|a, b| a.length().total_cmp(&b.length()))?;
    let normal = normal.try_normalize()?;
    let velocity = DVec3::from(rows.map(|row| row.dot(normal)));
    let rate = velocity.length();
    let along = velocity / rate;
    let rest = (0..3).map(|i| (rows[i] - velocity[i] * normal).length());
    let rest = rest.fold(along.dot(normal).abs() * rate, f64::max);
    (rest <= ROUNDING * rate).then(|| [along.to_array(), normal.to_array()])
}

const RATE: Key = required(
    "rate",
    Form::Number(Dimension::RATE, Range::NotZero),
    "Shear rate γ̇ or rate of extension ε̇.",
);

const CENTRE_VELOCITY: Key = required(
    "centre_velocity",
    Form::Number(Dimension::VELOCITY, Range::NotZero),
    "Velocity U on the axis, or in the middle of a channel without surfaces and obstacles.",
);

const KINDS: &[Kind] = &[
    kind("quiescent", &[]),
    kind("shear", &[RATE, COURSE]),
    kind("extension", &[RATE, COURSE]),
    kind("plane-extension", &[RATE, COURSE]),
    kind(
        "linear",
        &[
            required(
                "gradient",
                Form::Exactly(3, &Form::Exactly(3, &any(Dimension::RATE))),
                "Velocity gradient L, row by row: [[∂u/∂x, ∂u/∂y, ∂u/∂z], [∂v/∂x, …], …]; its trace is 0.",
            ),
            COURSE,
        ],
    ),
    kind(
        "poiseuille",
        &[
            CENTRE_VELOCITY,
            required(
                "radius",
                positive(Dimension::LENGTH),
                "Radius R of the tube of this flow. There are no walls: beyond R the flow is \
                 reversed.",
            ),
            required("direction", Form::Direction, "Direction of axis and flow."),
            optional(
                "through",
                Form::Vector(Dimension::LENGTH),
                "A point of the axis; by default [0, 0, 0].",
            ),
            COURSE,
        ],
    ),
    kind(
        "channel",
        &[
            CENTRE_VELOCITY,
            optional(
                "section",
                Form::Choice(|| vec!["plates", "duct"]),
                "\"plates\", walls at the ends of y; \"duct\", of z too; by default plates.",
            ),
            COURSE,
        ],
    ),
];

const fn kind(name: &'static str, keys: &'static [Key]) -> Kind {
    Kind {
        name,
        keys,
        exactly_one: &[],
    }
}

pub(super) static FLOW: Keys = Keys {
    keys: &of_kinds::<{ 1 + count_of(KINDS) }>(
        required(
            "kind",
            Form::Choice(|| kinds(&FLOW)),
            "\"quiescent\"; \"shear\", u = (γ̇ y, 0, 0); \"extension\", u = ε̇ (x, −y/2, −z/2); \
             \"plane-extension\", u = ε̇ (x, −y, 0); \"linear\", u = L·x; \"poiseuille\", u = U (1 − \
             ρ²/R²) along an axis, ρ the distance from it; \"channel\", along x between the walls of \
             a lattice's box, driven by a force on all fluid. On a lattice, two walls at the ends of \
             y cause the shear.",
        ),
        KINDS,
    ),
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: KINDS,
};
