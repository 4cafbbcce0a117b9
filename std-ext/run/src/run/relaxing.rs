//! Runs to equilibrium, load after load.

use super::deformed::overlap;
use super::drive::{Drive, Mark, Step, Work};
use super::remedy::{advice, of_mesh};
use super::state::{Approach, DriveState, RelaxingProgress, RelaxingState};
use super::{End, RunError};
use crate::dynamics::{Failure, Outcome, Problem, Relaxation, Settings, SetupError};
use crate::scene::{Relax, Scene};
use crate::series::ITERATION;
use crate::simulation::Simulation;

/// Residuals below this are due to rounding if a relaxation stagnates: every method with an energy
/// reaches the default of `driver.residual` on meshes that it can handle.
const ROUNDING: f64 = 1e-5;

/// Iterations between two steps towards the targets of exactly held quantities: the mesh adapts to the shape.
const ADAPTATION: u64 = 20;

/// The largest and the smallest fraction of the way of such a step.
const STEPS: [f64; 2] = [0.25, 1.0 / 512.0];

/// A relaxation under each load of a sequence.
pub(super) struct Relaxing {
    relax: Relax,
    settings: Settings,
    /// Iterations from one row, and from one checkpoint, to the next.
    every: [u64; 2],
    loads: usize,
    names: Vec<String>,
    /// Whether each surface gets new meshes.
    renewed: Vec<bool>,
    /// Remedies: one for each surface whose mesh has become bad, and one if the residual stagnates.
    remedies: Vec<String>,
    advice: String,
    relaxation: Relaxation,
    progress: RelaxingProgress,
    residual: f64,
    energy: f64,
}

impl Relaxing {
    pub(super) fn new(
        scene: &Scene,
        relax: Relax,
        every: [u64; 2],
        simulation: &mut Simulation,
        positions: Vec<[f64; 3]>,
    ) -> Result<Self, RunError> {
        let starts = simulation.held_values(&positions);
        let first = positions.clone();
        let relaxation = Relaxation::new(simulation.membranes(), positions, settings(scene, relax));
        let relaxation = relaxation.map_err(|error| of_surface(error, simulation))?;
        let progress = RelaxingProgress {
            limits: limits(relax),
            ..RelaxingProgress::default()
        };
        let state = (relaxation, progress);
        let mut this = Self::at(scene, relax, every, simulation, state);
        if let Some(Outcome::Failed(failure)) = this.relaxation.outcome()
            && failure.is_of_constraints()
            && simulation.constraint_count() > 0
        {
            this.progress.approach = Some(Approach {
                starts,
                fraction: 0.0,
                step: STEPS[0],
                steps: 0,
                reason: failure.to_string(),
            });
            if !this.come_nearer(simulation, &first)? {
                // The failure of one step is reported, as without steps.
                this.progress.approach = None;
            }
        }
        Ok(this)
    }

    /// Takes a step towards the targets of exactly held quantities, from these positions: the longest, by
    /// halves, from which a relaxation can begin. False if there is none; then nothing has changed.
    fn come_nearer(
        &mut self,
        simulation: &mut Simulation,
        positions: &[[f64; 3]],
    ) -> Result<bool, RunError> {
        let Some(approach) = &mut self.progress.approach else {
            return Ok(false);
        };
        let mut step = approach.step;
        while step >= STEPS[1] {
            let fraction = (approach.fraction + step).min(1.0);
            simulation.approach(&approach.starts, fraction);
            let own = self.settings;
            let relaxation = Relaxation::new(simulation.membranes(), positions.to_vec(), own);
            let mut relaxation = relaxation.map_err(|error| of_surface(error, simulation))?;
            let start = relaxation.start(simulation);
            if relaxation.outcome().is_none() {
                approach.fraction = fraction;
                approach.step = STEPS[0].min(2.0 * step);
                approach.steps += 1;
                self.relaxation = relaxation;
                self.residual = start.residual;
                self.energy = start.energy;
                self.progress.before += self.progress.iteration;
                self.progress.iteration = 0;
                self.progress.first_residual = None;
                return Ok(true);
            }
            step *= 0.5;
        }
        simulation.approach(&approach.starts, approach.fraction);
        Ok(false)
    }

