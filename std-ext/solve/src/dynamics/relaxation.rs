//! Steps of a relaxation.

use super::frame::Frame;
use super::place::Place;
use super::preconditioner::Preconditioner;
use super::redistribution::redistribute;
use super::secants::Secants;
use super::vector::Vector;
use super::{Evaluation, Membrane, Problem, Settings};
use serde::{Deserialize, Serialize};

mod direction;
mod modes;
mod newton;
mod outcome;
mod point;
mod search;
#[cfg(test)]
mod tests;

pub use modes::{Mode, ModesError, modes};
pub use outcome::{Failure, Outcome, SetupError};
use point::RelaxationPoint;
use search::Trial;

/// The fraction of the gain of a step that a redistribution of vertices may cost.
const SPENT: f64 = 0.5;

/// A relaxation with an energy and a residual below this is at rest if nothing improves for [`REST`] steps: what is
/// left is rounding. From half as many on vertices are not redistributed, which would start it again,
/// without end.
const REST_RESIDUAL: f64 = 1e-6;

/// See [`REST_RESIDUAL`].
const REST: usize = 50;

/// Number of steps between two attempts to redistribute vertices: the smallest, used initially and
/// after a change of frame, and the largest.
const WAIT: std::ops::RangeInclusive<usize> = 4..=256;

/// Relaxation of membranes to equilibrium.
#[derive(Debug)]
pub struct Relaxation {
    membranes: Vec<Membrane>,
    places: Vec<Place>,
    settings: Settings,
    state: State,
    preconditioners: Vec<Preconditioner>,
    frame: Frame,
    here: Option<RelaxationPoint>,
}

/// The state of a relaxation: plain data. A stored and restored run continues bit for bit, if numbers are
/// stored without loss.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    positions: Vec<Vector>,
    iteration: usize,
    evaluations: usize,
    redistributions: usize,
    secants: Secants,
    /// The positions of the last frame; empty before the first.
    anchor: Vec<Vector>,
    /// The positions of the last preconditioner; empty before the first.
    reference: Vec<Vector>,
    /// `None` before the first evaluation.
    lowest_energy: Option<f64>,
    progress: Option<Improvement>,
    /// Whether the last step was a Newton step.
    newton: bool,
    /// Steps until the next redistribution, and between the last two.
    wait: usize,
    last_wait: usize,
    /// The smallest allowed sine of an angle; `None` before the first evaluation.
    least_sine: Option<f64>,
    outcome: Option<Outcome>,
}

/// The best result so far, and the step of its last significant improvement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Improvement {
    residual: f64,
    energy: f64,
    iteration: usize,
}

/// Report of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Number of steps so far.
    pub iteration: usize,
    /// Number of evaluations so far.
    pub evaluations: usize,
    /// The energy after the step; see [`Evaluation::energy`].
    pub energy: f64,
    /// The distance from equilibrium: the root mean square of the force per area without the parts that
    /// constraints balance, and without tangential parts on fluid membranes, in units of
    /// `κ/R³ + K/R`, with the moduli of [`Membrane`] and the radius R of the sphere with the area of
    /// the membrane; the largest among the membranes. This scale is the stiffness of the membrane, so
    /// that the residual is independent of units, size and number of vertices.
    pub residual: f64,
    /// Length of the step relative to the proposed one; 0 if there was none.
    pub step: f64,
    /// Whether vertices were redistributed along the surface.
    pub redistributed: bool,
    /// The end of the relaxation, once reached.
    pub outcome: Option<Outcome>,
}

impl Relaxation {
    /// Membranes at these positions, one membrane after the other.
    ///
    /// # Errors
    /// If the number of positions differs from that of vertices, a membrane has no stiffness, or
    /// flags of fixed vertices do not fit its mesh.
    pub fn new(
        membranes: Vec<Membrane>,
        positions: Vec<[f64; 3]>,
        settings: Settings,
    ) -> Result<Self, SetupError> {
        let state = State {
            positions,
            iteration: 0,
            evaluations: 0,
            redistributions: 0,
            secants: Secants::default(),
            anchor: Vec::new(),
            reference: Vec::new(),
            lowest_energy: None,
            progress: None,
            newton: false,
            wait: *WAIT.start(),
            last_wait: *WAIT.start(),
            least_sine: None,
            outcome: None,
        };
        Self::resume(membranes, state, settings)
    }

