//! Solves Poisson's equation `−Δ_S u = f` on a closed surface with linear finite elements:
//! `S u = M f`, with the stiffness S and the consistent mass M.
//!
//! ```console
//! cargo run --release --example poisson
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

#[path = "shared/solver.rs"]
mod solver;
#[path = "shared/sphere.rs"]
mod sphere;

use helfrich::{Cotangent, SparseMatrix, Surface};
use solver::{dot, solve, times};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut before = f64::INFINITY;
    for levels in 2..=4 {
        let (mesh, points) = sphere::sphere(levels)?;
        let surface = Surface::new(&mesh, &points)?;
        let operator = Cotangent::default();
        let [mut stiffness, mut mass] = [SparseMatrix::new(), SparseMatrix::new()];
        operator.assemble_stiffness(surface, &mut stiffness);
        operator.assemble_mass(surface, &mut mass);
        let ones = vec![1.0; points.len()];
        let weights = times(&mass, &ones);
        // There is a solution if the integral of f is zero, and it is known up to a constant.
        let without_mean = |field: &[f64]| -> Vec<f64> {
            let mean = dot(field, &weights) / dot(&ones, &weights);
            field.iter().map(|value| value - mean).collect()
        };

        // A spherical harmonic of degree 2: −Δ_S u = 6 u.
        let exact: Vec<f64> = points
            .iter()
            .map(|&[x, y, z]| 3.0 * z * z - 1.0 + x * y)
            .collect();
        let density: Vec<f64> = exact.iter().map(|u| 6.0 * u).collect();
        let right = times(&mass, &without_mean(&density));
        let solution = without_mean(&solve(&stiffness, &right, 1e-10));

        let difference: Vec<f64> = solution
            .iter()
            .zip(&exact)
            .map(|(u, exact)| u - exact)
            .collect();
        let norm = |field: &[f64]| dot(field, &times(&mass, field)).sqrt();
        let error = norm(&difference) / norm(&exact);
        println!("{} vertices: relative error {error:.1e}", points.len());
        // Second order: a quarter of the error with edges of half the length.
        assert!(error < before / 3.5, "{error} after {before}");
        before = error;
    }
    assert!(before < 1e-2);
    Ok(())
}
