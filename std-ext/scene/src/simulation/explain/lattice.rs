//! Explanation of a lattice: its numbers, the limits of its step, its run time.

use super::Active;
use super::driver::interval;
use crate::execute::available_threads;
use crate::flow::lattice_boltzmann::limits::{ImmersedMembrane, StepLimit};
use crate::flow::lattice_boltzmann::{LatticeError, Setup, Sides, Speed, measure_speed};
use crate::info::MeshInfo;
use crate::scalar::Scalar;
use crate::scene::{
    Dimension, Driver, Every, Flow, Group, InteractionScene, LatticeBoltzmann, Parameters, Scene,
    SurfaceScene,
};
use serde::Serialize;

/// Explanation of a lattice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LatticeExplanation {
    /// The lattice: nodes, walls, kernel, number type, lengths.
    pub lattice: Active,
    /// Its numbers, with a the largest radius of a surface, h the longest mean edge.
    pub groups: Vec<Group>,
    /// The limits of the step, listed separately.
    pub limits: Vec<StepLimit>,
    /// Number of steps until the run ends.
    pub steps: u64,
    /// Number of nodes that this machine updates per second, measured on a small lattice.
    pub throughput: f64,
    /// Seconds per step for coupling as many points as there are vertices to that lattice.
    pub coupling: f64,
    /// Estimate of the run time from these two numbers and the forces of membranes. The estimate
    /// assumes 1e-7 s per vertex for elasticity and for bending by method B, and scales this by the
    /// relative cost of other methods. Viscous forces take twice as much in each of `3 + 7 √(η ν/(μ
    /// spacing))` products of the linear system of a step, as measured on capsules.
    pub minutes: f64,
}

/// Nodes along each axis of the measured lattice, too many for a processor's cache.
const TRIAL_NODES: usize = 48;

pub(super) fn explain(
    scene: &Scene,
    meshes: &[MeshInfo],
    number: &Parameters,
) -> Option<LatticeExplanation> {
    let Driver::LatticeBoltzmann(lattice) = &scene.driver else {
        return None;
    };
    let surfaces = scene.surfaces.iter().zip(meshes);
    let membranes = surfaces
        .clone()
        .map(|(surface, mesh)| surface.membrane_on(mesh));
    let membranes = Vec::from_iter(membranes);
    let barriers = Vec::from_iter(scene.interactions.iter().map(InteractionScene::barrier));
    let steps = (lattice.duration / lattice.step).ceil();
    let nodes: f64 = lattice.cells.iter().map(|&count| count as f64).product();
    let vertices = surfaces.clone().map(|(_, mesh)| mesh.vertices).sum();
    let speed = trial(lattice, vertices);
    let [throughput, coupling] = speed.map_or([f64::NAN; 2], |speed| [speed.nodes, speed.coupling]);
    let forces = surfaces.map(|(surface, mesh)| {
        let [both, elasticity] = surface.evaluation_seconds(mesh.vertices);
        both + 2.0 * viscous_products(surface, lattice) * elasticity
    });
    let step_time = nodes / throughput + coupling + forces.sum::<f64>();
    Some(LatticeExplanation {
        lattice: describe(scene, lattice, number),
        groups: groups(scene, lattice, &membranes),
        limits: lattice.parameters().step_limits(&membranes, &barriers),
        steps: steps as u64,
        throughput,
        coupling,
        minutes: steps * step_time / 60.0,
    })
}

/// The measurements of a suspension.
pub(super) fn rheology(scene: &Scene) -> Option<Active> {
    let (Driver::LatticeBoltzmann(lattice), Every::Time(interval)) =
        (&scene.driver, scene.output.every)
    else {
        return None;
    };
    let rheology = scene.output.rheology?;
    let mut parts = Vec::from_iter(rheology.stress.then(|| "stress".to_owned()));
    if rheology.profiles > 0 {
        parts.push(format!("profiles of {} slices", rheology.profiles));
    }
    let skipped = match rheology.skip {
        0.0 => String::new(),
        skip => format!(" after the strain {skip}"),
    };
    Some(Active {
        name: "rheology",
        choice: format!(
            "{}, means over {} rows{skipped} in {} blocks",
            parts.join(" and "),
            rheology.rows(lattice, interval),
            rheology.blocks
        ),
        parameters: Vec::new(),
    })
}

/// Estimated number of evaluations of viscous forces in a step.
fn viscous_products(surface: &SurfaceScene, lattice: &LatticeBoltzmann) -> f64 {
    let Some(membrane) = surface.effects.membrane_viscosity else {
        return 0.0;
    };
    let across = lattice.viscosity * lattice.spacing;
    let stiffness = membrane.shear.max(membrane.dilational) * lattice.lattice_viscosity / across;
    3.0 + 7.0 * stiffness.sqrt()
}

