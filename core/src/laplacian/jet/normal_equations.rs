//! Weighted least squares of polynomials by normal equations, several at once.
//!
//! Entries of the matrix are moments `Σ w x^a y^b`. A fit of degree d has as many as a polynomial of
//! degree 2d has coefficients, far fewer than entries, and no matrix with a row for each neighbour
//! is needed. The matrix has the squared condition number of the fit, so that these equations
//! serve well-conditioned fits only, and after one refinement solve them as accurately as an
//! orthogonal factorisation.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, sections 4.1, 4.2.8 and 5.3; Å. Björck,
//! Linear Algebra Appl. 88/89 (1987) 31 (refinement).

use super::{HIGHEST_DEGREE, coefficient_count};
use crate::lane::{Lane, Several, WIDTH};
use crate::laplacian::least_squares::dot;
use crate::real::Real;
use alloc::vec::Vec;

/// Number of sums that are computed together: none waits for another.
const SUMS: usize = 4;

/// Number of points whose values are computed together, for the same reason; a number of points is a
/// multiple of it.
pub(super) const TOGETHER: usize = 4;

/// The margin of an estimate of the growth. Estimates were between 0.16 and 5 times the growth of 100 000 fits of
/// degrees 4 and 6, on even, random and strongly uneven meshes, and less than a quarter in one of 1000. The growth of a
/// fit that is accepted by its estimate is therefore at most 1.6 times that of the acceptance, which itself is a bound.
const MARGIN: f64 = 4.0;

/// The place of `x^(degree − power) y^power` among monomials in order of their degrees, 1 first.
pub(crate) const fn place_of(degree: usize, power: usize) -> usize {
    degree * (degree + 1) / 2 + power
}

/// Degree, and power of y, of each monomial without 1.
pub(crate) const MONOMIALS: [(usize, usize); coefficient_count(HIGHEST_DEGREE)] = {
    let mut monomials = [(0, 0); coefficient_count(HIGHEST_DEGREE)];
    let mut degree = 1;
    while degree <= HIGHEST_DEGREE {
        let mut power = 0;
        while power <= degree {
            monomials[place_of(degree, power) - 1] = (degree, power);
            power += 1;
        }
        degree += 1;
    }
    monomials
};

/// Points with weights: coordinates along two axes.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a, T> {
    pub(crate) x: &'a [Several<T>],
    pub(crate) y: &'a [Several<T>],
    pub(crate) weights: &'a [Several<T>],
}

/// The equations `Aᵀ W A c = g` of polynomials of a degree without constant term.
#[derive(Clone, Debug, Default)]
pub(super) struct NormalEquations<T> {
    degree: usize,
    /// `Σ w x^a y^b` up to twice the degree.
    moments: Vec<Several<T>>,
    /// `Aᵀ W A = L D Lᵀ`: L row by row, `stride` to a row, and one row of L D.
    stride: usize,
    lower: Vec<Several<T>>,
    scaled: Vec<Several<T>>,
    pivots: Vec<Several<T>>,
    over_pivots: Vec<Several<T>>,
    definite: [bool; WIDTH],
    /// An estimate of the growth, and the growth where some lane needed it: the largest product of a
    /// diagonal entry of the matrix and the same of its inverse.
    estimate: [T; WIDTH],
    growth: Option<[T; WIDTH]>,
    /// L⁻¹, row by row, with zeros above its diagonal.
    inverse: Vec<Several<T>>,
    /// Number of times that solutions are refined.
    refinements: usize,
    /// Right-hand sides in order of the monomials, 1 first, which does not count.
    right: Vec<Several<T>>,
    /// Memory with an entry for each point.
    column: Vec<Several<T>>,
    powers: Vec<Several<T>>,
    values: Vec<Several<T>>,
    /// Memory for [`Self::determine`]: one matrix.
    rows: Vec<T>,
    left: Vec<T>,
    order: Vec<usize>,
}

impl<T: Real> NormalEquations<T> {
    /// Whether equations of fits that are accepted from this ratio on are accurate enough.
    pub(super) fn serve(least_ratio: T) -> bool {
        least_ratio * least_ratio >= T::constant(1e3) * T::epsilon()
    }

    /// Whether the rounding of solutions without refinement, ε/ratio², may exceed 2e-12 in fits that
    /// are accepted from this ratio on.
    pub(super) fn need_refinement(least_ratio: T) -> bool {
        T::epsilon() > T::constant(2e-12) * (least_ratio * least_ratio)
    }

