//! Weighted least-squares fits of polynomials by normal equations, for several vertices at once.
//!
//! Entries of the matrix are moments `Σ w x^a y^b`. A fit of degree d has one moment for each
//! coefficient of a polynomial of degree 2d, far fewer than the matrix has entries, and needs no
//! matrix with a row for each neighbour. The condition number of the matrix is the square of that of
//! the fit. Normal equations therefore serve well-conditioned fits only; one refinement makes their
//! solution as accurate as that of an orthogonal factorisation.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, section 5.3; Å. Björck, Linear Algebra Appl. 88/89 (1987) 31 (refinement).

use super::cholesky;
use super::moments::{MONOMIALS, Points, coefficient_count, evaluate, place_of, set_moments};
use crate::lane::{Lane, Several};
use crate::real::Real;
use alloc::vec::Vec;

/// Normal equations `Aᵀ W A c = g` of polynomials without constant term.
#[derive(Clone, Debug, Default)]
pub(crate) struct NormalEquations<T> {
    degree: usize,
    /// `Σ w x^a y^b` up to twice the degree.
    moments: Vec<Several<T>>,
    /// L of `Aᵀ W A = L D Lᵀ`.
    lower: Vec<Several<T>>,
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
        let count = coefficient_count(degree);
        self.lower
            .resize(cholesky::row_start(count), Several::zero());
        self.pivots.resize(count, Several::zero());
        self.over_pivots.resize(count, Several::zero());
        let moments = &self.moments;
        let entry = |i: usize, j: usize| {
            let ((degree, power), (other, others)) = (MONOMIALS[i], MONOMIALS[j]);
            moments[place_of(degree + other, power + others)]
        };
        let (pivots, over_pivots) = (&mut self.pivots, &mut self.over_pivots);
        cholesky::factorise(entry, &mut self.lower, pivots, over_pivots);
    }

    /// The squared distance of each column from the span of the columns before it.
    #[inline(always)]
    pub(crate) fn pivots(&self) -> &[Several<T>] {
        &self.pivots
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
        cholesky::substitute(&self.lower, &mut self.right[1..]);
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

    /// Adds to `coefficients` the solution for the right-hand side, which is overwritten.
    #[inline(always)]
    fn add_solution(&mut self, coefficients: &mut [Several<T>]) {
        let right = &mut self.right[1..];
        cholesky::solve(&self.lower, &self.over_pivots, right);
        for (coefficient, &entry) in coefficients.iter_mut().zip(&*right) {
            *coefficient = *coefficient + entry;
        }
    }
}
