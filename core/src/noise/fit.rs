//! Fits of height functions with columns in the order of their degrees, so that the contribution of
//! each degree to the heights is known.
//!
//! Regressions are solved by normal equations where rounding allows it; other fits are orthogonalised:
//! G. H. Golub and C. F. Van Loan, Matrix Computations, section 5.2 (Gram–Schmidt, modified).

mod moments;
mod spread;

use crate::lane::Lane;
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, dot, normalise, scale, sub, tangent_frame};
use alloc::vec::Vec;
use moments::Moments;

/// Least number of neighbours of a fit, however strongly the surface turns.
const LEAST: usize = 64;

/// Least cosine between the normals of a vertex and of the neighbours beyond these.
const UPRIGHT: f64 = 0.35;

/// Slope of the fitted surface in its frame above which it is fitted again in a frame along its
/// normal.
const LEAN: f64 = 0.1;

/// Number of times a fit is tilted: after the second time the slope is far below [`LEAN`].
const TILTS: usize = 3;

/// Number of partial sums of a scalar product, which do not wait for each other.
const SUMS: usize = 8;

/// Largest number of coefficients: of degree 8, without a constant.
const MOST_COLUMNS: usize = 44;

/// Largest relative rounding error of the solutions of normal equations, ε over the squared least diagonal
/// entry of the triangular factor. In f64 those of all fits that are accepted for measurements are below it,
/// and in f32 none.
const ROUNDING: f64 = 2e-12;

/// A polynomial that is fitted to heights over a tangent plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Model<T> {
    /// Its degree.
    pub(crate) degree: usize,
    /// β of the weights `exp(−β |x_j − x_i|²/ρ²)`, ρ the distance of the farthest neighbour.
    pub(crate) sharpness: T,
    /// Whether it has no constant term, so that it passes through the vertex.
    pub(crate) interpolates: bool,
}

impl<T> Model<T> {
    /// The place of a degree's first column; degree 0 has none if the polynomial interpolates.
    pub(super) fn start(&self, degree: usize) -> usize {
        (degree * (degree + 1) / 2).saturating_sub(usize::from(self.interpolates))
    }

    fn columns(&self) -> usize {
        self.start(self.degree + 1)
    }
}

/// A fit around one vertex: the triangular factor R of `W A D = Q R`, with the weights W, the monomials A and
/// scales D, and the heights in the orthonormal basis Q. The first columns are those of a fit of lower
/// degree.
#[derive(Clone, Debug, Default)]
pub(super) struct HeightFit<T> {
    /// Neighbours' positions relative to the vertex, in radii.
    offsets: Vec<Vec3<T>>,
    radius: T,
    weights: Vec<T>,
    /// Column by column, by rising degree, then the weighted heights; after the fit, Q and the residual
    /// of the heights.
    columns: Vec<T>,
    /// The points, and whether R is of their moments: then there is no Q.
    moments: Moments<T>,
    by_moments: bool,
    /// Memory with an entry for each point.
    values: Vec<T>,
    /// 1 over the original length of each column.
    scales: Vec<T>,
    /// The rows of the triangular factor, each followed by its part of the heights.
    upper: Vec<T>,
    coefficients: Vec<T>,
}

impl<T: Real> HeightFit<T> {
    /// Loads the neighbours of a vertex, which are sorted by distance. A polynomial that does not
    /// interpolate uses the vertex itself, too.
    #[inline(always)]
    pub(super) fn gather(
        &mut self,
        surface: Surface<'_, T>,
        vertex: u32,
        neighbours: &[(T, u32)],
        model: &Model<T>,
    ) {
        self.radius = neighbours.last().map_or(T::zero(), |last| last.0.sqrt());
        let over = self.radius.reciprocal_or_zero();
        self.offsets.clear();
        if !model.interpolates {
            self.offsets.push([T::zero(); 3]);
        }
        let seen = surface.seen_from(vertex);
        let offsets = neighbours.iter();
        self.offsets
            .extend(offsets.map(|&(_, neighbour)| scale(over, seen.difference(neighbour))));
        self.weights.clear();
        let weight = |offset: &Vec3<T>| (-model.sharpness * dot(*offset, *offset)).exp();
        self.weights.extend(self.offsets.iter().map(weight));
    }

