//! Runs in a flow, through time.

use super::deformed::Deformed;
use super::drive::{Drive, DriveState, Mark, Step, Work};
use super::{End, Progress, RunError};
use crate::dynamics::Problem;
use crate::dynamics::integrate::{Integrator, Scheme, Settings, Spectrum, State, StepReport};
use crate::flow::{Effort, Fluid, Membranes, Moving, SOLUTION_TOLERANCE, Suspension};
use crate::scene::{self, BoundaryIntegral, Every, Hold, Scene, SurfaceScene};
use crate::simulation::{Cost, Simulation};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The longest step in units of the flow's own time: tank-treading is followed from step to step.
const LONGEST_STEP: f64 = 0.5;

/// A mode is reported that grows faster than this many times the flow deforms.
const GROWTH: f64 = 3.0;

/// Membranes on their way through time.
pub(super) struct Flowing<'a> {
    scene: &'a Scene,
    driver: BoundaryIntegral,
    /// Time between outputs.
    interval: f64,
    suspension: Suspension,
    /// Whether velocities are solutions of linear systems.
    solves: bool,
    integrator: Integrator,
    report: Option<StepReport>,
    progress: FlowingProgress,
}

/// What a checkpoint holds of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct FlowingState {
    integrator: State,
    /// From which the next solution begins.
    guess: Vec<[f64; 3]>,
    progress: FlowingProgress,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct FlowingProgress {
    deformed: Deformed,
    /// The number of outputs so far, but for the first.
    outputs: u64,
    steps: u64,
    right_hand_sides: u64,
    notes: Vec<String>,
}

impl<'a> Flowing<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        driver: BoundaryIntegral,
        simulation: &mut Simulation,
        positions: Vec<[f64; 3]>,
    ) -> Result<Self, RunError> {
        let positions = start(simulation, positions);
        let suspension = suspension(scene, driver, simulation, &positions);
        let solves = suspension.has_contrast() || simulation.are_viscous();
        let settings = settings(driver, simulation, &positions, solves);
        let progress = FlowingProgress {
            deformed: Deformed::new(driver.flow.plane(), simulation, &positions),
            outputs: 0,
            steps: 0,
            right_hand_sides: 0,
            notes: Vec::new(),
        };
        Ok(Self {
            scene,
            driver,
            interval: interval(scene, driver),
            suspension,
            solves,
            integrator: Integrator::new(positions, 0.0, settings)?,
            report: None,
            progress,
        })
    }

    /// `positions` are those at the start, of which volumes are kept.
    pub(super) fn resume(
        scene: &'a Scene,
        driver: BoundaryIntegral,
        simulation: &mut Simulation,
        positions: Vec<[f64; 3]>,
        state: FlowingState,
    ) -> Result<Self, RunError> {
        let positions = start(simulation, positions);
        let mut suspension = suspension(scene, driver, simulation, &positions);
        let solves = suspension.has_contrast() || simulation.are_viscous();
        let settings = settings(driver, simulation, &positions, solves);
        suspension.set_guess(state.guess);
        Ok(Self {
            scene,
            driver,
            interval: interval(scene, driver),
            suspension,
            solves,
            integrator: Integrator::resume(state.integrator, settings)?,
            report: None,
            progress: state.progress,
        })
    }

    /// When the next output is due; the end is the last one.
    fn next_output(&self) -> f64 {
        let next = (self.progress.outputs + 1) as f64 * self.interval;
        // An interval that ends within a rounding of the end ends there.
        if next >= self.driver.duration * (1.0 - 1e-9) {
            self.driver.duration
        } else {
            next
        }
    }

    /// The time in units of the flow's own, or as it is.
    fn strain(&self) -> Option<f64> {
        Some(self.driver.flow.rate()? * self.integrator.time())
    }

    fn note_growth(&mut self, spectrum: Option<Spectrum>, simulation: &Simulation) {
        let rate = self.driver.flow.rate().unwrap_or(0.0);
        let Some(growing) = spectrum.and_then(|spectrum| spectrum.growing) else {
            return;
        };
        if growing.rate <= GROWTH * rate {
            return;
        }
        let mut bodies = simulation.bodies().iter();
        let Some(body) = bodies.find(|body| body.vertices().contains(&growing.vertex)) else {
            return;
        };
        let vertex = growing.vertex - body.vertices().start;
        let place = format!("surface \"{}\", vertex {vertex}", body.name());
        // Once for each place.
        if !self.progress.notes.iter().any(|note| note.contains(&place)) {
            let times = match rate {
                0.0 => String::new(),
                rate => format!(
                    ", {:.0} times as fast as the flow deforms",
                    growing.rate / rate
                ),
            };
            let note = format!(
                "from {}: the stiffest mode of the velocities grows instead of decaying, at a rate of \
                 {:.3e}{times}; it is largest at {place}: the mesh or the bending method is unstable \
                 there",
                self.caption(),
                growing.rate
            );
            self.progress.notes.push(note);
        }
    }
}

