//! The free points of patches: intersections of lines with jets, and their derivatives.
//!
//! A point y of a triangle moves along `m = normalise(Σ λ_k n_k)`. In the frame of a jet, in units of
//! its radius, the jet puts it at `P = (y − x)/ρ + s m` with `R = p(P_u, P_v) − P_h = 0`. The patch's
//! point is `y + m Σ_k B_k ρ_k s_k`, B the weights of the blend.
//!
//! With `G = (p_u, p_v, −1)`: `ds = −(dp + G·(d(y − x)/ρ + s dm))/(G·m)`.

use super::basis::{AROUND, ON_EDGE, blend};
use super::fit::{FieldPull, Fit, FitScratch};
use super::plan::{COUNT, STAR, VertexBlock};
use super::polynomial::{Polynomial, add_monomials};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::vec3::{Vec3, add, dot, norm, scale, sub};

/// Most steps of Newton's method for a point.
const MOST_STEPS: usize = 8;

/// Least cosine, about, between a line and the normal of the jet that it meets.
const LEAST_COSINE: f64 = 0.125;

/// A point as its jet sees it: barycentric coordinates λ of the next two corners, `(y − x)/ρ`, the
/// direction m, and 1 over the length of `Σ λ_k n_k`.
struct Line<L> {
    offset: Vec3<L>,
    direction: Vec3<L>,
    over_length: L,
}

impl<L: Lane> Line<L> {
    /// The line of a point with these barycentric coordinates; positions and normals of the two corners
    /// in the frame.
    #[inline(always)]
    fn new([own, next, other]: [f64; 3], places: [Vec3<L>; 2], normals: [Vec3<L>; 2]) -> Self {
        let [next, other] = [next, other].map(L::literal);
        let mut offset = scale(next, places[0]);
        let mut sum = scale(next, normals[0]);
        offset = add(offset, scale(other, places[1]));
        sum = add(sum, scale(other, normals[1]));
        sum[2] = sum[2] + L::literal(own);
        let over_length = norm(sum).reciprocal_or_zero();
        Self {
            offset,
            direction: scale(over_length, sum),
            over_length,
        }
    }
}

/// A step of Newton's method from s: the step, P, p_u, p_v, and −1/(G·m).
struct Step<L> {
    step: L,
    at: Vec3<L>,
    slopes: [L; 2],
    over: L,
}

impl<L: Lane> Step<L> {
    #[inline(always)]
    fn new(jet: &Polynomial<L>, line: &Line<L>, s: L) -> Self {
        let at = add(line.offset, scale(s, line.direction));
        let [value, by_u, by_v] = jet.with_slopes(at[0], at[1]);
        let [m_u, m_v, m_h] = line.direction;
        let cosine = m_h - by_u * m_u - by_v * m_v;
        let meets = L::literal(LEAST_COSINE).less(cosine);
        let over = L::select(meets, cosine.reciprocal_or_zero(), L::zero());
        Self {
            step: (value - at[2]) * over,
            at,
            slopes: [by_u, by_v],
            over,
        }
    }
}

/// The largest last step with which a point is settled, in radii: the next one is its square.
pub(super) fn settled<T: Real>() -> T {
    T::epsilon().sqrt()
}

#[inline(always)]
fn absolute<L: Lane>(x: L) -> L {
    L::select(x.less(L::zero()), -x, x)
}

/// Solves for s. A point that does not settle, or whose line is nearly tangential, stays at s = 0; the
/// last step, or 1.
#[inline(always)]
fn solve<T: Real>(
    jet: &Polynomial<Several<T>>,
    line: &Line<Several<T>>,
) -> (Several<T>, Several<T>) {
    let enough = Several::splat(settled());
    let one = Several::literal(1.0);
    let mut s = Several::zero();
    let mut last = one;
    for _ in 0..MOST_STEPS {
        let step = Step::new(jet, line, s);
        // Settled lanes stay as they are, whatever the others do.
        let done = last.less(enough);
        let meets = Several::zero().less(step.over);
        let taken = Several::select(meets, absolute(step.step), one);
        s = Several::select(done, s, s + step.step);
        last = Several::select(done, last, taken);
        if last.less(enough) == [true; WIDTH] {
            break;
        }
    }
    let good = last.less(enough);
    (
        Several::select(good, s, Several::zero()),
        Several::select(good, last, one),
    )
}

