//! Solves Poisson's equation `−Δ_S u = f` on a closed surface with linear finite elements:
//! `S u = M f`, with the stiffness S and the consistent mass M.
//!
//! ```console
//! cargo run --release --example poisson
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
    let (elements, size) = (Cotangent::default(), ball.positions.len());
    let mass = solver::columns(elements.mass(surface))?;
    // The solution is known up to a constant. An additional 1 on the diagonal makes it 0 there.
    let mut stiffness = elements.stiffness(surface);
    let mut first = DVector::zeros(size);
    first[0] = 1.0;
    stiffness.add_to_diagonal(first.as_slice());
    let stiffness = solver::columns(stiffness)?;

    // A spherical harmonic of degree 2: −Δ_S u = 6 u, and the integral of u is 0.
    let harmonic = |[x, y, z]: [f64; 3]| 3.0 * z * z - 1.0 + x * y;
    let exact = DVector::from_iterator(size, ball.positions.iter().copied().map(harmonic));
    let solution = CscCholesky::factor(&stiffness)?.solve(&(&mass * (&exact * 6.0)));

    let difference = solution.column(0) - &exact;
    let error = difference.add_scalar(-difference.mean()).amax() / exact.amax();
    println!("{size} vertices: largest relative error {error:.1e}");
    // The mesh is off by its squared edge length, 0.02.
    assert!(error < 2e-2);
    Ok(())
}
