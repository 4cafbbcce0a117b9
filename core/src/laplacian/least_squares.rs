//! Small dense least squares: column-pivoted Householder QR over reused memory.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, section 5.4.

use crate::real::Real;
use alloc::vec::Vec;

/// Numbers that are computed at once: columns are padded with zeros to a multiple of it, and what is
/// done to them starts at a multiple, so that nothing is left over to be done one by one.
const BLOCK: usize = 8;

/// The factorisation `A D P = Q R` of a matrix with unit columns after scaling by D, kept so that
/// both the solution and the rows of functionals of it can be had.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastSquares<T> {
    rows: usize,
    columns: usize,
    /// The number of rows, padded.
    height: usize,
    /// Column after column: Householder vectors, 0 above the diagonal and in the padding.
    matrix: Vec<T>,
    /// Column after column: R above the diagonal.
    upper: Vec<T>,
    /// The diagonal of R.
    diagonal: Vec<T>,
    /// 2/|v|² of each Householder vector v.
    factors: Vec<T>,
    /// D: what each column was divided by, in its original place.
    scales: Vec<T>,
    /// P: the original place of each column.
    order: Vec<usize>,
    squared_norms: Vec<T>,
    /// A right-hand side or a row, padded.
    vector: Vec<T>,
}

impl<T: Real> LeastSquares<T> {
    /// Room for a matrix: its entries column after column, and how far apart columns start. All
    /// have to be set, but for those in the padding.
    #[inline(always)]
    pub(crate) fn matrix(&mut self, rows: usize, columns: usize) -> (&mut [T], usize) {
        self.rows = rows;
        self.columns = columns;
        self.height = rows.next_multiple_of(BLOCK);
        self.matrix.resize(self.height * columns, T::zero());
        (&mut self.matrix, self.height)
    }

    /// Factorises the matrix. Returns |R_nn| / |R_11|, an estimate of the reciprocal condition; 0 if it
    /// has not full rank.
    #[inline(always)]
    pub(crate) fn factorise(&mut self) -> T {
        let columns = self.columns;
        self.upper.resize(columns * columns, T::zero());
        self.diagonal.resize(columns, T::zero());
        self.factors.resize(columns, T::zero());
        self.scales.clear();
        self.squared_norms.clear();
        self.order.clear();
        self.order.extend(0..columns);
        for column in self.matrix.chunks_exact_mut(self.height) {
            column[self.rows..].fill(T::zero());
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
    #[inline(always)]
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
            let (front, back) = self.matrix.split_at_mut(longest * self.height);
            front[step * self.height..][..self.height].swap_with_slice(&mut back[..self.height]);
        }
    }

    /// Clears a column below the diagonal and carries the others along; false if it was zero.
    #[inline(always)]
    fn reflect(&mut self, step: usize) -> bool {
        let height = self.height;
        let (front, back) = self.matrix.split_at_mut((step + 1) * height);
        let column = &mut front[step * height..];
        self.upper[step * self.columns..][..step].copy_from_slice(&column[..step]);
        column[..step].fill(T::zero());
        let start = block_of(step);
        let vector = &mut column[start..];
        let norm = dot(vector, vector).sqrt();
        if norm < T::min_positive_value() {
            return false;
        }
        // The sign that adds: v₀ = x₀ + sign(x₀)|x|.
        let first = &mut vector[step - start];
        let diagonal = if *first > T::zero() { -norm } else { norm };
        *first -= diagonal;
        let factor = -(diagonal * *first).recip();
        self.diagonal[step] = diagonal;
        self.factors[step] = factor;
        let carried = Carried {
            vector,
            factor,
            step,
        };
        for (offset, column) in back.chunks_exact_mut(height).enumerate() {
            let norm = &mut self.squared_norms[step + 1 + offset];
            carried.onto(column, norm);
        }
        true
    }