    /// Sets the matrices and factorises them.
    #[inline(always)]
    pub(super) fn set(&mut self, degree: usize, refined: bool, points: Points<'_, T>) {
        let coefficients = coefficient_count(degree);
        self.degree = degree;
        self.refinements = usize::from(refined);
        self.stride = coefficients.next_multiple_of(SUMS);
        // Whether pivots and the inverse are needed depends on the positions.
        self.inverse
            .resize(self.stride * self.stride, Several::zero());
        self.rows.resize(coefficients * coefficients, T::zero());
        self.left.resize(coefficients, T::zero());
        self.order.resize(coefficients, 0);
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
        self.factorise(coefficients);
        self.growth = None;
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
        self.right.clear();
        self.right.resize(count, Several::zero());
        let mut estimate = Several::zero();
        self.definite = [true; WIDTH];
        for j in 0..count {
            let pivot = self.pivots[j];
            let positive = Several::zero().less(pivot);
            for (definite, positive) in self.definite.iter_mut().zip(positive) {
                *definite &= positive;
            }
            let over = pivot.reciprocal_or_zero();
            self.over_pivots[j] = over;
            // The right-hand side of L y = s has the sign with which y grows, and the scale of the equation.
            let (sum, size) = (self.right[j], self.entry(j, j).sqrt());
            let solution = Several::select(sum.less(Several::zero()), sum - size, sum + size);
            estimate = estimate + solution * solution * over;
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
                        sums[c] = sums[c] - known[c][k] * scaled[k];
                    }
                }
                for (c, &sum) in sums.iter().enumerate().take(count - i) {
                    let entry = sum * over;
                    self.lower[(i + c) * stride + j] = entry;
                    self.pivots[i + c] = self.pivots[i + c] - entry * sum;
                    self.right[i + c] = self.right[i + c] - entry * solution;
                }
                i += SUMS;
            }
        }
        self.estimate = (estimate * Several::literal(1.0 / count as f64)).0;
    }

    /// The growth, from the inverse of L. Not inlined, because the estimate decides nearly always.
    #[inline(never)]
    fn growth(&mut self) -> [T; WIDTH] {
        let (count, stride) = (coefficient_count(self.degree), self.stride);
        self.inverse.clear();
        self.inverse.resize(stride * stride, Several::zero());
        // The diagonal of the inverse matrix.
        self.right.clear();
        self.right.resize(stride, Several::zero());
        for i in 0..count {
            let (known, row) = self.inverse.split_at_mut(i * stride);
            let lower = &self.lower[i * stride..][..i];
            let over = self.over_pivots[i];
            for j in (0..i).step_by(SUMS) {
                let mut sums = [Several::zero(); SUMS];
                for (&factor, known) in lower.iter().zip(known.chunks_exact(stride)).skip(j) {
                    for c in 0..SUMS {
                        sums[c] = sums[c] - factor * known[j + c];
                    }
                }
                for c in 0..SUMS {
                    row[j + c] = sums[c];
                    self.right[j + c] = self.right[j + c] + sums[c] * sums[c] * over;
                }
            }
            row[i] = Several::literal(1.0);
            self.right[i] = self.right[i] + over;
        }
        let mut most = Several::zero();
        for i in 0..count {
            let growth = self.right[i] * self.entry(i, i);
            most = Several::select(growth.less(most), most, growth);
        }
        most.0
    }

    /// Whether |R_nn|/|R_11| of the scaled, pivoted factorisation `W^½ A D P = Q R` is at least
    /// `least` in a lane. Its square is 1 over a diagonal entry of the scaled inverse, so that the
    /// largest of these decides most lanes, and its estimate most of them; the others are factorised
    /// with pivots.
    #[inline(always)]
    pub(super) fn determine(&mut self, lane: usize, least: T) -> bool {
        let least = least * least;
        self.definite[lane]
            && (self.estimate[lane] * least <= T::constant(1.0 / MARGIN)
                || self.growth_of(lane) * least <= T::one()
                || self.pivoted(lane, least))
    }

    #[inline(always)]
    fn growth_of(&mut self, lane: usize) -> T {
        let growth = match self.growth {
            Some(growth) => growth,
            None => self.growth(),
        };
        self.growth = Some(growth);
        growth[lane]
    }

    /// Factorises one matrix with pivots, scaled to ones on its diagonal. Returns whether all pivots
    /// are at least `least`.
    #[inline(never)]
    fn pivoted(&mut self, lane: usize, least: T) -> bool {
        let count = coefficient_count(self.degree);
        let scale = |equations: &Self, i: usize| equations.entry(i, i).0[lane].sqrt();
        self.rows.clear();
        self.rows.resize(count * count, T::zero());
        self.left.clear();
        self.left.resize(count, T::one());
        self.order.clear();
        self.order.extend(0..count);
        for step in 0..count {
            let mut longest = step;
            for place in step + 1..count {
                if self.left[self.order[place]] > self.left[self.order[longest]] {
                    longest = place;
                }
            }
            self.order.swap(step, longest);
            let pivot = self.order[step];
            let left = self.left[pivot];
            // The longest of the columns left is never longer later.
            if !(left > T::zero() && left >= least) {
                return false;
            }
            let (over, scale_of_pivot) = (left.sqrt().recip(), scale(self, pivot));
            for place in step + 1..count {
                let i = self.order[place];
                let mut sum = self.entry(i, pivot).0[lane] / (scale(self, i) * scale_of_pivot);
                let (row, other) = (&self.rows[i * count..], &self.rows[pivot * count..]);
                for (&a, &b) in row[..step].iter().zip(other) {
                    sum -= a * b;
                }
                let entry = sum * over;
                self.rows[i * count + step] = entry;
                self.left[i] -= entry * entry;
            }
        }
        true
    }

    /// Solves `Aᵀ W (A c − z) = f` with heights z and a functional f of the coefficients; shorter
    /// slices are continued by zeros.
    #[inline(always)]
    pub(super) fn solve(
        &mut self,
        points: Points<'_, T>,
        heights: &[Several<T>],
        functional: &[Several<T>],
        coefficients: &mut [Several<T>],
    ) {
        self.right.clear();
        self.right
            .resize(coefficient_count(self.degree) + 1, Several::zero());
        coefficients.fill(Several::zero());
        for pass in 0..=self.refinements {
            self.column.clear();
            self.column.extend_from_slice(heights);
            self.column.resize(points.x.len(), Several::zero());
            if pass > 0 {
                self.evaluate(points, coefficients);
                for (height, &value) in self.column.iter_mut().zip(&self.values) {
                    *height = *height - value;
                }
            }
            if pass > 0 || !heights.is_empty() {
                for (height, &weight) in self.column.iter_mut().zip(points.weights) {
                    *height = weight * *height;
                }
                let (right, column) = (&mut self.right, &mut self.column);
                set_moments(right, self.degree, points, column, &mut self.powers);
            }
            for (right, &known) in self.right[1..].iter_mut().zip(functional) {
                *right = *right + known;
            }
            self.add_solution(coefficients);
        }
    }

    /// Adds to `coefficients` the solution for the right-hand side, which is overwritten.
    #[inline(always)]
    fn add_solution(&mut self, coefficients: &mut [Several<T>]) {
        let right = &mut self.right[1..];
        let rows = self.lower.chunks_exact(self.stride);
        for (i, row) in rows.clone().enumerate().take(right.len()) {
            right[i] = right[i] - dot(&row[..i], &right[..i]);
        }
        for (entry, &over) in right.iter_mut().zip(&self.over_pivots) {
            *entry = *entry * over;
        }
        for (i, row) in rows.enumerate().take(right.len()).rev() {
            let last = right[i];
            for (entry, &factor) in right[..i].iter_mut().zip(row) {
                *entry = *entry - factor * last;
            }
        }
        for (coefficient, &entry) in coefficients.iter_mut().zip(&*right) {
            *coefficient = *coefficient + entry;
        }
    }

    /// The values of polynomials at the points.
    #[inline(always)]
    pub(super) fn evaluate(
        &mut self,
        points: Points<'_, T>,
        coefficients: &[Several<T>],
    ) -> &mut [Several<T>] {
        let degree = self.degree;
        self.values.resize(points.x.len(), Several::zero());
        let (x, y) = (
            points.x.as_chunks::<TOGETHER>().0,
            points.y.as_chunks::<TOGETHER>().0,
        );
        let places = x.iter().zip(y);
        for (values, (x, y)) in self.values.as_chunks_mut().0.iter_mut().zip(places) {
            *values = [Several::zero(); TOGETHER];
            for a in (0..=degree).rev() {
                let mut parts = [Several::zero(); TOGETHER];
                for b in (0..=degree - a).rev() {
                    let place = place_of(a + b, b);
                    // The polynomials have no constant term.
                    let coefficient = if place > 0 {
                        coefficients[place - 1]
                    } else {
                        Several::zero()
                    };
                    for k in 0..TOGETHER {
                        parts[k] = parts[k] * y[k] + coefficient;
                    }
                }
                for k in 0..TOGETHER {
                    values[k] = values[k] * x[k] + parts[k];
                }
            }
        }
        &mut self.values
    }
}

