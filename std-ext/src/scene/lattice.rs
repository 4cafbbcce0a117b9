//! Membranes in a box of fluid on a lattice.

use super::{Flow, Interaction, Scene, SurfaceScene};
use crate::flow::lattice_boltzmann::limits::{ImmersedMembrane, LatticeParameters};
use crate::flow::lattice_boltzmann::{Kernel, Units, memory};
use crate::flow::{AdhesiveWall, Barrier};
use crate::info::{MeshInfo, mean_edge};
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
    /// Mass density ρ of all fluid. `None`: no inertia; the flow is linear in the forces, apart
    /// from the delay with which it follows them.
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
    /// Duration of a step, already chosen.
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

    /// The largest speed of the fluid, or of a wall, that there would be without membranes.
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

    /// Memory in bytes: populations, forces and velocities at vertices, obstacles and viscosities.
    pub(crate) fn memory(&self, scene: &Scene) -> u64 {
        let nodes = self.cells.map(|count| count as u64).iter().product::<u64>();
        let (populations, number) = match self.precision {
            Scalar::F32 => (memory::<f32>(self.cells), 4),
            _ => (memory::<f64>(self.cells), 8),
        };
        let ratio =
            |surface: &SurfaceScene| surface.viscosity_ratio.is_some_and(|ratio| ratio != 1.0);
        let contrast = u64::from(scene.surfaces.iter().any(ratio));
        let labels = u64::from(!scene.obstacles.is_empty());
        populations.unwrap_or(0) as u64 + nodes * (number * (6 + contrast) + 2 * labels)
    }
}

impl Interaction {
    /// The repulsion as limits of steps see it.
    pub(crate) fn barrier(&self) -> Barrier {
        let Self::Repulsion {
            strength, cutoff, ..
        } = *self;
        Barrier { strength, cutoff }
    }
}

impl SurfaceScene {
    /// Size and stiffness of the surface, whose mesh has this radius, area and number of triangles.
    pub(super) fn membrane(&self, radius: f64, area: f64, triangles: usize) -> ImmersedMembrane {
        let stiffness = self.effects.stiffness();
        ImmersedMembrane {
            radius,
            edge: mean_edge(area, triangles),
            bending: stiffness.bending,
            shear: stiffness.shear,
            dilation: stiffness.area,
            tension: stiffness.tension.abs(),
            wall: self.effects.adhesion.map(|adhesion| AdhesiveWall {
                strength: adhesion.strength,
                range: adhesion.range,
            }),
        }
    }

    /// The same of a surface with this mesh.
    pub(crate) fn membrane_on(&self, mesh: &MeshInfo) -> ImmersedMembrane {
        self.membrane(mesh.enclosed_radius(), mesh.area, mesh.triangles)
    }
}
