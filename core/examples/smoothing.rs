//! Smooths a noisy mesh of glam's f32 points in two ways: by mean-curvature flow, which shrinks it,
//! and by Willmore flow, which does not: it follows the bending force.
//!
//! ```console
//! cargo run --release --example smoothing --features glam
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use glam::Vec3;
use helfrich::{
    Cotangent, DualArea, GompperKroll, Prepared, Serial, Subdivision, Surface, TriangleMesh,
};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, smooth) = ball(3)?;
    // The same noise every time.
    let noise = |vertex: usize| (12.9898 * vertex as f32).sin() * 43_758.547 % 0.03;
    let noisy = smooth.iter().enumerate();
    let noisy: Vec<Vec3> = noisy.map(|(v, point)| point * (1.0 + noise(v))).collect();

    let shrunk = mean_curvature_flow(&mesh, noisy.clone(), 4e-4, 40)?;
    let relaxed = willmore_flow(&mesh, noisy.clone(), 2e-6, 2000)?;

    let mut bending = Prepared::new(GompperKroll::new(1.0_f32), &mesh);
    let mut found = Vec::new();
    println!("{:20} {:>10} {:>10}", "", "E/8πκ", "volume");
    for (name, points) in [
        ("noisy", &noisy),
        ("mean-curvature flow", &shrunk),
        ("Willmore flow", &relaxed),
    ] {
        let surface = Surface::new(&mesh, points)?;
        let energy = bending.energy(surface) / (8.0 * std::f32::consts::PI);
        let volume = surface.volume().ok_or("the mesh is not closed")?;
        println!("{name:20} {energy:>10.4} {volume:>10.4}");
        found.push([energy, volume]);
    }
    // Both end near a sphere, with E = 8πκ; only the first loses volume on the way.
    assert!(found[0][0] > 1.2 && found[1][0] < 1.05 && found[2][0] < 1.05);
    assert!(found[1][1] < 0.97 * found[0][1] && found[2][1] > 0.98 * found[0][1]);
    Ok(())
}

/// Each vertex goes along Δ_S x = −2 H n.
fn mean_curvature_flow(
    mesh: &TriangleMesh,
    mut points: Vec<Vec3>,
    time_step: f32,
    steps: usize,
) -> Result<Vec<Vec3>, Box<dyn Error>> {
    // Memory is taken once: no step allocates.
    let mut operator = Prepared::new(Cotangent::new(DualArea::Mixed), mesh);
    for _ in 0..steps {
        let surface = Surface::new(mesh, &points)?;
        let curvature = operator.curvatures(surface);
        for (point, vertex) in points.iter_mut().zip(curvature) {
            *point -= time_step * 2.0 * vertex.mean * Vec3::from(vertex.normal);
        }
    }
    Ok(points)
}

/// Each vertex goes along the bending force over its area.
fn willmore_flow(
    mesh: &TriangleMesh,
    mut points: Vec<Vec3>,
    time_step: f32,
    steps: usize,
) -> Result<Vec<Vec3>, Box<dyn Error>> {
    let mut bending = Prepared::new(GompperKroll::new(1.0_f32), mesh);
    let operator = Cotangent::new(DualArea::Mixed);
    let mut areas = vec![0.0; points.len()];
    let mut force = vec![[0.0; 3]; points.len()];
    for _ in 0..steps {
        let surface = Surface::new(mesh, &points)?;
        operator.dual_areas(&Serial, surface, &mut areas);
        force.fill([0.0; 3]);
        bending.add_force(surface, &mut force);
        for ((point, force), area) in points.iter_mut().zip(&force).zip(&areas) {
            *point += time_step / area * Vec3::from(*force);
        }
    }
    Ok(points)
}

/// A sphere of radius 1: an octahedron, refined, its vertices put on the sphere.
fn ball(levels: u32) -> Result<(TriangleMesh, Vec<Vec3>), Box<dyn Error>> {
    let corners = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
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
    let on_sphere = points.map(Vec3::normalize).collect();
    Ok((refined.into_mesh(), on_sphere))
}