    /// Maps the neighbours by `x ↦ (x − b |x|²)/(1 − 2 b·x + |b|² |x|²)`, an inversion between two reflections. It
    /// leaves the vertex and lengths at the vertex as they are, and subtracts the same amount from both principal
    /// curvatures. `bend` is b in inverse radii.
    pub(super) fn invert(&mut self, bend: Vec3<T>) {
        let two = T::constant(2.0);
        for offset in &mut self.offsets {
            let square = dot(*offset, *offset);
            let factor = T::one() - two * dot(bend, *offset) + dot(bend, bend) * square;
            *offset = scale(factor.recip(), sub(*offset, scale(square, bend)));
        }
    }

    /// The sum of squares of the residual of the heights, in squared radii.
    pub(super) fn residual(&self, model: &Model<T>) -> T {
        let residual = &self.columns[model.columns() * self.offsets.len()..];
        product(residual, residual)
    }

    /// The square of the standard error of fourth derivatives, `z_xxxx + 2 z_xxyy + z_yyyy`, of an interpolating
    /// fit, if its residual is noise.
    pub(super) fn squared_error(&self, model: &Model<T>) -> T {
        let mut fourth = [T::zero(); 15];
        for (place, factor) in [(10, 24.0), (12, 8.0), (14, 24.0)] {
            fourth[place] = T::constant(factor);
        }
        let mut rows = [Vec::new()];
        self.rows(model, model.degree, &[fourth], &mut rows);
        let [row] = rows;
        // The height of the vertex itself enters all differences.
        let sum: T = row.iter().copied().sum();
        let [.., [residual, expected]] = self.spectrum(model);
        residual / expected * (product(&row, &row) + sum * sum) / self.radius.powi(8)
    }

    /// Fits heights over the plane of `normal`, which is tilted until the polynomial has almost no
    /// slope there. Returns the smallest diagonal entry of the triangular factor, for columns of length
    /// 1; 0 if there are too few neighbours.
    #[inline(always)]
    pub(super) fn fit(&mut self, normal: &mut Vec3<T>, model: &Model<T>) -> T {
        let columns = model.columns();
        if self.offsets.len() <= columns {
            return T::zero();
        }
        let serves = |least: T| T::epsilon() <= T::constant(ROUNDING) * (least * least);
        let mut least = T::zero();
        for _ in 0..=TILTS {
            let frame = tangent_frame(*normal);
            self.by_moments = !model.interpolates && serves(T::one());
            if self.by_moments {
                self.moments.place(&self.offsets, &self.weights, frame);
                let heights = self.offsets.iter().map(|&offset| dot(offset, *normal));
                self.values.clear();
                self.values.extend(heights);
                let (scales, upper) = (&mut self.scales, &mut self.upper);
                least = self.moments.set_upper(model, &self.values, scales, upper);
                self.by_moments = serves(least);
            }
            if !self.by_moments {
                self.set_columns(*normal, frame, model);
                least = self.factorise(columns);
            }
            if least <= T::zero() {
                break;
            }
            self.solve(columns);
            let first = model.start(1);
            let [p, q] = [0, 1].map(|place| self.coefficients[first + place]);
            if p * p + q * q <= T::constant(LEAN * LEAN) {
                break;
            }
            let along = sub(*normal, scale(p, frame[0]));
            *normal = normalise(sub(along, scale(q, frame[1])));
        }
        least
    }

