//! The driver, the flow, and the limits of the step.

use super::Active;
use crate::generate::Family;
use crate::info::{MeshInfo, mean_edge};
use crate::method::BendingMethod;
use crate::scene::course;
use crate::scene::{
    BoundaryIntegral, Dimension, Driver, Every, Integrator, InteractionScene, MeshSource,
    Parameter, Parameters, Scene, SurfaceScene,
};

pub(super) fn explain(driver: &Driver, meshes: &[MeshInfo], number: &Parameters) -> Active {
    let (mut choice, mut parameters) = driver.explain(number);
    let tolerance = cluster_tolerance(driver, meshes);
    if tolerance > 0.0 {
        choice.push_str(", sums over clusters of vertices");
        parameters.push(number.plain("cluster tolerance", tolerance));
    }
    Active {
        name: driver.name(),
        choice,
        parameters,
    }
}

/// The tolerance of sums over clusters, 0 without any.
pub(super) fn cluster_tolerance(driver: &Driver, meshes: &[MeshInfo]) -> f64 {
    let vertices = meshes.iter().map(|mesh| mesh.vertices).sum();
    match driver {
        Driver::BoundaryIntegral(integral) => integral.cluster_tolerance_at(vertices),
        Driver::Relax(_) | Driver::LatticeBoltzmann(_) => 0.0,
    }
}

/// The ambient flow, if there is a fluid.
pub(super) fn flow(scene: &Scene, number: &Parameters) -> Option<Active> {
    let flow = scene.driver.flow()?;
    let (mut choice, parameters) = flow.explain(number);
    choice.push_str(&course::words(&scene.course, number));
    Some(Active {
        name: "flow",
        choice,
        parameters,
    })
}

/// The integrator and the reason for it, and the times of outputs.
pub(super) fn integrator(scene: &Scene, number: &Parameters) -> Option<Active> {
    let Driver::BoundaryIntegral(integral) = &scene.driver else {
        return None;
    };
    let bends = |surface: &&SurfaceScene| surface.effects.bending.is_some();
    let bends = scene.surfaces.iter().find(bends);
    let tense = |surface: &&SurfaceScene| surface.effects.tension.is_some();
    let tense = scene.surfaces.iter().find(tense);
    let mut parameters = Vec::new();
    let tolerance = number.plain("tolerance", integral.tolerance);
    let (name, why) = match integral.integrator {
        Integrator::Rkc2 => {
            parameters.push(tolerance);
            let why = match (bends, tense) {
                (Some(surface), _) => format!(
                    "\"{}\" bends, which limits other explicit steps by the cube of an edge",
                    surface.name
                ),
                (None, Some(surface)) => format!(
                    "\"{}\" has a surface tension, which limits other explicit steps by an edge",
                    surface.name
                ),
                (None, None) => "as asked for: nothing bends, and bs23 would do".to_owned(),
            };
            ("rkc2", why)
        }
        Integrator::Bs23 => {
            parameters.push(tolerance);
            let why = match (bends, tense) {
                (Some(_), _) => "as asked for: where a surface bends rkc2 takes fewer evaluations",
                (None, Some(_)) => {
                    "as asked for: where a surface has a tension rkc2 takes fewer evaluations"
                }
                (None, None) => {
                    "nothing bends, and elasticity limits explicit steps by an edge alone"
                }
            };
            ("bs23", why.to_owned())
        }
        Integrator::Rosenbrock => {
            parameters.push(tolerance);
            (
                "rosenbrock",
                "as asked for: linearly implicit steps of four velocities, as long as their error allows, with \
                 the stiffness of membranes by differences of their forces and a local approximation of \
                 their mobility"
                    .to_owned(),
            )
        }
        Integrator::Rk4 { step } => {
            parameters.push(number.of("step", step, Dimension::TIME));
            (
                "rk4",
                "as asked for: fixed steps, without error control".to_owned(),
            )
        }
    };
    parameters.extend(interval(scene, number));
    Some(Active {
        name: "integrator",
        choice: format!("{name}: {why}"),
        parameters,
    })
}

/// Time from one output to the next.
pub(super) fn interval(scene: &Scene, number: &Parameters) -> Option<Parameter> {
    match scene.output.every {
        Every::Iterations(_) => None,
        Every::Time(interval) => Some(number.of("output interval", interval, Dimension::TIME)),
    }
}

