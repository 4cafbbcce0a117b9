//! The lowest modes of vibration of a surface, `S u = λ M u`, with the stiffness S and the mass M of
//! linear finite elements, by inverse iteration of several fields at once.
//!
//! ```console
//! cargo run --release --example eigenmodes
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
    let (mesh, points) = sphere::sphere(4)?;
    let surface = Surface::new(&mesh, &points)?;
    let operator = Cotangent::default();
    let [mut stiffness, mut mass] = [SparseMatrix::new(), SparseMatrix::new()];
    operator.assemble_stiffness(surface, &mut stiffness);
    operator.assemble_mass(surface, &mut mass);
    // The matrices have the same pattern. S + M is positive definite, and has the same modes.
    let mut shifted = stiffness.clone();
    for (entry, m) in shifted.values_mut().iter_mut().zip(mass.values()) {
        *entry += m;
    }

    // Nine fields of noise, made orthogonal in M after each step.
    let noise = |mode: usize| {
        let vertices = 0..points.len();
        vertices
            .map(|vertex| (vertex * (mode + 1)) as f64)
            .map(f64::sin)
            .collect()
    };
    let mut modes: Vec<Vec<f64>> = (0..9).map(noise).collect();
    for _ in 0..15 {
        for mode in 0..modes.len() {
            let mut field = solve(&shifted, &times(&mass, &modes[mode]), 1e-8);
            for lower in &modes[..mode] {
                let part = dot(&field, &times(&mass, lower));
                field
                    .iter_mut()
                    .zip(lower)
                    .for_each(|(u, l)| *u -= part * l);
            }
            let norm = dot(&field, &times(&mass, &field)).sqrt();
            modes[mode] = field.into_iter().map(|u| u / norm).collect();
        }
    }

    // Of the unit sphere: l (l + 1), each 2 l + 1 times. The mesh is off by its squared edge length.
    let exact = [0.0, 2.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0, 6.0];
    for (mode, exact) in modes.iter().zip(exact) {
        let found = dot(mode, &times(&stiffness, mode));
        println!("{found:8.4}, exactly {exact}");
        assert!((found - exact).abs() < 1e-2 * (1.0 + exact));
    }
    Ok(())
}
