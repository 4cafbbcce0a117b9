//! A capsule in a flow solver of one's own: the solver gives velocities for forces, the library forces
//! for positions. Here the solver is the simplest there is for Stokes flow, regularised Stokeslets
//! (R. Cortez, L. Fauci, A. Medovikov, Phys. Fluids 17 (2005) 031504), with Euler's steps.
//!
//! ```console
//! cargo run --release --example own_solver --features glam
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use glam::DVec3;
use helfrich::{GompperKroll, InPlane, NeoHookean, Prepared, Subdivision, Surface, TriangleMesh};
use std::error::Error;
use std::f64::consts::PI;

/// μγ̇a/G of a capsule of radius a = 1 with shear modulus G = 1 in a fluid of viscosity μ = 1.
const SHEAR_RATE: f64 = 0.15;
/// κ/(a²G).
const BENDING: f64 = 0.1125;

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, mut points) = ball(3)?;
    // Without stress as it starts; a pair of effects is their sum, resolved when it is compiled.
    let elastic = InPlane::new(
        NeoHookean { shear_modulus: 1.0 },
        &mesh,
        Surface::new(&mesh, &points)?,
    )?;
    let bending = GompperKroll::new(BENDING);
    let mut membrane = Prepared::new((elastic, bending), &mesh);

    // A membrane's forces are spread over about half an edge.
    let area = Surface::new(&mesh, &points)?.area();
    let spread = 0.4 * (area / points.len() as f64).sqrt();
    let (strain, time_step) = (4.0, 0.01);
    let steps = (strain / (SHEAR_RATE * time_step)) as usize;
    let mut force = vec![[0.0; 3]; points.len()];
    let mut velocities = vec![DVec3::ZERO; points.len()];
    for step in 0..=steps {
        if step % (steps / 8) == 0 {
            let strain = SHEAR_RATE * time_step * step as f64;
            println!("γ̇t = {strain:.2}  D = {:.4}", deformation(&points));
        }
        force.fill([0.0; 3]);
        membrane.add_force(Surface::new(&mesh, &points)?, &mut force);
        flow(&points, &force, spread, &mut velocities);
        for (point, velocity) in points.iter_mut().zip(&velocities) {
            *point += time_step * *velocity;
        }
    }
    // The boundary integrals of helfrich-std come to 0.1335; this solver is a coarse one.
    let found = deformation(&points);
    assert!((found / 0.1335 - 1.0).abs() < 0.1, "{found}");
    Ok(())
}

/// The shear flow, and what the forces add to it at the points.
fn flow(points: &[DVec3], force: &[[f64; 3]], spread: f64, velocities: &mut [DVec3]) {
    let square = spread * spread;
    for (at, velocity) in points.iter().zip(velocities) {
        let mut sum = DVec3::ZERO;
        for (point, &force) in points.iter().zip(force) {
            let (apart, force) = (*at - *point, DVec3::from(force));
            let distance = (apart.length_squared() + square).sqrt();
            let near = force * (distance * distance + square) + apart * apart.dot(force);
            sum += near / distance.powi(3);
        }
        *velocity = DVec3::new(SHEAR_RATE * at.y, 0.0, 0.0) + sum / (8.0 * PI);
    }
}

/// Taylor's D = (L − B)/(L + B), by the extreme distances in the plane of the shear.
fn deformation(points: &[DVec3]) -> f64 {
    let width = |angle: f64| {
        let direction = DVec3::new(angle.cos(), angle.sin(), 0.0);
        points
            .iter()
            .map(|point| point.dot(direction))
            .fold(0.0, f64::max)
    };
    let widths = (0..180).map(|degree| width(PI * f64::from(degree) / 180.0));
    let (longest, shortest) = widths.fold((0.0, f64::INFINITY), |(l, b): (f64, f64), width| {
        (l.max(width), b.min(width))
    });
    (longest - shortest) / (longest + shortest)
}

/// A sphere of radius 1: an octahedron, refined, its vertices put on the sphere.
fn ball(levels: u32) -> Result<(TriangleMesh, Vec<DVec3>), Box<dyn Error>> {
    let corners = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ];
    let triangles = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    let refined = Subdivision::new(&TriangleMesh::new(6, triangles)?, levels)?;
    let points = refined.refine_points(&corners).into_iter();
    let on_sphere = points.map(DVec3::normalize).collect();
    Ok((refined.into_mesh(), on_sphere))
}
