//! Jets: polynomials of degree 8 fitted to the neighbours of eight vertices at once, and the derivatives
//! of their coefficients.
//!
//! With differences `d_j = x_j − x_i` and the radius `ρ² = 2·105/K² Σ |d_j|²`, which holds about 105
//! neighbours on an even mesh (64 for lower degrees), the heights `h_j = d_j·n/ρ` over
//! `(u, v) = (d·t₁, d·t₂)/ρ` are fitted with weights `w = exp(−14 r²)/(r² + 10⁻³)`, `r = |d_j|/ρ`. The second
//! factor nearly interpolates the nearest neighbours: where two vertices are close, their jets agree, and the
//! blend does not divide a difference by a high power of the distance. `A c = Vᵀ W h`, `A = Vᵀ W V + R`, V the monomials. R is diagonal and constant,
//! of the size of rounding: where neighbours determine a coefficient, it changes nothing, and where they
//! do not, the coefficient is 0 instead of undefined.

use super::plan::{COUNT, DEGREE, VertexBlock};
use super::polynomial::Polynomial;
use crate::fit::{MONOMIALS, Points, coefficient_count, exponential, place_of, set_moments};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, tangent_frame};
use alloc::vec::Vec;

/// Entries of a matrix below its diagonal.
const BELOW: usize = COUNT * (COUNT - 1) / 2;
/// Number of rows that are eliminated together: none waits for another.
const TOGETHER: usize = 4;
/// Exponent of the weights at the radius.
pub(super) const SHARPNESS: f64 = 14.0;
/// Square of the distance, in radii, within which weights do not grow further.
const CORE: f64 = 1e-3;
/// Number of neighbours within the radius of an even mesh.
pub(super) const fn within(degree: usize) -> f64 {
    if degree > 6 { 105.0 } else { 64.0 }
}

/// `(2n − 1)!!/(2·14)ⁿ`: the mean of `u^2n` under the weights.
const fn mean_power(n: usize) -> f64 {
    let (mut mean, mut k) = (1.0, 0);
    while k < n {
        mean *= (2 * k + 1) as f64 / (2.0 * SHARPNESS);
        k += 1;
    }
    mean
}

/// The diagonal of `Vᵀ W V` on an even mesh, about.
const DIAGONAL: [f64; COUNT] = {
    let mut diagonal = [0.0; COUNT];
    let mut k = 0;
    while k < COUNT {
        let (degree, power) = MONOMIALS[k];
        diagonal[k] = within(DEGREE) / SHARPNESS * mean_power(degree - power) * mean_power(power);
        k += 1;
    }
    diagonal
};

/// R over the diagonal, in roundings.
const RIDGE: f64 = 64.0;

/// The fits of a block.
#[derive(Clone, Debug)]
pub(super) struct Fit<T> {
    pub(super) normal: Vec3<Several<T>>,
    pub(super) frame: [Vec3<Several<T>>; 2],
    pub(super) radius: Several<T>,
    pub(super) over_radius: Several<T>,
    pub(super) coefficients: [Several<T>; COUNT],
    /// `A = L D Lᵀ`: L below its diagonal, row by row, and D⁻¹.
    lower: [Several<T>; BELOW],
    over_pivots: [Several<T>; COUNT],
    /// The least pivot over the diagonal of A.
    pub(super) weakest: Several<T>,
    /// The largest last step of the points that the jet places, in radii.
    pub(super) unsettled: Several<T>,
}

impl<T: Real> Default for Fit<T> {
    fn default() -> Self {
        let zero = Several::zero();
        Self {
            normal: [zero; 3],
            frame: [[zero; 3]; 2],
            radius: zero,
            over_radius: zero,
            coefficients: [zero; COUNT],
            lower: [zero; BELOW],
            over_pivots: [zero; COUNT],
            weakest: zero,
            unsettled: zero,
        }
    }
}

/// A field that is fitted to the same neighbours: its polynomials, its values at neighbours less those at
/// the vertices, and the derivatives of the energy with respect to its values at points, without the
/// weights of the blend, and to its coefficients.
pub(super) struct FieldPull<'a, T> {
    pub(super) coefficients: &'a [Several<T>; COUNT],
    pub(super) values: &'a [Several<T>],
    pub(super) given: &'a [Several<T>],
    pub(super) by_coefficient: [Several<T>; COUNT],
}

