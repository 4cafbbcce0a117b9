//! Smooths a colour on a surface by implicit diffusion: `(M + t L) u = M u₀` with the assembled
//! stiffness L and the areas M of the cotangent operator, solved by conjugate gradients. Any sparse
//! solver takes the same rows.
//!
//! ```console
//! cargo run --release --example implicit_smoothing
//! ```
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use helfrich::{Cotangent, DualArea, Method, Rows, Serial, Subdivision, Surface, TriangleMesh};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let corners = [
        [1.0, 1.0, 1.0],
        [-1.0, -1.0, 1.0],
        [-1.0, 1.0, -1.0],
        [1.0, -1.0, -1.0],
    ];
    let solid = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    let refined = Subdivision::new(&solid, 5)?;
    // On the unit sphere, where −Δ_S z = 2 z: diffusion only scales this colour.
    let points: Vec<[f64; 3]> = refined
        .refine(&corners)
        .into_iter()
        .map(|point: [f64; 3]| {
            let length = point.iter().map(|x| x * x).sum::<f64>().sqrt();
            point.map(|x| x / length)
        })
        .collect();
    let mesh = refined.into_mesh();
    let surface = Surface::new(&mesh, &points)?;

    let operator = Cotangent::new(DualArea::Barycentric);
    let workspace = operator.workspace(&mesh);
    let mut stiffness = Rows::new();
    operator.assemble_stiffness(surface, &workspace, &mut stiffness);
    let mut areas = vec![0.0; points.len()];
    operator.dual_areas(&Serial, surface, &mut areas);

    let time = 0.3;
    let colour: Vec<f64> = points.iter().map(|point| point[2]).collect();
    let right: Vec<f64> = colour.iter().zip(&areas).map(|(u, a)| u * a).collect();
    let (smooth, iterations) = solve(&stiffness, &areas, time, &right, 1e-10);

    // One implicit step takes u to u/(1 + 2 t); the mesh is off by its squared edge length.
    let expected = 1.0 / (1.0 + 2.0 * time);
    let product: f64 = smooth.iter().zip(&right).map(|(u, v)| u * v).sum();
    let square: f64 = colour.iter().zip(&right).map(|(u, v)| u * v).sum();
    let found = product / square;
    println!(
        "{} vertices, {iterations} iterations: the colour is left with {found:.5} of itself, exactly {expected:.5}",
        points.len()
    );
    assert!((found / expected - 1.0).abs() < 1e-2);
    Ok(())
}

/// Solves `(M + t L) u = b` by conjugate gradients, with the matrix's diagonal as preconditioner.
/// `rows` hold −L without its diagonal, as all operators do: `Σ_j c_ij (u_j − u_i)`.
fn solve(rows: &Rows<f64>, areas: &[f64], t: f64, b: &[f64], tolerance: f64) -> (Vec<f64>, usize) {
    let size = b.len();
    let diagonal: Vec<f64> = (0..size)
        .map(|row| areas[row] - t * rows.diagonal(row))
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let precondition = |residual: &[f64]| -> Vec<f64> {
        residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect()
    };
    let mut product = vec![0.0; size];
    let mut solution = vec![0.0; size];
    let mut residual = b.to_vec();
    let mut preconditioned = precondition(&residual);
    let mut direction = preconditioned.clone();
    let mut square = dot(&residual, &preconditioned);
    let end = tolerance * tolerance * square;
    for iteration in 0..size {
        if square <= end {
            return (solution, iteration);
        }
        rows.apply_to_scalar(&Serial, &direction, &mut product);
        for ((product, &u), &area) in product.iter_mut().zip(&direction).zip(areas) {
            *product = area * u - t * *product;
        }
        let step = square / dot(&direction, &product);
        for row in 0..size {
            solution[row] += step * direction[row];
            residual[row] -= step * product[row];
        }
        preconditioned = precondition(&residual);
        let next = dot(&residual, &preconditioned);
        for (direction, r) in direction.iter_mut().zip(&preconditioned) {
            *direction = r + next / square * *direction;
        }
        square = next;
    }
    (solution, size)
}
