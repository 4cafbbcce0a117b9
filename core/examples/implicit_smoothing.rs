//! Smooths a colour on a surface by one implicit step of diffusion, `(A + t S) u = A u₀`, with the
//! stiffness S and the areas A of the cotangent operator.
//!
//! ```console
//! cargo run --release --example implicit_smoothing
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

#[path = "shared/solver.rs"]
mod solver;
#[path = "shared/sphere.rs"]
mod sphere;

use helfrich::{Cotangent, DualArea, Serial, SparseMatrix, Surface};
use solver::{dot, solve, times};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, points) = sphere::sphere(4)?;
    let surface = Surface::new(&mesh, &points)?;
    // On the unit sphere −Δ_S z = 2 z: diffusion only scales this colour.
    let colour: Vec<f64> = points.iter().map(|point| point[2]).collect();

    let operator = Cotangent::new(DualArea::Barycentric);
    let mut areas = vec![0.0; points.len()];
    operator.dual_areas(&Serial, surface, &mut areas);
    let mut matrix = SparseMatrix::new();
    operator.assemble_stiffness(surface, &mut matrix);
    let time = 0.3;
    matrix.values_mut().iter_mut().for_each(|s| *s *= time);
    matrix.add_to_diagonal(&areas);

    let right: Vec<f64> = colour.iter().zip(&areas).map(|(u, a)| u * a).collect();
    let smooth = solve(&matrix, &right, 1e-10);

    // One implicit step takes u to u/(1 + 2 t); the mesh is off by its squared edge length.
    let (found, expected) = (
        dot(&smooth, &right) / dot(&colour, &right),
        1.0 / (1.0 + 2.0 * time),
    );
    println!("the colour is left with {found:.5} of itself, exactly {expected:.5}");
    assert!((found / expected - 1.0).abs() < 1e-2);
    // The integral of a colour stays.
    let before: f64 = right.iter().sum();
    let after = dot(&times(&matrix, &smooth), &vec![1.0; points.len()]);
    assert!((after - before).abs() < 1e-8);
    Ok(())
}
