//! Line search: the length of a step.

use super::point::RelaxationPoint;
use super::{Failure, Outcome, Relaxation};
use crate::dynamics::Problem;
use crate::dynamics::vector::{self, Vector};

/// Armijo's constant: the required fraction of the linear decrease.
const SUFFICIENT: f64 = 1e-4;

/// Wolfe's constant: the fraction of the force along a step that may remain at its end.
const CURVATURE: f64 = 0.9;

/// Largest reversed force along a step at its end, as a fraction of the force at its start, where
/// the energy does not decide.
const OVERSHOOT: f64 = 0.5;

/// The largest growth of the residual in a step without an energy. It permits growing instabilities of
/// the shape, but rejects steps that are too long.
const LARGEST_GROWTH: f64 = 1.5;

/// The largest relative change of an edge in a step, which keeps triangles from turning over.
const LARGEST_STRAIN: f64 = 0.5;

/// Largest number of trials for one step; each is at most a tenth of the previous one.
const TRIALS: usize = 24;

/// Largest number of doublings of a step that is too short.
const EXPANSIONS: usize = 6;

/// Rounding of an energy, in units of the last place of its scale.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A candidate for the next point, and its step length.
pub(super) struct Trial {
    pub(super) point: RelaxationPoint,
    pub(super) step: f64,
    /// Whether the force has hardly fallen although the step was doubled as often as allowed.
    pub(super) crawls: bool,
}

/// The reason why a trial step is too long.
#[derive(Clone, Copy, Debug)]
enum TooFar {
    Bad(Failure),
    /// The best step length according to the trials so far.
    Rises(f64),
}

impl Relaxation {
    /// The longest step along a displacement within the allowed change of edges.
    pub(super) fn longest_step(&self, positions: &[Vector], displacement: &[Vector]) -> f64 {
        let mut largest = 0.0f64;
        for (membrane, place) in self.membranes.iter().zip(&self.places) {
            let [x, d] = [positions, displacement].map(|all| &all[place.vertices()]);
            for &[a, b] in membrane.mesh.edges() {
                let [a, b] = [a as usize, b as usize];
                let (edge, change) = (vector::sub(x[b], x[a]), vector::sub(d[b], d[a]));
                let length = vector::dot(edge, edge);
                if length > 0.0 {
                    largest = largest.max(vector::dot(change, change) / length);
                }
            }
        }
        LARGEST_STRAIN / largest.sqrt()
    }

    /// Finds the next point along the best direction known; if there is none, along the
    /// preconditioned force.
    pub(super) fn advance(
        &mut self,
        problem: &mut dyn Problem,
        here: &RelaxationPoint,
    ) -> Result<Trial, Outcome> {
        let newton = self.newton_is_due(problem);
        if newton {
            let trial = self.newton(problem, here);
            self.state.newton = trial.is_some();
            if let Some(trial) = trial {
                return Ok(trial);
            }
        }
        loop {
            let direction = self.direction(problem, here);
            let slope = vector::product(&here.force, &direction);
            let steep = slope > 0.0 && slope.is_finite();
            let found = if steep {
                self.search(problem, here, &direction, slope)
            } else {
                Err((Failure::StepBelowFloor { step: 1.0 }, 0.0))
            };
            match found {
                // Secants from differences of the size of rounding errors have no scale: steps along
                // them would stay short, and produce more such secants.
                Ok(trial) if trial.crawls => {
                    self.state.secants.clear();
                    return Ok(trial);
                }
                Ok(trial) => {
                    let mut step = direction;
                    step.iter_mut().for_each(|entry| *entry *= trial.step);
                    let mut fall = here.force.clone();
                    vector::add_scaled(&mut fall, -1.0, &trial.point.force);
                    self.state.secants.push(self.settings.memory, step, fall);
                    return Ok(trial);
                }
                Err(_) if !self.state.secants.is_empty() => self.state.secants.clear(),
                Err((failure, gain)) => {
                    let rounding = 1e3 * ROUNDING * here.evaluation.energy_scale;
                    let lost = problem.is_conservative() && gain <= rounding;
                    // Without an energy, the best point found, if neither direction is successful.
                    return Err(if lost || newton {
                        Outcome::Stagnated
                    } else {
                        Outcome::Failed(failure)
                    });
                }
            }
        }
    }

