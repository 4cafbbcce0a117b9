//! Patches: surfaces of degree 6 over eight triangles at once.

use super::basis::{FREE, POINTS, QuadraturePoint};
use super::plan::{Plan, gather_blended};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, norm, scale, sub};

/// The points of patches, and the derivatives of the energy with respect to them.
#[derive(Clone, Debug)]
pub(super) struct Bars<T> {
    pub(super) points: [Vec3<Several<T>>; FREE],
    pub(super) edges: [Vec3<Several<T>>; 2],
}

impl<T: Real> Default for Bars<T> {
    fn default() -> Self {
        let zero = [Several::zero(); 3];
        Self {
            points: [zero; FREE],
            edges: [zero; 2],
        }
    }
}

/// Eight patches.
pub(super) struct Patches<T> {
    /// From the first corner to the second and third.
    edges: [Vec3<Several<T>>; 2],
    /// The direction of each free point, 1 over the length of `Σ λ_k n_k`, and the displacement.
    directions: [Vec3<Several<T>>; FREE],
    over_lengths: [Several<T>; FREE],
    displacements: [Several<T>; FREE],
    points: [Vec3<Several<T>>; FREE],
}

impl<T: Real> Patches<T> {
    /// The patches from number `first` on; the last one repeats.
    #[inline(always)]
    pub(super) fn gather(
        plan: &Plan,
        surface: Surface<'_, T>,
        normals: &[[T; 3]],
        displacements: &[Several<T>],
        first: usize,
    ) -> Self {
        let zero = [Several::zero(); 3];
        let mut edges = [zero; 2];
        let mut corners = [zero; 3];
        for lane in 0..WIDTH {
            let patch = plan.patch_in(first, lane);
            let [origin, second, third] = patch.corners;
            for (edge, corner) in edges.iter_mut().zip([second, third]) {
                let difference = surface.difference(origin, corner);
                for axis in 0..3 {
                    edge[axis].0[lane] = difference[axis];
                }
            }
            for corner in 0..3 {
                let normal = normals[patch.corners[corner] as usize];
                for axis in 0..3 {
                    corners[corner][axis].0[lane] = normal[axis];
                }
            }
        }
        let mut patches = Self {
            edges,
            directions: [zero; FREE],
            over_lengths: [Several::zero(); FREE],
            displacements: gather_blended(plan, displacements, first),
            points: [zero; FREE],
        };
        for (k, place) in POINTS.iter().enumerate() {
            let mut sum = zero;
            for (&part, &normal) in place.iter().zip(&corners) {
                if part > 0.0 {
                    sum = add(sum, scale(Several::literal(part), normal));
                }
            }
            let over = norm(sum).reciprocal_or_zero();
            patches.over_lengths[k] = over;
            patches.directions[k] = scale(over, sum);
            patches.points[k] = scale(patches.displacements[k], patches.directions[k]);
        }
        patches
    }

    /// The surface at a quadrature point: the first N of x_v, x_w, x_vv, x_vw and x_ww.
    #[inline(always)]
    pub(super) fn derivatives<const N: usize>(
        &self,
        node: &QuadraturePoint<T>,
    ) -> [Vec3<Several<T>>; N] {
        let mut derivatives = [[Several::zero(); 3]; N];
        derivatives[..2].copy_from_slice(&self.edges);
        for (point, weights) in self.points.iter().zip(&node.derivatives) {
            for (derivative, &weight) in derivatives.iter_mut().zip(weights) {
                let weight = Several::splat(weight);
                for axis in 0..3 {
                    derivative[axis] = derivative[axis] + weight * point[axis];
                }
            }
        }
        derivatives
    }

    /// The surface at a quadrature point, relative to the first corner.
    #[inline(always)]
    pub(super) fn position(&self, node: &QuadraturePoint<T>) -> Vec3<Several<T>> {
        let [v, w] = node.place.map(Several::splat);
        let mut position = add(scale(v, self.edges[0]), scale(w, self.edges[1]));
        for (point, &weight) in self.points.iter().zip(&node.values) {
            position = add(position, scale(Several::splat(weight), *point));
        }
        position
    }

    /// From derivatives with respect to the points: those with respect to displacements, and to position
    /// and normal of each corner.
    #[inline(always)]
    pub(super) fn give_back(&self, bars: &Bars<T>, returned: &mut [Several<T>]) {
        let zero = [Several::zero(); 3];
        let mut normals = [zero; 3];
        for k in 0..FREE {
            let bar = bars.points[k];
            let along = dot(bar, self.directions[k]);
            returned[k] = along;
            let across = sub(bar, scale(along, self.directions[k]));
            let turn = scale(self.displacements[k] * self.over_lengths[k], across);
            for (corner, normal) in normals.iter_mut().enumerate() {
                if POINTS[k][corner] > 0.0 {
                    *normal = add(*normal, scale(Several::literal(POINTS[k][corner]), turn));
                }
            }
        }
        let [second, third] = bars.edges;
        let first = scale(Several::literal(-1.0), add(second, third));
        for (corner, place) in [first, second, third].into_iter().enumerate() {
            let rows = &mut returned[FREE + 6 * corner..][..6];
            rows[..3].copy_from_slice(&place);
            rows[3..].copy_from_slice(&normals[corner]);
        }
    }
}

impl<T: Real> Bars<T> {
    /// Adds the derivative with respect to [`Patches::position`].
    #[inline(always)]
    pub(super) fn add_position(&mut self, node: &QuadraturePoint<T>, given: Vec3<Several<T>>) {
        for (bar, &weight) in self.points.iter_mut().zip(&node.values) {
            *bar = add(*bar, scale(Several::splat(weight), given));
        }
        for (bar, &part) in self.edges.iter_mut().zip(&node.place) {
            *bar = add(*bar, scale(Several::splat(part), given));
        }
    }
}

/// Adds the derivatives with respect to [`Patches::derivatives`] to those with respect to the points.
#[inline(always)]
pub(super) fn spread<T: Real, const N: usize>(
    bars: &mut Bars<T>,
    node: &QuadraturePoint<T>,
    given: &[Vec3<Several<T>>; N],
) {
    for (bar, weights) in bars.points.iter_mut().zip(&node.derivatives) {
        for axis in 0..3 {
            let mut sum = bar[axis];
            for (given, &weight) in given.iter().zip(weights) {
                sum = sum + Several::splat(weight) * given[axis];
            }
            bar[axis] = sum;
        }
    }
    bars.edges[0] = add(bars.edges[0], given[0]);
    bars.edges[1] = add(bars.edges[1], given[1]);
}
