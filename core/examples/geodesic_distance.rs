//! Distances along a surface from one of its vertices, by the heat method: heat that diffuses for a
//! short time flows along shortest paths, and the distance is the field whose gradient has length 1
//! and that direction. K. Crane, C. Weischedel and M. Wardetzky, ACM Trans. Graph. 32 (2013) 152.
//!
//! ```console
//! cargo run --release --example geodesic_distance
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

#[path = "shared/solver.rs"]
mod solver;
#[path = "shared/sphere.rs"]
mod sphere;

use helfrich::{Cotangent, DualArea, Serial, SparseMatrix, Surface};
use solver::{dot, solve};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, points) = sphere::sphere(4)?;
    let surface = Surface::new(&mesh, &points)?;
    let source = 0;

    let operator = Cotangent::new(DualArea::Barycentric);
    let mut areas = vec![0.0; points.len()];
    operator.dual_areas(&Serial, surface, &mut areas);
    let mut stiffness = SparseMatrix::new();
    operator.assemble_stiffness(surface, &mut stiffness);

    // Heat from the source after a time of one squared edge length: (A + t S) u = δ.
    let lengths = mesh.edges().iter().map(|&[a, b]| {
        let edge = surface.difference(a, b);
        dot(&edge, &edge).sqrt()
    });
    let edge = lengths.sum::<f64>() / mesh.edges().len() as f64;
    let time = edge * edge;
    let mut diffusion = stiffness.clone();
    diffusion.values_mut().iter_mut().for_each(|s| *s *= time);
    diffusion.add_to_diagonal(&areas);
    let mut heat = vec![0.0; points.len()];
    heat[source] = 1.0;
    // Far away there is little heat, and its direction counts as much as that near the source.
    let heat = solve(&diffusion, &heat, 1e-30);

    // The direction away from the source: −∇u/|∇u|.
    let mut directions = vec![[0.0; 3]; mesh.triangles().len()];
    operator.gradient(&Serial, surface, &heat, &mut directions);
    for direction in &mut directions {
        let length = dot(direction, direction).sqrt();
        *direction = direction.map(|x| -x / length);
    }

    // The field with this gradient, as nearly as there is one: Δ φ = div, so that S φ = −div.
    let mut divergence = vec![0.0; points.len()];
    operator.integrated_divergence(&Serial, surface, &directions, &mut divergence);
    let right: Vec<f64> = divergence.iter().map(|d| -d).collect();
    let mut distance = solve(&stiffness, &right, 1e-10);
    let zero = distance[source];
    distance.iter_mut().for_each(|d| *d -= zero);

    // On the unit sphere the distance is the angle.
    let exact = points
        .iter()
        .map(|point| dot(point, &points[source]).clamp(-1.0, 1.0).acos());
    let errors: Vec<f64> = distance
        .iter()
        .zip(exact)
        .map(|(d, exact)| (d - exact).abs())
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let largest = errors.iter().copied().fold(0.0, f64::max);
    println!(
        "{} vertices, edges of {edge:.3}: mean error {mean:.4}, largest {largest:.4}",
        points.len()
    );
    // The method is of first order.
    assert!(mean < 0.25 * edge && largest < 0.5 * edge);
    Ok(())
}
