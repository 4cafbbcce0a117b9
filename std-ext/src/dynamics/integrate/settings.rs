//! What a run in time is asked for.

use serde::{Deserialize, Serialize};

/// How steps are made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// The stabilised scheme of second order by Sommeijer, Shampine and Verwer (RKC), with error
    /// control: s stages are stable for eigenvalues in (−s²/1.54, 0)/Δt, roughly.
    Rkc2,
    /// The pair of third and second order by Bogacki and Shampine, with error control; three
    /// velocities a step.
    Bs23,
    /// The classical scheme of fourth order, without error control; four velocities a step.
    Rk4 {
        /// The step, shortened only to what is stable and to output times.
        step: f64,
    },
}

/// Where the spectral radius of ∂v/∂x comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpectralRadius {
    /// It is estimated by power iteration, at first, every 25 steps and after rejected steps.
    Estimated,
    /// It is known to be at most this, per time.
    Given(f64),
    /// It is not asked for: steps are limited by their error alone. Not for [`Scheme::Rkc2`].
    Unknown,
}

/// How a run proceeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// How steps are made.
    pub scheme: Scheme,
    /// The error allowed in a step, `√(Σ|e_i|²/N)` over all N positions, in units of `length`.
    pub tolerance: f64,
    /// The size of what moves, the radius of a capsule say.
    pub length: f64,
    /// How accurately velocities are known, relative: that of rounding, or of an iterative solver
    /// where they come from one. Derivatives by differences take their displacement from it.
    pub precision: f64,
    /// The longest step; `None` for no limit.
    pub longest_step: Option<f64>,
    /// The largest number of stages of [`Scheme::Rkc2`]. It is lower where rounding, which grows
    /// with its square, would reach the tolerance.
    pub stage_limit: usize,
    /// Where the spectral radius comes from.
    pub spectral_radius: SpectralRadius,
}

impl Settings {
    /// The usual settings of a scheme for something of this size.
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

/// Why a run cannot begin.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// A number that has to be positive and finite is not.
    #[error("the {name} is {value:e}: it has to be positive and finite")]
    NotPositive {
        /// Which number.
        name: &'static str,
        /// What it is.
        value: f64,
    },
    /// The number of stages follows from the spectral radius.
    #[error("stabilised steps need the spectral radius: let it be estimated or give it")]
    NeedsRadius,
    /// Too few stages.
    #[error("{limit} stages are allowed in a stabilised step, which has at least 2")]
    StageLimit {
        /// What the limit is.
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
        /// How many vectors there are.
        found: usize,
        /// How many there should be.
        positions: usize,
    },
}