/// Memory of a block.
#[derive(Clone, Debug, Default)]
pub(super) struct FitScratch<T> {
    /// Coordinates u, v, h of each neighbour, and its weight.
    pub(super) places: [Vec<Several<T>>; 3],
    pub(super) weights: Vec<Several<T>>,
    /// Normals at the neighbours in the one-ring.
    pub(super) normals: Vec<Vec3<Several<T>>>,
    /// Derivatives of the energy with respect to u, v and h of each neighbour.
    pub(super) bars: Vec<Vec3<Several<T>>>,
    /// Derivatives with respect to normals in the one-ring, in the frame.
    pub(super) normal_bars: Vec<Vec3<Several<T>>>,
    pub(super) sums: Sums<T>,
}

/// Sums over points, and the memory that they need.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums<T> {
    column: Vec<Several<T>>,
    powers: Vec<Several<T>>,
    /// Moments of the matrix, and of values, that of degree 0 first.
    moments: Vec<Several<T>>,
    right: Vec<Several<T>>,
}

impl<T: Real> Sums<T> {
    /// Sets the moments of the points, and factorises their matrix.
    #[inline(always)]
    fn set_matrix(&mut self, fit: &mut Fit<T>, degree: usize, points: Points<'_, T>) {
        self.column.clear();
        self.column.extend_from_slice(points.weights);
        let count = place_of(2 * degree, 2 * degree) + 1;
        self.moments.resize(count, Several::zero());
        let (column, powers) = (&mut self.column, &mut self.powers);
        set_moments(&mut self.moments, 2 * degree, points, column, powers);
        fit.factorise(&self.moments, coefficient_count(degree));
    }

    /// The polynomials that are fitted to the values.
    #[inline(always)]
    pub(super) fn fitted(
        &mut self,
        fit: &Fit<T>,
        degree: usize,
        points: Points<'_, T>,
        values: impl Iterator<Item = Several<T>>,
    ) -> [Several<T>; COUNT] {
        self.column.clear();
        let weighted = values.zip(points.weights);
        self.column
            .extend(weighted.map(|(value, &weight)| weight * value));
        let count = coefficient_count(degree);
        self.right.resize(count + 1, Several::zero());
        let (right, column) = (&mut self.right, &mut self.column);
        set_moments(right, degree, points, column, &mut self.powers);
        let mut solution = [Several::zero(); COUNT];
        solution[..count].copy_from_slice(&right[1..]);
        fit.solve(&mut solution);
        solution
    }
}

impl<T: Real> FitScratch<T> {
    /// The neighbours with their weights, and the memory for sums over them.
    #[inline(always)]
    pub(super) fn points(&mut self) -> (Points<'_, T>, &mut Sums<T>) {
        let points = Points {
            x: &self.places[0],
            y: &self.places[1],
            weights: &self.weights,
        };
        (points, &mut self.sums)
    }

    /// Number of neighbours in the longest list.
    #[inline(always)]
    pub(super) fn rows(&self) -> usize {
        self.weights.len()
    }

    /// Sets coordinates and weights of the neighbours, and in `fit` the frame and the radius.
    #[inline(always)]
    pub(super) fn place(
        &mut self,
        fit: &mut Fit<T>,
        surface: Surface<'_, T>,
        block: &VertexBlock,
        neighbours: &[[u32; WIDTH]],
        normals: &[[T; 3]],
    ) {
        self.gather(surface, block, neighbours);
        for (lane, &vertex) in block.vertices.iter().enumerate() {
            for (axis, &entry) in normals[vertex as usize].iter().enumerate() {
                fit.normal[axis].0[lane] = entry;
            }
        }
        let [x, y, z] = &self.places;
        let mut squares = Several::zero();
        for ((&x, &y), &z) in x.iter().zip(y).zip(z) {
            squares = squares + dot([x, y, z], [x, y, z]);
        }
        fit.radius = (spread(block) * squares).sqrt();
        fit.over_radius = fit.radius.reciprocal_or_zero();
        fit.frame = tangent_frame(fit.normal);
        self.turn_into_frame(fit, block, neighbours, normals);
    }

