//! Normal equations of regressions, from moments `Σ w² x^a y^b` of the weighted points.
//!
//! A matrix of degree d has as many different entries as a polynomial of degree 2d has coefficients, far
//! fewer than a column for each monomial has. Its condition number is that of the fit squared.

use super::Model;
use crate::fit::{MONOMIALS, Points, cholesky, place_of, set_moments};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::vec3::{Vec3, dot};
use alloc::vec::Vec;

/// Weighted points in a tangent plane, [`WIDTH`] of them at a time.
#[derive(Clone, Debug, Default)]
pub(super) struct Moments<T> {
    x: Vec<Several<T>>,
    y: Vec<Several<T>>,
    /// w², 0 in the places after the last point.
    weights: Vec<Several<T>>,
    column: Vec<Several<T>>,
    powers: Vec<Several<T>>,
    partial: Vec<Several<T>>,
    sums: Vec<T>,
    /// The factors of the matrix.
    lower: Vec<T>,
    pivots: Vec<T>,
    over_pivots: Vec<T>,
}

impl<T: Real> Moments<T> {
    /// Sets the points by their offsets from the vertex and their weights w.
    #[inline(always)]
    pub(super) fn place(&mut self, offsets: &[Vec3<T>], weights: &[T], frame: [Vec3<T>; 2]) {
        let lanes = offsets.len().div_ceil(WIDTH);
        let [along_x, along_y] = frame;
        let coordinates = [(&mut self.x, along_x), (&mut self.y, along_y)];
        for (lane, axis) in coordinates {
            lane.clear();
            lane.resize(lanes, Several::zero());
            let entries = lane.iter_mut().flat_map(|lane| &mut lane.0);
            for (entry, &offset) in entries.zip(offsets) {
                *entry = dot(offset, axis);
            }
        }
        self.weights.clear();
        self.weights.resize(lanes, Several::zero());
        let entries = self.weights.iter_mut().flat_map(|lane| &mut lane.0);
        for (entry, &weight) in entries.zip(weights) {
            *entry = weight * weight;
        }
    }

    /// The sums `Σ w² v x^a y^b` over the points up to a degree, in order of the monomials; without
    /// values v, these are 1.
    #[inline(always)]
    pub(super) fn sums(&mut self, degree: usize, values: Option<&[T]>) -> &[T] {
        self.set_sums(degree, values);
        &self.sums
    }

    #[inline(always)]
    fn set_sums(&mut self, degree: usize, values: Option<&[T]>) {
        self.column.clear();
        self.column.extend_from_slice(&self.weights);
        if let Some(values) = values {
            let entries = self.column.iter_mut().flat_map(|lane| &mut lane.0);
            for (entry, &value) in entries.zip(values) {
                *entry *= value;
            }
        }
        let count = place_of(degree, degree) + 1;
        self.partial.resize(count, Several::zero());
        let points = Points {
            x: &self.x,
            y: &self.y,
            weights: &self.weights,
        };
        let (column, powers) = (&mut self.column, &mut self.powers);
        set_moments(&mut self.partial[..count], degree, points, column, powers);
        self.sums.clear();
        let partial = self.partial[..count].iter();
        self.sums
            .extend(partial.map(|lane| lane.0.iter().copied().sum::<T>()));
    }

    /// Sets `upper` to the factor R of `Rᵀ R = D Aᵀ W² A D`, row by row with `D = diag(scales)`, each row
    /// followed by its part of the heights, and returns the smallest entry on its diagonal; 0 if the matrix
    /// is not positive definite.
    #[inline(always)]
    pub(super) fn set_upper(
        &mut self,
        model: &Model<T>,
        heights: &[T],
        scales: &mut Vec<T>,
        upper: &mut Vec<T>,
    ) -> T {
        let count = model.columns();
        let width = count + 1;
        upper.clear();
        upper.resize(count * width, T::zero());
        let monomial = |place: usize| match place {
            0 => (0, 0),
            _ => MONOMIALS[place - 1],
        };
        self.set_sums(2 * model.degree, None);
        let sums = &self.sums;
        let entry = |i: usize, j: usize| {
            let ((degree, power), (other, others)) = (monomial(i), monomial(j));
            sums[place_of(degree + other, power + others)]
        };
        scales.clear();
        scales.extend((0..count).map(|k| entry(k, k).sqrt().reciprocal_or_zero()));
        self.lower.resize(cholesky::row_start(count), T::zero());
        self.pivots.resize(count, T::zero());
        self.over_pivots.resize(count, T::zero());
        let scaled = |i: usize, j: usize| entry(i, j) * scales[i] * scales[j];
        let (lower, pivots) = (&mut self.lower, &mut self.pivots);
        cholesky::factorise(scaled, lower, pivots, &mut self.over_pivots);
        if !pivots.iter().all(|&pivot| T::zero() < pivot) {
            return T::zero();
        }
        let least = pivots
            .iter()
            .fold(T::one(), |least, &pivot| least.min(pivot));
        for (k, &pivot) in pivots.iter().enumerate() {
            let norm = pivot.sqrt();
            upper[k * width + k] = norm;
            for i in k + 1..count {
                upper[k * width + i] = lower[cholesky::row_start(i) + k] * norm;
            }
        }
        self.set_sums(model.degree, Some(heights));
        let right = &mut self.sums[..];
        for (entry, &scale) in right.iter_mut().zip(&*scales) {
            *entry *= scale;
        }
        cholesky::substitute(&self.lower, right);
        for (k, &entry) in right.iter().enumerate() {
            upper[k * width + count] = entry / upper[k * width + k];
        }
        least.sqrt()
    }

    /// Sets each of `rows` to `w² p` at the points, with the polynomials p given by their coefficients.
    #[inline(always)]
    pub(super) fn evaluate<const F: usize>(
        &self,
        degree: usize,
        coefficients: &[[T; F]],
        rows: &mut [Vec<T>; F],
    ) {
        for row in rows.iter_mut() {
            row.resize(self.x.len() * WIDTH, T::zero());
        }
        let points = self.x.iter().zip(&self.y).zip(&self.weights);
        for (lane, ((&x, &y), &weight)) in points.enumerate() {
            let mut values = [Several::zero(); F];
            for a in (0..=degree).rev() {
                let mut parts = [Several::zero(); F];
                for b in (0..=degree - a).rev() {
                    let terms = &coefficients[place_of(a + b, b)];
                    for (part, &term) in parts.iter_mut().zip(terms) {
                        *part = *part * y + Several::splat(term);
                    }
                }
                for (value, part) in values.iter_mut().zip(parts) {
                    *value = *value * x + part;
                }
            }
            for (row, value) in rows.iter_mut().zip(values) {
                row[lane * WIDTH..][..WIDTH].copy_from_slice(&(weight * value).0);
            }
        }
    }
}
