//! The interface between a run and the drivers, which move the surfaces of a scene.

use super::state::DriveState;
use super::{End, RunError};
use crate::flow::{Effort, Fluid};
use crate::simulation::{EffectCost, Simulation};

/// A driver in progress.
pub(super) trait Drive {
    /// The names of the first numbers of a row.
    fn columns(&self, simulation: &Simulation) -> Vec<String>;

    /// The values of these numbers.
    fn numbers(&self, simulation: &Simulation) -> Vec<f64>;

    /// The progress, as a time in files and as a number in their names.
    fn mark(&self) -> Mark;

    /// A text about the progress, for the caption of a picture.
    fn caption(&self) -> String;

    /// The positions of the vertices.
    fn positions(&self) -> &[[f64; 3]];

    /// Advances by one step.
    fn step(&mut self, simulation: &mut Simulation) -> Result<Step, RunError>;

    /// The end of the run after a step with a mesh that is [worn](Step::worn) and cannot be replaced.
    fn worn_out(&mut self, _simulation: &mut Simulation) -> Step {
        Step::default()
    }

    /// Continues with the new meshes of the simulation at these positions. `references` are the positions with which each
    /// surface got its present mesh: what is kept from then on is measured there, and again when the run is continued.
    fn replace_meshes(
        &mut self,
        simulation: &mut Simulation,
        references: Vec<[f64; 3]>,
        positions: Vec<[f64; 3]>,
    ) -> Result<(), RunError>;

    /// The progress from 0 to 1, and its description.
    fn progress(&self) -> (f64, String);

    /// Work done so far.
    fn work(&self) -> Work;

    /// Computing times of the driver, besides those of effects.
    fn costs(&self) -> Vec<EffectCost> {
        Vec::new()
    }

    /// Velocity and pressure of the fluid at some points; `None` for drivers without a fluid.
    fn fluid_at(&mut self, _simulation: &mut Simulation, _points: &[[f64; 3]]) -> Option<Fluid> {
        None
    }

    /// The fluid between walls; `None` for drivers without a box of fluid, and before the first step.
    fn sheared(&mut self) -> Option<Sheared<'_>> {
        None
    }

    /// Remarks on the results.
    fn notes(&self) -> &[String];

    /// The complete state, from which a run continues bit for bit.
    fn state(&mut self) -> DriveState;
}

/// A box of fluid and its walls. Without walls, stress and flow rates are NaN.
#[derive(Clone, Debug)]
pub(super) struct Sheared<'a> {
    /// The mean shear stress on the walls, positive if the fluid drags the low wall along x.
    pub(super) wall_stress: f64,
    /// Volume per time along x, now and in the undisturbed flow.
    pub(super) flow_rates: [f64; 2],
    /// Heights and mean velocities along x: on the low wall, in each layer of nodes, on the high wall.
    pub(super) layers: Vec<[f64; 2]>,
    /// The positions of the vertices of all surfaces.
    pub(super) positions: &'a [[f64; 3]],
    /// The velocities of the material of all surfaces at their vertices.
    pub(super) material: &'a [[f64; 3]],
}

/// A point in the progress of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) time: f64,
    pub(super) number: u64,
}

/// Outputs due after a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Step {
    /// A row and files.
    pub(super) output: bool,
    /// A checkpoint.
    pub(super) checkpoint: bool,
    /// The end of the run, and a text with its reason.
    pub(super) end: Option<(End, String)>,
    /// The surface whose mesh does not allow a further step.
    pub(super) worn: Option<usize>,
}

/// Work of a driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Work {
    /// Iterations, or steps in time.
    pub(super) iterations: u64,
    /// Evaluations of velocities, of drivers in time.
    pub(super) right_hand_sides: Option<u64>,
}

/// Cost of something other than an effect.
pub(super) fn cost(name: &str, effort: Effort) -> EffectCost {
    EffectCost {
        effect: name.to_owned(),
        evaluations: effort.evaluations,
        seconds: effort.time.as_secs_f64(),
    }
}