    /// The coefficients, in the original order of the columns, that minimise |A c − b|.
    #[inline(always)]
    pub(crate) fn solve(&mut self, right: &[T], coefficients: &mut [T]) {
        self.vector.clear();
        self.vector.extend_from_slice(right);
        self.vector.resize(self.height, T::zero());
        let result = &mut self.vector[..];
        for step in 0..self.columns {
            let start = block_of(step);
            let vector = &self.matrix[step * self.height..][start..self.height];
            let tail = &mut result[start..];
            add_scaled(tail, -(self.factors[step] * dot(vector, tail)), vector);
        }
        for place in (0..self.columns).rev() {
            let found = result[place] / self.diagonal[place];
            result[place] = found;
            let above = &self.upper[place * self.columns..][..place];
            for (entry, &upper) in result.iter_mut().zip(above) {
                *entry -= upper * found;
            }
        }
        for (place, &original) in self.order.iter().enumerate() {
            coefficients[original] = result[place] / self.scales[original];
        }
    }

    /// The row r with `functional · c = r · b` for the solution c of every right-hand side b.
    #[inline(always)]
    pub(crate) fn row_of(&mut self, functional: &[T], row: &mut [T]) {
        self.vector.clear();
        self.vector.resize(self.height, T::zero());
        let result = &mut self.vector[..];
        for place in 0..self.columns {
            let original = self.order[place];
            let scaled = functional[original] / self.scales[original];
            let above = &self.upper[place * self.columns..][..place];
            let known = above.iter().zip(&*result);
            let sum = known.fold(T::zero(), |sum, (&a, &b)| sum + a * b);
            result[place] = (scaled - sum) / self.diagonal[place];
        }
        for step in (0..self.columns).rev() {
            let start = block_of(step);
            let vector = &self.matrix[step * self.height..][start..self.height];
            let tail = &mut result[start..];
            add_scaled(tail, -(self.factors[step] * dot(vector, tail)), vector);
        }
        row.copy_from_slice(&self.vector[..self.rows]);
    }
}

/// A Householder reflection, of one column that is left after the other.
struct Carried<'a, T> {
    vector: &'a [T],
    factor: T,
    step: usize,
}

impl<T: Real> Carried<'_, T> {
    /// One column; `norm` is the square of what is left of it.
    #[inline(always)]
    fn onto(&self, column: &mut [T], norm: &mut T) {
        let tail = &mut column[block_of(self.step)..];
        let along = -(self.factor * dot(self.vector, tail));
        add_scaled(tail, along, self.vector);
        *norm = self.left(column, *norm);
    }

    /// The square of what is left of a column below this step; it was `norm` before.
    #[inline(always)]
    fn left(&self, column: &[T], norm: T) -> T {
        let removed = column[self.step] * column[self.step];
        let left = norm - removed;
        // What a difference of nearly equal numbers leaves is measured anew.
        if left > norm * T::constant(1e-3) {
            return left;
        }
        let below = block_of(self.step) + BLOCK;
        let blocks = &column[below..];
        let mut sum = dot(blocks, blocks);
        for &entry in &column[self.step + 1..below] {
            sum += entry * entry;
        }
        sum
    }
}

/// Where the block of a row starts.
#[inline(always)]
fn block_of(row: usize) -> usize {
    row / BLOCK * BLOCK
}

/// Scalar product of whole blocks, in as many interleaved sums, which map to vector registers.
#[inline(always)]
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sums = [T::zero(); BLOCK];
    for (a, b) in a
        .as_chunks::<BLOCK>()
        .0
        .iter()
        .zip(b.as_chunks::<BLOCK>().0)
    {
        for k in 0..BLOCK {
            sums[k] += a[k] * b[k];
        }
    }
    total(sums)
}

#[inline(always)]
fn total<T: Real>(sums: [T; BLOCK]) -> T {
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

/// `target += factor vector`, whole blocks.
#[inline(always)]
fn add_scaled<T: Real>(target: &mut [T], factor: T, vector: &[T]) {
    let blocks = target.as_chunks_mut::<BLOCK>().0.iter_mut();
    for (target, vector) in blocks.zip(vector.as_chunks::<BLOCK>().0) {
        // Read as a whole before anything is written: the two might overlap, for all that is known.
        let (mut sum, vector) = (*target, *vector);
        for k in 0..BLOCK {
            sum[k] += factor * vector[k];
        }
        *target = sum;
    }
}