    /// Sets weighted monomials, degree by degree, and heights.
    #[inline(always)]
    fn set_columns(&mut self, normal: Vec3<T>, frame: [Vec3<T>; 2], model: &Model<T>) {
        let rows = self.offsets.len();
        let columns = model.columns();
        self.columns.clear();
        self.columns.resize(rows * (columns + 1), T::zero());
        let degrees = usize::from(model.interpolates)..=model.degree;
        for (row, (&offset, &weight)) in self.offsets.iter().zip(&self.weights).enumerate() {
            let [x, y] = frame.map(|axis| dot(offset, axis));
            // x^(degree − e) y^e, from the monomials of the degree below.
            let mut monomials = [T::zero(); 10];
            monomials[0] = weight;
            if model.interpolates {
                (monomials[0], monomials[1]) = (weight * x, weight * y);
            }
            for degree in degrees.clone() {
                let start = model.start(degree);
                for (place, &monomial) in monomials[..=degree].iter().enumerate() {
                    self.columns[(start + place) * rows + row] = monomial;
                }
                monomials[degree + 1] = monomials[degree] * y;
                for monomial in &mut monomials[..=degree] {
                    *monomial *= x;
                }
            }
            self.columns[columns * rows + row] = weight * dot(offset, normal);
        }
    }

    /// Makes the columns orthonormal, and transforms the heights.
    #[inline(always)]
    fn factorise(&mut self, columns: usize) -> T {
        let rows = self.offsets.len();
        let width = columns + 1;
        self.upper.clear();
        self.upper.resize(columns * width, T::zero());
        self.scales.clear();
        for column in self.columns.chunks_exact_mut(rows).take(columns) {
            let over = product(column, column).sqrt().reciprocal_or_zero();
            column.iter_mut().for_each(|entry| *entry *= over);
            self.scales.push(over);
        }
        let mut least = T::one();
        for place in 0..columns {
            let (front, back) = self.columns.split_at_mut((place + 1) * rows);
            let column = &mut front[place * rows..];
            let upper = &mut self.upper[place * width + place..];
            let norm = product(column, column).sqrt();
            let over = norm.reciprocal_or_zero();
            column.iter_mut().for_each(|entry| *entry *= over);
            least = least.min(norm);
            upper[0] = norm;
            for (other, upper) in back.chunks_exact_mut(rows).zip(&mut upper[1..]) {
                let along = product(column, other);
                *upper = along;
                for (entry, &unit) in other.iter_mut().zip(&*column) {
                    *entry -= along * unit;
                }
            }
        }
        least
    }

    /// The least diagonal entry that a triangular factor with another order of the columns may have: 1 over the
    /// root of the largest diagonal entry of `(Aᵀ A)⁻¹`, for columns of length 1.
    pub(super) fn conditioning(&self, model: &Model<T>) -> T {
        let columns = model.columns();
        let width = columns + 1;
        let mut squares = [T::zero(); MOST_COLUMNS];
        for column in 0..columns {
            // A column of the inverse of the factor.
            let mut solved = [T::zero(); MOST_COLUMNS];
            solved[column] = self.upper[column * width + column].recip();
            for place in (0..column).rev() {
                let row = &self.upper[place * width..][..column + 1];
                let known = row[place + 1..].iter().zip(&solved[place + 1..]);
                let sum: T = known.map(|(&factor, &known)| factor * known).sum();
                solved[place] = -sum / row[place];
            }
            for (square, solved) in squares.iter_mut().zip(&solved[..=column]) {
                *square += *solved * *solved;
            }
        }
        let most = squares.into_iter().fold(T::zero(), T::max);
        most.sqrt().reciprocal_or_zero()
    }

    /// Sets the coefficients of the monomials, heights and places in radii.
    fn solve(&mut self, columns: usize) {
        let width = columns + 1;
        let mut coefficients = core::mem::take(&mut self.coefficients);
        self.combine(
            columns,
            |place| self.upper[place * width + columns],
            &mut coefficients,
        );
        self.coefficients = coefficients;
    }

    /// Sets the coefficients of the polynomial in the first `count` monomials, given its components
    /// along the orthonormal columns.
    fn combine(&self, count: usize, part: impl Fn(usize) -> T, coefficients: &mut Vec<T>) {
        let width = self.scales.len() + 1;
        coefficients.clear();
        coefficients.resize(count, T::zero());
        for place in (0..count).rev() {
            let upper = &self.upper[place * width..][..count];
            let mut sum = part(place);
            for (&above, &known) in upper[place + 1..].iter().zip(&coefficients[place + 1..]) {
                sum -= above * known;
            }
            coefficients[place] = sum / upper[place];
        }
        for (coefficient, &scale) in coefficients.iter_mut().zip(&self.scales) {
            *coefficient *= scale;
        }
    }

