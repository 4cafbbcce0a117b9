//! Membranes in a box of fluid on a lattice, and the limits of its steps.

use super::barrier::Barrier;
use super::explain::enclosed_radius;
use super::{Adhesion, Flow, Scene, SurfaceScene};
use crate::flow::lattice_boltzmann::{Kernel, Units, mach, memory};
use crate::info::MeshInfo;
use crate::scalar::Scalar;
use helfrich::Images;
use serde::Serialize;

/// The names of the axes in messages.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

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
        Units {
            spacing: self.spacing,
            step: self.step,
            density: self.viscosity * self.step / (self.lattice_viscosity * self.spacing.powi(2)),
        }
    }

    /// Mach number of the flow, or of the walls.
    pub(super) fn mach(&self) -> f64 {
        mach(self.largest_speed() * self.step / self.spacing)
    }

    /// 3 P in lattice units: the change of density due to the pressure P.
    pub(super) fn compression(&self, pressure: f64) -> f64 {
        3.0 * pressure / self.units().pressure()
    }

    /// Reynolds number `γ̇ a²/ν` of surfaces of this radius. Without a density it is the Reynolds
    /// number of the lattice, whose flow follows forces with a delay. Without a flow, the rate is
    /// that of membranes with this pressure.
    pub(super) fn reynolds(&self, radius: f64, pressure: f64) -> f64 {
        let rate = self.flow.rate().unwrap_or(pressure / self.viscosity);
        let nodes = radius / self.spacing;
        rate * self.step * nodes * nodes / self.lattice_viscosity
    }

    /// Memory in bytes: populations, forces and velocities at vertices, obstacles and viscosities.
    pub(super) fn memory(&self, scene: &Scene) -> u64 {
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

    /// The limits of the step, listed separately.
    pub(super) fn step_limits(
        &self,
        membranes: &[Membrane],
        barriers: &[Barrier],
    ) -> Vec<StepLimit> {
        let Self {
            viscosity, spacing, ..
        } = *self;
        let largest = |of: &dyn Fn(&Membrane) -> f64| membranes.iter().map(of).fold(0.0, f64::max);
        let pressure = self.pressure(membranes);
        let compressibility = match self.density {
            None => COMPRESSION * viscosity / (3.0 * self.lattice_viscosity * pressure),
            Some(density) => spacing * (COMPRESSION * density / (3.0 * pressure)).sqrt(),
        };
        let speed = self.largest_speed();
        let mut limits = vec![
            StepLimit {
                name: "compressibility",
                formula: "3 P step²/(ρ spacing²) ≤ 0.01, P the largest of μγ̇, G/a, κ/a³ and σ/a",
                step: compressibility,
            },
            StepLimit {
                name: "Mach number",
                formula: "√3 U step/spacing ≤ 0.1",
                step: MACH * spacing / (3.0_f64.sqrt() * speed),
            },
        ];
        if self.density.is_none() {
            let radius = largest(&|membrane| membrane.radius);
            let rate = self.flow.rate().unwrap_or(pressure / viscosity);
            limits.push(StepLimit {
                name: "inertia of the lattice",
                formula: "γ̇ a² step/(ν spacing²) ≤ 0.2",
                step: INERTIA * self.lattice_viscosity * spacing.powi(2) / (rate * radius.powi(2)),
            });
        }
        limits.extend(self.membrane_limits(membranes));
        limits.push(self.barrier_limit(membranes, barriers));
        limits.push(self.adhesion_limit(membranes));
        // What does not exist limits nothing.
        limits.retain(|limit| limit.step.is_finite());
        limits
    }

    /// The limits due to membranes, whose forces are evaluated at the start of a step.
    pub(super) fn membrane_limits(&self, membranes: &[Membrane]) -> [StepLimit; 2] {
        // Forces that the viscosity or the mass of the fluid can balance in a step.
        let stiff = |of: fn(&Membrane) -> f64, most: f64| {
            let share = MEMBRANES.min(most / self.lattice_viscosity);
            let stiffest = membranes.iter().map(of).fold(0.0, f64::max);
            share * self.viscosity * self.spacing / stiffest
        };
        [
            StepLimit {
                name: "elasticity",
                formula: "(K_s + G + σ) step/(μ spacing) ≤ 0.5 and 0.25/ν",
                step: stiff(Membrane::plane_stiffness, PLANE),
            },
            StepLimit {
                name: "bending",
                formula: "κ step/(μ spacing edge²) ≤ 0.5 and 0.09/ν",
                step: stiff(Membrane::bending_stiffness, BENDING),
            },
        ]
    }

    /// The limit due to repulsions, where surfaces touch.
    pub(super) fn barrier_limit(&self, membranes: &[Membrane], barriers: &[Barrier]) -> StepLimit {
        let edge = |membrane: &Membrane| self.moved_together(membrane);
        let edge = membranes.iter().map(edge).fold(0.0, f64::max);
        let pressure = self.pressure(membranes);
        let stiffness = |barrier: &Barrier| barrier.stiffness(pressure, edge);
        let stiffest = barriers.iter().map(stiffness).fold(0.0, f64::max);
        StepLimit {
            name: "repulsion",
            formula: "0.87 |p'(d)| edge² step/(μ spacing) ≤ 1 and 0.5/ν, p(d) = 10 P",
            step: self.contact_step(stiffest),
        }
    }

    /// The limit due to walls to which membranes adhere, where they are pressed against them.
    pub(super) fn adhesion_limit(&self, membranes: &[Membrane]) -> StepLimit {
        let pressure = WALL_PRESSURE * self.pressure(membranes);
        let stiffness = |membrane: &Membrane| {
            let adhesion = membrane.adhesion?;
            let edge = self.moved_together(membrane);
            Some(0.75_f64.sqrt() * edge * edge * adhesion.stiffness(pressure))
        };
        let stiffest = membranes.iter().filter_map(stiffness).fold(0.0, f64::max);
        StepLimit {
            name: "adhesion",
            formula: "0.87 V″(z) edge² step/(μ spacing) ≤ 1 and 0.5/ν, −V′(z) = 10 P",
            step: self.contact_step(stiffest),
        }
    }

    /// The mean edge, or the distance of nodes if that is longer: vertices between the same nodes move together.
    fn moved_together(&self, membrane: &Membrane) -> f64 {
        membrane.edge.max(self.spacing)
    }

    /// The longest step in which the fluid balances forces that hold a vertex with this force per length.
    fn contact_step(&self, stiffness: f64) -> f64 {
        let share = CONTACT.min(CONTACT_MASS / self.lattice_viscosity);
        share * self.viscosity * self.spacing / stiffness
    }

    /// P, the pressure by which membranes and flow change the density.
    pub(super) fn pressure(&self, membranes: &[Membrane]) -> f64 {
        let viscous = self.viscosity * self.flow.rate().unwrap_or(0.0);
        membranes
            .iter()
            .map(Membrane::pressure)
            .fold(viscous, f64::max)
    }
}