impl Drive for Flowing<'_> {
    fn columns(&self, simulation: &Simulation) -> Vec<String> {
        let mut columns = vec!["time"];
        if self.driver.flow.rate().is_some() {
            columns.push("strain");
        }
        let mut columns = Vec::from_iter(columns.into_iter().map(str::to_owned));
        columns.extend(self.progress.deformed.columns(simulation));
        columns.extend(["step", "step_limit", "right_hand_sides"].map(str::to_owned));
        if self.solves {
            columns.push("products".to_owned());
        }
        columns
    }

    fn numbers(&self, simulation: &Simulation) -> Vec<f64> {
        let mut numbers = vec![self.integrator.time()];
        numbers.extend(self.strain());
        let deformed = &self.progress.deformed;
        numbers.extend(deformed.numbers(simulation, self.integrator.positions()));
        let report = self.report.as_ref();
        let limit = report.and_then(|report| report.step_limit);
        numbers.extend([
            report.map_or(f64::NAN, |report| report.step),
            limit.unwrap_or(f64::NAN),
            self.progress.right_hand_sides as f64,
        ]);
        if self.solves {
            numbers.push(self.suspension.products() as f64);
        }
        numbers
    }

    fn mark(&self) -> Mark {
        Mark {
            time: self.integrator.time(),
            number: self.progress.outputs,
        }
    }

    fn caption(&self) -> String {
        match self.strain() {
            Some(strain) => format!("γ̇t = {strain:.3}"),
            None => format!("t = {:.4}", self.integrator.time()),
        }
    }

    fn positions(&self) -> &[[f64; 3]] {
        self.integrator.positions()
    }

    fn step(&mut self, simulation: &mut Simulation) -> Result<Step, RunError> {
        let completed = Some((End::Completed, "the end is reached".to_owned()));
        if self.integrator.time() >= self.driver.duration {
            return Ok(Step {
                end: completed,
                ..Step::default()
            });
        }
        let due = self.next_output();
        let mut moving = Moving {
            suspension: &mut self.suspension,
            membranes: simulation,
        };
        let report = match self.integrator.step(&mut moving, due) {
            Ok(report) => report,
            Err(failure) => {
                return Ok(Step {
                    output: true,
                    checkpoint: true,
                    end: Some((End::Failed, failure.to_string())),
                });
            }
        };
        self.report = Some(report);
        self.progress.steps = report.accepted as u64;
        self.progress.right_hand_sides = report.evaluations as u64;
        let positions = self.integrator.positions();
        let deformed = &mut self.progress.deformed;
        deformed.follow(report.time, simulation, positions);
        self.note_growth(report.spectrum, simulation);
        let output = report.time >= due;
        if output {
            self.progress.outputs += 1;
        }
        let every = self.scene.output.checkpoint_every;
        let done = report.time >= self.driver.duration;
        Ok(Step {
            output,
            checkpoint: done || self.progress.steps.is_multiple_of(every),
            end: completed.filter(|_| done),
        })
    }

    fn progress(&self) -> Progress {
        let (step, stages) = self
            .report
            .map_or((f64::NAN, 0), |report| (report.step, report.stages));
        let message = match self.driver.flow.rate() {
            Some(rate) => format!(
                "{} of {:.3}, step {:.4}, {stages} velocities a step",
                self.caption(),
                rate * self.driver.duration,
                rate * step
            ),
            None => format!(
                "{} of {:.4}, step {step:.3e}, {stages} velocities a step",
                self.caption(),
                self.driver.duration
            ),
        };
        Progress {
            fraction: self.integrator.time() / self.driver.duration,
            message,
        }
    }

    fn work(&self) -> Work {
        Work {
            iterations: self.progress.steps,
            right_hand_sides: Some(self.progress.right_hand_sides),
        }
    }

    fn costs(&self) -> Vec<Cost> {
        let cost = |(effect, effort): (&str, Effort)| Cost {
            effect: effect.to_owned(),
            evaluations: effort.evaluations,
            seconds: effort.time.as_secs_f64(),
        };
        self.suspension.efforts().into_iter().map(cost).collect()
    }

    fn fluid_at(&mut self, simulation: &mut Simulation, points: &[[f64; 3]]) -> Option<Fluid> {
        let positions = self.integrator.positions();
        let fluid = self.suspension.fluid_at(simulation, positions, points);
        fluid.ok()
    }

    fn notes(&self) -> &[String] {
        &self.progress.notes
    }

    fn state(&self) -> DriveState {
        DriveState::Flowing(FlowingState {
            integrator: self.integrator.state().clone(),
            guess: self.suspension.guess().to_vec(),
            progress: self.progress.clone(),
        })
    }
}

