//! Runs on a lattice of fluid, through time.

use super::clock::Clock;
use super::deformed::{Deformed, overlap};
use super::drive::{Drive, Mark, Sheared, Step, Work, cost};
use super::flowing::is_held;
use super::state::{DriveState, ImmersingProgress, ImmersingState};
use super::{End, RunError};
use crate::dynamics::Problem;
use crate::execute::available_threads;
use crate::flow::lattice_boltzmann::{Lattice, Node, Setup, Sides};
use crate::flow::{
    Channel, Fluid, Immersion, ImmersionError, ImmersionPrecision, KeptVolumes, Redistribution,
    Ripples,
};
use crate::info::MeshInfo;
use crate::scene::{Flow, LatticeBoltzmann, Scene};
use crate::simulation::{EffectCost, Simulation};
use std::array;
use std::f64::consts::PI;
use std::sync::Arc;

/// Largest number of steps by which an output may be early.
const NEAREST: f64 = 0.5;

/// The residual of the velocities by which vertices slide along fluid membranes. It may be large,
/// because no derivative of these velocities is taken.
const SLIDING_TOLERANCE: f64 = 1e-3;

/// The driver of membranes in a box of fluid.
pub(super) struct Immersing<'a, T> {
    scene: &'a Scene,
    driver: LatticeBoltzmann,
    clock: Clock,
    immersion: Immersion<T>,
    positions: Vec<[f64; 3]>,
    progress: ImmersingProgress,
}

/// A number type of lattices, whose states a checkpoint holds.
pub(super) trait Stored: ImmersionPrecision {
    fn stored(state: ImmersingState<Self>) -> DriveState;

    /// State from a checkpoint, if there is one.
    fn taken(stored: Option<DriveState>) -> Result<Option<ImmersingState<Self>>, RunError>;
}

impl Stored for f32 {
    fn stored(state: ImmersingState<Self>) -> DriveState {
        DriveState::ImmersingF32(state)
    }

    fn taken(stored: Option<DriveState>) -> Result<Option<ImmersingState<Self>>, RunError> {
        match stored {
            None => Ok(None),
            Some(DriveState::ImmersingF32(state)) => Ok(Some(state)),
            Some(_) => Err(RunError::Mismatch),
        }
    }
}

impl Stored for f64 {
    fn stored(state: ImmersingState<Self>) -> DriveState {
        DriveState::ImmersingF64(state)
    }

    fn taken(stored: Option<DriveState>) -> Result<Option<ImmersingState<Self>>, RunError> {
        match stored {
            None => Ok(None),
            Some(DriveState::ImmersingF64(state)) => Ok(Some(state)),
            Some(_) => Err(RunError::Mismatch),
        }
    }
}

impl<'a, T: Stored> Immersing<'a, T> {
    /// `positions` are the initial positions, which define the volumes to be kept; with a stored
    /// state the run continues from it.
    pub(super) fn new(
        scene: &'a Scene,
        driver: LatticeBoltzmann,
        simulation: &mut Simulation,
        mut positions: Vec<[f64; 3]>,
        stored: Option<ImmersingState<T>>,
    ) -> Result<Self, RunError> {
        simulation.restore(&mut positions);
        let mut immersion = immersion(scene, driver, simulation, &positions)?;
        let clock = Clock::new(scene, &driver.flow, driver.duration);
        let (positions, progress, clock) = match stored {
            Some(state) => {
                immersion.restore(state.immersion, &state.positions)?;
                let ImmersingProgress { steps, outputs, .. } = state.progress;
                // An output is made at the end of the step nearest to its due time.
                let [time, early] = [steps as f64, NEAREST].map(|count| count * driver.step);
                let clock = clock.taken_up(state.schedule, time, early, outputs)?;
                (state.positions, state.progress, clock)
            }
            None => {
                let deformed = Deformed::new(driver.flow.plane(), simulation, &positions);
                let progress = ImmersingProgress {
                    deformed,
                    steps: 0,
                    outputs: 0,
                    wall_stresses: [f64::NAN; 2],
                    notes: notes(scene, driver, simulation, &positions),
                };
                (positions, progress, clock)
            }
        };
        Ok(Self {
            scene,
            driver,
            clock,
            immersion,
            positions,
            progress,
        })
    }

    /// As a rank that is not the first: does what that one needs, until it is dismissed.
    pub(super) fn assist(
        scene: &'a Scene,
        driver: LatticeBoltzmann,
        simulation: &mut Simulation,
        mut positions: Vec<[f64; 3]>,
    ) -> Result<(), RunError> {
        simulation.restore(&mut positions);
        let mut immersion = immersion::<T>(scene, driver, simulation, &positions)?;
        immersion.assist(simulation, &mut positions);
        Ok(())
    }

