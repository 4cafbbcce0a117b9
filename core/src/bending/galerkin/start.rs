//! The strong form over the jets of method G: the force density of components with a boundary, and the start of
//! the solution for that of the others.

use super::fields::differences_of;
use super::fit::Fit;
use super::mass::{Neighbour, columns};
use super::plan::Plan;
use super::vertices::Work;
use crate::element::SlotKernel;
use crate::fit::Points;
use crate::lane::{Lane, Several};
use crate::real::Real;

/// H at a vertex without a fit, such as one of a boundary: the mean of the polynomials around vertices that
/// have it as a neighbour, by its weights in their fits; 0 where there are none.
pub(super) fn mean_beyond<T: Real>(
    plan: &Plan,
    neighbours: &[Neighbour<T>],
    fits: &[Fit<T>],
    vertex: usize,
) -> T {
    let (mut sum, mut weights) = (T::zero(), T::zero());
    for place in plan.listed_at(vertex) {
        let Some((block, lane)) = plan.members[place.vertex as usize] else {
            continue;
        };
        let (block, lane) = (block as usize, usize::from(lane));
        let rows = plan.neighbour_offsets[block]..plan.neighbour_offsets[block + 1];
        let row = place.row() - rows.start;
        let [u, v, weight, _] = columns(&neighbours[rows]).map(|numbers| numbers[row].0[lane]);
        let mean = fits[block].mean_at(lane, u, v);
        if mean.is_finite() {
            sum += weight * mean;
            weights += weight;
        }
    }
    sum * weights.reciprocal_or_zero()
}

/// Δ_S of a field at the vertices of a block, by polynomials that are fitted as the jets are.
pub(super) struct Laplacians<'a, T> {
    pub(super) plan: &'a Plan,
    pub(super) neighbours: &'a [Neighbour<T>],
    pub(super) fits: &'a [Fit<T>],
    pub(super) values: &'a [T],
}

impl<'a, T: Real> SlotKernel<Work<T>, &'a mut [Several<T>]> for Laplacians<'_, T> {
    #[inline(always)]
    fn set(&self, work: &mut Work<T>, start: usize, slots: &'a mut [Several<T>]) {
        let plan = self.plan;
        for (number, laplacian) in (start..).zip(slots) {
            let (block, fit) = (&plan.blocks[number], &self.fits[number]);
            let rows = plan.neighbour_offsets[number]..plan.neighbour_offsets[number + 1];
            let [x, y, weights, _] = columns(&self.neighbours[rows]);
            let differences = differences_of(plan, number, self.values);
            let (sums, points) = (&mut work.scratch.sums, Points { x, y, weights });
            let field = sums.fitted(fit, block.degree, points, differences);
            *laplacian = fit.laplacian(&field);
        }
    }
}

impl<T: Real> Fit<T> {
    /// Δ_S at the vertex of a field with these coefficients. With the height p over the plane,
    /// `Δ_S φ = g^ij (φ_ij − p_ij p_k φ_k/(1 + p_u² + p_v²))`, g the metric.
    #[inline(always)]
    fn laplacian(&self, field: &[Several<T>]) -> Several<T> {
        let [p, q, ..] = self.coefficients;
        let one = Several::literal(1.0);
        let (squared, two) = (one + p * p + q * q, Several::literal(2.0));
        let over = squared.reciprocal_or_zero();
        let trace = |of: &[Several<T>]| {
            let [uu, uv, vv] = [two * of[2], of[3], two * of[4]];
            over * ((one + q * q) * uu - two * p * q * uv + (one + p * p) * vv)
        };
        let along = over * (p * field[0] + q * field[1]);
        let over_square = self.over_radius * self.over_radius;
        over_square * (trace(field) - trace(&self.coefficients) * along)
    }
}
