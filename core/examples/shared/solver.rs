//! A solver for the examples. Any sparse solver takes the arrays of the matrix; the documentation of
//! `SparseMatrix` has the line for each.

use helfrich::{Serial, SparseMatrix};

/// The scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The product of a matrix with a field.
pub(crate) fn times(matrix: &SparseMatrix<f64>, field: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; field.len()];
    matrix.apply_to_scalar(&Serial, field, &mut product);
    product
}

/// Solves `matrix · x = right` by conjugate gradients, with the diagonal as preconditioner, until the
/// residual has fallen by the factor `tolerance`. The matrix is symmetric and positive definite; or
/// semi-definite, and then `right` is orthogonal to the fields that it maps to zero.
pub(crate) fn solve(matrix: &SparseMatrix<f64>, right: &[f64], tolerance: f64) -> Vec<f64> {
    let precondition = |residual: &[f64]| -> Vec<f64> {
        let rows = residual.iter().enumerate();
        rows.map(|(row, r)| r / matrix.diagonal(row)).collect()
    };
    let (mut solution, mut residual) = (vec![0.0; right.len()], right.to_vec());
    let mut direction = precondition(&residual);
    let mut square = dot(&residual, &direction);
    let end = tolerance * tolerance * square;
    while square > end {
        let product = times(matrix, &direction);
        let step = square / dot(&direction, &product);
        for row in 0..right.len() {
            solution[row] += step * direction[row];
            residual[row] -= step * product[row];
        }
        let preconditioned = precondition(&residual);
        let next = dot(&residual, &preconditioned);
        for (direction, r) in direction.iter_mut().zip(preconditioned) {
            *direction = r + next / square * *direction;
        }
        square = next;
    }
    solution
}