    fn time(&self) -> f64 {
        self.progress.steps as f64 * self.driver.step
    }

    /// Notes results that are no longer trustworthy.
    fn note_state(&mut self, simulation: &Simulation) {
        let caption = self.clock.caption(self.time());
        let ImmersingProgress {
            deformed, notes, ..
        } = &mut self.progress;
        deformed.note(simulation, &self.positions, &caption, notes);
    }

    /// The mean shear stress on the walls in the last step.
    fn wall_stress(&self) -> f64 {
        let lattice = self.immersion.lattice();
        let [x, y, z] = self.driver.size();
        // Walls of a shear move against each other, those of a channel are both dragged along.
        let against = matches!(self.driver.flow, Flow::Shear { .. });
        let (mut force, mut area) = (0.0, 0.0);
        for (axis, across) in [(1, x * z), (2, x * y)] {
            if self.driver.walls()[axis] {
                let [low, high] = lattice.wall_forces(axis).map(|[along, ..]| along);
                force += if against { low - high } else { low + high };
                area += 2.0 * across;
            }
        }
        force * self.driver.units().force() / area
    }

    /// The number of the step that ends nearest to a time.
    fn nearest(&self, time: f64) -> u64 {
        ((time / self.driver.step).round() as u64).max(1)
    }
}

impl<T: Stored> Drive for Immersing<'_, T> {
    fn columns(&self, simulation: &Simulation) -> Vec<String> {
        let mut columns = self.clock.columns();
        columns.extend(self.progress.deformed.columns(simulation));
        columns.push("steps".to_owned());
        columns
    }

    fn numbers(&self, simulation: &Simulation) -> Vec<f64> {
        let mut numbers = self.clock.numbers(self.time());
        let deformed = &self.progress.deformed;
        numbers.extend(deformed.numbers(simulation, &self.positions));
        numbers.push(self.progress.steps as f64);
        numbers
    }

    fn mark(&self) -> Mark {
        Mark {
            time: self.time(),
            number: self.progress.outputs,
        }
    }

    fn caption(&self) -> String {
        self.clock.caption(self.time())
    }

    fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    fn replace_meshes(
        &mut self,
        simulation: &mut Simulation,
        mut references: Vec<[f64; 3]>,
        positions: Vec<[f64; 3]>,
    ) -> Result<(), RunError> {
        simulation.restore(&mut references);
        self.immersion.continue_at(&positions)?;
        immerse(
            self.scene,
            self.driver,
            simulation,
            &references,
            &mut self.immersion,
        );
        self.positions = positions;
        let deformed = &mut self.progress.deformed;
        deformed.meshes_changed(simulation, &self.positions);
        Ok(())
    }

    fn step(&mut self, simulation: &mut Simulation) -> Result<Step, RunError> {
        let completed = Some((End::Completed, "the end is reached".to_owned()));
        let total = self.nearest(self.clock.duration);
        if self.progress.steps >= total {
            return Ok(Step {
                end: completed,
                ..Step::default()
            });
        }
        if !self.scene.course.is_steady() {
            let middle = self.time() + 0.5 * self.driver.step;
            let factor = self.scene.course.at(middle);
            let sides = sides(self.driver, factor);
            self.immersion
                .drive(driving_force(self.driver, factor), sides)?;
        }
        if let Err(error) = self.immersion.advance(simulation, &mut self.positions) {
            self.note_state(simulation);
            let mut message = error.to_string();
            if let ImmersionError::TooFast { .. } = error {
                let stiff = ": the forces are too stiff for the step, a shorter one is needed";
                let overlap = overlap(simulation, &self.positions);
                message.push_str(overlap.as_deref().unwrap_or(stiff));
            }
            return Ok(Step {
                output: true,
                checkpoint: true,
                end: Some((End::Failed, message)),
                ..Step::default()
            });
        }
        self.progress.steps += 1;
        if self.scene.output.rheology.is_some() {
            let [_, before] = self.progress.wall_stresses;
            self.progress.wall_stresses = [before, self.wall_stress()];
        }
        let (steps, time) = (self.progress.steps, self.time());
        let deformed = &mut self.progress.deformed;
        let material = (self.driver.redistribution).then(|| self.immersion.material_velocities());
        deformed.follow(time, simulation, &self.positions, material);
        let output = steps >= self.nearest(self.clock.next_output(self.progress.outputs));
        if output {
            self.progress.outputs += 1;
            self.note_state(simulation);
        }
        let every = self.scene.output.checkpoint_every;
        let done = steps >= total;
        Ok(Step {
            output,
            checkpoint: done || steps.is_multiple_of(every),
            end: completed.filter(|_| done),
            ..Step::default()
        })
    }

    fn progress(&self) -> (f64, String) {
        let total = self.nearest(self.clock.duration);
        let progress = self.clock.progress(self.time(), self.driver.step);
        let message = format!("{progress}, {} of {total} steps", self.progress.steps);
        (self.progress.steps as f64 / total as f64, message)
    }

    fn work(&self) -> Work {
        Work {
            iterations: self.progress.steps,
            right_hand_sides: None,
        }
    }

    fn costs(&self) -> Vec<EffectCost> {
        let efforts = self.immersion.efforts().into_iter();
        efforts.map(|(name, effort)| cost(name, effort)).collect()
    }

    fn fluid_at(&mut self, _simulation: &mut Simulation, points: &[[f64; 3]]) -> Option<Fluid> {
        Some(self.immersion.fluid_at(points))
    }

    fn sheared(&mut self) -> Option<Sheared<'_>> {
        if self.progress.steps == 0 {
            return None;
        }
        self.immersion.collect();
        let (driver, unit) = (self.driver, self.driver.units().velocity());
        let factor = self.scene.course.at(self.time());
        let [low, high] = driver.corners();
        let [_, rows, planes] = driver.cells;
        let place = |node: usize, axis: usize| low[axis] + (node as f64 + 0.5) * driver.spacing;
        let wall = |y: f64| {
            let [along, ..] = undisturbed(driver, [driver.centre[0], y, driver.centre[2]]);
            [y, factor * along]
        };
        let layers = self.immersion.lattice().layer_velocities().into_iter();
        let layers = layers.enumerate();
        let layers = layers.map(|(row, [along, ..])| [place(row, 1), unit * along]);
        let layers = Vec::from_iter(layers);
        let undisturbed = (0..rows * planes).map(|node| {
            let point = [
                driver.centre[0],
                place(node % rows, 1),
                place(node / rows, 2),
            ];
            undisturbed(driver, point)[0]
        });
        let [_, height, depth] = driver.size();
        let means = [
            layers.iter().map(|[_, along]| along).sum::<f64>() / rows as f64,
            undisturbed.sum::<f64>() / (rows * planes) as f64,
        ];
        Some(Sheared {
            // As velocities of vertices, the mean of two steps has no part of the momentum whose sign alternates.
            wall_stress: 0.5 * self.progress.wall_stresses.iter().sum::<f64>(),
            flow_rates: means.map(|mean| mean * height * depth),
            layers: [vec![wall(low[1])], layers, vec![wall(high[1])]].concat(),
            positions: &self.positions,
            material: self.immersion.material_velocities(),
        })
    }

    fn notes(&self) -> &[String] {
        &self.progress.notes
    }

    fn state(&mut self) -> DriveState {
        T::stored(ImmersingState {
            schedule: self.clock.schedule(),
            immersion: self.immersion.state(),
            positions: self.positions.clone(),
            progress: self.progress.clone(),
        })
    }
}

