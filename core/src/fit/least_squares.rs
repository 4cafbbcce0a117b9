//! Small dense least squares, several at once: column-pivoted Householder QR over reused memory.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, section 5.4.
//!
//! Each entry is a lane that holds the entries of several matrices. All matrices undergo the same
//! operations; only the pivots differ. Sums run over the rows in their order, so that neither rows
//! of zeros, which pad shorter matrices, nor the other matrices change any bit.

use super::cholesky::dot;
use crate::lane::{Lane, Several, WIDTH, Wide};
use crate::real::Real;
use alloc::vec::Vec;
use core::array;

/// Number of columns that are transformed together: their sums are independent, so that none waits
/// for another.
const COLUMNS: usize = 4;

/// The factorisations `A D P = Q R`, with D scaling columns to unit length. They are kept so that
/// both solutions and rows of functionals can be computed.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastSquares<T> {
    rows: usize,
    columns: usize,
    /// Column by column: R above the diagonal, Householder vectors from the diagonal on; then the
    /// right-hand side, which becomes Qᵀb.
    matrix: Vec<Several<T>>,
    /// The diagonal of R, and 1 over it: 0 where it is 0.
    diagonal: Vec<Several<T>>,
    over_diagonal: Vec<Several<T>>,
    /// −2/|v|² of each Householder vector v.
    factors: Vec<Several<T>>,
    /// D: 1 over the length of each column, in its original place.
    scales: Vec<Several<T>>,
    /// P: the original place of each column.
    order: Vec<[u32; WIDTH]>,
    squared_norms: Vec<Several<T>>,
    /// A row.
    vector: Vec<Several<T>>,
}

impl<T: Real> LeastSquares<T> {
    /// Memory for matrices with at least as many rows as columns, and their right-hand sides:
    /// entries column by column, all of which have to be set.
    #[inline(always)]
    pub(crate) fn matrix(&mut self, rows: usize, columns: usize) -> &mut [Several<T>] {
        self.rows = rows;
        self.columns = columns;
        self.matrix.resize(rows * (columns + 1), Several::zero());
        &mut self.matrix
    }

    /// Factorises the matrices and transforms the right-hand sides. Returns |R_nn| / |R_11| of
    /// each, an estimate of the reciprocal condition number, or 0 without full rank.
    #[inline(always)]
    pub(crate) fn factorise(&mut self) -> Several<T> {
        let (rows, columns) = (self.rows, self.columns);
        self.diagonal.resize(columns, Several::zero());
        self.over_diagonal.resize(columns, Several::zero());
        self.factors.resize(columns, Several::zero());
        self.scales.resize(columns, Several::zero());
        self.squared_norms.resize(columns, Several::zero());
        self.order.resize(columns, [0; WIDTH]);
        for place in 0..columns {
            let column = &mut self.matrix[place * rows..][..rows];
            let over = dot(column, column).sqrt().reciprocal_or_zero();
            for entry in column.iter_mut() {
                *entry = *entry * over;
            }
            self.scales[place] = over;
            let extended = Several::zero().less(over);
            self.squared_norms[place] = Several::select(extended, Several::literal(1.0), over);
            self.order[place] = [place as u32; WIDTH];
        }
        for step in 0..columns {
            self.pivot(step);
            self.reflect(step);
        }
        let ratio = self.diagonal[columns - 1] * self.over_diagonal[0];
        Several::select(ratio.less(Several::zero()), -ratio, ratio)
    }

    /// Moves the longest of the remaining columns forward, separately for each matrix.
    #[inline(always)]
    fn pivot(&mut self, step: usize) {
        let rows = self.rows;
        let mut longest = self.squared_norms[step];
        let mut pivots = [step as u32; WIDTH];
        for place in step + 1..self.columns {
            let norm = self.squared_norms[place];
            for (k, pivot) in pivots.iter_mut().enumerate() {
                let longer = norm.0[k] > longest.0[k];
                longest.0[k] = if longer { norm.0[k] } else { longest.0[k] };
                *pivot = if longer { place as u32 } else { *pivot };
            }
        }
        let (front, back) = self.matrix.split_at_mut((step + 1) * rows);
        let column = &mut front[step * rows..];
        for (k, &pivot) in pivots.iter().enumerate() {
            let pivot = pivot as usize;
            if pivot == step {
                continue;
            }
            let (now, then) = (self.order[step][k], self.order[pivot][k]);
            (self.order[step][k], self.order[pivot][k]) = (then, now);
            self.squared_norms[pivot].0[k] = self.squared_norms[step].0[k];
            let other = &mut back[(pivot - step - 1) * rows..][..rows];
            for (a, b) in column.iter_mut().zip(other) {
                (a.0[k], b.0[k]) = (b.0[k], a.0[k]);
            }
        }
    }

