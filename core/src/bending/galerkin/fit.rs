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
use crate::fit::{
    MONOMIALS, Points, cholesky, coefficient_count, exponential, place_of, set_moments,
};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, tangent_frame};
use alloc::vec::Vec;

/// Entries of a matrix below its diagonal.
const BELOW: usize = cholesky::row_start(COUNT);
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
    /// Number of coefficients, and L and D⁻¹ of `A = L D Lᵀ`.
    count: usize,
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
            count: 0,
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
        fit.set(&self.moments, coefficient_count(degree));
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

    /// Factorises the matrix of these moments.
    #[inline(always)]
    fn set(&mut self, moments: &[Several<T>], count: usize) {
        let ridge = T::constant(RIDGE) * T::epsilon();
        let entry = |i: usize, j: usize| {
            let ((degree, power), (other, others)) = (MONOMIALS[i], MONOMIALS[j]);
            let moment = moments[place_of(degree + other, power + others)];
            if i == j {
                moment + Several::splat(ridge * T::constant(DIAGONAL[i]))
            } else {
                moment
            }
        };
        let mut pivots = [Several::zero(); COUNT];
        let (pivots, over_pivots) = (&mut pivots[..count], &mut self.over_pivots[..count]);
        cholesky::factorise(entry, &mut self.lower, pivots, over_pivots);
        self.count = count;
        self.weakest = Several::literal(1.0);
        for (i, &pivot) in pivots.iter().enumerate() {
            let part = pivot * entry(i, i).reciprocal_or_zero();
            let weaker = part.less(self.weakest);
            self.weakest = Several::select(weaker, part, self.weakest);
        }
    }

    /// Solves `A x = b` in place, in as many coefficients as the jet has.
    #[inline(always)]
    pub(super) fn solve(&self, x: &mut [Several<T>; COUNT]) {
        cholesky::solve(&self.lower, &self.over_pivots, &mut x[..self.count]);
    }
}