    /// Sets `coefficients` to those of the polynomial of a degree up to the model's, with heights and
    /// positions in radii.
    pub(super) fn coefficients(&self, model: &Model<T>, degree: usize, coefficients: &mut Vec<T>) {
        let columns = model.columns();
        let part = |place: usize| self.upper[place * (columns + 1) + columns];
        self.combine(model.start(degree + 1), part, coefficients);
    }

    /// Sets `coefficients` to those of the polynomial, of a degree up to the model's, that is fitted to
    /// the sum of the heights and `errors` at the fit's vertices, in order; in radii.
    pub(super) fn coefficients_with(
        &mut self,
        model: &Model<T>,
        degree: usize,
        errors: impl Fn(usize) -> T,
        coefficients: &mut Vec<T>,
    ) {
        let (rows, columns) = (self.offsets.len(), model.columns());
        let (width, count) = (columns + 1, model.start(degree + 1));
        let over = self.radius.reciprocal_or_zero();
        self.values.clear();
        self.values.extend((0..rows).map(|row| over * errors(row)));
        let mut parts = [T::zero(); MOST_COLUMNS];
        if self.by_moments {
            let sums = self.moments.sums(degree, Some(&self.values));
            for (part, (&sum, &scale)) in parts.iter_mut().zip(sums.iter().zip(&self.scales)) {
                *part = sum * scale;
            }
            for place in 0..count {
                let row = &self.upper[place * width..][..count];
                let known = parts[place] / row[place];
                parts[place] = known;
                for (part, &factor) in parts[place + 1..].iter_mut().zip(&row[place + 1..]) {
                    *part -= factor * known;
                }
            }
        } else {
            for (value, &weight) in self.values.iter_mut().zip(&self.weights) {
                *value *= weight;
            }
            let columns = self.columns.chunks_exact(rows);
            for (part, column) in parts[..count].iter_mut().zip(columns) {
                *part = product(column, &self.values);
            }
        }
        let part = |place: usize| self.upper[place * width + columns] + parts[place];
        self.combine(count, part, coefficients);
    }

    /// Sets each of `rows` to the row of a linear functional of the coefficients up to a degree: its product
    /// with any values at the fit's vertices is the functional of their fit. A functional is given by its
    /// first factors, in order of the monomials from 1 on; the others are 0. A model that interpolates has no constant, and its
    /// rows have no entry for the vertex itself.
    #[inline(always)]
    pub(super) fn rows<const N: usize, const F: usize>(
        &self,
        model: &Model<T>,
        degree: usize,
        functionals: &[[T; N]; F],
        rows: &mut [Vec<T>; F],
    ) {
        let (length, count) = (self.offsets.len(), model.start(degree + 1));
        let width = model.columns() + 1;
        let before = usize::from(model.interpolates);
        let mut solved = [[T::zero(); F]; MOST_COLUMNS];
        for place in 0..count {
            let mut sums = [T::zero(); F];
            for (sum, functional) in sums.iter_mut().zip(functionals) {
                let factor = functional.get(place + before).copied();
                *sum = factor.unwrap_or(T::zero()) * self.scales[place];
            }
            for (earlier, known) in solved[..place].iter().enumerate() {
                let upper = self.upper[earlier * width + place];
                for (sum, &known) in sums.iter_mut().zip(known) {
                    *sum -= upper * known;
                }
            }
            let over = self.upper[place * width + place].recip();
            solved[place] = sums.map(|sum| sum * over);
        }
        if self.by_moments {
            for place in (0..count).rev() {
                let (first, later) = solved.split_at_mut(place + 1);
                let sums = &mut first[place];
                let upper = &self.upper[place * width..][..count];
                for (&factor, known) in upper[place + 1..].iter().zip(later) {
                    for (sum, &known) in sums.iter_mut().zip(&*known) {
                        *sum -= factor * known;
                    }
                }
                *sums = sums.map(|sum| sum / upper[place]);
            }
            for (solved, &scale) in solved.iter_mut().zip(&self.scales) {
                *solved = solved.map(|entry| entry * scale);
            }
            self.moments.evaluate(degree, &solved[..count], rows);
            rows.iter_mut().for_each(|row| row.truncate(length));
            return;
        }
        for row in rows.iter_mut() {
            row.clear();
            row.resize(length, T::zero());
        }
        let columns = self.columns.chunks_exact(length);
        for (solved, column) in solved[..count].iter().zip(columns) {
            for (row, &factor) in rows.iter_mut().zip(solved) {
                for (entry, &unit) in row.iter_mut().zip(column) {
                    *entry += factor * unit;
                }
            }
        }
        for row in rows {
            for (entry, &weight) in row.iter_mut().zip(&self.weights) {
                *entry *= weight;
            }
        }
    }