    /// Searches along a direction. An error comes with the decrease of the energy that was expected
    /// of the first trial.
    fn search(
        &mut self,
        problem: &mut dyn Problem,
        here: &RelaxationPoint,
        direction: &[f64],
        slope: f64,
    ) -> Result<Trial, (Failure, f64)> {
        let displacement = self.frame.expand(&self.places, &here.positions, direction);
        let longest = self.longest_step(&here.positions, &displacement);
        let mut step = longest.min(1.0);
        let gain = step * slope;
        let mut short: Option<Trial> = None;
        let mut expansions = 0;
        let mut failure = Failure::StepBelowFloor { step };
        for _ in 0..TRIALS {
            let moved = |(x, d): (&Vector, &Vector)| vector::add(*x, vector::scale(step, *d));
            let positions = here
                .positions
                .iter()
                .zip(&displacement)
                .map(moved)
                .collect();
            let trial = self.evaluate(problem, positions, true);
            let judged = match trial {
                Ok(point) => {
                    let left = vector::product(&point.force, direction);
                    match self.too_far(problem, here, &point, step, slope, left) {
                        Some(shorter) => Err(TooFar::Rises(shorter)),
                        None => Ok((point, left)),
                    }
                }
                Err((failure, _)) => Err(TooFar::Bad(failure)),
            };
            match judged {
                Ok((point, left)) => {
                    let falls = left <= CURVATURE * slope || step >= longest;
                    let enough = falls || expansions >= EXPANSIONS;
                    let crawls = enough && !falls;
                    let trial = Trial {
                        point,
                        step,
                        crawls,
                    };
                    if enough {
                        return Ok(trial);
                    }
                    // After a step that was too long, a step that is merely short is accepted.
                    if expansions == 0 && step < longest.min(1.0) {
                        return Ok(trial);
                    }
                    expansions += 1;
                    step = (2.0 * step).min(longest);
                    short = Some(trial);
                }
                Err(reason) => {
                    if let Some(trial) = short {
                        return Ok(trial);
                    }
                    step = match reason {
                        TooFar::Bad(bad) => {
                            failure = bad;
                            0.25 * step
                        }
                        TooFar::Rises(shorter) => {
                            failure = Failure::StepBelowFloor { step };
                            shorter
                        }
                    };
                }
            }
        }
        Err((failure, gain))
    }

    /// A better step length, if a point is too far along a direction.
    fn too_far(
        &self,
        problem: &dyn Problem,
        here: &RelaxationPoint,
        there: &RelaxationPoint,
        step: f64,
        slope: f64,
        left: f64,
    ) -> Option<f64> {
        // The zero of the force along the direction, by linear interpolation.
        let secant = step * (slope / (slope - left)).clamp(0.1, 0.7);
        if !problem.is_conservative() {
            let wild = there.residual > LARGEST_GROWTH * here.residual;
            return (wild || left < -OVERSHOOT * slope).then_some(secant);
        }
        let (before, after) = (here.evaluation, there.evaluation);
        let rounding = ROUNDING * before.energy_scale.max(after.energy_scale);
        let rise = after.energy - before.energy;
        if rise <= -SUFFICIENT * step * slope {
            return None;
        }
        // W. W. Hager and H. Zhang, SIAM J. Optim. 16 (2005) 170: if differences of energy are of the
        // size of rounding errors, the force decides.
        let lowest = self.state.lowest_energy.unwrap_or(before.energy);
        if after.energy <= lowest + rounding && left >= -OVERSHOOT * slope {
            return None;
        }
        let parabola = 0.5 * step * slope / (slope + rise / step);
        let shorter = if rise > rounding { parabola } else { secant };
        Some(shorter.clamp(0.1 * step, 0.7 * step))
    }
}
