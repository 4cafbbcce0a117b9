//! The stepper.

use super::coordinates::{Coordinates, Place, reciprocal_or_zero};
use super::frame::Frame;
use super::preconditioner::Preconditioner;
use super::redistribution::redistribute;
use super::secants::Secants;
use super::vector::{self, Vector};
use super::{Evaluation, Membrane, Problem, Settings};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Armijo's constant: the share of the linear decrease that has to come true.
const SUFFICIENT: f64 = 1e-4;

/// Wolfe's constant: the share of the force along a step that may be left at its end.
const CURVATURE: f64 = 0.9;

/// How far beyond its zero the force along a step may be at its end, where the energy does not
/// decide, as a share of that at its start.
const OVERSHOOT: f64 = 0.5;

/// The largest growth of the residual in a step that no energy decides on: instabilities of a shape
/// may grow, those of a step that is too long may not.
const LARGEST_GROWTH: f64 = 1.5;

/// The largest change of an edge in a step, as a share of its length: triangles do not turn over.
const LARGEST_STRAIN: f64 = 0.5;

/// The sine of the angle, 3°, below which no triangle's angle may fall; on meshes that are worse to
/// begin with, half of their least.
const LEAST_SINE: f64 = 0.052;

/// Trials for one step; each is at least a factor 10 below the one before.
const TRIALS: usize = 24;

/// How often a step that was too short is doubled.
const EXPANSIONS: usize = 6;

/// Rounding of an energy, in units of the last place of its scale.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Root-mean-square change of the edges, in parts of their length, after which the preconditioner
/// is made anew.
const OUTDATED: f64 = 0.1;

/// The share of a step's gain that spreading vertices anew may cost.
const SPENT: f64 = 0.5;

/// Steps between two attempts to spread vertices anew: at first and each time the surface has turned
/// away from its frame, and at most.
const WAIT: std::ops::RangeInclusive<usize> = 4..=256;

/// Membranes on their way to equilibrium.
#[derive(Debug)]
pub struct Relaxation {
    membranes: Vec<Membrane>,
    places: Vec<Place>,
    settings: Settings,
    state: State,
    preconditioners: Vec<Preconditioner>,
    frame: Frame,
    here: Option<Point>,
}

/// Everything that a relaxation carries from step to step: plain data, to be stored.
///
/// Stored and taken up again, a run continues bit for bit, if numbers are stored without loss.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    positions: Vec<Vector>,
    iteration: usize,
    evaluations: usize,
    redistributions: usize,
    secants: Secants,
    /// Where the frame was made; empty before.
    anchor: Vec<Vector>,
    /// Where the preconditioner was made; empty before.
    reference: Vec<Vector>,
    /// `None` before the first evaluation.
    lowest_energy: Option<f64>,
    progress: Option<Progress>,
    /// Steps until vertices are spread anew, and how many they were the last time.
    wait: usize,
    last_wait: usize,
    /// The least sine of an angle that is allowed; `None` before the first evaluation.
    least_sine: Option<f64>,
    outcome: Option<Outcome>,
}

/// The best that was reached, and when it was worth mentioning for the last time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Progress {
    residual: f64,
    energy: f64,
    iteration: usize,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Number of steps so far.
    pub iteration: usize,
    /// Number of evaluations so far.
    pub evaluations: usize,
    /// The energy after the step; see [`Evaluation::energy`].
    pub energy: f64,
    /// How far from equilibrium: the root mean square of the force per area, constraints and what
    /// fluid membranes do not feel taken out, in units of `κ/R³ + K/R`, with the moduli of
    /// [`Membrane`] and R the radius of the sphere with the membrane's area; the largest among the
    /// membranes. Its scale is that of a membrane's own stiffness, so that it means the same for
    /// every unit, size and number of vertices.
    pub residual: f64,
    /// Length of the step in units of what was proposed; 0 if there was none.
    pub step: f64,
    /// Whether vertices were spread anew along the surface.
    pub redistributed: bool,
    /// How the relaxation ended, once it did.
    pub outcome: Option<Outcome>,
}

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

