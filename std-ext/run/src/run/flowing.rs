//! Runs in a flow, through time.

use super::clock::Clock;
use super::deformed::{Deformed, overlap};
use super::drive::{Drive, Mark, Step, Work, cost};
use super::state::{DriveState, FlowingProgress, FlowingState};
use super::{End, RunError};
use crate::dynamics::integrate::{Integrator, Scheme, Settings, SpectralRadius, StepReport};
use crate::dynamics::{Motion, Problem};
use crate::enclosure::surroundings;
use crate::execute::available_threads;
use crate::flow::{
    Fluid, KeptVolumes, Membranes, Moving, Redistribution, SOLUTION_TOLERANCE, Suspension,
};
use crate::scene::{self, BoundaryIntegral, Scene, SurfaceScene};
use crate::simulation::{EffectCost, Simulation};
use std::f64::consts::PI;
use std::sync::Arc;

/// The longest step in units of the inverse deformation rate of the flow, because tank-treading has to
/// be followed from step to step.
const LONGEST_STEP: f64 = 0.5;

/// Steps, in units of the inverse deformation rate of the flow, that are too short to continue a run: a
/// unit of strain would take more than a hundred thousand steps.
const SHORTEST_STEP: f64 = 1e-5;

/// Largest number of consecutive steps that may be this short; some steps are, after a disturbance.
const SHORT_STEPS: u64 = 50;

/// Relative difference below which two steps are the same.
const ROUNDING: f64 = 1e-6;

/// Growth rate, in units of the deformation rate of the flow, above which a mode is reported.
const GROWTH: f64 = 3.0;

/// Total growth of such a mode, in factors of e, at which a run stops: e²⁰ = 5e8, from rounding
/// errors to the size of the surface.
const FOLDS: f64 = 20.0;

/// The driver of membranes in Stokes flow.
pub(super) struct Flowing<'a> {
    scene: &'a Scene,
    driver: BoundaryIntegral,
    clock: Clock,
    suspension: Suspension,
    /// Whether velocities require the solution of linear systems.
    solves: bool,
    integrator: Integrator,
    report: Option<StepReport>,
    progress: FlowingProgress,
}