/// Sets `moments` to `Σ c x^a y^b` up to a degree, in order of the monomials. The column c is
/// overwritten; `powers` is scratch memory.
#[inline(always)]
pub(crate) fn set_moments<T: Real>(
    moments: &mut [Several<T>],
    degree: usize,
    points: Points<'_, T>,
    column: &mut [Several<T>],
    powers: &mut Vec<Several<T>>,
) {
    powers.resize(column.len(), Several::zero());
    for a in 0..=degree {
        let mut set = |b: usize, sums: [Several<T>; SUMS]| {
            for (c, &sum) in sums.iter().enumerate().take(degree + 1 - a - b) {
                moments[place_of(a + b + c, b + c)] = sum;
            }
        };
        let mut sums = [Several::zero(); SUMS];
        let next = powers.iter_mut().zip(column.iter_mut());
        for ((power, entry), (&x, &y)) in next.zip(points.x.iter().zip(points.y)) {
            *power = add_powers(&mut sums, *entry, y);
            *entry = *entry * x;
        }
        set(0, sums);
        for b in (SUMS..degree + 1 - a).step_by(SUMS) {
            let mut sums = [Several::zero(); SUMS];
            for (power, &y) in powers.iter_mut().zip(points.y) {
                *power = add_powers(&mut sums, *power, y);
            }
            set(b, sums);
        }
    }
}

/// Adds c, c y, c y² … to the sums, and returns the power after those.
#[inline(always)]
fn add_powers<T: Real>(
    sums: &mut [Several<T>; SUMS],
    mut power: Several<T>,
    y: Several<T>,
) -> Several<T> {
    for sum in sums {
        *sum = *sum + power;
        power = power * y;
    }
    power
}
