//! Smooths a colour on a surface by one implicit step of diffusion, `(M + t S) u = M u₀`, with the
//! stiffness S and the consistent mass M of linear finite elements.
//!
//! ```console
//! cargo run --release --example implicit_smoothing
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

#[path = "shared/solver.rs"]
mod solver;

use helfrich::{Cotangent, Surface};
use helfrich_std::generate::{Family, generate};
use nalgebra::DVector;
use nalgebra_sparse::factorization::CscCholesky;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ball = generate(&"sphere".parse()?, Family::Smooth, 642, 0)?;
    let surface = Surface::new(&ball.mesh, &ball.positions)?;
    let (elements, time) = (Cotangent::default(), 0.3);
    let mass = solver::columns(elements.mass(surface))?;
    let stiffness = solver::columns(elements.stiffness(surface))?;

    // On the unit sphere −Δ_S z = 2 z: diffusion only scales this colour.
    let heights = ball.positions.iter().map(|point| point[2]);
    let colour = DVector::from_iterator(mass.nrows(), heights);
    let step = CscCholesky::factor(&(&mass + stiffness * time))?;
    let smooth = step.solve(&(&mass * &colour));

    // One implicit step takes u to u/(1 + 2 t); the mesh is off by its squared edge length, 0.02.
    let error = (smooth * (1.0 + 2.0 * time) - &colour).amax();
    println!("the largest error of a colour from -1 to 1 is {error:.1e}");
    assert!(error < 2e-2);
    Ok(())
}