    /// Whether exactly held quantities are still on the way to their targets.
    fn approaches(&self) -> bool {
        let approach = self.progress.approach.as_ref();
        approach.is_some_and(|approach| approach.fraction < 1.0)
    }

    pub(super) fn resume(
        scene: &Scene,
        relax: Relax,
        every: [u64; 2],
        simulation: &mut Simulation,
        state: RelaxingState,
    ) -> Result<Self, RunError> {
        simulation.set_load(state.progress.load);
        if let Some(Approach {
            starts, fraction, ..
        }) = &state.progress.approach
        {
            simulation.approach(starts, *fraction);
        }
        let membranes = simulation.membranes();
        let relaxation = Relaxation::resume(membranes, state.relaxation, settings(scene, relax));
        let mut relaxation = relaxation.map_err(|error| of_surface(error, simulation))?;
        let mut progress = state.progress;
        if progress.limits != limits(relax) {
            progress.limits = limits(relax);
            relaxation.settings_changed();
        }
        Ok(Self::at(
            scene,
            relax,
            every,
            simulation,
            (relaxation, progress),
        ))
    }

    fn at(
        scene: &Scene,
        relax: Relax,
        every: [u64; 2],
        simulation: &mut Simulation,
        (mut relaxation, progress): (Relaxation, RelaxingProgress),
    ) -> Self {
        // Evaluated before the first step, so that the first row has a residual.
        let start = relaxation.start(simulation);
        let names = simulation
            .bodies()
            .iter()
            .map(|body| body.name().to_owned());
        Self {
            relax,
            settings: settings(scene, relax),
            every,
            loads: simulation.load_count(),
            names: names.collect(),
            renewed: scene
                .surfaces
                .iter()
                .map(|surface| surface.remesh.is_some())
                .collect(),
            remedies: scene.surfaces.iter().map(of_mesh).collect(),
            advice: advice(&scene.surfaces),
            relaxation,
            progress,
            residual: start.residual,
            energy: start.energy,
        }
    }

    /// Continues with the next load, from the end of the previous one.
    fn next_load(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        self.progress.load += 1;
        self.progress.before += self.progress.iteration;
        self.progress.iteration = 0;
        self.progress.first_residual = None;
        simulation.set_load(self.progress.load);
        let positions = self.relaxation.positions().to_vec();
        let relaxation = Relaxation::new(simulation.membranes(), positions, self.settings);
        self.relaxation = relaxation.map_err(|error| of_surface(error, simulation))?;
        Ok(())
    }

    /// The surface that a new mesh may help over this end. Forces without an energy may find no step because of the mesh.
    fn worn(&self, outcome: Outcome) -> Option<usize> {
        match outcome {
            Outcome::Failed(
                Failure::Inverted { membrane, .. } | Failure::Distorted { membrane, .. },
            ) => Some(membrane).filter(|&membrane| self.renewed[membrane]),
            Outcome::Failed(Failure::StepBelowFloor { .. }) => {
                self.renewed.iter().position(|&renewed| renewed)
            }
            _ => None,
        }
    }

    /// Step of the run that follows from the end of a load.
    fn load_ended(&mut self, outcome: Outcome, simulation: &Simulation) -> Step {
        let mut message = self.message(outcome, simulation);
        let load = self.progress.load + 1;
        if self.loads > 1 && outcome != Outcome::Converged {
            message = format!("load {load} of {}: {message}", self.loads);
            if !self.progress.notes.contains(&message) {
                self.progress.notes.push(message.clone());
            }
            self.progress.unfinished.get_or_insert(end(outcome));
        }
        let failed = matches!(outcome, Outcome::Failed(_)) || self.approaches();
        let last = load == self.loads || failed;
        let first = self.progress.unfinished.filter(|_| !failed);
        if last && !self.progress.notes.is_empty() {
            message = self.progress.notes.join("; ");
        }
        Step {
            output: true,
            checkpoint: true,
            end: last.then(|| {
                let own = if failed { End::Failed } else { end(outcome) };
                (first.unwrap_or(own), message)
            }),
            worn: None,
        }
    }