/// The box with its fluid in undisturbed flow, without membranes and obstacles.
fn immersion<T: ImmersionPrecision>(
    scene: &Scene,
    driver: LatticeBoltzmann,
    simulation: &Simulation,
    positions: &[[f64; 3]],
) -> Result<Immersion<T>, RunError> {
    let units = driver.units();
    let [origin, _] = driver.corners();
    let on_lattice = |velocity: [f64; 3]| velocity.map(|component| component / units.velocity());
    let setup = Setup {
        cells: driver.cells,
        sides: sides(driver, scene.course.at(0.0)),
        viscosity: driver.lattice_viscosity,
        inertia: driver.density.is_some(),
        threads: available_threads(),
    };
    let mut lattice = Lattice::shared(setup, simulation.division().team().clone())?;
    let factor = scene.course.at(0.0);
    lattice.set_force(driving_force(driver, factor))?;
    lattice.fill(|cell| {
        let point =
            array::from_fn(|axis| origin[axis] + (cell[axis] as f64 + 0.5) * driver.spacing);
        Node {
            density: 1.0,
            velocity: on_lattice(undisturbed(driver, point).map(|component| factor * component)),
        }
    });
    for obstacle in simulation.obstacles() {
        let positions = obstacle.positions.iter().map(|position| {
            array::from_fn(|axis| (position[axis] - origin[axis]) / driver.spacing)
        });
        lattice.add_obstacle(&obstacle.mesh, &Vec::from_iter(positions))?;
    }
    let mut immersion = Immersion::new(lattice, units, origin, driver.kernel, positions.len());
    immersion.share(simulation.division().clone());
    immerse(scene, driver, simulation, positions, &mut immersion);
    Ok(immersion)
}