/// Limit of 3 P in lattice units, the relative change of density. At 0.01 the volume of a capsule
/// changes by as much, and its deformation is wrong by 2 %.
pub(super) const COMPRESSION: f64 = 0.01;
/// Limit of the Mach number; errors by compressibility are proportional to its square.
pub(super) const MACH: f64 = 0.1;
/// Limit of the Reynolds number of a lattice without `density`. Steady shapes do not depend on it;
/// at 0.65 D(t) of a capsule is late by 2 %.
pub(super) const INERTIA: f64 = 0.2;
/// Largest stiffness of membranes in explicit steps, relative to `μ spacing/step` of the viscous
/// fluid: about half of the stiffness at which capsules started to oscillate in trials.
pub(super) const MEMBRANES: f64 = 0.5;
/// The same for in-plane stiffness, relative to `ρ spacing³/step²` of the mass of the fluid.
const PLANE: f64 = 0.25;
/// The same for bending stiffness, relative to the mass of the fluid.
const BENDING: f64 = 0.09;

/// Largest stiffness of forces that hold a single vertex, relative to `μ spacing/step` of the fluid.
const CONTACT: f64 = 1.0;
/// The same relative to `ρ spacing³/step²` of the mass of the fluid. At 2 a vertex that is spread
/// over one node would be thrown back farther than it came.
const CONTACT_MASS: f64 = 0.5;

/// Ratio of the pressure against a wall to the largest of μγ̇, G/a, κ/a³ and σ/a, as where two surfaces touch.
const WALL_PRESSURE: f64 = 10.0;

/// Ratio of the step to the limit at which membranes oscillate.
pub(super) const TREMBLING: f64 = 2.0;
/// D(L) − D(∞) over (a/L)³ of a capsule in shear between walls at a distance L: A. Guckenberger et al.,
/// Comput. Phys. Commun. 207 (2016) 1. In cubes that are periodic too, 1.1 to 1.8 were found here.
pub const FINITE_BOX: f64 = 2.4;

/// A limit of the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepLimit {
    /// The name of the limit.
    pub name: &'static str,
    /// The condition.
    pub formula: &'static str,
    /// The step at which it just holds, a time.
    pub step: f64,
}

/// Properties of a surface that the lattice needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Membrane {
    /// a, that of the sphere of the same volume.
    pub(super) radius: f64,
    /// The edge of an equilateral triangle of the mean area.
    pub(super) edge: f64,
    /// κ.
    bending: f64,
    /// G.
    shear: f64,
    /// K_s, with the moduli of local and total area.
    dilation: f64,
    /// σ, without sign.
    tension: f64,
    /// To a wall.
    adhesion: Option<Adhesion>,
}

impl Membrane {
    /// Properties of a surface whose mesh has this radius, area and number of triangles.
    pub(super) fn new(surface: &SurfaceScene, radius: f64, area: f64, triangles: usize) -> Self {
        let stiffness = surface.effects.stiffness();
        Self {
            radius,
            edge: (4.0 * area / (3_f64.sqrt() * triangles as f64)).sqrt(),
            bending: stiffness.bending,
            shear: stiffness.shear,
            dilation: stiffness.area,
            tension: stiffness.tension.abs(),
            adhesion: surface.effects.adhesion,
        }
    }

    /// A surface and its mesh.
    pub(super) fn of(surface: &SurfaceScene, mesh: &MeshInfo) -> Self {
        Self::new(surface, enclosed_radius(mesh), mesh.area, mesh.triangles)
    }

    /// The pressure with which the surface resists deformation.
    pub(super) fn pressure(&self) -> f64 {
        let plane = self.shear.max(self.tension) / self.radius;
        plane.max(self.bending / self.radius.powi(3))
    }

    /// In-plane stiffness between neighbouring vertices, force per length.
    fn plane_stiffness(&self) -> f64 {
        self.dilation + self.shear + self.tension
    }

    /// Bending stiffness of a vertex, force per length.
    fn bending_stiffness(&self) -> f64 {
        self.bending / (self.edge * self.edge)
    }
}
