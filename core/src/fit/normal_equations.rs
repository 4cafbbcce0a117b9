//! Weighted least-squares fits of polynomials by normal equations, for several vertices at once.
//!
//! Entries of the matrix are moments `Σ w x^a y^b`. A fit of degree d has one moment for each
//! coefficient of a polynomial of degree 2d, far fewer than the matrix has entries, and needs no
//! matrix with a row for each neighbour. The condition number of the matrix is the square of that of
//! the fit. Normal equations therefore serve well-conditioned fits only; one refinement makes their
//! solution as accurate as that of an orthogonal factorisation.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, sections 4.1, 4.2.8 and 5.3; Å. Björck,
//! Linear Algebra Appl. 88/89 (1987) 31 (refinement).

use super::least_squares::dot;
use super::moments::{MONOMIALS, Points, SUMS, coefficient_count, evaluate, place_of, set_moments};
use crate::lane::{Lane, Several};
use crate::real::Real;
use alloc::vec::Vec;

/// Normal equations `Aᵀ W A c = g` of polynomials without constant term.
#[derive(Clone, Debug, Default)]
pub(crate) struct NormalEquations<T> {
    degree: usize,
    /// `Σ w x^a y^b` up to twice the degree.
    moments: Vec<Several<T>>,
    /// `Aᵀ W A = L D Lᵀ`: `lower` is L row by row, with `stride` entries to a row; `scaled` is one row
    /// of L D.
    stride: usize,
    lower: Vec<Several<T>>,
    scaled: Vec<Several<T>>,
    /// D, in order of the monomials: the squared distance of each column from the span of the columns
    /// before it.
    pivots: Vec<Several<T>>,
    over_pivots: Vec<Several<T>>,
    /// Right-hand sides in order of the monomials; the first entry, that of 1, is not used.
    right: Vec<Several<T>>,
    /// Memory with an entry for each point.
    column: Vec<Several<T>>,
    powers: Vec<Several<T>>,
    values: Vec<Several<T>>,
}

impl<T: Real> NormalEquations<T> {
    /// The least distance of a column from the span of the columns before it, relative to its length, at
    /// which the equations are accurate enough.
    pub(crate) fn least_distance() -> T {
        (T::constant(1e3) * T::epsilon()).sqrt()
    }

    /// Whether rounding errors of solutions without refinement may exceed 2e-12, if fits are accepted
    /// whose columns have this least distance.
    pub(crate) fn need_refinement(least: T) -> bool {
        T::epsilon() > T::constant(2e-12) * (least * least)
    }

    /// Sets the matrices and factorises them.
    #[inline(always)]
    pub(crate) fn set(&mut self, degree: usize, points: Points<'_, T>) {
        self.degree = degree;
        self.stride = coefficient_count(degree).next_multiple_of(SUMS);
        self.moments
            .resize(place_of(2 * degree, 2 * degree) + 1, Several::zero());
        self.column.clear();
        self.column.extend_from_slice(points.weights);
        set_moments(
            &mut self.moments,
            2 * degree,
            points,
            &mut self.column,
            &mut self.powers,
        );
        self.factorise(coefficient_count(degree));
    }

    /// The squared distance of each column from the span of the columns before it.
    #[inline(always)]
    pub(crate) fn pivots(&self) -> &[Several<T>] {
        &self.pivots
    }

    /// The entry of the matrix for two monomials.
    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> Several<T> {
        let ((degree, power), (other, others)) = (MONOMIALS[i], MONOMIALS[j]);
        self.moments[place_of(degree + other, power + others)]
    }