/// Whether a surface's volume is held exactly.
fn is_held(surface: &SurfaceScene) -> bool {
    surface
        .volume
        .is_some_and(|volume| volume.hold == Hold::Exact)
}

/// The positions with which a run begins: volumes that are held exactly are at their targets.
fn start(simulation: &mut Simulation, mut positions: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    // That they can be reached was found out when the simulation was made.
    simulation.restore(&mut positions);
    positions
}

fn interval(scene: &Scene, driver: BoundaryIntegral) -> f64 {
    match scene.output.every {
        Every::Time(interval) => interval,
        Every::Iterations(_) => driver.duration,
    }
}

fn suspension(
    scene: &Scene,
    driver: BoundaryIntegral,
    simulation: &Simulation,
    positions: &[[f64; 3]],
) -> Suspension {
    let bodies = simulation.bodies().iter();
    let meshes = Vec::from_iter(bodies.map(|body| Arc::clone(body.shared_mesh())));
    let ratios = scene.surfaces.iter();
    let ratios = Vec::from_iter(ratios.map(|surface| surface.viscosity_ratio.unwrap_or(1.0)));
    let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let mut suspension = Suspension::new(
        &meshes,
        driver.viscosity,
        &ratios,
        driver.flow.ambient(),
        threads,
    );
    let kept = |number: usize| driver.volume_correction || is_held(&scene.surfaces[number]);
    suspension.keep_volumes(&meshes, kept, positions);
    suspension
}

fn settings(
    driver: BoundaryIntegral,
    simulation: &Simulation,
    positions: &[[f64; 3]],
    solves: bool,
) -> Settings {
    let scheme = match driver.integrator {
        scene::Integrator::Rkc2 => Scheme::Rkc2,
        scene::Integrator::Bs23 => Scheme::Bs23,
        scene::Integrator::Rk4 { step } => Scheme::Rk4 { step },
    };
    // The radius of the sphere of the same area, of the smallest surface.
    let radius = |body: &crate::simulation::Body| {
        let area = body
            .surface(positions)
            .map_or(f64::NAN, |surface| surface.area());
        (area / (4.0 * PI)).sqrt()
    };
    let length = simulation
        .bodies()
        .iter()
        .map(radius)
        .fold(f64::INFINITY, f64::min);
    Settings {
        tolerance: driver.tolerance,
        longest_step: driver.flow.rate().map(|rate| LONGEST_STEP / rate),
        precision: if solves {
            SOLUTION_TOLERANCE
        } else {
            f64::EPSILON
        },
        ..Settings::new(scheme, length)
    }
}