    /// Clears a column below the diagonal and transforms the others.
    #[inline(always)]
    fn reflect(&mut self, step: usize) {
        let rows = self.rows;
        let (front, back) = self.matrix.split_at_mut((step + 1) * rows);
        let vector = &mut front[step * rows + step..];
        let norm = dot(vector, vector).sqrt();
        // The sign without cancellation: v₀ = x₀ + sign(x₀)|x|.
        let first = vector[0];
        let diagonal = Several::select(Several::zero().less(first), -norm, norm);
        let first = first - diagonal;
        vector[0] = first;
        let factor = (diagonal * first).reciprocal_or_zero();
        self.diagonal[step] = diagonal;
        self.over_diagonal[step] = diagonal.reciprocal_or_zero();
        self.factors[step] = factor;
        let norms = &mut self.squared_norms[step + 1..];
        let mut blocks = back.chunks_exact_mut(COLUMNS * rows);
        for block in &mut blocks {
            carry::<T, COLUMNS>(vector, factor, block);
        }
        let left = blocks.into_remainder();
        match left.len() / rows {
            3 => carry::<T, 3>(vector, factor, left),
            2 => carry::<T, 2>(vector, factor, left),
            1 => carry::<T, 1>(vector, factor, left),
            _ => {}
        }
        for (column, norm) in back.chunks_exact(rows).zip(norms) {
            *norm = left_of(&column[step..], *norm);
        }
    }

    /// Sets the coefficients, in the original order of the columns, that minimise |A c − b|.
    #[inline(always)]
    pub(crate) fn solve(&mut self, coefficients: &mut [Several<T>]) {
        let (front, result) = self.matrix.split_at_mut(self.columns * self.rows);
        for place in (0..self.columns).rev() {
            let found = result[place] * self.over_diagonal[place];
            let above = &front[place * self.rows..][..place];
            for (entry, &upper) in result.iter_mut().zip(above) {
                *entry = *entry - upper * found;
            }
            for k in 0..WIDTH {
                let original = self.order[place][k] as usize;
                coefficients[original].0[k] = found.0[k] * self.scales[original].0[k];
            }
        }
    }

    /// The rows r with `functional · c = r · b` for the solutions c of every right-hand side b.
    #[inline(always)]
    pub(crate) fn row_of(&mut self, functional: &[Several<T>]) -> &mut [Several<T>] {
        self.vector.clear();
        self.vector.resize(self.rows, Several::zero());
        let result = &mut self.vector[..];
        for place in 0..self.columns {
            let mut sum = Several::zero();
            for k in 0..WIDTH {
                let original = self.order[place][k] as usize;
                sum.0[k] = functional[original].0[k] * self.scales[original].0[k];
            }
            let above = &self.matrix[place * self.rows..][..place];
            for (&upper, &known) in above.iter().zip(&*result) {
                sum = sum - upper * known;
            }
            result[place] = sum * self.over_diagonal[place];
        }
        for step in (0..self.columns).rev() {
            let vector = &self.matrix[step * self.rows..][step..self.rows];
            let tail = &mut result[step..];
            let along = self.factors[step] * dot(vector, tail);
            for (entry, &across) in tail.iter_mut().zip(vector) {
                *entry = *entry + along * across;
            }
        }
        result
    }
}

/// Reflects `C` columns in the rows of the Householder vector, which are the last.
#[inline(always)]
fn carry<T: Real, const C: usize>(
    vector: &[Several<T>],
    factor: Several<T>,
    mut columns: &mut [Several<T>],
) {
    let (rows, left) = (columns.len() / C, vector.len());
    let mut tails: [&mut [Several<T>]; C] = array::from_fn(|_| Default::default());
    for tail in &mut tails {
        let (column, others) = columns.split_at_mut(rows);
        *tail = &mut column[rows - left..][..left];
        columns = others;
    }
    let mut sums = [Several::<T>::zero(); C];
    for row in 0..left {
        for c in 0..C {
            sums[c] = sums[c].plus(vector[row].times(tails[c][row]));
        }
    }
    for sum in &mut sums {
        *sum = factor * *sum;
    }
    for row in 0..left {
        let across = vector[row];
        for c in 0..C {
            tails[c][row] = tails[c][row].plus(sums[c].times(across));
        }
    }
}

/// The squared norms of the remaining columns without their first entries; `norms` has those with
/// the first entries.
#[inline(always)]
fn left_of<T: Real>(columns: &[Several<T>], norms: Several<T>) -> Several<T> {
    let mut left = norms - columns[0] * columns[0];
    // A difference of nearly equal numbers has lost its digits: the norm is computed again.
    let least = norms * Several::literal(1e-3);
    let mut any = false;
    for k in 0..WIDTH {
        any |= left.0[k] <= least.0[k];
    }
    if any {
        let measured = dot(&columns[1..], &columns[1..]);
        left = Several::select(least.less(left), left, measured);
    }
    left
}
