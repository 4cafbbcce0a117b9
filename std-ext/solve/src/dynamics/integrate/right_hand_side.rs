//! The velocities of an integration, and the ways in which they fail.

use super::Start;
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

    /// Prepares [`Self::solve`] for an approximation A of the derivatives ∂v/∂x at these positions. Steps
    /// of [`Scheme::Rosenbrock`](super::Scheme::Rosenbrock) keep their order whatever A is; they are
    /// stable where its decay rates are between about 0.7 times and four times those of ∂v/∂x. By
    /// default A is 0.
    ///
    /// # Errors
    /// The reason why A cannot be computed. The step fails.
    fn linearise(&mut self, _positions: &[[f64; 3]], _time: f64) -> Result<(), String> {
        Ok(())
    }

    /// Replaces a field r by y, where `y − c A y = r`. The solution must depend on A, c and r alone, to
    /// the last bit.
    ///
    /// # Errors
    /// The reason why there is no solution. The step is then repeated with a shorter length.
    fn solve(&mut self, _c: f64, _field: &mut [[f64; 3]]) -> Result<(), String> {
        Ok(())
    }

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

    pub(super) fn linearise(&mut self, start: Start<'_>) -> Result<(), Failure> {
        let time = start.time;
        let linearised = self.inner.linearise(start.positions, time);
        linearised.map_err(|reason| Failure::Refused { reason, time })
    }

    pub(super) fn solve(&mut self, c: f64, time: f64, field: &mut [Vector]) -> Result<(), Failure> {
        let solved = self.inner.solve(c, field);
        solved.map_err(|reason| Failure::Refused { reason, time })?;
        match first_bad(field) {
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
