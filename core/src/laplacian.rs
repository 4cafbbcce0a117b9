//! Laplace–Beltrami operators and the curvatures that come with them.
//!
//! Sign: `Δ_S = div_S grad_S`, negative semi-definite; on a sphere `Δ_S x = −2 H n` with `H > 0`.

mod cotangent;
mod finite_elements;
mod heat_kernel;
mod jet;
mod paraboloid;

pub(crate) use cotangent::VertexSums;
pub use cotangent::{Cotangent, CotangentMemory};

pub use heat_kernel::{Bandwidth, HeatKernel, HeatKernelMemory};
pub use jet::{Jet, JetMemory};
pub(crate) use jet::{JetPoint, LocalPolynomial};
pub use paraboloid::{Paraboloid, ParaboloidMemory};

pub use crate::curvature::Curvature;
pub use crate::neighbourhood::Surroundings;

use crate::curvature::Curvatures;
use crate::element::{Execution, Ragged, Strided};
use crate::method::Workspace;
use crate::real::{Real, finite_or_zero};
use crate::sparse_matrix::SparseMatrix;
use crate::surface::Surface;
use alloc::vec;
use alloc::vec::Vec;

/// A discrete Laplace–Beltrami operator: pointwise values, 1/length² times the field's unit.
///
/// Laws: a constant field gives exactly zero; curvatures and results follow rotations,
/// translations and relabellings; curvatures scale as 1/length (H) and 1/length² (K).
/// Each operator says whether it is symmetric in the inner product of its areas.
///
/// [`Curvatures::curvatures`] measures the surface, and leaves in the workspace what
/// [`Self::apply`] and [`Self::assemble`] need for it.
pub trait LaplaceBeltrami<T: Real>: Curvatures<T> {
    /// Sets `laplacian` to `Δ_S field`, for a field of D numbers per vertex, on the surface that
    /// was measured last.
    ///
    /// # Panics
    /// If `field` or `laplacian` have fewer entries than the surface has vertices, the surface has
    /// another mesh than that of the workspace, or no surface has been measured with it.
    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    );

    /// Sets `laplacian` to `Δ_S field`, for a scalar field.
    ///
    /// # Panics
    /// As [`Self::apply`].
    fn apply_to_scalar(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        field: &[T],
        laplacian: &mut [T],
    ) {
        let (field, laplacian) = (field.as_chunks().0, laplacian.as_chunks_mut().0);
        self.apply::<1>(execution, surface, workspace, field, laplacian);
    }

    /// Sets `laplacian` to Δ_S of κ(H − H0), of which `field` has the values and `factor(i)` is κ at vertex i,
    /// for the operator's own H: [`Self::apply_to_scalar`], unless the operator knows more about its H than
    /// the values at the vertices.
    ///
    /// # Panics
    /// As [`Self::apply`].
    fn apply_to_mean(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        (field, _factor): (&[T], impl Fn(usize) -> T + Sync),
        laplacian: &mut [T],
    ) {
        self.apply_to_scalar(execution, surface, workspace, field, laplacian);
    }

    /// Fills `rows` with the operator of the surface that was measured last. Previous contents of
    /// `rows` are overwritten; the memory is reused, and the pattern too if it has not changed.
    ///
    /// # Panics
    /// If the surface has another mesh than that of the workspace, or no surface has been measured
    /// with it.
    fn assemble(&self, surface: Surface<'_, T>, workspace: &Workspace<T, Self>, rows: &mut Rows<T>);
}

/// Refuses to apply an operator that has measured no surface.
#[inline]
#[track_caller]
fn expect_measured(measured: usize, surface_vertices: usize) {
    assert!(
        measured == surface_vertices,
        "the operator has measured no surface with this workspace: call its method `curvatures` \
         before `apply` and `assemble`"
    );
}

/// A matrix in compressed rows without its diagonal:
/// `(Δ φ)_i = Σ_j c_ij (φ_j − φ_i)`, so that constants give exactly zero.
///
/// [`Self::fill_matrix`] turns it into a [`SparseMatrix`], with the diagonal.
///
/// A row may have room for more entries than it holds, so that an operator whose neighbours move
/// with the positions can be refilled without allocation.
#[derive(Debug, Default, PartialEq)]
pub struct Rows<T> {
    offsets: Vec<usize>,
    lengths: Vec<u32>,
    columns: Vec<u32>,
    coefficients: Vec<T>,
}

impl<T: Clone> Clone for Rows<T> {
    fn clone(&self) -> Self {
        Self {
            offsets: self.offsets.clone(),
            lengths: self.lengths.clone(),
            columns: self.columns.clone(),
            coefficients: self.coefficients.clone(),
        }
    }

    /// Reuses the memory of `self`, unlike a derived `clone_from`.
    fn clone_from(&mut self, source: &Self) {
        self.offsets.clone_from(&source.offsets);
        self.lengths.clone_from(&source.lengths);
        self.columns.clone_from(&source.columns);
        self.coefficients.clone_from(&source.coefficients);
    }
}

/// The length, the columns and the coefficients of each row.
type RowSlots<'a, T> = (&'a mut [u32], (Strided<'a, u32>, Strided<'a, T>));

/// The same for rows with different capacities.
type RaggedRowSlots<'a, T> = (&'a mut [u32], (Ragged<'a, u32>, Ragged<'a, T>));

impl<T: Real> Rows<T> {
    /// No rows; the first assembly makes them.
    pub fn new() -> Self {
        Self::default()
    }