/// Sets all that depends on the meshes; volumes are kept at those of these positions.
fn immerse<T: ImmersionPrecision>(
    scene: &Scene,
    driver: LatticeBoltzmann,
    simulation: &Simulation,
    positions: &[[f64; 3]],
    immersion: &mut Immersion<T>,
) {
    let meshes = simulation.bodies().iter();
    let meshes = Vec::from_iter(meshes.map(|body| Arc::clone(body.shared_mesh())));
    let ratios = scene.surfaces.iter();
    let ratios = Vec::from_iter(ratios.map(|surface| surface.viscosity_ratio.unwrap_or(1.0)));
    immersion.set_viscosity_ratios(&meshes, &ratios);
    let own = |number: usize| simulation.owns(number);
    let kept = |number: usize| {
        own(number) && (driver.volume_correction || is_held(&scene.surfaces[number]))
    };
    immersion.keep_volumes(KeptVolumes::new(&meshes, &kept, positions));
    let fluid = |number: usize| own(number) && scene.surfaces[number].slides();
    let slides = |number: usize| driver.redistribution && fluid(number);
    immersion.resist(Ripples::new(&meshes, &fluid, &ratios, driver.viscosity));
    immersion.redistribute(Redistribution::new(&meshes, &slides, SLIDING_TOLERANCE));
}

/// The undisturbed flow, without membranes and obstacles.
fn undisturbed(driver: LatticeBoltzmann, point: [f64; 3]) -> [f64; 3] {
    if let Flow::Channel {
        centre_velocity,
        width,
        depth,
    } = driver.flow
    {
        let [_, y, z] = array::from_fn(|axis| point[axis] - driver.centre[axis]);
        let channel = Channel { width, depth };
        let share = channel.response(y, z) / channel.response(0.0, 0.0);
        return [centre_velocity * share, 0.0, 0.0];
    }
    let ambient = driver.flow.ambient();
    ambient.map_or([0.0; 3], |ambient| ambient.velocity(point))
}

/// The force on every node that drives a flow of this factor, in lattice units.
fn driving_force(driver: LatticeBoltzmann, factor: f64) -> [f64; 3] {
    let force = driver.flow.driving_force(driver.viscosity);
    let force = force.map_or(0.0, |force| force / driver.units().force_density());
    [factor * force, 0.0, 0.0]
}

/// Walls move with the velocity of the undisturbed flow of this factor there.
fn sides(driver: LatticeBoltzmann, factor: f64) -> [Sides; 3] {
    let corners = driver.corners();
    let unit = driver.units().velocity();
    let walls = driver.walls();
    array::from_fn(|axis| {
        if !walls[axis] {
            return Sides::Periodic;
        }
        let [low, high] = corners.map(|corner| {
            let mut point = driver.centre;
            point[axis] = corner[axis];
            undisturbed(driver, point).map(|component| factor * component / unit)
        });
        Sides::Walls { low, high }
    })
}

/// Remarks on a box that are known at the start.
fn notes(
    scene: &Scene,
    driver: LatticeBoltzmann,
    simulation: &Simulation,
    positions: &[[f64; 3]],
) -> Vec<String> {
    let mut notes = Vec::new();
    let Flow::Shear { .. } = driver.flow else {
        return notes;
    };
    // Many surfaces in a periodic box form a suspension, for which the box is not an error.
    if let [body] = simulation.bodies() {
        let volume = body.surface(positions).and_then(|surface| surface.volume());
        let Some(radius) = volume.map(|volume| (0.75 * volume / PI).cbrt()) else {
            return notes;
        };
        let radii = driver.size()[1] / radius;
        let [surface] = scene.surfaces.as_slice() else {
            return notes;
        };
        let membrane = body.surface(positions).map(MeshInfo::new);
        let membrane = membrane.map(|mesh| surface.membrane_on(&mesh));
        let ratio = surface.viscosity_ratio.unwrap_or(1.0);
        let known = membrane.and_then(|membrane| membrane.between_walls(radii, ratio));
        let by = known.map_or(String::new(), |known| {
            format!(
                " by {} = {:.4} or somewhat less, by {}",
                known.term, known.value, known.source
            )
        });
        notes.push(format!(
            "surface \"{}\" is in a box {radii:.3} radii a wide, L: in unbounded fluid its deformation is \
             smaller{by}; nothing is corrected",
            body.name(),
        ));
    }
    notes
}
