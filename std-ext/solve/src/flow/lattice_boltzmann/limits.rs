//! Limits of the steps of membranes on a lattice, from numbers of the fluid and of the membranes.

use super::units::{Units, mach};
use crate::flow::{AdhesiveWall, Barrier};
use serde::Serialize;
use std::ops::RangeInclusive;

/// Lattice viscosities for which the method is stable and accurate.
pub const VISCOSITIES: RangeInclusive<f64> = 0.02..=1.0;
/// The lattice viscosity by default: about where compressibility and the delay of the flow require
/// equally short steps.
const VISCOSITY: f64 = 1.0 / 3.0;
/// Ratio of a chosen step to the longest step that all limits allow.
const MARGIN: f64 = 0.9;

/// Limit of 3 P in lattice units, the relative change of density. At 0.01 the volume of a capsule
/// changes by as much, and its deformation is wrong by 2 %.
pub const COMPRESSION: f64 = 0.01;
/// Limit of the Mach number; errors by compressibility are proportional to its square.
pub const MACH: f64 = 0.1;
/// Limit of the Reynolds number of a lattice without `density`. Steady shapes do not depend on it;
/// at 0.65 D(t) of a capsule is late by 2 %.
pub const INERTIA: f64 = 0.2;
/// Largest stiffness of membranes in explicit steps, relative to `μ spacing/step` of the viscous
/// fluid: about half of the stiffness at which capsules started to oscillate in trials.
const MEMBRANES: f64 = 0.5;
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
pub const OSCILLATING: f64 = 2.0;
/// Length of a box, in radii of the membrane in it, from which its ends have little influence.
pub const FREE_BOX: f64 = 7.0;
/// D(L) − D(∞) over (a/L)³ of a capsule in shear between walls at a distance L: A. Guckenberger et al.,
/// Comput. Phys. Commun. 207 (2016) 1. In cubes that are periodic too, 1.1 to 1.8 were found here.
pub const CAPSULE_BOX: f64 = 2.4;
/// D(L)/D(∞) − 1 over `(1 + 2.5 λ)/(1 + λ) (a/L)³` of a drop in the middle between such walls: M. Shapira and
/// S. Haber, Int. J. Multiphase Flow 16 (1990) 305.
const DROP_BOX: f64 = 5.7;

/// The known effect of a finite box on Taylor's deformation D of a surface in shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiniteBox {
    /// The formula.
    pub formula: &'static str,
    /// The part of D that is due to the box, as in `D is larger by …`.
    pub term: &'static str,
    /// The source.
    pub source: &'static str,
    /// The value of the term.
    pub value: f64,
}

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

/// Numbers of a fluid on a lattice on which the limits of its step depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeParameters {
    /// Viscosity μ of the fluid outside of membranes.
    pub viscosity: f64,
    /// Mass density ρ; `None` without inertia.
    pub density: Option<f64>,
    /// Distance of nodes.
    pub spacing: f64,
    /// Duration of a step.
    pub step: f64,
    /// Kinematic viscosity ν on the lattice, in units of spacing²/step.
    pub lattice_viscosity: f64,
    /// Rate γ̇ of the flow, if it has one.
    pub rate: Option<f64>,
    /// The largest speed U of the fluid, or of a wall, without membranes.
    pub largest_speed: f64,
}

/// Size and stiffness of a membrane on a lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImmersedMembrane {
    /// Radius a of the sphere of the same volume.
    pub radius: f64,
    /// Mean edge: that of an equilateral triangle of the mean area.
    pub edge: f64,
    /// Bending modulus κ.
    pub bending: f64,
    /// In-plane shear modulus G.
    pub shear: f64,
    /// Area modulus K_s, with the moduli of local and total area.
    pub dilation: f64,
    /// Magnitude of the surface tension σ.
    pub tension: f64,
    /// The wall to which the membrane adheres.
    pub wall: Option<AdhesiveWall>,
}

/// The lattice viscosity by default. If possible, that of the fluid inside membranes with these viscosity
/// ratios is in the range [`VISCOSITIES`], too.
pub fn default_viscosity(ratios: impl IntoIterator<Item = f64>) -> f64 {
    let [least, most] = [*VISCOSITIES.start(), *VISCOSITIES.end()];
    let inside = |viscosity: f64, ratio: f64| (viscosity * ratio).clamp(least, most) / ratio;
    let viscosity = ratios.into_iter().fold(VISCOSITY, inside);
    viscosity.clamp(least, most)
}

impl LatticeParameters {
    /// Lattice units in units of the parameters. Without inertia the density follows from viscosity
    /// and step: `μ step/(ν spacing²)`.
    pub fn units(&self) -> Units {
        Units {
            spacing: self.spacing,
            step: self.step,
            density: self.viscosity * self.step / (self.lattice_viscosity * self.spacing.powi(2)),
        }
    }

    /// Mach number of the flow, or of the walls.
    pub fn mach(&self) -> f64 {
        mach(self.largest_speed * self.step / self.spacing)
    }

    /// 3 P in lattice units: the change of density due to the pressure P.
    pub fn compression(&self, pressure: f64) -> f64 {
        3.0 * pressure / self.units().pressure()
    }

    /// Reynolds number `γ̇ a²/ν` of surfaces of this radius. Without a density it is the Reynolds
    /// number of the lattice, whose flow follows forces with a delay. Without a flow, the rate is
    /// that of membranes with this pressure.
    pub fn reynolds(&self, radius: f64, pressure: f64) -> f64 {
        let rate = self.rate.unwrap_or(pressure / self.viscosity);
        let nodes = radius / self.spacing;
        rate * self.step * nodes * nodes / self.lattice_viscosity
    }

