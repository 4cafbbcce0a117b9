//! Matrices for `nalgebra-sparse`, the solver of the examples. The documentation of `SparseMatrix` has
//! the line for others.

use helfrich::SparseMatrix;
use nalgebra_sparse::{CscMatrix, SparseFormatError};

/// The matrix in compressed columns: it is symmetric, and its rows are its columns.
pub(crate) fn columns(matrix: SparseMatrix<f64>) -> Result<CscMatrix<f64>, SparseFormatError> {
    let size = matrix.size();
    let (offsets, indices, values) = matrix.into_parts();
    CscMatrix::try_from_csc_data(size, size, offsets, indices, values)
}