    /// Description of an outcome, with details.
    fn message(&self, outcome: Outcome, simulation: &Simulation) -> String {
        let mut message = outcome.to_string();
        if let Some(Approach {
            fraction,
            steps,
            reason,
            ..
        }) = &self.progress.approach
        {
            message = match self.approaches() {
                false => format!(
                    "{message}, with exactly held quantities brought to their targets in {steps} steps, \
                     because at once {reason}"
                ),
                true => format!(
                    "exactly held quantities came {:.1} % of the way to their targets, in {steps} steps, \
                     and no nearer ({message}); at once {reason}: choose targets nearer to the initial \
                     shape, or a shape nearer to them",
                    100.0 * fraction
                ),
            };
        }
        if let Outcome::Failed(failure) = outcome
            && let Some(membrane) = failure.membrane()
        {
            let name = &self.names[membrane];
            message.push_str(&format!("; membrane {membrane} is the surface \"{name}\""));
        }
        if outcome != Outcome::Converged && self.residual.is_finite() {
            message.push_str(&format!("; the residual is {:.1e}", self.residual));
        }
        if matches!(outcome, Outcome::Stagnated | Outcome::Failed(_))
            && let Some(overlap) = overlap(simulation, self.relaxation.positions())
        {
            message.push_str(&overlap);
            return message;
        }
        match outcome {
            Outcome::Failed(
                Failure::Inverted { membrane, .. } | Failure::Distorted { membrane, .. },
            ) => message.push_str(&format!(": {}", self.remedies[membrane])),
            Outcome::Stagnated if self.residual < ROUNDING => message.push_str(&format!(
                ": this is rounding error; a `driver.residual` above {:.1e} can be reached",
                self.residual
            )),
            Outcome::Stagnated | Outcome::Failed(Failure::StepBelowFloor { .. }) => {
                message.push_str(&self.advice);
            }
            _ => {}
        }
        message
    }

    /// Iterations of all loads.
    fn iterations(&self) -> u64 {
        self.progress.before + self.progress.iteration
    }
}

impl Drive for Relaxing {
    fn columns(&self, _simulation: &Simulation) -> Vec<String> {
        [ITERATION, "residual"].map(str::to_owned).to_vec()
    }

    fn numbers(&self, _simulation: &Simulation) -> Vec<f64> {
        vec![self.iterations() as f64, self.residual]
    }

    fn mark(&self) -> Mark {
        Mark {
            time: self.iterations() as f64,
            number: self.iterations(),
        }
    }

    fn caption(&self) -> String {
        format!("iteration {}", self.iterations())
    }

    fn positions(&self) -> &[[f64; 3]] {
        self.relaxation.positions()
    }

    fn step(&mut self, simulation: &mut Simulation) -> Result<Step, RunError> {
        let ended = self.relaxation.outcome();
        let failed = matches!(ended, Some(Outcome::Failed(_)));
        if ended.is_some() && !failed && self.progress.load + 1 < self.loads {
            self.next_load(simulation)?;
        }
        let report = self.relaxation.step(simulation);
        self.progress.iteration = report.iteration as u64;
        self.residual = report.residual;
        self.energy = report.energy;
        self.progress.first_residual.get_or_insert(report.residual);
        let failed = matches!(report.outcome, Some(Outcome::Failed(_)));
        let is_due = self.progress.iteration.is_multiple_of(ADAPTATION);
        if self.approaches() && !failed && (is_due || report.outcome.is_some()) {
            let positions = self.relaxation.positions().to_vec();
            if self.come_nearer(simulation, &positions)? {
                return Ok(Step::default());
            }
        }
        if let Some(outcome) = report.outcome {
            let worn = self.worn(outcome);
            return Ok(match worn {
                Some(_) => Step {
                    worn,
                    ..Step::default()
                },
                None => self.load_ended(outcome, simulation),
            });
        }
        let [output, checkpoint] = self
            .every
            .map(|every| self.progress.iteration.is_multiple_of(every));
        Ok(Step {
            output,
            checkpoint,
            ..Step::default()
        })
    }

    fn worn_out(&mut self, simulation: &mut Simulation) -> Step {
        let outcome = self.relaxation.outcome().unwrap_or(Outcome::Stagnated);
        self.load_ended(outcome, simulation)
    }

