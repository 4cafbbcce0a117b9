//! A sparse matrix as solvers take it: compressed rows with the diagonal.

use crate::element::Execution;
use crate::real::Real;
use alloc::vec::Vec;

/// A square sparse matrix in compressed rows (CSR).
///
/// Row i has the entries k from `row_offsets[i]` up to `row_offsets[i + 1]`, each with its column
/// `column_indices[k]` and its value `values[k]`. Columns increase within a row, and every row has
/// its diagonal entry, even if that is 0. The pattern depends on which vertices are neighbours and
/// not on values: a solver can keep its symbolic factorisation as long as neighbours stay.
///
/// [`Cotangent::assemble_stiffness`](crate::Cotangent::assemble_stiffness) and
/// [`Cotangent::assemble_mass`](crate::Cotangent::assemble_mass) fill matrices of equal pattern, so
/// that their linear combinations are those of their values. [`Rows::fill_matrix`](crate::Rows::fill_matrix)
/// does it for the rows of any operator.
///
/// # For solvers
///
/// With `size = matrix.size()` and `(offsets, columns, values) = matrix.into_parts()`:
///
/// * `nalgebra-sparse`: `CsrMatrix::try_from_csr_data(size, size, offsets, columns, values)?`
/// * `sprs`: `CsMat::new((size, size), offsets, columns, values)`
/// * `faer`: `SparseRowMat::new(SymbolicSparseRowMat::new_checked(size, size, offsets, None, columns), values)`
/// * SciPy: `scipy.sparse.csr_matrix((values, columns, offsets), shape=(size, size))` with the arrays
///   as NumPy arrays
///
/// Solvers that take triplets have [`Self::triplets`]. A symmetric matrix has the same arrays in
/// compressed columns (CSC).
///
/// ```
/// use helfrich::{Cotangent, Surface, TriangleMesh};
///
/// let mesh = TriangleMesh::new(3, vec![[0, 1, 2]])?;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let stiffness = Cotangent::default().stiffness(Surface::new(&mesh, &points)?);
///
/// assert_eq!(stiffness.row_offsets(), [0, 3, 6, 9]);
/// assert_eq!(stiffness.column_indices(), [0, 1, 2, 0, 1, 2, 0, 1, 2]);
/// assert_eq!(stiffness.values(), [1.0, -0.5, -0.5, -0.5, 0.5, 0.0, -0.5, 0.0, 0.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseMatrix<T> {
    row_offsets: Vec<usize>,
    column_indices: Vec<usize>,
    values: Vec<T>,
}

impl<T: Real> SparseMatrix<T> {
    /// A matrix without rows, to be filled. Memory is reused when it is filled again.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of rows, which is the number of columns.
    pub fn size(&self) -> usize {
        self.row_offsets.len().saturating_sub(1)
    }

    /// The place of the first entry of each row, and the number of entries at the end; empty before
    /// the matrix is first filled.
    pub fn row_offsets(&self) -> &[usize] {
        &self.row_offsets
    }

    /// The column of each entry, increasing within a row.
    pub fn column_indices(&self) -> &[usize] {
        &self.column_indices
    }

    /// The value of each entry.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The value of each entry, to change in place: to scale a matrix, or to add another one of the
    /// same pattern.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Row offsets, column indices and values, without a copy.
    pub fn into_parts(self) -> (Vec<usize>, Vec<usize>, Vec<T>) {
        (self.row_offsets, self.column_indices, self.values)
    }

    /// The columns and values of row i.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> (&[usize], &[T]) {
        let range = self.row_offsets[row]..self.row_offsets[row + 1];
        (&self.column_indices[range.clone()], &self.values[range])
    }

    /// An iterator over all entries as `(row, column, value)`, row by row, in the order of
    /// [`Self::values`].
    pub fn triplets(&self) -> impl Iterator<Item = (usize, usize, T)> + '_ {
        (0..self.size()).flat_map(|row| {
            let (columns, values) = self.row(row);
            let entries = columns.iter().zip(values);
            entries.map(move |(&column, &value)| (row, column, value))
        })
    }

    /// The value of the diagonal entry of row i.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn diagonal(&self, row: usize) -> T {
        self.values[self.place(row, row)]
    }

    /// Adds one number to the diagonal entry of each row, such as areas, the diagonal of a lumped
    /// mass matrix.
    ///
    /// # Panics
    /// If `diagonal` has fewer entries than there are rows.
    pub fn add_to_diagonal(&mut self, diagonal: &[T]) {
        for (row, &value) in diagonal[..self.size()].iter().enumerate() {
            let place = self.place(row, row);
            self.values[place] += value;
        }
    }

    /// Sets `result` to the product with a field of D numbers per row.
    ///
    /// # Panics
    /// If `field` or `result` have fewer entries than there are rows.
    pub fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        field: &[[T; D]],
        result: &mut [[T; D]],
    ) {
        execution.map(&mut result[..self.size()], |row, result| {
            let (columns, values) = self.row(row);
            *result = [T::zero(); D];
            for (&column, &value) in columns.iter().zip(values) {
                for k in 0..D {
                    result[k] += value * field[column][k];
                }
            }
        });
    }

    /// Sets `result` to the product with a scalar field.
    ///
    /// # Panics
    /// If `field` or `result` have fewer entries than there are rows.
    pub fn apply_to_scalar(&self, execution: &impl Execution, field: &[T], result: &mut [T]) {
        self.apply::<1>(execution, field.as_chunks().0, result.as_chunks_mut().0);
    }

    /// Gives row i the columns `neighbours(i)`, different from each other and from i, and the
    /// diagonal; sets all values to zero.
    pub(crate) fn reset<'a>(&mut self, rows: usize, neighbours: impl Fn(usize) -> &'a [u32]) {
        self.row_offsets.clear();
        self.row_offsets.push(0);
        self.column_indices.clear();
        for row in 0..rows {
            let start = self.column_indices.len();
            self.column_indices.push(row);
            let columns = neighbours(row).iter().map(|&column| column as usize);
            self.column_indices.extend(columns);
            self.column_indices[start..].sort_unstable();
            self.row_offsets.push(self.column_indices.len());
        }
        self.values.clear();
        self.values.resize(self.column_indices.len(), T::zero());
    }

    /// Adds to an entry of the pattern.
    pub(crate) fn add(&mut self, row: usize, column: usize, value: T) {
        let place = self.place(row, column);
        self.values[place] += value;
    }

    /// Sets each diagonal entry to minus the sum of the other entries of its row, which are added in
    /// the order of their columns.
    pub(crate) fn close_rows(&mut self) {
        for row in 0..self.size() {
            let diagonal = self.place(row, row);
            let (columns, values) = self.row(row);
            let entries = columns.iter().zip(values);
            let others = entries.filter(|&(&column, _)| column != row);
            let sum: T = others.map(|(_, &value)| value).sum();
            self.values[diagonal] = -sum;
        }
    }

    /// The place of an entry among all.
    fn place(&self, row: usize, column: usize) -> usize {
        let start = self.row_offsets[row];
        let columns = &self.column_indices[start..self.row_offsets[row + 1]];
        match columns.binary_search(&column) {
            Ok(place) => start + place,
            Err(_) => panic!("row {row} has no entry in column {column}"),
        }
    }
}