impl<'a> Flowing<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        driver: BoundaryIntegral,
        simulation: &mut Simulation,
        positions: Vec<[f64; 3]>,
    ) -> Result<Self, RunError> {
        let positions = start(simulation, positions);
        let (mut suspension, solves, settings) =
            Self::prepare(scene, driver, simulation, &positions);
        let progress = FlowingProgress {
            deformed: Deformed::new(driver.flow.plane(), simulation, &positions),
            outputs: 0,
            steps: 0,
            right_hand_sides: 0,
            short_steps: 0,
            products: 0,
            folds: 0.0,
            notes: Vec::new(),
        };
        let mut integrator = Integrator::new(positions, 0.0, settings)?;
        if let scene::Integrator::Rk4 { step } = driver.integrator {
            let mut moving = Moving {
                suspension: &mut suspension,
                membranes: &mut *simulation,
            };
            refuse_unstable(step, &mut integrator, &mut moving)?;
        }
        Ok(Self {
            scene,
            driver,
            clock: Clock::new(scene, &driver.flow, driver.duration),
            suspension,
            solves,
            integrator,
            report: None,
            progress,
        })
    }

    /// `positions` are the initial positions, which define the volumes to be kept.
    pub(super) fn resume(
        scene: &'a Scene,
        driver: BoundaryIntegral,
        simulation: &mut Simulation,
        positions: Vec<[f64; 3]>,
        state: FlowingState,
    ) -> Result<Self, RunError> {
        let positions = start(simulation, positions);
        let (mut suspension, solves, settings) =
            Self::prepare(scene, driver, simulation, &positions);
        suspension.set_recent(state.recent);
        let integrator = Integrator::resume(state.integrator, settings)?;
        let clock = Clock::new(scene, &driver.flow, driver.duration);
        let outputs = state.progress.outputs;
        Ok(Self {
            scene,
            driver,
            clock: clock.taken_up(state.schedule, integrator.time(), 0.0, outputs)?,
            suspension,
            solves,
            integrator,
            report: None,
            progress: state.progress,
        })
    }

    /// The suspension and the settings of the integration for surfaces at these positions, which define the volumes to be
    /// kept.
    fn prepare(
        scene: &Scene,
        driver: BoundaryIntegral,
        simulation: &Simulation,
        positions: &[[f64; 3]],
    ) -> (Suspension, bool, Settings) {
        let suspension = suspension(scene, driver, simulation, positions);
        let solves =
            suspension.has_contrast() || suspension.has_obstacles() || simulation.are_viscous();
        let precision = precision(&suspension, solves);
        let settings = settings(scene, driver, simulation, positions, precision);
        (suspension, solves, settings)
    }

    /// Matrix products of the linear solutions since the start.
    fn products(&self) -> u64 {
        self.progress.products + self.suspension.products()
    }

    /// The reason to stop if steps stay too short. A step that an output or the course of the flow has cut short does
    /// not count.
    fn stagnation(
        &mut self,
        report: &StepReport,
        cut: bool,
        simulation: &Simulation,
    ) -> Option<String> {
        let rate = self.driver.flow.rate()?;
        if !cut {
            let short = rate * report.step < SHORTEST_STEP;
            let before = self.progress.short_steps;
            self.progress.short_steps = if short { before + 1 } else { 0 };
        }
        if self.progress.short_steps < SHORT_STEPS {
            return None;
        }
        let steps = (rate * report.step).recip();
        let mut message = format!(
            "at {} steps have come down to {:.1e}, so that a unit of strain takes {steps:.0e}",
            self.caption(),
            report.step
        );
        if let Some(spectrum) = report.spectrum {
            let place = place(simulation, spectrum.vertex);
            message.push_str(&format!(
                ": the fastest mode, at a rate of {:.1e}, is largest at {place}; a better mesh there, \
                 a method that is stable on it (j4) or less bending would help",
                spectrum.radius
            ));
        }
        Some(message)
    }

    /// Notes results that are no longer trustworthy.
    fn note_state(&mut self, simulation: &Simulation) {
        let caption = self.caption();
        let positions = self.integrator.positions();
        let FlowingProgress {
            deformed, notes, ..
        } = &mut self.progress;
        deformed.note(simulation, positions, &caption, notes);
    }

    /// Notes that steps are shorter than the scene asks for.
    fn note_shortened(&mut self, report: &StepReport, cut: bool) {
        let scene::Integrator::Rk4 { step } = self.driver.integrator else {
            return;
        };
        const WHAT: &str = "the step of rk4 is no longer stable and is shortened";
        if cut || report.step > step * (1.0 - ROUNDING) {
            return;
        }
        if !self.progress.notes.iter().any(|note| note.contains(WHAT)) {
            let note = format!(
                "from {}: {WHAT}, to {:.3e} here: the stiffness has grown since the start",
                self.caption(),
                report.step
            );
            self.progress.notes.push(note);
        }
    }

    /// Warns that the stiffest mode grows, and returns a reason to stop if it has grown too far.
    fn growth(&mut self, report: &StepReport, simulation: &Simulation) -> Option<String> {
        let rate = self.driver.flow.rate().unwrap_or(0.0);
        let found = report.spectrum.and_then(|it| Some((it, it.growth?)));
        let Some((spectrum, growth)) = found.filter(|(_, growth)| *growth > GROWTH * rate) else {
            self.progress.folds = 0.0;
            return None;
        };
        self.progress.folds += growth * report.step;
        let place = place(simulation, spectrum.vertex);
        // One warning per surface, because the place of the mode moves as it grows.
        let times = match rate {
            0.0 => String::new(),
            rate => format!(", {:.0} times as fast as the flow deforms", growth / rate),
        };
        const WHAT: &str = "grows instead of decaying";
        let caption = self.caption();
        if !self.progress.notes.iter().any(|note| note.contains(WHAT)) {
            self.progress.notes.push(format!(
                "from {caption}: the stiffest mode of the velocities {WHAT}, at a rate of \
                 {growth:.3e}{times}; it is largest at {place}: the mesh or the bending method is \
                 unstable there"
            ));
        }
        (self.progress.folds > FOLDS).then(|| {
            format!(
                "at {caption} the stiffest mode of the velocities {WHAT}, at a rate of \
                 {growth:.1e}{times}, and has grown by {FOLDS} factors of e: it is largest at \
                 {place}; a better mesh there, a method that is stable on it (j4), or less bending \
                 would help"
            )
        })
    }
}