    fn replace_meshes(
        &mut self,
        simulation: &mut Simulation,
        _references: Vec<[f64; 3]>,
        positions: Vec<[f64; 3]>,
    ) -> Result<(), RunError> {
        if let Some(approach) = &mut self.progress.approach {
            let counts =
                |values: &[Vec<Vec<f64>>]| Vec::from_iter(values.iter().flatten().map(Vec::len));
            let present = simulation.held_values(&positions);
            if approach.fraction < 1.0 && counts(&present) != counts(&approach.starts) {
                // A surface has parted: the rest of the way is one of its parts.
                approach.starts = present;
                approach.fraction = 0.0;
            }
            simulation.approach(&approach.starts, approach.fraction);
        }
        let membranes = simulation.membranes();
        let relaxation = self.relaxation.on_new_meshes(membranes, positions);
        self.relaxation = relaxation.map_err(|error| of_surface(error, simulation))?;
        let start = self.relaxation.start(simulation);
        self.residual = start.residual;
        self.energy = start.energy;
        Ok(())
    }

    /// Progress: the decades by which the residual has fallen, relative to those by which it has to
    /// fall.
    fn progress(&self) -> (f64, String) {
        let first = self.progress.first_residual.unwrap_or(f64::NAN);
        let done = (first / self.residual).ln() / (first / self.relax.residual).ln();
        // NaN if there is nothing to do.
        let done = if done.is_finite() {
            done.clamp(0.0, 1.0)
        } else {
            0.0
        };
        let Self {
            loads,
            residual,
            energy,
            ..
        } = self;
        let load = if *loads > 1 {
            format!("load {} of {loads}, ", self.progress.load + 1)
        } else {
            String::new()
        };
        let load = match &self.progress.approach {
            Some(approach) if approach.fraction < 1.0 => {
                format!("{load}targets at {:.1} %, ", 100.0 * approach.fraction)
            }
            _ => load,
        };
        let message = format!(
            "{load}iteration {}, energy {energy:.6e}, residual {residual:.1e}",
            self.progress.iteration
        );
        ((self.progress.load as f64 + done) / *loads as f64, message)
    }

    fn work(&self) -> Work {
        Work {
            iterations: self.iterations(),
            right_hand_sides: None,
        }
    }

    fn notes(&self) -> &[String] {
        &self.progress.notes
    }

    fn state(&mut self) -> DriveState {
        DriveState::Relaxing(RelaxingState {
            relaxation: self.relaxation.state().clone(),
            progress: self.progress.clone(),
        })
    }
}

/// The stopping criteria of a load.
fn limits(relax: Relax) -> (f64, u64) {
    (relax.residual, relax.iterations)
}

/// The error with the name of the surface.
fn of_surface(error: SetupError, simulation: &Simulation) -> RunError {
    match error {
        SetupError::Modulus {
            membrane,
            bending,
            in_plane,
        } => RunError::Modulus {
            surface: simulation.bodies()[membrane].name().to_owned(),
            bending,
            in_plane,
        },
        error => RunError::Setup(error),
    }
}

/// The settings of a relaxation. On surfaces that get new meshes the way may be long: no angle falls below 20°, because a
/// new mesh is due before, and forces without an energy lead there by few secants at a time, and by Newton steps only near
/// the end. Without all three, j6 took a prolate vesicle of v = 0.651 nowhere in 500 steps, and with them 250 are enough.
fn settings(scene: &Scene, relax: Relax) -> Settings {
    let all = Settings {
        tolerance: relax.residual,
        iteration_limit: usize::try_from(relax.iterations).unwrap_or(usize::MAX),
        redistribution: relax.redistribution,
        ..Settings::default()
    };
    if scene
        .surfaces
        .iter()
        .all(|surface| surface.remesh.is_none())
    {
        return all;
    }
    Settings {
        newton: 1.0,
        restart: 10,
        least_sine: [0.35, 0.8],
        ..all
    }
}

fn end(outcome: Outcome) -> End {
    match outcome {
        Outcome::Converged => End::Converged,
        Outcome::IterationLimit => End::IterationLimit,
        Outcome::Stagnated => End::Stagnated,
        _ => End::Failed,
    }
}
