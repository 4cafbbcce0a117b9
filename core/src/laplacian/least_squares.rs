//! Small dense least squares: column-pivoted Householder QR over reused memory.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, section 5.4.

use crate::real::Real;
use alloc::vec::Vec;

/// The factorisation `A D P = Q R` of a matrix with unit columns after scaling by D, kept so that
/// both the solution and the rows of functionals of it can be had.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastSquares<T> {
    rows: usize,
    columns: usize,
    /// Column after column: Householder vectors below the diagonal, R on and above it.
    matrix: Vec<T>,
    /// The diagonal of R.
    diagonal: Vec<T>,
    /// 2/|v|² of each Householder vector v.
    factors: Vec<T>,
    /// D: what each column was divided by, in its original place.
    scales: Vec<T>,
    /// P: the original place of each column.
    order: Vec<usize>,
    squared_norms: Vec<T>,
}

impl<T: Real> LeastSquares<T> {
    /// Takes a matrix, column after column, through `fill`, and factorises it. Returns
    /// |R_nn| / |R_11|, an estimate of the reciprocal condition; 0 if it has not full rank.
    pub(crate) fn factorise(
        &mut self,
        rows: usize,
        columns: usize,
        fill: impl FnOnce(&mut [T]),
    ) -> T {
        self.rows = rows;
        self.columns = columns;
        self.matrix.resize(rows * columns, T::zero());
        self.diagonal.resize(columns, T::zero());
        self.factors.resize(columns, T::zero());
        self.scales.clear();
        self.squared_norms.clear();
        self.order.clear();
        self.order.extend(0..columns);
        fill(&mut self.matrix);
        for column in self.matrix.chunks_exact_mut(rows) {
            let norm = dot(column, column).sqrt();
            if norm < T::min_positive_value() {
                return T::zero();
            }
            let over = norm.recip();
            for entry in column.iter_mut() {
                *entry *= over;
            }
            self.scales.push(norm);
            self.squared_norms.push(T::one());
        }
        for step in 0..columns {
            self.pivot(step);
            if !self.reflect(step) {
                return T::zero();
            }
        }
        (self.diagonal[columns - 1] / self.diagonal[0]).abs()
    }

    /// Brings the longest of the remaining columns forward.
    fn pivot(&mut self, step: usize) {
        let mut longest = step;
        for column in step + 1..self.columns {
            if self.squared_norms[column] > self.squared_norms[longest] {
                longest = column;
            }
        }
        if longest != step {
            self.order.swap(step, longest);
            self.squared_norms.swap(step, longest);
            let (front, back) = self.matrix.split_at_mut(longest * self.rows);
            front[step * self.rows..][..self.rows].swap_with_slice(&mut back[..self.rows]);
        }
    }

    /// Clears a column below the diagonal and carries the others along; false if it was zero.
    fn reflect(&mut self, step: usize) -> bool {
        let rows = self.rows;
        let (front, back) = self.matrix.split_at_mut((step + 1) * rows);
        let vector = &mut front[step * rows + step..];
        let norm = dot(vector, vector).sqrt();
        if norm < T::min_positive_value() {
            return false;
        }
        // The sign that adds: v₀ = x₀ + sign(x₀)|x|.
        let diagonal = if vector[0] > T::zero() { -norm } else { norm };
        vector[0] -= diagonal;
        let factor = -(diagonal * vector[0]).recip();
        self.diagonal[step] = diagonal;
        self.factors[step] = factor;
        for (offset, column) in back.chunks_exact_mut(rows).enumerate() {
            let tail = &mut column[step..];
            add_scaled(tail, -(factor * dot(vector, tail)), vector);
            let removed = tail[0] * tail[0];
            let squared = &mut self.squared_norms[step + 1 + offset];
            let left = *squared - removed;
            // What a difference of nearly equal numbers leaves is measured anew.
            *squared = if left > *squared * T::constant(1e-3) {
                left
            } else {
                dot(&tail[1..], &tail[1..])
            };
        }
        true
    }

    fn vector(&self, step: usize) -> &[T] {
        &self.matrix[step * self.rows + step..(step + 1) * self.rows]
    }

    fn upper(&self, row: usize, column: usize) -> T {
        self.matrix[column * self.rows + row]
    }

    /// The coefficients, in the original order of the columns, that minimise |A c − b|; `right`
    /// holds b and is overwritten.
    pub(crate) fn solve(&self, right: &mut [T], coefficients: &mut [T]) {
        for step in 0..self.columns {
            let vector = self.vector(step);
            let tail = &mut right[step..];
            add_scaled(tail, -(self.factors[step] * dot(vector, tail)), vector);
        }
        for row in (0..self.columns).rev() {
            let known = right[row + 1..self.columns].iter().enumerate();
            let sum: T = known
                .map(|(k, &entry)| self.upper(row, row + 1 + k) * entry)
                .sum();
            right[row] = (right[row] - sum) / self.diagonal[row];
        }
        for (place, &original) in self.order.iter().enumerate() {
            coefficients[original] = right[place] / self.scales[original];
        }
    }

    /// The row r with `functional · c = r · b` for the solution c of every right-hand side b.
    pub(crate) fn row_of(&self, functional: &[T], row: &mut [T]) {
        let original = |place: usize| self.order[place];
        for place in 0..self.columns {
            let scaled = functional[original(place)] / self.scales[original(place)];
            let above = &self.matrix[place * self.rows..][..place];
            row[place] = (scaled - dot(above, &row[..place])) / self.diagonal[place];
        }
        row[self.columns..].fill(T::zero());
        for step in (0..self.columns).rev() {
            let vector = self.vector(step);
            let tail = &mut row[step..];
            add_scaled(tail, -(self.factors[step] * dot(vector, tail)), vector);
        }
    }
}

/// Scalar product in eight interleaved sums, which map to vector registers.
#[inline(always)]
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let (a_blocks, a_rest) = a.as_chunks::<8>();
    let (b_blocks, b_rest) = b.as_chunks::<8>();
    let mut sums = [T::zero(); 8];
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let mut rest = T::zero();
    for (&a, &b) in a_rest.iter().zip(b_rest) {
        rest += a * b;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    (((a + e) + (b + f)) + ((c + g) + (d + h))) + rest
}

#[inline(always)]
fn add_scaled<T: Real>(target: &mut [T], factor: T, vector: &[T]) {
    for (target, &entry) in target.iter_mut().zip(vector) {
        *target += factor * entry;
    }
}