    /// Sets coordinates and weights of the neighbours of a fit.
    #[inline(always)]
    pub(super) fn place_again(
        &mut self,
        fit: &Fit<T>,
        surface: Surface<'_, T>,
        block: &VertexBlock,
        neighbours: &[[u32; WIDTH]],
        normals: &[[T; 3]],
    ) {
        self.gather(surface, block, neighbours);
        self.turn_into_frame(fit, block, neighbours, normals);
    }

    /// Sets `places` to differences of positions.
    #[inline(always)]
    fn gather(
        &mut self,
        surface: Surface<'_, T>,
        block: &VertexBlock,
        neighbours: &[[u32; WIDTH]],
    ) {
        let rows = neighbours.len();
        for values in &mut self.places {
            values.resize(rows, Several::zero());
        }
        let [x, y, z] = &mut self.places;
        for (lane, &vertex) in block.vertices.iter().enumerate() {
            let seen = surface.seen_from(vertex);
            for row in 0..rows {
                let difference = seen.difference(neighbours[row][lane]);
                x[row].0[lane] = difference[0];
                y[row].0[lane] = difference[1];
                z[row].0[lane] = difference[2];
            }
        }
    }

    #[inline(always)]
    fn turn_into_frame(
        &mut self,
        fit: &Fit<T>,
        block: &VertexBlock,
        neighbours: &[[u32; WIDTH]],
        normals: &[[T; 3]],
    ) {
        let rows = neighbours.len();
        self.weights.resize(rows, Several::zero());
        let [x, y, z] = &mut self.places;
        for row in 0..rows {
            let local = scale(fit.over_radius, [x[row], y[row], z[row]]);
            x[row] = dot(local, fit.frame[0]);
            y[row] = dot(local, fit.frame[1]);
            z[row] = dot(local, fit.normal);
            let exponent = Several::literal(-SHARPNESS) * dot(local, local);
            let near = Several::literal(LEAST_EXPONENT).less(exponent);
            let bounded = Several::select(near, exponent, Several::zero());
            let fading = Several::select(near, exponential(bounded), Several::zero());
            let closeness = (dot(local, local) + Several::literal(CORE)).reciprocal_or_zero();
            self.weights[row] = fading * closeness;
        }
        let ring = block.valences.iter().copied().max().unwrap_or(0) as usize;
        self.normals.clear();
        for neighbours in neighbours.iter().take(ring) {
            let mut gathered = [Several::zero(); 3];
            for (lane, &neighbour) in neighbours.iter().enumerate() {
                for (axis, &entry) in normals[neighbour as usize].iter().enumerate() {
                    gathered[axis].0[lane] = entry;
                }
            }
            self.normals.push(fit.in_frame(gathered));
        }
    }

    /// Fits the polynomials.
    #[inline(always)]
    pub(super) fn fit(&mut self, fit: &mut Fit<T>, degree: usize) {
        let points = Points {
            x: &self.places[0],
            y: &self.places[1],
            weights: &self.weights,
        };
        self.sums.set_matrix(fit, degree, points);
        let heights = self.places[2].iter().copied();
        fit.coefficients = self.sums.fitted(fit, degree, points, heights);
    }

