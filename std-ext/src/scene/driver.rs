//! Drivers, which move the surfaces.

use super::LatticeBoltzmann;
use crate::flow::{Ambient, Channel};
use glam::DVec3;
use helfrich::Images;
use serde::Serialize;

/// A driver, which moves the surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Driver {
    /// To an equilibrium, along a path without meaning: there is no time.
    Relax(Relax),
    /// Membranes in Stokes flow without walls.
    BoundaryIntegral(BoundaryIntegral),
    /// Membranes in a box of fluid on a lattice.
    LatticeBoltzmann(LatticeBoltzmann),
}

impl Driver {
    /// Its name, the `kind` of a scene's driver.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Relax(_) => "relax",
            Self::BoundaryIntegral(_) => "boundary-integral",
            Self::LatticeBoltzmann(_) => "lattice-boltzmann",
        }
    }

    /// The ambient flow, of drivers that have one.
    pub fn flow(&self) -> Option<&Flow> {
        match self {
            Self::Relax(_) => None,
            Self::BoundaryIntegral(driver) => Some(&driver.flow),
            Self::LatticeBoltzmann(driver) => Some(&driver.flow),
        }
    }

    /// The periodic images of surfaces in a box; none in free space.
    pub fn images(&self) -> Images<f64> {
        match self {
            Self::Relax(_) | Self::BoundaryIntegral(_) => Images::none(),
            Self::LatticeBoltzmann(driver) => driver.images(),
        }
    }

    /// Viscosity μ of the fluid outside the surfaces, of drivers with a fluid.
    pub fn viscosity(&self) -> Option<f64> {
        match self {
            Self::Relax(_) => None,
            Self::BoundaryIntegral(driver) => Some(driver.viscosity),
            Self::LatticeBoltzmann(driver) => Some(driver.viscosity),
        }
    }
}

/// Settings of a relaxation, and its stopping criteria.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Relax {
    /// The scheme, already chosen: never `auto`.
    pub scheme: Scheme,
    /// The run ends when the root mean square of the remaining force per area is below this, in
    /// units of κ/R³ + K/R. K is the largest in-plane modulus, `4πR² = A`.
    pub residual: f64,
    /// Iterations after which the run ends in any case.
    pub iterations: u64,
    /// Whether vertices are moved along the surface to keep the mesh even.
    pub redistribution: bool,
    /// Largest relative error of the energy of a closed surface with bending at which a run counts
    /// as converged.
    pub energy_error: f64,
}

/// The minimisation scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Energy minimisation, for conservative methods.
    Minimise,
    /// Overdamped dynamics, for all methods.
    Overdamped,
}

/// Membranes in Stokes flow, moved by boundary integrals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoundaryIntegral {
    /// Viscosity μ of the fluid outside, pressure times time.
    pub viscosity: f64,
    /// The undisturbed flow, without membranes.
    pub flow: Flow,
    /// The time at which the run ends; it begins at 0.
    pub duration: f64,
    /// The integrator, already chosen: never `auto`.
    pub integrator: Integrator,
    /// The error tolerance of a step, in units of the size of the surfaces.
    pub tolerance: f64,
    /// Whether the discrete volume of each closed surface is kept to rounding.
    pub volume_correction: bool,
    /// Whether vertices of fluid surfaces slide along them to keep the mesh even.
    pub redistribution: bool,
}

/// The integrator. [`crate::dynamics::integrate::Scheme`] describes each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "name")]
pub enum Integrator {
    /// Stabilised steps of second order, where bending limits the step.
    Rkc2,
    /// A pair of third and second order.
    Bs23,
    /// The classical scheme of fourth order.
    Rk4 {
        /// The fixed step, a time.
        step: f64,
    },
}

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
        /// L, 1/time: `gradient[i][j]` is ∂u_i/∂x_j. Its trace is 0, but for rounding.
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
    /// The rate, 1/time and above 0, by which strain and capillary numbers are counted.
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
    /// gradient for a shear, along stretching and shrinking for a plane extension. A linear flow
    /// has a plane only if it is a shear `L = γ̇ t nᵀ` with `t·n = 0`. Other flows have none.
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
