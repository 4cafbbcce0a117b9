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

use helfrich::{Cotangent, Serial, Surface};
use helfrich_std::{
    generate::{Family, generate},
    info::mean_edge,
};
use nalgebra::{DVector, Vector3};
use nalgebra_sparse::factorization::CscCholesky;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ball = generate(&"sphere".parse()?, Family::Smooth, 642, 0)?;
    let surface = Surface::new(&ball.mesh, &ball.positions)?;
    let (elements, size) = (Cotangent::default(), ball.positions.len());
    let mut source = DVector::zeros(size);
    source[0] = 1.0;

    // Heat from vertex 0, after a time of one squared edge length: (A + t S) u = δ.
    let edge = mean_edge(surface.area(), ball.mesh.triangles().len());
    let mut areas = vec![0.0; size];
    elements.dual_areas(&Serial, surface, &mut areas);
    let mut diffusion = elements.stiffness(surface);
    for entry in diffusion.values_mut() {
        *entry *= edge * edge;
    }
    diffusion.add_to_diagonal(&areas);
    let heat = CscCholesky::factor(&solver::columns(diffusion)?)?.solve(&source);

    // The direction away from the vertex: −∇u/|∇u|.
    let mut directions = vec![[0.0; 3]; ball.mesh.triangles().len()];
    elements.gradient(&Serial, surface, heat.as_slice(), &mut directions);
    for direction in &mut directions {
        *direction = (-Vector3::from(*direction).normalize()).into();
    }

    // The field with this gradient, as nearly as there is one: S φ = −div, and 0 at the vertex.
    let mut divergence = DVector::zeros(size);
    elements.integrated_divergence(&Serial, surface, &directions, divergence.as_mut_slice());
    let mut stiffness = elements.stiffness(surface);
    stiffness.add_to_diagonal(source.as_slice());
    let distance = CscCholesky::factor(&solver::columns(stiffness)?)?.solve(&-divergence);

    // On the unit sphere the distance is the angle.
    let pole = Vector3::from(ball.positions[0]);
    let angle = |point: &[f64; 3]| pole.angle(&Vector3::from(*point));
    let exact = DVector::from_iterator(size, ball.positions.iter().map(angle));
    let error = (distance.column(0) - exact).amax();
    println!("{size} vertices, edges of {edge:.3}: largest error {error:.4}");
    // The method is of first order.
    assert!(error < 0.5 * edge);
    Ok(())
}