    #[inline(always)]
    fn factorise(&mut self, count: usize) {
        let stride = self.stride;
        self.lower.resize(stride * stride, Several::zero());
        self.over_pivots.resize(count, Several::zero());
        self.pivots.clear();
        for i in 0..count {
            let diagonal = self.entry(i, i);
            self.pivots.push(diagonal);
        }
        for j in 0..count {
            let over = self.pivots[j].reciprocal_or_zero();
            self.over_pivots[j] = over;
            self.scaled.clear();
            let row = self.lower[j * stride..][..j].iter().zip(&self.pivots);
            self.scaled
                .extend(row.map(|(&entry, &pivot)| entry * pivot));
            let mut i = j + 1;
            while i < count {
                let mut sums = [Several::zero(); SUMS];
                for (c, sum) in sums.iter_mut().enumerate().take(count - i) {
                    *sum = self.entry(i + c, j);
                }
                let rows = &self.lower[i * stride..];
                let row = |c: usize| &rows[c.min(count - i - 1) * stride..][..j];
                let known = [row(0), row(1), row(2), row(3)];
                let scaled = &self.scaled[..j];
                for k in 0..j {
                    for c in 0..SUMS {
                        sums[c] = sums[c].minus(known[c][k].times(scaled[k]));
                    }
                }
                for (c, &sum) in sums.iter().enumerate().take(count - i) {
                    let entry = sum * over;
                    self.lower[(i + c) * stride + j] = entry;
                    self.pivots[i + c] = self.pivots[i + c] - entry * sum;
                }
                i += SUMS;
            }
        }
    }

    /// Solves `Aᵀ W (A c − z) = f` with heights z and a functional f of the coefficients, and refines
    /// the solutions `refinements` times. Entries that `heights` and `functional` lack count as 0.
    #[inline(always)]
    pub(crate) fn solve(
        &mut self,
        points: Points<'_, T>,
        heights: &[Several<T>],
        functional: &[Several<T>],
        coefficients: &mut [Several<T>],
        refinements: usize,
    ) {
        self.right.clear();
        self.right
            .resize(coefficient_count(self.degree) + 1, Several::zero());
        coefficients.fill(Several::zero());
        for pass in 0..=refinements {
            self.column.clear();
            self.column.extend_from_slice(heights);
            self.column.resize(points.x.len(), Several::zero());
            if pass > 0 {
                evaluate(self.degree, points, coefficients, &mut self.values);
                for (height, &value) in self.column.iter_mut().zip(&self.values) {
                    *height = *height - value;
                }
            }
            if pass > 0 || !heights.is_empty() {
                self.set_right(points);
            }
            for (right, &known) in self.right[1..].iter_mut().zip(functional) {
                *right = *right + known;
            }
            self.add_solution(coefficients);
        }
    }

    /// The weighted sum of the squared residuals of fits to these heights.
    #[inline(always)]
    pub(crate) fn left_of(&mut self, points: Points<'_, T>, heights: &[Several<T>]) -> Several<T> {
        self.column.clear();
        self.column.extend_from_slice(heights);
        self.set_right(points);
        let mut left = Several::zero();
        for (&height, &weight) in heights.iter().zip(points.weights) {
            left = left + weight * height * height;
        }
        self.substitute();
        for (&entry, &over) in self.right[1..].iter().zip(&self.over_pivots) {
            left = left - entry * entry * over;
        }
        left
    }

    /// Sets the right-hand sides from the heights in `column`, which are overwritten.
    #[inline(always)]
    fn set_right(&mut self, points: Points<'_, T>) {
        for (height, &weight) in self.column.iter_mut().zip(points.weights) {
            *height = weight * *height;
        }
        let (right, column) = (&mut self.right, &mut self.column);
        set_moments(right, self.degree, points, column, &mut self.powers);
    }

    /// Replaces the right-hand side r by the solution y of L y = r.
    #[inline(always)]
    fn substitute(&mut self) {
        let right = &mut self.right[1..];
        let rows = self.lower.chunks_exact(self.stride);
        for (i, row) in rows.enumerate().take(right.len()) {
            right[i] = right[i] - dot(&row[..i], &right[..i]);
        }
    }

    /// Adds to `coefficients` the solution for the right-hand side, which is overwritten.
    #[inline(always)]
    fn add_solution(&mut self, coefficients: &mut [Several<T>]) {
        self.substitute();
        let right = &mut self.right[1..];
        let rows = self.lower.chunks_exact(self.stride);
        for (entry, &over) in right.iter_mut().zip(&self.over_pivots) {
            *entry = *entry * over;
        }
        for (i, row) in rows.enumerate().take(right.len()).rev() {
            let last = right[i];
            for (entry, &factor) in right[..i].iter_mut().zip(row) {
                *entry = entry.minus(factor.times(last));
            }
        }
        for (coefficient, &entry) in coefficients.iter_mut().zip(&*right) {
            *coefficient = *coefficient + entry;
        }
    }
}