    /// The distance of the farthest neighbour.
    pub(super) fn radius(&self) -> T {
        self.radius
    }

    /// The height of the last fitted polynomial above the vertex; 0 if it interpolates.
    pub(super) fn constant(&self, model: &Model<T>) -> T {
        match model.interpolates {
            true => T::zero(),
            false => self.radius * self.coefficients[0],
        }
    }

    /// For each of the highest three degrees of an interpolating fit, and for the residual: the squared
    /// contribution to the heights, and the expected contribution of noise with variance 1 in every
    /// height, including that of the vertex itself.
    pub(super) fn spectrum(&self, model: &Model<T>) -> [[T; 2]; 4] {
        let rows = self.offsets.len();
        let columns = model.columns();
        let mut spectrum = [[T::zero(); 2]; 4];
        let all = product(&self.weights, &self.weights);
        // Heights are w_j (ε_j − ε_i).
        let mut left = all + all;
        let lowest = model.start(model.degree - 2);
        let squared = self.radius * self.radius;
        for (place, column) in self.columns.chunks_exact(rows).take(columns).enumerate() {
            let mut gain = product(column, &self.weights);
            gain *= gain;
            for (&entry, &weight) in column.iter().zip(&self.weights) {
                gain += (entry * weight) * (entry * weight);
            }
            left -= gain;
            if place < lowest {
                continue;
            }
            let begun = |back: &usize| place >= model.start(model.degree - back);
            let degree = (0..2).filter(begun).count();
            let part = self.upper[place * (columns + 1) + columns];
            spectrum[degree][0] += squared * part * part;
            spectrum[degree][1] += gain;
        }
        let residual = &self.columns[columns * rows..];
        spectrum[3] = [squared * product(residual, residual), left.max(T::zero())];
        spectrum
    }
}

/// A scalar product.
#[inline(always)]
fn product<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sums = [T::zero(); SUMS];
    let (whole_a, rest_a) = a.as_chunks::<SUMS>();
    let (whole_b, rest_b) = b.as_chunks::<SUMS>();
    for (a, b) in whole_a.iter().zip(whole_b) {
        for k in 0..SUMS {
            sums[k] += a[k] * b[k];
        }
    }
    for (k, (&a, &b)) in rest_a.iter().zip(rest_b).enumerate() {
        sums[k] += a * b;
    }
    sums.into_iter().sum()
}

/// Finds the nearest neighbours of a vertex, and returns the number of them that a fit uses.
pub(super) fn reach<T: Real>(
    surface: Surface<'_, T>,
    normals: &[Vec3<T>],
    vertex: u32,
    neighbours: usize,
    near: &mut Neighbourhood<T>,
) -> usize {
    near.nearest(surface, vertex, neighbours);
    let here = normals[vertex as usize];
    let turned = |&(_, other): &(T, u32)| dot(normals[other as usize], here) < T::constant(UPRIGHT);
    let upright = near.found.iter().position(turned);
    let count = upright.map_or(near.found.len(), |count| count.max(LEAST));
    count.min(near.found.len())
}