impl Drive for Flowing<'_> {
    fn columns(&self, simulation: &Simulation) -> Vec<String> {
        let mut columns = self.clock.columns();
        columns.extend(self.progress.deformed.columns(simulation));
        columns.extend(["step", "step_limit", "right_hand_sides"].map(str::to_owned));
        if self.solves {
            columns.push("products".to_owned());
        }
        columns
    }

    fn numbers(&self, simulation: &Simulation) -> Vec<f64> {
        let mut numbers = self.clock.numbers(self.integrator.time());
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
            numbers.push(self.products() as f64);
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
        self.clock.caption(self.integrator.time())
    }

    fn positions(&self) -> &[[f64; 3]] {
        self.integrator.positions()
    }

    fn replace_meshes(
        &mut self,
        simulation: &mut Simulation,
        references: Vec<[f64; 3]>,
        positions: Vec<[f64; 3]>,
    ) -> Result<(), RunError> {
        let references = start(simulation, references);
        self.progress.products = self.products();
        let (suspension, _, settings) =
            Self::prepare(self.scene, self.driver, simulation, &references);
        self.suspension = suspension;
        self.integrator = self.integrator.on_new_positions(positions, settings)?;
        let positions = self.integrator.positions();
        self.progress.deformed.meshes_changed(simulation, positions);
        Ok(())
    }

    fn step(&mut self, simulation: &mut Simulation) -> Result<Step, RunError> {
        let completed = Some((End::Completed, "the end is reached".to_owned()));
        if self.integrator.time() >= self.clock.duration {
            return Ok(Step {
                end: completed,
                ..Step::default()
            });
        }
        let due = self.clock.next_output(self.progress.outputs);
        let mut moving = Moving {
            suspension: &mut self.suspension,
            membranes: simulation,
        };
        let corner = self.scene.course.next_corner(self.integrator.time());
        let end = due.min(corner);
        let report = match self.integrator.step(&mut moving, end) {
            Ok(report) => report,
            Err(failure) => {
                self.note_state(simulation);
                let overlap = overlap(simulation, self.integrator.positions());
                let message = failure.to_string() + &overlap.unwrap_or_default();
                return Ok(Step {
                    output: true,
                    checkpoint: true,
                    end: Some((End::Failed, message)),
                    ..Step::default()
                });
            }
        };
        self.report = Some(report);
        self.progress.steps = report.accepted as u64;
        self.progress.right_hand_sides = report.evaluations as u64;
        let positions = self.integrator.positions();
        let deformed = &mut self.progress.deformed;
        let material = (self.driver.redistribution).then(|| self.suspension.material_velocities());
        deformed.follow(report.time, simulation, positions, material);
        let grown = self.growth(&report, simulation);
        let output = report.time >= due;
        if output {
            self.progress.outputs += 1;
            self.note_state(simulation);
        }
        let cut = report.time >= end;
        self.note_shortened(&report, cut);
        if let Some(message) = grown {
            self.note_state(simulation);
            return Ok(Step {
                output: true,
                checkpoint: true,
                end: Some((End::Failed, message)),
                ..Step::default()
            });
        }
        if let Some(message) = self.stagnation(&report, cut, simulation) {
            self.note_state(simulation);
            return Ok(Step {
                output: true,
                checkpoint: true,
                end: Some((End::Stagnated, message)),
                ..Step::default()
            });
        }
        let every = self.scene.output.checkpoint_every;
        let done = report.time >= self.clock.duration;
        Ok(Step {
            output,
            checkpoint: done || self.progress.steps.is_multiple_of(every),
            end: completed.filter(|_| done),
            ..Step::default()
        })
    }

    fn progress(&self) -> (f64, String) {
        let (step, stages) = self
            .report
            .map_or((f64::NAN, 0), |report| (report.step, report.stages));
        let progress = self.clock.progress(self.integrator.time(), step);
        let message = format!("{progress}, {stages} velocities a step");
        (self.integrator.time() / self.clock.duration, message)
    }

    fn work(&self) -> Work {
        Work {
            iterations: self.progress.steps,
            right_hand_sides: Some(self.progress.right_hand_sides),
        }
    }

    fn costs(&self) -> Vec<EffectCost> {
        let efforts = self.suspension.efforts().into_iter();
        efforts.map(|(name, effort)| cost(name, effort)).collect()
    }

    fn fluid_at(&mut self, simulation: &mut Simulation, points: &[[f64; 3]]) -> Option<Fluid> {
        let positions = self.integrator.positions();
        self.suspension.set_time(self.integrator.time());
        let fluid = self.suspension.fluid_at(simulation, positions, points);
        fluid.ok()
    }

    fn notes(&self) -> &[String] {
        &self.progress.notes
    }

    fn state(&mut self) -> DriveState {
        DriveState::Flowing(FlowingState {
            schedule: self.clock.schedule(),
            integrator: self.integrator.state().clone(),
            recent: self.suspension.recent().clone(),
            progress: FlowingProgress {
                products: self.products(),
                ..self.progress.clone()
            },
        })
    }
}

