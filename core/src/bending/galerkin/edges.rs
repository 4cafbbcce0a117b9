//! The angle between the patches at an edge, times the mean of their curvatures.
//!
//! Patches meet without a gap but with a small angle θ between their normals, in which a part of the
//! curvature is concentrated: `2κ ∫ {H − H0} θ ds`, {·} the mean of both sides, is what the energy of a
//! smooth surface has there. With it the gradient is consistent: S. C. Brenner and L.-Y. Sung, J. Sci.
//! Comput. 22 (2005) 83; M. Neunteufel, J. Schöberl, K. Sturm, J. Comput. Phys. 488 (2023) 112218.

use super::basis::{Basis, GAUSS};
use super::plan::{InteriorEdge, Plan};
use crate::element::{SlotKernel, Slots, Strided};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::vec3::{cross, dot, norm, scale};

/// Numbers at each quadrature point of an edge: x_t, n, H, κ and H0.
pub(super) const EDGE_VALUES: usize = 9;
/// Rows of these of a patch.
pub(super) const PATCH_EDGE_VALUES: usize = 3 * GAUSS * EDGE_VALUES;
/// Gradient entries of an edge at each quadrature point: with respect to the angle, and to H, the length, κ and H0 on one
/// side.
pub(super) const EDGE_GRADIENT: usize = 5;
/// Rows of these of an edge.
pub(super) const EDGE_GRADIENTS: usize = GAUSS * EDGE_GRADIENT;

/// σ of the penalty `σ/2 ∫ κ θ² ds/∫ ds` of an edge, without which the energy of a rough surface that is not
/// resolved may be negative.
const PENALTY: f64 = 1.0;

/// Energies of edges and their derivatives.
pub(super) struct Edges<'a, T> {
    pub(super) plan: &'a Plan,
    pub(super) basis: &'a Basis<T>,
    pub(super) edge_values: &'a [Several<T>],
}

impl<'a, T: Real> SlotKernel<(), (&'a mut [Several<T>], Strided<'a, Several<T>>)> for Edges<'_, T> {
    #[inline(always)]
    fn set(
        &self,
        (): &mut (),
        start: usize,
        (energies, edge_gradients): (&'a mut [Several<T>], Strided<'a, Several<T>>),
    ) {
        let half = Several::literal(0.5);
        for (index, (energy, gradients)) in energies
            .iter_mut()
            .zip(edge_gradients.into_slots())
            .enumerate()
        {
            let first = (start + index) * WIDTH;
            let mut sides = [[[Several::zero(); EDGE_VALUES]; 2]; GAUSS];
            let mut angles = [Several::zero(); GAUSS];
            let mut lengths = [Several::zero(); GAUSS];
            let mut whole = Several::zero();
            for gauss in 0..GAUSS {
                sides[gauss] = self.sides(first, gauss);
                angles[gauss] = angle(&sides[gauss]);
                let [x, y, z, ..] = sides[gauss][0];
                lengths[gauss] = norm([x, y, z]);
                whole = whole + Several::splat(self.basis.edges[gauss].weight) * lengths[gauss];
            }
            let over = whole.reciprocal_or_zero();
            let quarter = Several::literal(0.25 * PENALTY);
            *energy = Several::zero();
            for (gauss, rows) in gradients
                .chunks_exact_mut(EDGE_GRADIENT)
                .take(GAUSS)
                .enumerate()
            {
                let [near, far] = sides[gauss];
                let (angle, length) = (angles[gauss], lengths[gauss]);
                let [modulus, spontaneous] = [near[7], near[8]];
                let excess = half * (near[6] + far[6]) - spontaneous;
                let two = T::constant(2.0);
                let part = Several::splat(two * self.basis.edges[gauss].weight);
                let weight = part * modulus;
                let stiff = quarter * over * angle;
                let density = excess * angle + stiff * angle;
                *energy = *energy + weight * (length * density);
                rows[0] = weight * (length * (excess + stiff + stiff));
                rows[1] = half * (weight * (length * angle));
                rows[2] = half * (weight * density);
                rows[3] = half * (part * (length * density));
                rows[4] = -(half * (weight * (length * angle)));
            }
            // The length of the whole edge, by which the penalty is divided.
            let mut penalty = Several::zero();
            for gauss in 0..GAUSS {
                let two = T::constant(2.0);
                let part = Several::splat(two * self.basis.edges[gauss].weight);
                let strength = part * sides[gauss][0][7] * lengths[gauss];
                penalty =
                    penalty + strength * (quarter * over * over * angles[gauss] * angles[gauss]);
            }
            for (gauss, rows) in gradients
                .chunks_exact_mut(EDGE_GRADIENT)
                .take(GAUSS)
                .enumerate()
            {
                let part = Several::splat(self.basis.edges[gauss].weight);
                rows[2] = rows[2] - half * (part * penalty);
            }
            for lane in 0..WIDTH {
                if first + lane >= self.plan.interior_edges.len() {
                    energy.0[lane] = T::zero();
                }
            }
        }
    }
}

/// The numbers of an edge on both sides, at a quadrature point as the first side counts; x_t of the second
/// side runs backward.
#[inline(always)]
fn read_sides<T: Real>(
    edge_values: &[Several<T>],
    shared: &InteriorEdge,
    gauss: usize,
    mut set: impl FnMut(usize, usize, T),
) {
    for (side, &(patch, edge)) in shared.sides.iter().enumerate() {
        let gauss = if side == 0 { gauss } else { GAUSS - 1 - gauss };
        let (block, entry) = (patch as usize / WIDTH, patch as usize % WIDTH);
        let point = usize::from(edge) * GAUSS + gauss;
        let rows = &edge_values[block * PATCH_EDGE_VALUES + point * EDGE_VALUES..][..EDGE_VALUES];
        for (number, row) in rows.iter().enumerate() {
            set(side, number, row.0[entry]);
        }
    }
}

/// θ, positive where the surface is convex.
#[inline(always)]
fn angle<L: Lane>([near, far]: &[[L; EDGE_VALUES]; 2]) -> L {
    let along = [near[0], near[1], near[2]];
    let [one, other] = [near, far].map(|side| [side[3], side[4], side[5]]);
    let unit = scale(norm(along).reciprocal_or_zero(), along);
    dot(cross(one, other), unit).atan2(dot(one, other))
}

/// θ at one quadrature point.
pub(super) fn angle_of<T: Real>(
    edge_values: &[Several<T>],
    shared: &InteriorEdge,
    gauss: usize,
) -> T {
    let mut sides = [[T::zero(); EDGE_VALUES]; 2];
    read_sides(edge_values, shared, gauss, |side, number, value| {
        sides[side][number] = value;
    });
    angle(&sides)
}

impl<T: Real> Edges<'_, T> {
    /// The numbers of edges on both sides at a quadrature point.
    #[inline(always)]
    fn sides(&self, first: usize, gauss: usize) -> [[Several<T>; EDGE_VALUES]; 2] {
        let mut sides = [[Several::zero(); EDGE_VALUES]; 2];
        for lane in 0..WIDTH {
            let shared =
                &self.plan.interior_edges[(first + lane).min(self.plan.interior_edges.len() - 1)];
            read_sides(self.edge_values, shared, gauss, |side, number, value| {
                sides[side][number].0[lane] = value;
            });
        }
        sides
    }
}