/// The limit of the step, in words.
pub(super) fn step_limit(scene: &Scene, spectral_radius: Option<f64>) -> String {
    let Driver::BoundaryIntegral(_) = &scene.driver else {
        return "none: relax has no time, and chooses its steps itself; without a flow there is no \
                capillary number either"
            .to_owned();
    };
    match spectral_radius {
        Some(radius) => {
            let number = Parameters::new(scene.units);
            let step = number.of("Δt", 2.5 / radius, Dimension::TIME);
            let radius = number.of("ρ", radius, Dimension::RATE);
            let repulsion = match scene.interactions.is_empty() {
                true => "",
                false => {
                    ", or up to 0.15 |p'(d)| d/μ of repulsions, p(d) ten times the largest of μγ̇, G/a, κ/a³ \
                     and σ/a"
                }
            };
            format!(
                "estimate {step} of bs23 and rk4, 2.5/ρ with the spectral radius {radius}; rkc2 takes \
                 √(1 + 1.54 Δt ρ) stages for any Δt (ρ = max{{0.355 (K_s + G)/(μ h), 2.65 κ/(μ h³)}} \
                 of method B on icospheres with edges h, λ = 1{repulsion}; the run estimates it anew)"
            )
        }
        None => {
            "estimated by power iteration as the run begins: there is a formula for method B on \
                 icospheres alone"
                .to_owned()
        }
    }
}

/// Estimate of the spectral radius of all surfaces; `None` if it is unknown for one surface.
pub(super) fn spectral_radius(scene: &Scene, meshes: &[MeshInfo]) -> Option<f64> {
    let Driver::BoundaryIntegral(integral) = &scene.driver else {
        return None;
    };
    let surfaces = scene.surfaces.iter().zip(meshes);
    let mut radii = surfaces.map(|(surface, mesh)| of_one(surface, mesh, integral.viscosity));
    let radius = radii.try_fold(0.0, |largest: f64, radius| Some(radius?.max(largest)))?;
    Some(radius.max(of_repulsion(scene, meshes, integral)))
}

/// Largest of the repulsions, where flow and membranes press surfaces together as hard as they can; 0
/// without any.
fn of_repulsion(scene: &Scene, meshes: &[MeshInfo], driver: &BoundaryIntegral) -> f64 {
    let membranes = scene.surfaces.iter().zip(meshes);
    let membranes = membranes.map(|(surface, mesh)| surface.membrane_on(mesh));
    let flow = driver.viscosity * driver.flow.rate().unwrap_or(0.0);
    let (pressure, edge) = membranes.fold((flow, f64::INFINITY), |(pressure, edge), membrane| {
        (membrane.pressure().max(pressure), membrane.edge.min(edge))
    });
    let rate = |interaction: &InteractionScene| {
        let barrier = interaction.barrier();
        barrier.rate(pressure, edge, driver.viscosity)
    };
    scene.interactions.iter().map(rate).fold(0.0, f64::max)
}

/// The estimate for one surface; `None` where there is no formula.
///
/// `ρ/γ̇ = (1/Ca) max{0.355 (K_s/G + 1)(a/h), 2.65 b (a/h)³}` as measured for method B on icospheres,
/// with `Ca = μγ̇a/G` and `b = κ/(a²G)`: flow and size drop out of it.
fn of_one(surface: &SurfaceScene, mesh: &MeshInfo, viscosity: f64) -> Option<f64> {
    let MeshSource::Shape { family, .. } = surface.source else {
        return None;
    };
    let even = matches!(family, Family::Regular | Family::Smooth | Family::Relaxed);
    let method = surface
        .effects
        .bending
        .as_ref()
        .map(|bending| bending.method);
    let known = method.is_none_or(|method| method == BendingMethod::GompperKroll);
    if !even || !known || surface.effects.tension.is_some() {
        return None;
    }
    let in_plane = surface.effects.elasticity.as_ref();
    let in_plane = in_plane.map_or(0.0, |elasticity| {
        elasticity.law.area_modulus() + elasticity.law.shear_modulus()
    });
    let local_area = surface
        .effects
        .local_area
        .as_ref()
        .map_or(0.0, |local| local.modulus);
    let bending = surface
        .effects
        .bending
        .as_ref()
        .map_or(0.0, |bending| bending.modulus.largest());
    let edge = mean_edge(mesh.area, mesh.triangles);
    let stretch = 0.355 * (in_plane + local_area) / edge;
    let radius = stretch.max(2.65 * bending / edge.powi(3)) / viscosity;
    (radius > 0.0 && radius.is_finite()).then_some(radius)
}
