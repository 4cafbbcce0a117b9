//! Lengths of steps.

use super::right_hand_side::{Checked, RightHandSide};
use super::{Failure, Integrator, RETREAT, Scheme, Start, bs23, rk4, rkc2};
use crate::dynamics::vector::{Vector, add, root_mean_square, scale, sub};
use serde::{Deserialize, Serialize};

/// The share of the allowed error that step control aims at: that of the paper of [`rkc2`].
const SAFETY: f64 = 0.8;

/// The limits of the change of a step.
const FACTOR: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// The error, in units of what is allowed, below which a step grows by no more than [`FACTOR`].
const LEAST_ERROR: f64 = 5e-4;

/// The shortest step, in units of the time in which positions move by the tolerance or, for bodies
/// at rest, of the first trial step.
const FLOOR: f64 = 1e-8;

/// The memory of the step controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Previous {
    pub(super) step: f64,
    /// The error in units of the tolerance.
    pub(super) error: f64,
}

impl Integrator {
    /// The next step by the last two errors: the controller of the paper of [`rkc2`], after H. A.
    /// Watts, J. Comput. Appl. Math. 12 (1985) 93. The error is of third order for each of these schemes.
    pub(super) fn choose_step(&mut self, step: f64, error: f64) {
        if matches!(self.settings.scheme, Scheme::Rk4 { .. }) {
            return;
        }
        let error = error.max(LEAST_ERROR);
        let trend = self.state.previous.map_or(1.0, |previous| {
            step / previous.step * (previous.error / error).cbrt()
        });
        let factor = SAFETY * trend / error.cbrt();
        let factor = factor.clamp(*FACTOR.start(), *FACTOR.end());
        self.state.step = Some(factor * step);
        self.state.previous = Some(Previous { step, error });
    }

    /// The first step, from the change of velocities in an Euler step, as in that paper.
    pub(super) fn first_step(
        &mut self,
        right_hand_side: &mut dyn RightHandSide,
        remaining: f64,
    ) -> Result<f64, Failure> {
        let longest = self.settings.longest_step.unwrap_or(f64::INFINITY);
        let longest = longest.min(remaining);
        let allowed = self.settings.tolerance * self.settings.length;
        let state = &mut self.state;
        let speed = root_mean_square(state.velocities.iter().copied());
        let mut trial = longest.min(0.1 * self.settings.length / speed);
        if let Some(radius) = state.radius(&self.settings) {
            trial = trial.min(radius.recip());
        }
        // Nothing moves, so there is no time scale for a first step.
        if !trial.is_finite() {
            return Ok(longest);
        }
        let mut checked = Checked {
            inner: right_hand_side,
            evaluations: &mut state.evaluations,
        };
        let work = &mut self.work;
        if self.settings.scheme == Scheme::Rosenbrock {
            // The change of velocities by what is stiff.
            let start = Start {
                time: state.time,
                positions: &state.positions,
                velocities: &state.velocities,
            };
            let smoothed = &mut work.end_velocities;
            smoothed.copy_from_slice(start.velocities);
            checked.linearise(start)?;
            if checked.solve(trial, start.time, smoothed).is_err() {
                return Ok(RETREAT * trial);
            }
            let error = trial * difference(start.velocities, smoothed) / allowed;
            return Ok((0.1 * trial / error.sqrt()).min(longest));
        }
        for (end, (x, v)) in work
            .end
            .iter_mut()
            .zip(state.positions.iter().zip(&state.velocities))
        {
            *end = add(*x, scale(trial, *v));
        }
        let time = state.time + trial;
        match checked.evaluate(&work.end, time, &mut work.end_velocities) {
            Ok(()) => {}
            // The first step will be shortened by error control.
            Err(_) => return Ok(RETREAT * trial),
        }
        let error = trial * difference(&state.velocities, &work.end_velocities) / allowed;
        Ok((0.1 * trial / error.sqrt()).min(longest))
    }

    /// The step to try after a step whose error was `error` times the allowed error.
    pub(super) fn shorter(step: f64, error: f64) -> f64 {
        let factor = if error.is_finite() {
            (SAFETY / error.cbrt()).max(*FACTOR.start())
        } else {
            *FACTOR.start()
        };
        factor * step
    }

    /// The longest stable step of the scheme, by the last estimate of the spectrum; `None` if the
    /// spectral radius is not known or 0, and for [`Scheme::Rosenbrock`].
    pub fn step_limit(&self) -> Option<f64> {
        let radius = self.state.radius(&self.settings)?;
        let interval = match self.settings.scheme {
            Scheme::Rosenbrock => return None,
            Scheme::Rkc2 => {
                let stages = self.settings.largest_stages() as f64;
                (stages * stages - 1.0) / rkc2::STABILITY
            }
            Scheme::Bs23 => bs23::STABILITY,
            Scheme::Rk4 { .. } => rk4::STABILITY,
        };
        let limit = interval / radius;
        limit.is_finite().then_some(limit)
    }

    /// The shortest useful step after a first trial of length `first`: it exceeds the rounding of
    /// the time, and is long enough for positions to move.
    pub(super) fn floor(&self, first: f64) -> f64 {
        let speed = root_mean_square(self.state.velocities.iter().copied());
        let moving = self.settings.tolerance * self.settings.length / speed;
        let rounding = 16.0 * f64::EPSILON * self.state.time.abs();
        (FLOOR * moving.min(first)).max(rounding)
    }
}

/// The root mean square of the change of a field.
fn difference(before: &[Vector], after: &[Vector]) -> f64 {
    let changes = after.iter().zip(before);
    root_mean_square(changes.map(|(after, before)| sub(*after, *before)))
}