/// Numbers of the neighbour that follows each one in the one-ring.
#[inline(always)]
fn next_in_ring(block: &VertexBlock, row: usize) -> [usize; WIDTH] {
    block
        .valences
        .map(|valence| (row + 1) % valence.max(1) as usize)
}

#[inline(always)]
fn gathered<T: Real>(
    rows: &[usize; WIDTH],
    at: impl Fn(usize, usize) -> Vec3<T>,
) -> Vec3<Several<T>> {
    let mut vector = [Several::zero(); 3];
    for (lane, &row) in rows.iter().enumerate() {
        let entry = at(row, lane);
        for axis in 0..3 {
            vector[axis].0[lane] = entry[axis];
        }
    }
    vector
}

impl<T: Real> FitScratch<T> {
    /// Positions and normals of a neighbour in the one-ring and of the following one.
    #[inline(always)]
    fn corners(&self, block: &VertexBlock, row: usize) -> [[Vec3<Several<T>>; 2]; 2] {
        let next = next_in_ring(block, row);
        let [x, y, z] = &self.places;
        let normals = &self.normals;
        [
            [
                [x[row], y[row], z[row]],
                gathered(&next, |row, lane| {
                    [x[row].0[lane], y[row].0[lane], z[row].0[lane]]
                }),
            ],
            [
                normals[row],
                gathered(&next, |row, lane| normals[row].map(|axis| axis.0[lane])),
            ],
        ]
    }

    /// Sets the displacements `ρ s` of the points around the vertices, and the largest last step in
    /// `fit`.
    #[inline(always)]
    pub(super) fn displace(
        &self,
        fit: &mut Fit<T>,
        block: &VertexBlock,
        displacements: &mut [Several<T>],
    ) {
        let jet = fit.polynomial();
        let mut worst = Several::zero();
        for (row, displacements) in displacements.chunks_exact_mut(STAR).enumerate() {
            let [places, normals] = self.corners(block, row);
            let used: [bool; WIDTH] = block.valences.map(|valence| row < valence as usize);
            for (point, displacement) in displacements.iter_mut().enumerate() {
                let line = Line::new(AROUND[point], places, normals);
                let (s, last) = solve(&jet, &line);
                *displacement = s * fit.radius;
                let worse = Several::select(worst.less(last), last, worst);
                worst = Several::select(used, worse, worst);
            }
        }
        fit.unsettled = worst;
    }

