//! Membranes in a box of fluid on a lattice.

use super::super::flow::Flow;
use super::super::keys::{Form, Kind, NUMBER, optional, positive};
use super::super::parameter::{Parameter, Parameters};
use super::super::units::Dimension;
use super::DescribedDriver;
use super::shared::{
    DURATION, FLOW, REDISTRIBUTION, STEP, STRAIN, VISCOSITY, VOLUME_CORRECTION, flow_parameters,
    kept,
};
use crate::flow::lattice_boltzmann::limits::LatticeParameters;
use crate::flow::lattice_boltzmann::{Kernel, Units};
use crate::scalar::Scalar;
use helfrich::Images;
use serde::Serialize;

/// The names of the axes in messages.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// Membranes in a box of fluid, moved by the lattice Boltzmann method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LatticeBoltzmann {
    /// Viscosity μ of the fluid outside, pressure times time.
    pub viscosity: f64,
    /// Mass density ρ of all fluid. `None`: there is no inertia, and the flow is linear in the forces,
    /// apart from a delay.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// The flow: at rest in a periodic box; a shear between walls at the ends of y that move with
    /// ±γ̇ L_y/2 along x; or a channel. Axes without walls are periodic.
    pub flow: Flow,
    /// The time at which the run ends; it begins at 0.
    pub duration: f64,
    /// Distance between nodes, a length.
    pub spacing: f64,
    /// Number of nodes along each axis.
    pub cells: [usize; 3],
    /// Centre of the box.
    pub centre: [f64; 3],
    /// Kinematic viscosity ν on the lattice, in units of spacing²/step.
    pub lattice_viscosity: f64,
    /// Duration of a step; a default has been resolved.
    pub step: f64,
    /// The kernel that spreads forces of vertices to nodes.
    pub kernel: Kernel,
    /// Number type of the lattice, f32 or f64; membranes are always f64.
    pub precision: Scalar,
    /// Whether the discrete volume of each closed surface is kept to rounding.
    pub volume_correction: bool,
    /// Whether vertices of fluid surfaces slide along them to keep the mesh even.
    pub redistribution: bool,
}

impl LatticeBoltzmann {
    /// The lengths of the box.
    pub fn size(&self) -> [f64; 3] {
        self.cells.map(|count| count as f64 * self.spacing)
    }

    /// The lowest and the highest coordinates of the box.
    pub fn corners(&self) -> [[f64; 3]; 2] {
        let size = self.size();
        [-0.5, 0.5].map(|side| std::array::from_fn(|axis| self.centre[axis] + side * size[axis]))
    }

    /// Which axes end in walls; the others are periodic.
    pub fn walls(&self) -> [bool; 3] {
        match self.flow {
            Flow::Shear { .. } => [false, true, false],
            Flow::Channel { depth, .. } => [false, true, depth.is_some()],
            _ => [false; 3],
        }
    }

    /// The periodic images, along the axes without walls.
    pub fn images(&self) -> Images<f64> {
        let (size, walls) = (self.size(), self.walls());
        let period = |axis: usize| if walls[axis] { 0.0 } else { size[axis] };
        Images {
            periods: [0, 1, 2].map(period),
            own: true,
        }
    }

    /// The largest speed of the fluid, or of a wall, in the undisturbed flow.
    pub fn largest_speed(&self) -> f64 {
        match self.flow {
            Flow::Shear { rate } => 0.5 * rate.abs() * self.size()[1],
            Flow::Channel {
                centre_velocity, ..
            } => centre_velocity.abs(),
            _ => 0.0,
        }
    }

    /// Lattice units in units of the scene. Without inertia the density follows from viscosity and
    /// step: `μ step/(ν spacing²)`.
    pub fn units(&self) -> Units {
        self.parameters().units()
    }

    /// The numbers on which the limits of the step depend.
    pub fn parameters(&self) -> LatticeParameters {
        LatticeParameters {
            viscosity: self.viscosity,
            density: self.density,
            spacing: self.spacing,
            step: self.step,
            lattice_viscosity: self.lattice_viscosity,
            rate: self.flow.rate(),
            largest_speed: self.largest_speed(),
        }
    }
}

impl DescribedDriver for LatticeBoltzmann {
    const KIND: Kind = Kind {
        name: "lattice-boltzmann",
        keys: &[
            VISCOSITY.required(),
            FLOW,
            DURATION,
            STRAIN,
            optional(
                "spacing",
                positive(Dimension::LENGTH),
                "Distance of the nodes of the lattice.",
            ),
            optional(
                "resolution",
                NUMBER,
                "Number of nodes in the radius a of the sphere with the volume of the smallest surface, \
                 instead of spacing.",
            ),
            optional(
                "box",
                Form::Exactly(3, &positive(Dimension::LENGTH)),
                "Lengths of the box of fluid, rounded to whole nodes; by default 7 a along each axis, \
                 in scenes with one surface.",
            ),
            optional(
                "centre",
                Form::Vector(Dimension::LENGTH),
                "Centre of the box; by default [0, 0, 0].",
            ),
            optional(
                "density",
                positive(Dimension::DENSITY),
                "Mass density ρ of the fluid, inside and outside; by default there is no inertia, and \
                 the remaining inertia of the lattice is kept small.",
            ),
            optional(
                "lattice_viscosity",
                NUMBER,
                "Kinematic viscosity ν on the lattice in units of spacing²/step, best from 0.02 to 1; \
                 by default 1/3, or less if a surface's viscosity ratio requires it; with density and \
                 step it follows from these.",
            ),
            STEP,
            optional(
                "kernel",
                Form::Choice(|| vec!["two", "three", "four"]),
                "The kernel that spreads forces of vertices: its number of nodes along each axis; by \
                 default \"two\".",
            ),
            optional(
                "precision",
                Form::Choice(|| vec!["f32", "f64"]),
                "Number type of the lattice; membranes are always f64; by default \"f64\".",
            ),
            VOLUME_CORRECTION,
            REDISTRIBUTION,
        ],
        exactly_one: &[&["duration", "strain"], &["spacing", "resolution"]],
    };

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let kept = kept(self.volume_correction, self.redistribution);
        let mut parameters = flow_parameters(number, self.viscosity, self.duration, self.flow);
        let inertia = match self.density {
            Some(density) => {
                parameters.push(number.of("density", density, Dimension::DENSITY));
                "fluid with inertia"
            }
            None => "Stokes flow",
        };
        (format!("{inertia} in a box, {kept}"), parameters)
    }
}
