//! Settings of an integration in time.

use serde::{Deserialize, Serialize};

/// The scheme of steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// The stabilised scheme of second order by Sommeijer, Shampine and Verwer (RKC), with error
    /// control: s stages are stable for eigenvalues in about (−s²/1.54, 0)/Δt.
    Rkc2,
    /// The pair of third and second order by Bogacki and Shampine, with error control; three
    /// velocities per step.
    Bs23,
    /// Linearly implicit steps of third order, with error control; four velocities per step. Their
    /// length is limited by their error alone if [`RightHandSide::linearise`](super::RightHandSide::linearise)
    /// covers what is stiff.
    Rosenbrock,
    /// The classical scheme of fourth order, without error control; four velocities per step.
    Rk4 {
        /// The step, shortened only to what is stable and to output times.
        step: f64,
    },
}

/// Source of the spectral radius of ∂v/∂x.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpectralRadius {
    /// An estimate by power iteration, at the start, every 25 steps and after rejected steps.
    Estimated,
    /// A known upper bound, per time.
    Given(f64),
    /// No spectral radius: steps are limited by their error alone. Not allowed for
    /// [`Scheme::Rkc2`].
    Unknown,
}

/// Settings of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The scheme of steps.
    pub scheme: Scheme,
    /// The error allowed per step, `√(Σ|e_i|²/N)` over all N positions, in units of `length`.
    pub tolerance: f64,
    /// The size of the moving bodies, for example the radius of a capsule.
    pub length: f64,
    /// Relative accuracy of velocities: that of rounding, or of the iterative solver that computes them.
    /// It determines the displacement of derivatives by differences.
    pub precision: f64,
    /// The longest step; `None` for no limit.
    pub longest_step: Option<f64>,
    /// The largest number of stages of [`Scheme::Rkc2`]. It is lower where rounding, which grows
    /// with its square, would reach the tolerance.
    pub stage_limit: usize,
    /// Source of the spectral radius.
    pub spectral_radius: SpectralRadius,
}

impl Settings {
    /// The usual settings of a scheme for bodies of this size.
    pub fn new(scheme: Scheme, length: f64) -> Self {
        Self {
            scheme,
            tolerance: 1e-4,
            length,
            precision: f64::EPSILON,
            longest_step: None,
            stage_limit: 200,
            spectral_radius: SpectralRadius::Estimated,
        }
    }

    pub(super) fn check(&self) -> Result<(), SetupError> {
        let positive = |name, value: f64| {
            if value > 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(SetupError::NotPositive { name, value })
            }
        };
        positive("tolerance", self.tolerance)?;
        positive("length", self.length)?;
        positive("precision", self.precision)?;
        if let Some(step) = self.longest_step {
            positive("longest step", step)?;
        }
        match (self.scheme, self.spectral_radius) {
            (Scheme::Rk4 { step }, _) => positive("step", step)?,
            (Scheme::Rkc2, SpectralRadius::Unknown) => return Err(SetupError::NeedsRadius),
            (Scheme::Rkc2, _) if self.stage_limit < 2 => {
                let limit = self.stage_limit;
                return Err(SetupError::StageLimit { limit });
            }
            _ => {}
        }
        if !matches!(self.scheme, Scheme::Rk4 { .. }) && self.tolerance < f64::EPSILON {
            let tolerance = self.tolerance;
            return Err(SetupError::BelowRounding { tolerance });
        }
        match self.spectral_radius {
            SpectralRadius::Given(radius) if !(radius >= 0.0 && radius.is_finite()) => {
                Err(SetupError::NotPositive {
                    name: "spectral radius",
                    value: radius,
                })
            }
            _ => Ok(()),
        }
    }

    /// The largest number of stages: that of rounding by the paper of [`rkc2`](super::rkc2).
    pub(super) fn largest_stages(&self) -> usize {
        let rounding = (0.1 * self.tolerance / f64::EPSILON).sqrt();
        self.stage_limit.min(rounding as usize).max(2)
    }
}

/// Reason why a run cannot start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// A number that has to be positive and finite is not.
    #[error("the {name} is {value:e}: it has to be positive and finite")]
    NotPositive {
        /// The name of the number.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A tolerance below the accuracy of any step.
    #[error(
        "the tolerance is {tolerance:e} of the size of the surfaces, and positions are rounded by {:e} \
         of theirs: it has to be larger, such as 1e-4",
        f64::EPSILON
    )]
    BelowRounding {
        /// The tolerance.
        tolerance: f64,
    },
    /// The number of stages follows from the spectral radius.
    #[error("stabilised steps need the spectral radius: let it be estimated or give it")]
    NeedsRadius,
    /// Too few stages.
    #[error("{limit} stages are allowed in a stabilised step, which has at least 2")]
    StageLimit {
        /// The limit.
        limit: usize,
    },
    /// A position or the time is not finite.
    #[error("position {vertex}, or the time, is not finite")]
    NotFinite {
        /// The first such vertex, 0 if it is the time.
        vertex: usize,
    },
    /// Parts of a stored state do not belong together.
    #[error("the stored state has {found} vectors for {positions} positions")]
    CountMismatch {
        /// The number of vectors.
        found: usize,
        /// The expected number.
        positions: usize,
    },
}