    /// Adjoint of the fit: maps ∂E/∂c (`by_coefficient`) and ∂E/∂(u, v, h) (`bars`, `normal_bars`) to ∂E/∂x_j (`bars`)
    /// and ∂E/∂n_j (`normal_bars`) of the neighbours j, and returns ∂E/∂n of the vertex. `by_radius` is ∂E/∂ρ at fixed
    /// coefficients and places.
    ///
    /// With `z = A⁻¹ ∂c`, `q = V z` and the residuals `r = h − V c`: `∂h = W q`,
    /// `∂V = W (r zᵀ − q cᵀ)`, `∂w = q r`.
    #[inline(always)]
    pub(super) fn pull(
        &mut self,
        fit: &Fit<T>,
        block: &VertexBlock,
        mut by_coefficient: [Several<T>; COUNT],
        mut by_radius: Several<T>,
        ring: &[Vec3<Several<T>>],
        fields: &mut [Option<FieldPull<'_, T>>; 2],
    ) -> Vec3<Several<T>> {
        let count = coefficient_count(block.degree);
        by_coefficient[count..].fill(Several::zero());
        fit.solve(&mut by_coefficient);
        for field in fields.iter_mut().flatten() {
            field.by_coefficient[count..].fill(Several::zero());
            fit.solve(&mut field.by_coefficient);
        }
        let [across, along] = fit.frame;
        let (jet, duals) = (fit.polynomial(), Polynomial::new(&by_coefficient));
        let of_fields = fields.each_ref().map(|field| {
            let field = field.as_ref()?;
            let polynomials = [field.coefficients, &field.by_coefficient].map(Polynomial::new);
            Some((field.values, polynomials))
        });
        let mut turned = [[Several::zero(); 3]; 3];
        let over = fit.over_radius;
        for row in 0..self.rows() {
            let [u, v, h] = [0, 1, 2].map(|axis| self.places[axis][row]);
            let weight = self.weights[row];
            let [value, by_u, by_v] = jet.with_slopes(u, v);
            let [dual, dual_u, dual_v] = duals.with_slopes(u, v);
            let residual = h - value;
            let bars = self.bars[row];
            let mut bars = [
                bars[0] + weight * (residual * dual_u - dual * by_u),
                bars[1] + weight * (residual * dual_v - dual * by_v),
                bars[2] + weight * dual,
            ];
            let mut by_weight = dual * residual;
            for (values, [field, duals]) in of_fields.iter().flatten() {
                let [value, by_u, by_v] = field.with_slopes(u, v);
                let [dual, dual_u, dual_v] = duals.with_slopes(u, v);
                let residual = values[row] - value;
                bars[0] = bars[0] + weight * (residual * dual_u - dual * by_u);
                bars[1] = bars[1] + weight * (residual * dual_v - dual * by_v);
                by_weight = by_weight + dual * residual;
            }
            // The scaled difference, which the weight depends on, too.
            let local = add(add(scale(u, across), scale(v, along)), scale(h, fit.normal));
            let closeness = (dot(local, local) + Several::literal(CORE)).reciprocal_or_zero();
            let slope = Several::literal(SHARPNESS) + closeness;
            let fade = Several::literal(-2.0) * slope * weight * by_weight;
            for axis in 0..3 {
                turned[axis] = add(turned[axis], scale(bars[axis], local));
            }
            let pull = add(
                add(scale(bars[0], across), scale(bars[1], along)),
                add(scale(bars[2], fit.normal), scale(fade, local)),
            );
            by_radius = by_radius - over * dot(pull, local);
            self.bars[row] = scale(over, pull);
        }
        // dρ = spread/ρ Σ d·dd.
        let grow = by_radius * spread(block);
        for row in 0..self.rows() {
            let [u, v, h] = [0, 1, 2].map(|axis| self.places[axis][row]);
            let local = add(add(scale(u, across), scale(v, along)), scale(h, fit.normal));
            self.bars[row] = add(self.bars[row], scale(grow, local));
        }
        for (bars, &normal) in self.normal_bars.iter_mut().zip(ring) {
            for (turned, &bar) in turned.iter_mut().zip(&*bars) {
                *turned = add(*turned, scale(bar, normal));
            }
            *bars = fit.out_of_frame(*bars);
        }
        // The frame follows the normal without a rotation about it: dt = −(t·dn) n.
        let [by_across, by_along, by_normal] = turned;
        let tilt = [dot(by_across, fit.normal), dot(by_along, fit.normal)];
        add(
            by_normal,
            add(scale(-tilt[0], across), scale(-tilt[1], along)),
        )
    }
}

/// Below it weights are 0.
const LEAST_EXPONENT: f64 = -64.0;

/// ρ²/Σ|d|².
#[inline(always)]
fn spread<T: Real>(block: &VertexBlock) -> Several<T> {
    Several::from_fn(|lane| {
        let count = f64::from(block.counts[lane]);
        T::constant(2.0 * within(block.degree) / (count * count))
    })
}

impl<T: Real> Fit<T> {
    /// The polynomial of the jet.
    #[inline(always)]
    pub(super) fn polynomial(&self) -> Polynomial<Several<T>> {
        Polynomial::new(&self.coefficients)
    }

    /// A vector in coordinates of the frame.
    #[inline(always)]
    pub(super) fn in_frame(&self, vector: Vec3<Several<T>>) -> Vec3<Several<T>> {
        let [across, along] = self.frame;
        [
            dot(vector, across),
            dot(vector, along),
            dot(vector, self.normal),
        ]
    }

