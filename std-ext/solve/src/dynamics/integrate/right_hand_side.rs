//! The velocities of an integration, and the ways in which they fail.

use crate::dynamics::vector::Vector;
use serde::{Deserialize, Serialize};

/// Velocities as functions of positions and time.
///
/// They must depend on positions and time alone, to the last bit, for a run to continue bit for
/// bit.
pub trait RightHandSide {
    /// Sets `velocities` to v(x, t).
    ///
    /// # Errors
    /// The reason why velocities cannot be computed. The step is then repeated with a shorter
    /// length.
    fn evaluate(
        &mut self,
        positions: &[[f64; 3]],
        time: f64,
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String>;

    /// Corrects the positions at the end of a step for quantities that steps conserve only up to their
    /// error, for example volumes.
    fn restore(&mut self, _positions: &mut [[f64; 3]]) {}
}

impl<F> RightHandSide for F
where
    F: FnMut(&[[f64; 3]], f64, &mut [[f64; 3]]) -> Result<(), String>,
{
    fn evaluate(
        &mut self,
        positions: &[[f64; 3]],
        time: f64,
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        self(positions, time, velocities)
    }
}

/// Failure of a run; the positions stay the last good ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Failure {
    /// A velocity is not finite.
    #[error("the velocity of vertex {vertex} is not a finite number at time {time:e}")]
    NotFinite {
        /// The first such vertex.
        vertex: usize,
        /// The time.
        time: f64,
    },
    /// The right-hand side could not compute velocities.
    #[error("velocities cannot be computed at time {time:e}: {reason}")]
    Refused {
        /// The reason.
        reason: String,
        /// The time.
        time: f64,
    },
    /// The error is too large for every step.
    #[error(
        "at time {time:e} a step of {tried:e} still has {error:.2} times the allowed error, and steps below {floor:e} are too short to make progress"
    )]
    StepBelowFloor {
        /// The time.
        time: f64,
        /// The last step tried.
        tried: f64,
        /// Its error in units of that allowed.
        error: f64,
        /// The shortest step that makes sense.
        floor: f64,
    },
}

/// A right-hand side that is counted, and whose velocities are finite.
pub(super) struct Checked<'a> {
    pub(super) inner: &'a mut dyn RightHandSide,
    pub(super) evaluations: &'a mut usize,
}

impl Checked<'_> {
    pub(super) fn evaluate(
        &mut self,
        positions: &[Vector],
        time: f64,
        velocities: &mut [Vector],
    ) -> Result<(), Failure> {
        *self.evaluations += 1;
        let evaluated = self.inner.evaluate(positions, time, velocities);
        evaluated.map_err(|reason| Failure::Refused { reason, time })?;
        match first_bad(velocities) {
            Some(vertex) => Err(Failure::NotFinite { vertex, time }),
            None => Ok(()),
        }
    }

    /// Evaluates the right-hand side at the end of a step, where positions are restored.
    pub(super) fn arrive(
        &mut self,
        positions: &mut [Vector],
        time: f64,
        velocities: &mut [Vector],
    ) -> Result<(), Failure> {
        self.inner.restore(positions);
        self.evaluate(positions, time, velocities)
    }
}

/// The first vector that is not finite.
pub(super) fn first_bad(field: &[Vector]) -> Option<usize> {
    let bad = |vector: &Vector| !vector.iter().all(|entry| entry.is_finite());
    field.iter().position(bad)
}