/// Refuses a fixed step that is longer than the stable step at the start of the run.
///
/// If velocities cannot be computed, the first step reports the reason.
fn refuse_unstable(
    step: f64,
    integrator: &mut Integrator,
    moving: &mut Moving<'_, Simulation>,
) -> Result<(), RunError> {
    let Ok(spectrum) = integrator.estimate_spectrum(moving) else {
        return Ok(());
    };
    match integrator.step_limit() {
        Some(limit) if step > limit => {
            let rate = spectrum.radius;
            Err(RunError::UnstableStep { step, limit, rate })
        }
        _ => Ok(()),
    }
}

/// "surface S, vertex k" for a vertex that is counted over all surfaces.
fn place(simulation: &Simulation, vertex: usize) -> String {
    let mut bodies = simulation.bodies().iter();
    match bodies.find(|body| body.vertices().contains(&vertex)) {
        Some(body) => {
            let own = vertex - body.vertices().start;
            format!("surface \"{}\", vertex {own}", body.name())
        }
        None => format!("vertex {vertex}"),
    }
}

/// Whether a surface's volume is held exactly.
pub(super) fn is_held(surface: &SurfaceScene) -> bool {
    let volume = surface.effects.volume;
    volume.is_some_and(|volume| volume.hold.is_exact())
}

/// The initial positions of a run, with exactly held volumes at their targets.
fn start(simulation: &mut Simulation, mut positions: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    // The targets can be reached: this was checked when the simulation was built.
    simulation.restore(&mut positions);
    positions
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
    let mut suspension = Suspension::new(
        &meshes,
        driver.viscosity,
        &ratios,
        driver.flow.ambient(),
        available_threads(),
    );
    let obstacles = simulation.obstacles().iter();
    let obstacles = obstacles.map(|solid| (&*solid.mesh, &solid.positions[..]));
    suspension.set_obstacles(&meshes, &Vec::from_iter(obstacles));
    suspension.set_course(scene.course.clone());
    suspension.set_cluster_tolerance(driver.cluster_tolerance_at(positions.len()));
    // The nesting is determined once, because membranes do not pass through each other.
    let bodies = simulation.bodies().iter();
    let surfaces = bodies.map(|body| body.surface(positions));
    if let Some(surfaces) = surfaces.collect::<Option<Vec<_>>>() {
        suspension.set_surroundings(&surroundings(&surfaces, simulation.images()));
    }
    let kept = |number: usize| driver.volume_correction || is_held(&scene.surfaces[number]);
    suspension.keep_volumes(KeptVolumes::new(&meshes, &kept, positions));
    let slides = |number: usize| driver.redistribution && scene.surfaces[number].slides();
    if driver.integrator == scene::Integrator::Rosenbrock {
        let mut membranes = simulation.membranes();
        for (number, membrane) in membranes.iter_mut().enumerate() {
            membrane.motion = if slides(number) {
                Motion::AlongNormals
            } else {
                Motion::Free
            };
        }
        suspension.set_implicit(membranes, &ratios, driver.tolerance);
    }
    suspension.redistribute(Redistribution::new(&meshes, &slides, SOLUTION_TOLERANCE));
    suspension
}

/// The relative error of velocities; `solves` if they require the solution of a linear system.
fn precision(suspension: &Suspension, solves: bool) -> f64 {
    let solution = if solves { SOLUTION_TOLERANCE } else { 0.0 };
    suspension.precision().max(solution)
}

fn settings(
    scene: &Scene,
    driver: BoundaryIntegral,
    simulation: &Simulation,
    positions: &[[f64; 3]],
    precision: f64,
) -> Settings {
    let scheme = match driver.integrator {
        scene::Integrator::Rkc2 => Scheme::Rkc2,
        scene::Integrator::Bs23 => Scheme::Bs23,
        scene::Integrator::Rosenbrock => Scheme::Rosenbrock,
        scene::Integrator::Rk4 { step } => Scheme::Rk4 { step },
    };
    // The radius of the sphere with the same area as the smallest surface.
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
    let spectral_radius = match scheme {
        Scheme::Rosenbrock => SpectralRadius::Unknown,
        _ => SpectralRadius::Estimated,
    };
    let by_rate = driver.flow.rate().map(|rate| LONGEST_STEP / rate);
    let longest = (by_rate.into_iter()).fold(scene.course.longest_step(), f64::min);
    Settings {
        spectral_radius,
        tolerance: driver.tolerance,
        longest_step: Some(longest).filter(|longest| longest.is_finite()),
        precision,
        ..Settings::new(scheme, length)
    }
}
