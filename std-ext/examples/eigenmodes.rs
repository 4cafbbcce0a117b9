//! The lowest modes of vibration of a surface, `S u = λ M u`, with the stiffness S and the mass M of
//! linear finite elements, by inverse iteration of several fields at once.
//!
//! ```console
//! cargo run --release --example eigenmodes
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

#[path = "shared/solver.rs"]
mod solver;

use helfrich::{Cotangent, Surface};
use helfrich_std::generate::{Family, generate};
use nalgebra::{DMatrix, SymmetricEigen};
use nalgebra_sparse::factorization::CscCholesky;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ball = generate(&"sphere".parse()?, Family::Smooth, 642, 0)?;
    let surface = Surface::new(&ball.mesh, &ball.positions)?;
    let mass = solver::columns(Cotangent::default().mass(surface))?;
    let stiffness = solver::columns(Cotangent::default().stiffness(surface))?;
    // S + M is positive definite, and has the same modes.
    let shifted = CscCholesky::factor(&(&stiffness + &mass))?;

    // Eigenvalues of the unit sphere: l (l + 1), each with multiplicity 2 l + 1.
    let exact = [0.0, 2.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0, 6.0];
    // Fields without order. Each step makes them orthogonal: uᵀ M u = 1.
    let mut modes = DMatrix::from_fn(mass.nrows(), exact.len(), |i, j| {
        ((i * (j + 1)) as f64).sin()
    });
    for _ in 0..15 {
        modes = shifted.solve(&(&mass * modes));
        let SymmetricEigen {
            eigenvalues,
            eigenvectors,
        } = modes.tr_mul(&(&mass * &modes)).symmetric_eigen();
        modes = modes * eigenvectors * DMatrix::from_diagonal(&eigenvalues.map(|u| 1.0 / u.sqrt()));
    }

    let mut found = modes
        .tr_mul(&(&stiffness * &modes))
        .symmetric_eigenvalues()
        .data
        .as_vec()
        .clone();
    found.sort_by(f64::total_cmp);
    for (found, exact) in found.into_iter().zip(exact) {
        println!("{found:8.4}, exactly {exact}");
        // The mesh is off by its squared edge length, 0.02.
        assert!((found - exact).abs() < 2e-2 * (1.0 + exact));
    }
    Ok(())
}