    #[inline(always)]
    fn out_of_frame(&self, [u, v, h]: Vec3<Several<T>>) -> Vec3<Several<T>> {
        let [across, along] = self.frame;
        add(
            add(scale(u, across), scale(v, along)),
            scale(h, self.normal),
        )
    }

    /// Factorises the matrix of these moments; of the coefficients from `count` on it is the identity.
    #[inline(always)]
    fn factorise(&mut self, moments: &[Several<T>], count: usize) {
        let entry = |i: usize, j: usize| {
            let ((degree, power), (other, others)) = (MONOMIALS[i], MONOMIALS[j]);
            moments[place_of(degree + other, power + others)]
        };
        let ridge = T::constant(RIDGE) * T::epsilon();
        let mut scaled = [[Several::zero(); COUNT]; TOGETHER];
        self.weakest = Several::literal(1.0);
        self.over_pivots = [Several::literal(1.0); COUNT];
        self.lower[row_start(count).min(BELOW)..].fill(Several::zero());
        let mut first = 0;
        while first < count {
            let rows = (count - first).min(TOGETHER);
            for j in 0..first {
                let mut sums = [Several::zero(); TOGETHER];
                for (c, sum) in sums.iter_mut().enumerate().take(rows) {
                    *sum = entry(first + c, j);
                }
                let known = &self.lower[row_start(j)..][..j];
                for (k, &factor) in known.iter().enumerate() {
                    for c in 0..TOGETHER {
                        sums[c] = sums[c] - scaled[c][k] * factor;
                    }
                }
                for c in 0..TOGETHER {
                    scaled[c][j] = sums[c];
                }
            }
            for (c, scaled) in scaled.iter_mut().enumerate().take(rows) {
                let i = first + c;
                for j in first..i {
                    let mut sum = entry(i, j);
                    let known = &self.lower[row_start(j)..][..j];
                    for (&known, &own) in known.iter().zip(&*scaled) {
                        sum = sum - own * known;
                    }
                    scaled[j] = sum;
                }
                let whole = entry(i, i) + Several::splat(ridge * T::constant(DIAGONAL[i]));
                let mut pivot = whole;
                let row = self.lower[row_start(i)..][..i].iter_mut();
                for ((entry, &own), &over) in row.zip(&*scaled).zip(&self.over_pivots) {
                    let factor = own * over;
                    pivot = pivot - own * factor;
                    *entry = factor;
                }
                let part = pivot * whole.reciprocal_or_zero();
                let weaker = part.less(self.weakest);
                self.weakest = Several::select(weaker, part, self.weakest);
                let positive = Several::zero().less(pivot);
                let over = pivot.reciprocal_or_zero();
                self.over_pivots[i] = Several::select(positive, over, Several::zero());
            }
            first += TOGETHER;
        }
    }

    /// Solves `A x = b` in place.
    #[inline(always)]
    pub(super) fn solve(&self, x: &mut [Several<T>; COUNT]) {
        for i in 1..COUNT {
            let row = &self.lower[row_start(i)..][..i];
            let mut sums = [Several::zero(); 4];
            let (fours, others) = row.as_chunks::<4>();
            let (known, last) = x[..i].as_chunks::<4>();
            for (factors, values) in fours.iter().zip(known) {
                for k in 0..4 {
                    sums[k] = sums[k] + factors[k] * values[k];
                }
            }
            for ((sum, &factor), &value) in sums.iter_mut().zip(others).zip(last) {
                *sum = *sum + factor * value;
            }
            x[i] = x[i] - ((sums[0] + sums[1]) + (sums[2] + sums[3]));
        }
        for (x, &over) in x.iter_mut().zip(&self.over_pivots) {
            *x = *x * over;
        }
        for i in (1..COUNT).rev() {
            let row = &self.lower[row_start(i)..][..i];
            let value = x[i];
            for (x, &factor) in x.iter_mut().zip(row) {
                *x = *x - factor * value;
            }
        }
    }
}

/// Start of row i of a matrix below its diagonal.
const fn row_start(i: usize) -> usize {
    i * i.saturating_sub(1) / 2
}
