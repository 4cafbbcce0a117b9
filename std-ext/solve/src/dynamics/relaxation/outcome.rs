//! Ends of a relaxation, and reasons why it cannot start.

use serde::{Deserialize, Serialize};
use std::fmt;

/// End of a relaxation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Outcome {
    /// The residual is below the tolerance.
    Converged,
    /// The limit of steps was reached.
    IterationLimit,
    /// Neither residual nor energy improves: the remaining forces are rounding errors or, for methods
    /// without an energy, a cycle.
    Stagnated,
    /// A failure; the positions are the last good ones.
    Failed(Failure),
}

/// The reason of a failure, and its place.
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
    /// The normal of a triangle is opposite to the surface around it.
    #[error(
        "triangle {triangle} of membrane {membrane} faces the opposite way to the surface around it"
    )]
    Inverted {
        /// The membrane, from 0.
        membrane: usize,
        /// The triangle of that membrane.
        triangle: usize,
    },
    /// A triangle has become too narrow for meaningful forces.
    #[error(
        "triangle {triangle} of membrane {membrane} has become too narrow: an angle of {degrees:.2} degrees"
    )]
    Distorted {
        /// The membrane, from 0.
        membrane: usize,
        /// The triangle of that membrane.
        triangle: usize,
        /// The angle with the smallest sine.
        degrees: f64,
    },
    /// The step fell below its floor although forces are far above rounding: either forces are not the
    /// gradient of the energy, or the mesh is so bad that no step makes progress.
    #[error("no step, down to {step:e} of the proposed length, makes progress")]
    StepBelowFloor {
        /// The last step tried, relative to the proposed one.
        step: f64,
    },
    /// Constraints cannot be met from these positions.
    #[error(
        "area, volume or another constrained value misses its target by a relative error of {error:e}; the limit is {limit:e}"
    )]
    ConstraintsLost {
        /// The remaining relative error.
        error: f64,
        /// The largest relative error allowed.
        limit: f64,
    },
}

impl Failure {
    /// Whether a jump of constrained values to their targets can be the reason.
    pub fn is_of_constraints(&self) -> bool {
        matches!(
            self,
            Self::Inverted { .. } | Self::Distorted { .. } | Self::ConstraintsLost { .. }
        )
    }

    /// The membrane to which the failure belongs, from 0.
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

/// Reason why a relaxation cannot start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// Each vertex needs one position.
    #[error("{positions} positions were given for membranes of {vertices} vertices")]
    CountMismatch {
        /// The number of positions.
        positions: usize,
        /// The expected number.
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
    /// Either every vertex or none needs a flag that states whether it is fixed.
    #[error("membrane {membrane} has {vertices} vertices, and {flags} flags of fixed ones")]
    Fixed {
        /// The membrane, from 0.
        membrane: usize,
        /// The number of flags.
        flags: usize,
        /// Number of vertices of the membrane.
        vertices: usize,
    },
}