    /// Copies other rows, and reuses memory that is large enough, unlike a derived `clone_from`.
    fn copy_from(&mut self, other: &Self) {
        self.offsets.clone_from(&other.offsets);
        self.lengths.clone_from(&other.lengths);
        self.columns.clone_from(&other.columns);
        self.coefficients.clone_from(&other.coefficients);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.lengths.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.lengths.is_empty()
    }

    /// The columns j and coefficients c_ij of row i.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> (&[u32], &[T]) {
        let start = self.offsets[row];
        let range = start..start + self.lengths[row] as usize;
        (&self.columns[range.clone()], &self.coefficients[range])
    }

    /// The coefficients of row i, to change in place.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row_mut(&mut self, row: usize) -> &mut [T] {
        let start = self.offsets[row];
        &mut self.coefficients[start..start + self.lengths[row] as usize]
    }

    /// The coefficient c_ii = −Σ_j c_ij that the form without diagonal implies.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn diagonal(&self, row: usize) -> T {
        -self.row(row).1.iter().copied().sum::<T>()
    }

    /// Sets `result` to the product with a field of D numbers per vertex.
    ///
    /// # Panics
    /// If `field` or `result` have fewer entries than there are rows.
    pub fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        field: &[[T; D]],
        result: &mut [[T; D]],
    ) {
        execution.map(&mut result[..self.len()], |row, result| {
            let (columns, coefficients) = self.row(row);
            let mut sum = [T::zero(); D];
            for (&column, &coefficient) in columns.iter().zip(coefficients) {
                for k in 0..D {
                    sum[k] += coefficient * (field[column as usize][k] - field[row][k]);
                }
            }
            *result = finite_or_zero(sum);
        });
    }

    /// Sets `result` to the product with a scalar field.
    ///
    /// # Panics
    /// If `field` or `result` have fewer entries than there are rows.
    pub fn apply_to_scalar(&self, execution: &impl Execution, field: &[T], result: &mut [T]) {
        self.apply::<1>(execution, field.as_chunks().0, result.as_chunks_mut().0);
    }

    /// Fills `matrix` with these rows and their diagonal: the columns of a row in increasing order,
    /// and minus the sum of the row as its diagonal entry. Memory of `matrix` is reused.
    ///
    /// The form without diagonal maps constants to exactly 0, the matrix to their rounding.
    pub fn fill_matrix(&self, matrix: &mut SparseMatrix<T>) {
        matrix.reset(self.len(), |row| self.row(row).0);
        for row in 0..self.len() {
            let (columns, coefficients) = self.row(row);
            for (&column, &coefficient) in columns.iter().zip(coefficients) {
                matrix.add(row, column as usize, coefficient);
            }
        }
        matrix.close_rows();
    }

    /// Makes room for `rows` rows of up to `capacity` entries each, all empty, and returns for each
    /// row its length, columns and coefficients, to be set in any order.
    fn slots(&mut self, rows: usize, capacity: usize) -> RowSlots<'_, T> {
        self.offsets.clear();
        self.offsets.extend((0..=rows).map(|row| row * capacity));
        self.lengths.clear();
        self.lengths.resize(rows, 0);
        if self.columns.len() != rows * capacity {
            // From the system, which has zeros at no cost where none of them is ever used.
            self.columns = vec![0; rows * capacity];
            self.coefficients = vec![T::zero(); rows * capacity];
        }
        let columns = Strided::new(&mut self.columns, capacity);
        let coefficients = Strided::new(&mut self.coefficients, capacity);
        (&mut self.lengths, (columns, coefficients))
    }

    /// Makes room for rows of up to `offsets[i + 1] − offsets[i]` entries, all empty, and returns
    /// for each row its length, columns and coefficients, to be set in any order.
    fn ragged_slots(&mut self, offsets: &[usize]) -> RaggedRowSlots<'_, T> {
        self.offsets.clear();
        self.offsets.extend_from_slice(offsets);
        let entries = offsets.last().copied().unwrap_or(0);
        self.lengths.clear();
        self.lengths.resize(offsets.len().saturating_sub(1), 0);
        self.columns.resize(entries, 0);
        self.coefficients.resize(entries, T::zero());
        let columns = Ragged::new(&mut self.columns, &self.offsets);
        let coefficients = Ragged::new(&mut self.coefficients, &self.offsets);
        (&mut self.lengths, (columns, coefficients))
    }

    /// Removes all rows and keeps the memory, to be filled by [`Self::push`] and [`Self::end_row`].
    fn clear(&mut self) {
        self.offsets.clear();
        self.offsets.push(0);
        self.lengths.clear();
        self.columns.clear();
        self.coefficients.clear();
    }

    /// Adds an entry to the current row.
    fn push(&mut self, column: u32, coefficient: T) {
        self.columns.push(column);
        self.coefficients.push(coefficient);
    }

    /// Ends the current row.
    fn end_row(&mut self) {
        let start = self.offsets.last().copied().unwrap_or(0);
        self.lengths.push((self.columns.len() - start) as u32);
        self.offsets.push(self.columns.len());
    }

    /// Sets the pattern of row i to `columns[offsets[i] .. offsets[i + 1]]`, unless it is the same
    /// already, and sets all coefficients to zero.
    fn reset(&mut self, offsets: &[u32], columns: &[u32]) {
        let offsets = offsets.iter().map(|&offset| offset as usize);
        if !offsets.clone().eq(self.offsets.iter().copied()) || self.columns != columns {
            self.offsets.clear();
            self.offsets.extend(offsets);
            self.columns.clear();
            self.columns.extend_from_slice(columns);
            self.lengths.clear();
            let lengths = self
                .offsets
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) as u32);
            self.lengths.extend(lengths);
        }
        self.coefficients.clear();
        self.coefficients.resize(columns.len(), T::zero());
    }
}
