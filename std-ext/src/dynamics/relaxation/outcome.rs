//! How a relaxation ends, and why it may not begin.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How a relaxation ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Outcome {
    /// The residual is below the tolerance.
    Converged,
    /// The limit of steps was reached.
    IterationLimit,
    /// Nothing improves any more: what is left of forces is rounding, or for methods without an
    /// energy a cycle.
    Stagnated,
    /// It went wrong; the positions are the last good ones.
    Failed(Failure),
}

/// What went wrong, and where.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Failure {
    /// A force or the energy is not finite.
    #[error(
        "the force on vertex {vertex} of membrane {membrane}, or the energy, is not a finite number"
    )]
    NotFinite {
        /// The membrane, from 0.
        membrane: usize,
        /// The vertex of that membrane whose force is not finite, 0 if it is the energy.
        vertex: usize,
    },
    /// A triangle looks the other way than the surface around it.
    #[error(
        "triangle {triangle} of membrane {membrane} is turned over against the surface around it"
    )]
    Inverted {
        /// The membrane, from 0.
        membrane: usize,
        /// The triangle of that membrane.
        triangle: usize,
    },
    /// A triangle has become too narrow for forces on it to mean anything.
    #[error(
        "triangle {triangle} of membrane {membrane} has become too narrow: an angle of {degrees:.2} degrees"
    )]
    Distorted {
        /// The membrane, from 0.
        membrane: usize,
        /// The triangle of that membrane.
        triangle: usize,
        /// The angle whose sine is least.
        degrees: f64,
    },
    /// The step fell below its floor, though forces are far from rounding: they do not belong to
    /// the energy, or the mesh is so bad that no step helps.
    #[error("no step down to {step:e} of what was proposed brings the membranes any further")]
    StepBelowFloor {
        /// The last step tried, in units of what was proposed.
        step: f64,
    },
    /// Constraints cannot be met from these positions.
    #[error(
        "area, volume or another constrained value stays off its target by {error:e} of it; the limit is {limit:e}"
    )]
    ConstraintsLost {
        /// The relative error that is left.
        error: f64,
        /// The relative error that is allowed.
        limit: f64,
    },
}

impl Failure {
    /// The membrane it names, from 0.
    pub fn membrane(&self) -> Option<usize> {
        match *self {
            Self::NotFinite { membrane, .. }
            | Self::Inverted { membrane, .. }
            | Self::Distorted { membrane, .. } => Some(membrane),
            Self::StepBelowFloor { .. } | Self::ConstraintsLost { .. } => None,
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Converged => formatter.write_str("converged"),
            Self::IterationLimit => formatter.write_str("limit of steps reached"),
            Self::Stagnated => formatter.write_str("stagnated: nothing improves any more"),
            Self::Failed(failure) => failure.fmt(formatter),
        }
    }
}

/// Why a relaxation cannot begin.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// Each vertex needs one position.
    #[error("{positions} positions were given for membranes of {vertices} vertices")]
    CountMismatch {
        /// How many positions there are.
        positions: usize,
        /// How many there should be.
        vertices: usize,
    },
    /// A modulus is negative or not finite, or both are 0.
    #[error(
        "membrane {membrane} has the moduli {bending:e} (bending) and {in_plane:e} (in plane): neither may be negative, nor both 0"
    )]
    Modulus {
        /// The membrane, from 0.
        membrane: usize,
        /// Its bending modulus.
        bending: f64,
        /// Its in-plane modulus.
        in_plane: f64,
    },
}