fn describe(scene: &Scene, lattice: &LatticeBoltzmann, number: &Parameters) -> Active {
    let [x, y, z] = lattice.cells;
    let walls = match lattice.walls() {
        [_, true, true] => "walls at the ends of y and z",
        [_, true, _] => "walls at the ends of y",
        _ => "periodic",
    };
    let mut parameters = vec![number.of("spacing", lattice.spacing, Dimension::LENGTH)];
    let names = ["box x", "y", "z"];
    parameters.extend(number.vector(names, lattice.size(), Dimension::LENGTH));
    parameters.push(number.of("step", lattice.step, Dimension::TIME));
    parameters.extend(interval(scene, number));
    Active {
        name: "lattice",
        choice: format!(
            "{x} × {y} × {z} nodes in {}, {walls}, kernel of {} nodes an axis",
            lattice.precision,
            lattice.kernel.points()
        ),
        parameters,
    }
}

fn groups(scene: &Scene, lattice: &LatticeBoltzmann, membranes: &[ImmersedMembrane]) -> Vec<Group> {
    let parameters = lattice.parameters();
    let mut groups = Vec::new();
    let mut group = |name, formula, value: f64| {
        groups.push(Group {
            name,
            formula,
            value,
        });
    };
    let largest = |of: fn(&ImmersedMembrane) -> f64| membranes.iter().map(of).fold(0.0, f64::max);
    let radius = largest(|membrane| membrane.radius);
    let edge = largest(|membrane| membrane.edge);
    let radii = membranes.iter().map(|membrane| membrane.radius);
    let smallest = radii.fold(f64::NAN, f64::min);
    group(
        "smallest radius in nodes",
        "a_min/spacing",
        smallest / lattice.spacing,
    );
    group("mean edge in nodes", "h/spacing", edge / lattice.spacing);
    let size = lattice.size();
    group("box in radii, along x", "L_x/a", size[0] / radius);
    group("along y", "L_y/a", size[1] / radius);
    group("along z", "L_z/a", size[2] / radius);
    let viscosity = lattice.lattice_viscosity;
    group("viscosity on the lattice", "ν", viscosity);
    group("relaxation time", "τ = 3 ν + 1/2", 3.0 * viscosity + 0.5);
    if let Some(rate) = lattice.flow.rate() {
        group("shear rate on the lattice", "γ̇ step", rate * lattice.step);
    }
    group("Mach number", "√3 U step/spacing", parameters.mach());
    let pressure = parameters.pressure(membranes);
    let compression = parameters.compression(pressure);
    group(
        "change of the density",
        "3 P step²/(ρ spacing²)",
        compression,
    );
    let reynolds = parameters.reynolds(radius, pressure);
    match lattice.density {
        Some(_) => group("Reynolds number", "Re = ρ γ̇ a²/μ", reynolds),
        None => group(
            "Reynolds number of the lattice alone",
            "γ̇ a² step/(ν spacing²)",
            reynolds,
        ),
    }
    if let (Flow::Shear { .. }, [membrane], [surface]) = (lattice.flow, membranes, &*scene.surfaces)
        && let Some(known) =
            membrane.between_walls(size[1] / radius, surface.viscosity_ratio.unwrap_or(1.0))
    {
        group("finite box, not corrected for", known.formula, known.value);
    }
    groups
}

/// The limit of the step, in words.
pub(super) fn step_limit(lattice: &LatticeExplanation, number: &Parameters) -> String {
    let limits = lattice.limits.iter().map(|limit| {
        let step = number.of(limit.name, limit.step, Dimension::TIME);
        format!("{step} ({})", limit.formula)
    });
    let shortest = |a: &&StepLimit, b: &&StepLimit| a.step.total_cmp(&b.step);
    let first = lattice.limits.iter().min_by(shortest);
    let first = first.map_or("nothing", |limit| limit.name);
    format!("{first}; {}", Vec::from_iter(limits).join(", "))
}

/// The speed of this machine on a small lattice of the same kind.
fn trial(lattice: &LatticeBoltzmann, vertices: usize) -> Result<Speed, LatticeError> {
    let setup = Setup {
        cells: lattice.cells.map(|count| count.clamp(1, TRIAL_NODES)),
        sides: [Sides::Periodic; 3],
        viscosity: 1.0 / 6.0,
        inertia: lattice.density.is_some(),
        threads: available_threads(),
    };
    match lattice.precision {
        Scalar::F32 => measure_speed::<f32>(setup, lattice.kernel, vertices),
        _ => measure_speed::<f64>(setup, lattice.kernel, vertices),
    }
}