/// All that is known at some positions.
#[derive(Clone, Debug)]
struct Point {
    positions: Vec<Vector>,
    evaluation: Evaluation,
    coordinates: Coordinates,
    /// The force that is not taken up by constraints.
    force: Vec<f64>,
    residual: f64,
}

/// A point that is to become the next one, and how far it is.
struct Trial {
    point: Point,
    step: f64,
}

/// Why a trial is too far.
#[derive(Clone, Copy, Debug)]
enum TooFar {
    Bad(Failure),
    /// The step at which the trials so far put the best place.
    Rises(f64),
}

impl Relaxation {
    /// Membranes at these positions, one membrane's after the other.
    ///
    /// # Errors
    /// If there are not as many positions as vertices, or a membrane resists nothing.
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
            wait: *WAIT.start(),
            last_wait: *WAIT.start(),
            least_sine: None,
            outcome: None,
        };
        Self::resume(membranes, state, settings)
    }

    /// Takes a stored state up again.
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

    /// What has to be stored for the run to be continued.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The positions, one membrane's after the other.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.state.positions
    }

    /// How the relaxation ended, if it did.
    pub fn outcome(&self) -> Option<Outcome> {
        self.state.outcome
    }

    /// How often vertices were spread anew along the surface.
    pub fn redistributions(&self) -> usize {
        self.state.redistributions
    }

    /// To be called when parameters or targets of the problem were changed between two steps: energies
    /// before and after cannot be compared, and the relaxation goes on if it had ended.
    pub fn problem_changed(&mut self) {
        self.here = None;
        self.state.secants.clear();
        self.state.lowest_energy = None;
        self.state.progress = None;
        self.state.wait = *WAIT.start();
        self.state.last_wait = *WAIT.start();
        self.state.outcome = None;
    }

    /// Moves on by one step; once the relaxation has ended nothing moves any more.
    pub fn step(&mut self, problem: &mut (impl Problem + ?Sized)) -> StepReport {
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
        let here = match self.turn(problem, here) {
            Ok(here) => here,
            Err((failure, evaluation)) => return self.fail(failure, evaluation),
        };
        self.refresh_preconditioners(&here.positions);
        let (next, step, redistributed) = match self.advance(problem, &here) {
            Ok(Trial { point, step }) => {
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
        problem: &mut (impl Problem + ?Sized),
        mut each: impl FnMut(&Self, &StepReport) -> bool,
    ) -> StepReport {
        loop {
            let report = self.step(problem);
            if !each(self, &report) || report.outcome.is_some() {
                return report;
            }
        }
    }

    fn report(&self, point: &Point, step: f64, redistributed: bool) -> StepReport {
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

    /// The report of a relaxation that failed before it could begin.
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
        problem: &mut (impl Problem + ?Sized),
    ) -> Result<Point, (Failure, Evaluation)> {
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

    /// Chooses the frame anew where the surface has turned away from it.
    fn turn(
        &mut self,
        problem: &mut (impl Problem + ?Sized),
        here: Point,
    ) -> Result<Point, (Failure, Evaluation)> {
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

    fn ended(&mut self, problem: &mut (impl Problem + ?Sized), point: &Point) -> Option<Outcome> {
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
        let now = Progress {
            residual: point.residual,
            energy,
            iteration: *iteration,
        };
        let best = progress.get_or_insert(now);
        let falls =
            problem.is_conservative() && energy < best.energy - 1e3 * f64::EPSILON * energy_scale;
        if falls || point.residual < 0.99 * best.residual {
            *best = Progress {
                residual: best.residual.min(point.residual),
                energy: best.energy.min(energy),
                iteration: *iteration,
            };
        }
        let idle = *iteration - best.iteration;
        if *iteration >= self.settings.iteration_limit {
            return Some(Outcome::IterationLimit);
        }
        if idle < self.settings.patience {
            return None;
        }
        // Steps may have become so small because a triangle is at its limit.
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

    /// Restores constraints if that is asked for, and finds out all there is to know.
    fn evaluate(
        &mut self,
        problem: &mut (impl Problem + ?Sized),
        mut positions: Vec<Vector>,
        restore: bool,
    ) -> Result<Point, (Failure, Evaluation)> {
        let none = Evaluation::new(f64::NAN);
        if let Some(failure) = self.not_finite(&positions) {
            return Err((failure, none));
        }
        let constraints = problem.constraint_count();
        if restore && constraints > 0 {
            let error = problem.restore(&mut positions);
            let limit = self.settings.constraint_tolerance;
            if error > limit || error.is_nan() {
                return Err((Failure::ConstraintsLost { error, limit }, none));
            }
            if let Some(failure) = self.not_finite(&positions) {
                return Err((failure, none));
            }
        }
        let (membranes, places) = (&self.membranes, &self.places);
        let mut coordinates = Coordinates::new(membranes, places, &positions);
        if let Some((membrane, triangle)) = coordinates.folded(membranes, places, &positions) {
            return Err((Failure::Inverted { membrane, triangle }, none));
        }
        let (sine, membrane, triangle) = coordinates.narrowest(membranes, places, &positions);
        let least = *self
            .state
            .least_sine
            .get_or_insert(LEAST_SINE.min(0.5 * sine));
        if sine < least {
            let degrees = sine.asin().to_degrees();
            let failure = Failure::Distorted {
                membrane,
                triangle,
                degrees,
            };
            return Err((failure, none));
        }
        if self.state.anchor.is_empty() {
            self.state.anchor.clone_from(&positions);
            self.set_frame();
        }
        let mut nodal = vec![[0.0; 3]; positions.len()];
        let evaluation = problem.evaluate(&positions, &mut nodal);
        self.state.evaluations += 1;
        if let Some(failure) = self.not_finite(&nodal) {
            return Err((failure, evaluation));
        }
        if !evaluation.energy.is_finite() {
            let failure = Failure::NotFinite {
                membrane: 0,
                vertex: 0,
            };
            return Err((failure, evaluation));
        }
        let mut force = self.frame.reduce(&self.places, &positions, &nodal);
        if constraints > 0 {
            let mut gradients = vec![vec![[0.0; 3]; positions.len()]; constraints];
            problem.constraint_gradients(&positions, &mut gradients);
            let reduced: Vec<_> = gradients
                .iter()
                .map(|gradient| self.frame.reduce(&self.places, &positions, gradient))
                .collect();
            coordinates.forbid(&self.places, problem.groups(), reduced);
            coordinates.take_out(&self.places, problem.groups(), &mut force);
        }
        let residual = self.residual(&coordinates, &force);
        Ok(Point {
            positions,
            evaluation,
            coordinates,
            force,
            residual,
        })
    }

    fn not_finite(&self, field: &[Vector]) -> Option<Failure> {
        let bad = |entry: &Vector| entry.iter().any(|number| !number.is_finite());
        let index = field.iter().position(bad)?;
        let holds = |place: &Place| place.vertices().contains(&index);
        let membrane = self.places.iter().position(holds)?;
        Some(Failure::NotFinite {
            membrane,
            vertex: index - self.places[membrane].first_vertex,
        })
    }

    /// See [`StepReport::residual`].
    fn residual(&self, coordinates: &Coordinates, force: &[f64]) -> f64 {
        let mut largest = 0.0f64;
        for (membrane, place) in self.membranes.iter().zip(&self.places) {
            let areas = &coordinates.areas[place.vertices()];
            let forces = force[place.numbers()].chunks_exact(place.width);
            let squares = |(force, &area): (&[f64], &f64)| {
                vector::product(force, force) * reciprocal_or_zero(area)
            };
            let sum: f64 = forces.zip(areas).map(squares).sum();
            let area: f64 = areas.iter().sum();
            let over = reciprocal_or_zero((area / SPHERE).sqrt());
            let unit =
                membrane.bending_modulus * over * over * over + membrane.in_plane_modulus * over;
            largest = largest.max((sum / area).sqrt() / unit);
        }
        largest
    }

    fn set_preconditioners(&mut self) {
        let parts = self.membranes.iter().zip(&self.places);
        for (preconditioner, (membrane, place)) in self.preconditioners.iter_mut().zip(parts) {
            preconditioner.set(membrane, &self.state.reference[place.vertices()]);
        }
    }

    /// Makes preconditioners anew if membranes are no longer what they were.
    fn refresh_preconditioners(&mut self, positions: &[Vector]) {
        if !self.settings.preconditioned {
            return;
        }
        let reference = &self.state.reference;
        let outdated = |membrane: &Membrane, place: &Place| {
            let [now, then] = [positions, reference].map(|all| &all[place.vertices()]);
            let squared = |all: &[Vector], &[a, b]: &[u32; 2]| {
                let edge = vector::sub(all[b as usize], all[a as usize]);
                vector::dot(edge, edge)
            };
            let change = |edge: &[u32; 2]| {
                let (now, then) = (squared(now, edge), squared(then, edge));
                // Twice the strain, to first order.
                ((now - then) / now.max(then)).powi(2)
            };
            let edges = membrane.mesh.edges();
            edges.iter().map(change).sum::<f64>() > (2.0 * OUTDATED).powi(2) * edges.len() as f64
        };
        let mut parts = self.membranes.iter().zip(&self.places);
        if reference.is_empty() || parts.any(|(membrane, place)| outdated(membrane, place)) {
            self.state.reference = positions.to_vec();
            self.set_preconditioners();
        }
    }

    /// The displacement that would end the force, were the membranes as stiff as they seem.
    fn direction(&mut self, problem: &(impl Problem + ?Sized), here: &Point) -> Vec<f64> {
        let Self {
            places,
            membranes,
            preconditioners,
            settings,
            state,
            frame,
            ..
        } = self;
        let stiff = |membrane: &Membrane, place: &Place| {
            let areas = &here.coordinates.areas[place.vertices()];
            let shift = SPHERE / areas.iter().sum::<f64>();
            shift * (membrane.bending_modulus * shift + membrane.in_plane_modulus)
        };
        let parts = membranes.iter().zip(places.iter());
        let stiffest = parts.map(|(m, p)| stiff(m, p)).fold(0.0, f64::max);
        let mut direction = here.force.clone();
        let precondition = |force: &mut [f64]| {
            for ((place, membrane), preconditioner) in
                places.iter().zip(membranes).zip(preconditioners)
            {
                let force = &mut force[place.numbers()];
                if settings.preconditioned {
                    preconditioner.apply(place.width, force);
                } else {
                    plain(membrane, place, &here.coordinates, force);
                }
            }
        };
        state.secants.apply(&mut direction, |force| {
            frame.apart_from_rigid(stiffest.recip(), force, precondition);
        });
        here.coordinates
            .keep(places, problem.groups(), &mut direction);
        direction
    }

    /// The longest step along a displacement that no edge suffers from.
    fn longest_step(&self, positions: &[Vector], displacement: &[Vector]) -> f64 {
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
    fn advance(
        &mut self,
        problem: &mut (impl Problem + ?Sized),
        here: &Point,
    ) -> Result<Trial, Outcome> {
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
                    return Err(if lost {
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
        problem: &mut (impl Problem + ?Sized),
        here: &Point,
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
                    let trial = Trial { point, step };
                    let enough =
                        left <= CURVATURE * slope || step >= longest || expansions >= EXPANSIONS;
                    if enough {
                        return Ok(trial);
                    }
                    // Where it was too far before, a step that is merely short will do.
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

    /// Whether a point is too far along a direction: then a better step.
    fn too_far(
        &self,
        problem: &(impl Problem + ?Sized),
        here: &Point,
        there: &Point,
        step: f64,
        slope: f64,
        left: f64,
    ) -> Option<f64> {
        // Where the force along the way vanishes if it falls evenly.
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
        // W. W. Hager and H. Zhang, SIAM J. Optim. 16 (2005) 170: where the energy is rounding, the
        // force decides.
        let lowest = self.state.lowest_energy.unwrap_or(before.energy);
        if after.energy <= lowest + rounding && left >= -OVERSHOOT * slope {
            return None;
        }
        let parabola = 0.5 * step * slope / (slope + rise / step);
        let shorter = if rise > rounding { parabola } else { secant };
        Some(shorter.clamp(0.1 * step, 0.7 * step))
    }

    /// Spreads the vertices of fluid membranes anew if it is time and costs little: part of what the
    /// step gained for problems with an energy, nothing of it for the others.
    fn spread(
        &mut self,
        problem: &mut (impl Problem + ?Sized),
        before: &Point,
        point: Point,
    ) -> (Point, bool) {
        if !self.settings.redistribution {
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
        let cheap = |spread: &Point| {
            let [e0, e1, e2] = [before, &point, spread].map(|point| point.evaluation.energy);
            let [r0, r1, r2] = [before, &point, spread].map(|point| point.residual);
            if problem.is_conservative() {
                e2 <= e1 + SPENT * (e0 - e1).max(0.0)
            } else {
                r2 <= r0.max(r1)
            }
        };
        // Less and less often, or a relaxation that is nearly at its end would be disturbed forever.
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

/// Area of the unit sphere.
const SPHERE: f64 = 4.0 * std::f64::consts::PI;

/// Displacements in proportion to forces, as far as the shortest waves allow.
fn plain(membrane: &Membrane, place: &Place, coordinates: &Coordinates, force: &mut [f64]) {
    let areas = &coordinates.areas[place.vertices()];
    let area = areas.iter().sum::<f64>() / areas.len() as f64;
    let stiffness = membrane.bending_modulus / area + membrane.in_plane_modulus;
    force
        .iter_mut()
        .for_each(|entry| *entry *= 0.05 / stiffness);
}

#[cfg(test)]
mod tests {
    use super::super::{Held, Membrane, Motion, Problem, Settings};
    use super::{Evaluation, Failure, Outcome, Relaxation, SetupError, State, StepReport};
    use crate::generate::{AnyShape, Family, generate};
    use helfrich::{Constraint, Constraints, Juelicher, Prepared, Quantity, Surface, TriangleMesh};
    use std::sync::Arc;

    /// Jülicher's bending energy with area and volume held.
    struct Vesicle {
        mesh: Arc<TriangleMesh>,
        bending: Prepared<f64, Juelicher<f64>>,
        held: Held,
        groups: Vec<u32>,
        /// The evaluation that goes wrong.
        broken: Option<usize>,
        evaluations: usize,
    }

    impl Vesicle {
        /// Of reduced volume 0.9, from an ellipsoid.
        fn new() -> (Self, Vec<[f64; 3]>) {
            let shape: AnyShape = "ellipsoid:1,1,1.9".parse().expect("a shape");
            let generated = generate(&shape, Family::Relaxed, 162, 0).expect("a mesh");
            let mesh = Arc::new(generated.mesh);
            let area = Surface::new(&mesh, &generated.positions)
                .expect("fits")
                .area();
            let sphere = area * (area / std::f64::consts::PI).sqrt() / 6.0;
            let hold = |functional, target: f64| Constraint {
                functional,
                targets: target.into(),
            };
            let constraints = Constraints {
                constraints: vec![
                    hold(Quantity::Area, area),
                    hold(Quantity::Volume, 0.9 * sphere),
                ],
            };
            let vesicle = Self {
                bending: Prepared::new(Juelicher::new(1.0), &mesh),
                held: Held::new(Arc::clone(&mesh), constraints),
                groups: vec![0; mesh.vertex_count()],
                mesh,
                broken: None,
                evaluations: 0,
            };
            (vesicle, generated.positions)
        }

        fn membranes(&self) -> Vec<Membrane> {
            vec![Membrane {
                mesh: Arc::clone(&self.mesh),
                bending_modulus: 1.0,
                in_plane_modulus: 0.0,
                motion: Motion::AlongNormals,
            }]
        }
    }

    impl Problem for Vesicle {
        fn is_conservative(&self) -> bool {
            true
        }

        fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation {
            self.evaluations += 1;
            force.fill([0.0; 3]);
            let surface = Surface::new(&self.mesh, positions).expect("finite");
            let energy = self.bending.add_force_and_energy(surface, force);
            if self.broken.is_some_and(|broken| self.evaluations >= broken) {
                force[7][1] = f64::NAN;
            }
            Evaluation::new(energy)
        }

        fn constraint_count(&self) -> usize {
            self.held.count()
        }

        fn groups(&self) -> &[u32] {
            &self.groups
        }

        fn constraint_gradients(
            &mut self,
            positions: &[[f64; 3]],
            gradients: &mut [Vec<[f64; 3]>],
        ) {
            for (index, gradient) in gradients.iter_mut().enumerate() {
                self.held.gradient(index, positions, gradient);
            }
        }

        fn restore(&mut self, positions: &mut [[f64; 3]]) -> f64 {
            let corrected = self.held.restore(positions);
            corrected.map_or(f64::INFINITY, |correction| correction.residual)
        }
    }

    #[test]
    fn a_stored_state_continues_bit_for_bit() {
        let (mut vesicle, positions) = Vesicle::new();
        let membranes = vesicle.membranes();
        let settings = Settings::default();
        let mut whole =
            Relaxation::new(membranes.clone(), positions.clone(), settings).expect("a start");
        let mut expected = Vec::new();
        let end = whole.run(&mut vesicle, |_, report| {
            expected.push(*report);
            true
        });
        assert_eq!(end.outcome, Some(Outcome::Converged));

        // Stored and taken up again after every single step, by a problem that remembers nothing.
        let mut parts = Relaxation::new(membranes.clone(), positions, settings).expect("a start");
        let mut reports: Vec<StepReport> = Vec::new();
        while reports.last().is_none_or(|report| report.outcome.is_none()) {
            let (mut vesicle, _) = Vesicle::new();
            reports.push(parts.step(&mut vesicle));
            let bytes = postcard::to_stdvec(parts.state()).expect("encodes");
            let state: State = postcard::from_bytes(&bytes).expect("decodes");
            parts = Relaxation::resume(membranes.clone(), state, settings).expect("a state");
        }
        assert_eq!(reports, expected);
        assert_eq!(parts.positions(), whole.positions());
        assert_eq!(parts.state(), whole.state());
    }

    #[test]
    fn what_goes_wrong_is_said_and_the_last_good_positions_stay() {
        let (mut vesicle, positions) = Vesicle::new();
        vesicle.broken = Some(6);
        let mut relaxation =
            Relaxation::new(vesicle.membranes(), positions, Settings::default()).expect("a start");
        let end = relaxation.run(&mut vesicle, |_, _| true);
        let expected = Failure::NotFinite {
            membrane: 0,
            vertex: 7,
        };
        assert_eq!(end.outcome, Some(Outcome::Failed(expected)));
        assert!(end.iteration > 0 && end.energy.is_finite());
        vesicle.broken = None;
        let surface = Surface::new(&vesicle.mesh, relaxation.positions()).expect("finite");
        let energy = vesicle.bending.energy(surface);
        assert_eq!(energy, end.energy);
    }

    #[test]
    fn targets_out_of_reach_are_said() {
        let (mut vesicle, positions) = Vesicle::new();
        // More volume than a sphere of this area has.
        vesicle.held.constraints_mut().constraints[1].targets = 100.0.into();
        let mut relaxation =
            Relaxation::new(vesicle.membranes(), positions, Settings::default()).expect("a start");
        let outcome = relaxation.step(&mut vesicle).outcome;
        assert!(
            matches!(
                outcome,
                Some(Outcome::Failed(Failure::ConstraintsLost { .. }))
            ),
            "{outcome:?}"
        );
    }

    #[test]
    fn settings_that_make_no_sense_are_refused() {
        let (vesicle, mut positions) = Vesicle::new();
        let mut membranes = vesicle.membranes();
        membranes[0].bending_modulus = 0.0;
        let refused = Relaxation::new(membranes, positions.clone(), Settings::default());
        assert!(matches!(
            refused.map(|_| ()),
            Err(SetupError::Modulus { membrane: 0, .. })
        ));
        positions.pop();
        let refused = Relaxation::new(vesicle.membranes(), positions, Settings::default());
        assert!(matches!(
            refused.map(|_| ()),
            Err(SetupError::CountMismatch {
                positions: 161,
                vertices: 162
            })
        ));
    }
}