    /// The limits of the step, listed separately.
    pub fn step_limits(
        &self,
        membranes: &[ImmersedMembrane],
        barriers: &[Barrier],
    ) -> Vec<StepLimit> {
        let Self {
            viscosity, spacing, ..
        } = *self;
        let largest =
            |of: &dyn Fn(&ImmersedMembrane) -> f64| membranes.iter().map(of).fold(0.0, f64::max);
        let pressure = self.pressure(membranes);
        let compressibility = match self.density {
            None => COMPRESSION * viscosity / (3.0 * self.lattice_viscosity * pressure),
            Some(density) => spacing * (COMPRESSION * density / (3.0 * pressure)).sqrt(),
        };
        let speed = self.largest_speed;
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
            let rate = self.rate.unwrap_or(pressure / viscosity);
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

    /// A step somewhat shorter than every limit; NaN without limits.
    pub fn chosen_step(&self, membranes: &[ImmersedMembrane], barriers: &[Barrier]) -> f64 {
        let limits = self.step_limits(membranes, barriers);
        let steps = limits.iter().map(|limit| limit.step);
        MARGIN * steps.fold(f64::NAN, f64::min)
    }

    /// The limits due to membranes, whose forces are evaluated at the start of a step.
    pub fn membrane_limits(&self, membranes: &[ImmersedMembrane]) -> [StepLimit; 2] {
        // Forces that the viscosity or the mass of the fluid can balance in a step.
        let stiff = |of: fn(&ImmersedMembrane) -> f64, most: f64| {
            let share = MEMBRANES.min(most / self.lattice_viscosity);
            let stiffest = membranes.iter().map(of).fold(0.0, f64::max);
            share * self.viscosity * self.spacing / stiffest
        };
        [
            StepLimit {
                name: "elasticity",
                formula: "(K_s + G + σ) step/(μ spacing) ≤ 0.5 and 0.25/ν",
                step: stiff(ImmersedMembrane::plane_stiffness, PLANE),
            },
            StepLimit {
                name: "bending",
                formula: "κ step/(μ spacing edge²) ≤ 0.5 and 0.09/ν",
                step: stiff(ImmersedMembrane::bending_stiffness, BENDING),
            },
        ]
    }

    /// The limit due to repulsions, where surfaces touch.
    pub fn barrier_limit(&self, membranes: &[ImmersedMembrane], barriers: &[Barrier]) -> StepLimit {
        let edge = |membrane: &ImmersedMembrane| self.moved_together(membrane);
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
    pub fn adhesion_limit(&self, membranes: &[ImmersedMembrane]) -> StepLimit {
        let pressure = WALL_PRESSURE * self.pressure(membranes);
        let stiffness = |membrane: &ImmersedMembrane| {
            let wall = membrane.wall?;
            let edge = self.moved_together(membrane);
            Some(0.75_f64.sqrt() * edge * edge * wall.stiffness(pressure))
        };
        let stiffest = membranes.iter().filter_map(stiffness).fold(0.0, f64::max);
        StepLimit {
            name: "adhesion",
            formula: "0.87 V″(z) edge² step/(μ spacing) ≤ 1 and 0.5/ν, −V′(z) = 10 P",
            step: self.contact_step(stiffest),
        }
    }

    /// The mean edge, or the distance of nodes if that is longer: vertices between the same nodes move together.
    fn moved_together(&self, membrane: &ImmersedMembrane) -> f64 {
        membrane.edge.max(self.spacing)
    }

    /// The longest step in which the fluid balances forces that hold a vertex with this force per length.
    fn contact_step(&self, stiffness: f64) -> f64 {
        let share = CONTACT.min(CONTACT_MASS / self.lattice_viscosity);
        share * self.viscosity * self.spacing / stiffness
    }

    /// P, the pressure by which membranes and flow change the density.
    pub fn pressure(&self, membranes: &[ImmersedMembrane]) -> f64 {
        let viscous = self.viscosity * self.rate.unwrap_or(0.0);
        membranes
            .iter()
            .map(ImmersedMembrane::pressure)
            .fold(viscous, f64::max)
    }
}

impl ImmersedMembrane {
    /// The pressure with which the membrane resists deformation: the largest of G/a, σ/a and κ/a³.
    pub fn pressure(&self) -> f64 {
        let plane = self.shear.max(self.tension) / self.radius;
        plane.max(self.bending / self.radius.powi(3))
    }

    /// The effect on D of walls at a distance of so many radii; `None` where none is known. `ratio` is the
    /// viscosity ratio λ.
    pub fn between_walls(&self, radii: f64, ratio: f64) -> Option<FiniteBox> {
        let cube = radii.powi(-3);
        let is_drop = self.shear == 0.0 && self.dilation == 0.0 && self.bending == 0.0;
        if self.shear > 0.0 {
            Some(FiniteBox {
                formula: "D(L_y) − D(∞) = 2.4 (a/L_y)³",
                term: "2.4 (a/L)³",
                source: "Guckenberger et al. 2016",
                value: CAPSULE_BOX * cube,
            })
        } else if is_drop && self.tension > 0.0 {
            Some(FiniteBox {
                formula: "D(L_y)/D(∞) − 1 = 5.7 (1 + 2.5 λ)/(1 + λ) (a/L_y)³",
                term: "the fraction 5.7 (1 + 2.5 λ)/(1 + λ) (a/L)³",
                source: "Shapira and Haber 1990",
                value: DROP_BOX * (1.0 + 2.5 * ratio) / (1.0 + ratio) * cube,
            })
        } else {
            None
        }
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