    /// From the derivatives `by_displacement` of the energy with respect to the displacements of patches'
    /// points: sets `bars` and `normal_bars`, and returns the derivatives with respect to coefficients
    /// and radius.
    #[inline(always)]
    pub(super) fn pull_points(
        &mut self,
        fit: &Fit<T>,
        block: &VertexBlock,
        displacements: &[Several<T>],
        by_displacement: &[Several<T>],
        fields: &mut [Option<FieldPull<'_, T>>; 2],
    ) -> ([Several<T>; COUNT], Several<T>) {
        let zero = [Several::zero(); 3];
        self.bars.clear();
        self.bars.resize(self.rows(), zero);
        self.normal_bars.clear();
        self.normal_bars.resize(self.normals.len(), zero);
        let jet = fit.polynomial();
        let of_fields = fields.each_ref().map(|field| {
            let field = field.as_ref()?;
            Some(Polynomial::new(field.coefficients))
        });
        let mut by_coefficient = [Several::zero(); COUNT];
        let mut by_radius = Several::zero();
        let enough = Several::splat(settled());
        let stars = displacements.chunks_exact(STAR);
        for (row, (displacements, given)) in
            stars.zip(by_displacement.chunks_exact(STAR)).enumerate()
        {
            let [places, normals] = self.corners(block, row);
            let [mut on_next, mut on_other] = [[zero; 2]; 2];
            for point in 0..STAR {
                let [own, next, other] = AROUND[point];
                let weight = Several::literal(blend([own, next, other]));
                let line = Line::new([own, next, other], places, normals);
                let s = displacements[point] * fit.over_radius;
                let step = Step::new(&jet, &line, s);
                let by_s = weight * given[point];
                by_radius = by_radius + by_s * s;
                let good = absolute(step.step).less(enough);
                let [u, v, _] = step.at;
                // Fields depend on the place along the line, too.
                let mut by_place = zero;
                for (field, of_field) in fields.iter_mut().zip(&of_fields) {
                    let (Some(field), Some(of_field)) = (field, of_field) else {
                        continue;
                    };
                    let by_value = weight * field.given[row * STAR + point];
                    let [_, by_u, by_v] = of_field.with_slopes(u, v);
                    by_place[0] = by_place[0] + by_value * by_u;
                    by_place[1] = by_place[1] + by_value * by_v;
                    add_monomials(&mut field.by_coefficient, by_value, u, v);
                }
                let a = (by_s * fit.radius + dot(by_place, line.direction)) * step.over;
                let a = Several::select(good, a, Several::zero());
                add_monomials(&mut by_coefficient, a, u, v);
                let [by_u, by_v] = step.slopes;
                let by_offset = add([a * by_u, a * by_v, -a], by_place);
                let by_direction = scale(s, by_offset);
                let level = dot(by_direction, line.direction);
                let by_sum = scale(
                    line.over_length,
                    sub(by_direction, scale(level, line.direction)),
                );
                let next = Several::literal(next);
                on_next[0] = add(on_next[0], scale(next, by_offset));
                on_next[1] = add(on_next[1], scale(next, by_sum));
                if point >= ON_EDGE {
                    let other = Several::literal(other);
                    on_other[0] = add(on_other[0], scale(other, by_offset));
                    on_other[1] = add(on_other[1], scale(other, by_sum));
                }
            }
            self.bars[row] = add(self.bars[row], on_next[0]);
            self.normal_bars[row] = add(self.normal_bars[row], on_next[1]);
            let next = next_in_ring(block, row);
            for (lane, &next) in next.iter().enumerate() {
                let [places, normals] = &on_other;
                for (bar, other) in self.bars[next].iter_mut().zip(places) {
                    bar.0[lane] += other.0[lane];
                }
                for (bar, other) in self.normal_bars[next].iter_mut().zip(normals) {
                    bar.0[lane] += other.0[lane];
                }
            }
        }
        (by_coefficient, by_radius)
    }

    /// Sets the values of a field at the points around the vertices, from its polynomials and its values
    /// at the vertices.
    #[inline(always)]
    pub(super) fn set_field(
        &self,
        fit: &Fit<T>,
        block: &VertexBlock,
        displacements: &[Several<T>],
        (coefficients, own): (&[Several<T>; COUNT], Several<T>),
        values: &mut [Several<T>],
    ) {
        let field = Polynomial::new(coefficients);
        let stars = displacements.chunks_exact(STAR);
        for (row, (displacements, values)) in stars.zip(values.chunks_exact_mut(STAR)).enumerate() {
            let [places, normals] = self.corners(block, row);
            for point in 0..STAR {
                let line = Line::new(AROUND[point], places, normals);
                let s = displacements[point] * fit.over_radius;
                let [u, v, _] = add(line.offset, scale(s, line.direction));
                values[point] = own + field.value(u, v);
            }
        }
    }
}