    /// Restores a stored state.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn resume(
        membranes: Vec<Membrane>,
        state: State,
        settings: Settings,
    ) -> Result<Self, SetupError> {
        let places = Place::of(&membranes);
        let vertices = places.last().map_or(0, |place| place.vertices().end);
        let made = [&state.anchor, &state.reference].map(Vec::len);
        let made = made.into_iter().filter(|&count| count > 0);
        for count in made.chain([state.positions.len()]) {
            if count != vertices {
                return Err(SetupError::CountMismatch {
                    positions: count,
                    vertices,
                });
            }
        }
        for (index, membrane) in membranes.iter().enumerate() {
            let (bending, in_plane) = (membrane.bending_modulus, membrane.in_plane_modulus);
            let sum = bending + in_plane;
            if !(bending >= 0.0 && in_plane >= 0.0 && sum > 0.0 && sum.is_finite()) {
                return Err(SetupError::Modulus {
                    membrane: index,
                    bending,
                    in_plane,
                });
            }
        }
        for (index, membrane) in membranes.iter().enumerate() {
            let vertices = membrane.mesh.vertex_count();
            if ![0, vertices].contains(&membrane.fixed.len()) {
                return Err(SetupError::Fixed {
                    membrane: index,
                    flags: membrane.fixed.len(),
                    vertices,
                });
            }
        }
        let preconditioners = membranes
            .iter()
            .map(|membrane| Preconditioner::new(&membrane.mesh))
            .collect();
        let mut relaxation = Self {
            membranes,
            places,
            settings,
            state,
            preconditioners,
            frame: Frame::default(),
            here: None,
        };
        if !relaxation.state.anchor.is_empty() {
            relaxation.set_frame();
        }
        if !relaxation.state.reference.is_empty() {
            relaxation.set_preconditioners();
        }
        Ok(relaxation)
    }

    /// The state to store so that the run can be continued.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The positions, one membrane after the other.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.state.positions
    }

    /// The end of the relaxation, if reached.
    pub fn outcome(&self) -> Option<Outcome> {
        self.state.outcome
    }

    /// Number of redistributions of vertices along the surface.
    pub fn redistributions(&self) -> usize {
        self.state.redistributions
    }

    /// The relaxation continued on new meshes of its surfaces, with the numbers of steps and evaluations so far. All that
    /// depends on the meshes begins again. A relaxation that had ended continues.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn on_new_meshes(
        &self,
        membranes: Vec<Membrane>,
        positions: Vec<[f64; 3]>,
    ) -> Result<Self, SetupError> {
        let mut new = Self::new(membranes, positions, self.settings)?;
        new.state.iteration = self.state.iteration;
        new.state.evaluations = self.state.evaluations;
        new.state.redistributions = self.state.redistributions;
        Ok(new)
    }

    /// Must be called after parameters or targets of the problem have changed between two steps: energies
    /// before and after cannot be compared. A relaxation that had ended continues.
    pub fn problem_changed(&mut self) {
        self.here = None;
        self.state.secants.clear();
        self.state.lowest_energy = None;
        self.state.progress = None;
        self.state.wait = *WAIT.start();
        self.state.last_wait = *WAIT.start();
        self.state.outcome = None;
    }

    /// Must be called after the tolerance or the limit of steps has changed between two steps: a
    /// relaxation that had ended without a failure continues.
    pub fn settings_changed(&mut self) {
        if !matches!(self.state.outcome, Some(Outcome::Failed(_))) {
            self.state.outcome = None;
        }
    }

    /// Evaluates the start, with constraints at their targets, before the first step. The first step does
    /// not repeat this evaluation.
    pub fn start(&mut self, problem: &mut dyn Problem) -> StepReport {
        let here = match self.here.take() {
            Some(here) => here,
            None => match self.arrive(problem) {
                Ok(here) => here,
                Err((failure, evaluation)) => return self.fail(failure, evaluation),
            },
        };
        let report = self.report(&here, 0.0, false);
        self.here = Some(here);
        report
    }

    /// Takes one step; after the end nothing moves.
    pub fn step(&mut self, problem: &mut dyn Problem) -> StepReport {
        let here = match self.here.take() {
            Some(here) => here,
            None => match self.arrive(problem) {
                Ok(here) => here,
                Err((failure, report)) => return self.fail(failure, report),
            },
        };
        if self.state.outcome.is_none() {
            self.state.outcome = self.ended(problem, &here);
        }
        if self.state.outcome.is_some() {
            let report = self.report(&here, 0.0, false);
            self.here = Some(here);
            return report;
        }
        let State { iteration, .. } = self.state;
        if !problem.is_conservative()
            && iteration > 0
            && iteration.is_multiple_of(self.settings.restart)
        {
            self.state.secants.clear();
            self.state.wait = *WAIT.start();
            self.state.last_wait = *WAIT.start();
        }
        let here = match self.turn(problem, here) {
            Ok(here) => here,
            Err((failure, evaluation)) => return self.fail(failure, evaluation),
        };
        self.refresh_preconditioners(&here.positions);
        let (next, step, redistributed) = match self.advance(problem, &here) {
            Ok(Trial { point, step, .. }) => {
                let (point, redistributed) = self.spread(problem, &here, point);
                (point, step, redistributed)
            }
            Err(outcome) => {
                self.state.outcome = Some(outcome);
                (here, 0.0, false)
            }
        };
        self.state.positions.clone_from(&next.positions);
        let energy = next.evaluation.energy;
        self.state.lowest_energy = self.state.lowest_energy.map(|lowest| lowest.min(energy));
        if self.state.outcome.is_none() {
            self.state.iteration += 1;
            self.state.outcome = self.ended(problem, &next);
        }
        let report = self.report(&next, step, redistributed);
        self.here = Some(next);
        report
    }

    /// Steps until the relaxation has ended; `each` sees every step and may stop it by `false`.
    pub fn run(
        &mut self,
        problem: &mut dyn Problem,
        mut each: impl FnMut(&Self, &StepReport) -> bool,
    ) -> StepReport {
        loop {
            let report = self.step(problem);
            if !each(self, &report) || report.outcome.is_some() {
                return report;
            }
        }
    }

    fn report(&self, point: &RelaxationPoint, step: f64, redistributed: bool) -> StepReport {
        StepReport {
            iteration: self.state.iteration,
            evaluations: self.state.evaluations,
            energy: point.evaluation.energy,
            residual: point.residual,
            step,
            redistributed,
            outcome: self.state.outcome,
        }
    }

    /// The report of a relaxation that failed at its start.
    fn fail(&mut self, failure: Failure, evaluation: Evaluation) -> StepReport {
        self.state.outcome = Some(Outcome::Failed(failure));
        StepReport {
            iteration: self.state.iteration,
            evaluations: self.state.evaluations,
            energy: evaluation.energy,
            residual: f64::INFINITY,
            step: 0.0,
            redistributed: false,
            outcome: self.state.outcome,
        }
    }

    /// The first point. Constraints are not restored where a run is resumed, so that it stays on its
    /// way.
    fn arrive(
        &mut self,
        problem: &mut dyn Problem,
    ) -> Result<RelaxationPoint, (Failure, Evaluation)> {
        let resumed = self.state.lowest_energy.is_some();
        let positions = self.state.positions.clone();
        let evaluations = self.state.evaluations;
        let point = self.evaluate(problem, positions, !resumed)?;
        if resumed {
            self.state.evaluations = evaluations;
        } else {
            self.state.positions.clone_from(&point.positions);
            self.state.lowest_energy = Some(point.evaluation.energy);
        }
        Ok(point)
    }

    /// Chooses a new frame if the surface has turned away from the old one.
    fn turn(
        &mut self,
        problem: &mut dyn Problem,
        here: RelaxationPoint,
    ) -> Result<RelaxationPoint, (Failure, Evaluation)> {
        if !here.coordinates.turned(&self.places, &self.frame) {
            return Ok(here);
        }
        self.state.anchor.clone_from(&here.positions);
        self.state.last_wait = *WAIT.start();
        self.state.wait = self.state.wait.min(*WAIT.start());
        self.set_frame();
        self.evaluate(problem, here.positions, false)
    }

    fn set_frame(&mut self) {
        self.frame = Frame::new(&self.membranes, &self.places, &self.state.anchor);
    }

    fn ended(&mut self, problem: &mut dyn Problem, point: &RelaxationPoint) -> Option<Outcome> {
        if point.residual <= self.settings.tolerance {
            return Some(Outcome::Converged);
        }
        let State {
            progress,
            iteration,
            ..
        } = &mut self.state;
        let Evaluation {
            energy,
            energy_scale,
        } = point.evaluation;
        let now = Improvement {
            residual: point.residual,
            energy,
            iteration: *iteration,
        };
        let best = progress.get_or_insert(now);
        let falls =
            problem.is_conservative() && energy < best.energy - 1e3 * f64::EPSILON * energy_scale;
        if falls || point.residual < 0.99 * best.residual {
            *best = Improvement {
                residual: best.residual.min(point.residual),
                energy: best.energy.min(energy),
                iteration: *iteration,
            };
        }
        let idle = *iteration - best.iteration;
        if *iteration >= self.settings.iteration_limit {
            return Some(Outcome::IterationLimit);
        }
        let rests = problem.is_conservative() && best.residual < REST_RESIDUAL;
        let patience = if rests { REST } else { usize::MAX };
        if idle < self.settings.patience.min(patience) {
            return None;
        }
        // A triangle at its limit may be the reason why steps have become so small.
        let (sine, membrane, triangle) =
            point
                .coordinates
                .narrowest(&self.membranes, &self.places, &point.positions);
        let least = self.state.least_sine.unwrap_or(0.0);
        Some(if sine < 1.1 * least {
            Outcome::Failed(Failure::Distorted {
                membrane,
                triangle,
                degrees: sine.asin().to_degrees(),
            })
        } else {
            Outcome::Stagnated
        })
    }

    /// Redistributes the vertices of fluid membranes if this is due and cheap: with an energy it
    /// may cost a fraction of the gain of the step, otherwise nothing.
    fn spread(
        &mut self,
        problem: &mut dyn Problem,
        before: &RelaxationPoint,
        point: RelaxationPoint,
    ) -> (RelaxationPoint, bool) {
        let best = self.state.progress.map(|progress| progress.iteration);
        let idle = best.map_or(0, |best| self.state.iteration - best);
        let rests = problem.is_conservative() && point.residual < REST_RESIDUAL && 2 * idle >= REST;
        if !self.settings.redistribution || self.state.newton || rests {
            return (point, false);
        }
        if self.state.wait > 1 {
            self.state.wait -= 1;
            return (point, false);
        }
        let mut positions = point.positions.clone();
        let (membranes, places) = (&self.membranes, &self.places);
        let moves = redistribute(membranes, places, &point.coordinates, &mut positions);
        let spread = if moves {
            self.evaluate(problem, positions, true).ok()
        } else {
            None
        };
        let cheap = |spread: &RelaxationPoint| {
            let [e0, e1, e2] = [before, &point, spread].map(|point| point.evaluation.energy);
            let [r0, r1, r2] = [before, &point, spread].map(|point| point.residual);
            if problem.is_conservative() {
                e2 <= e1 + SPENT * (e0 - e1).max(0.0)
            } else {
                r2 <= r0.max(r1)
            }
        };
        // Intervals grow, because a relaxation near its end would otherwise be disturbed forever.
        self.state.last_wait = (2 * self.state.last_wait).min(*WAIT.end());
        self.state.wait = self.state.last_wait;
        match spread.filter(cheap) {
            Some(spread) => {
                self.state.redistributions += 1;
                (spread, true)
            }
            None => (point, false),
        }
    }
}
