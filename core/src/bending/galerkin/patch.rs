//! Patches: surfaces of degree 6 over eight triangles at once, their energy, and its derivatives.

use super::basis::{AROUND, FREE, GAUSS, INSIDE, Node, ON_EDGE, POINTS, blend, inner_from};
use super::fields::Field;
use super::plan::{NONE, Plan};
use super::shape::Shape;
use crate::bending::surface_point::Point;
use crate::element::{SlotKernel, Strided};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub};

/// Numbers at each quadrature point of an edge: x_t, n, H, κ and H0.
pub(super) const EDGE_VALUES: usize = 9;
/// Rows of these of a patch.
pub(super) const PATCH_EDGE_VALUES: usize = 3 * GAUSS * EDGE_VALUES;
/// Gradient entries of an edge at each quadrature point: with respect to the angle, and to H, the length, κ and H0 on one
/// side.
pub(super) const EDGE_GRADIENT: usize = 5;
/// Rows of these of an edge.
pub(super) const EDGE_GRADIENTS: usize = GAUSS * EDGE_GRADIENT;
/// Rows of what a patch returns: derivatives with respect to the displacements of free points, and to
/// the position and the normal of each corner. Derivatives with respect to parameters that vary follow, at
/// free points.
pub(super) const RETURNED: usize = FREE + 3 * 6;

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
    pub(super) fn derivatives<const N: usize>(&self, node: &Node<T>) -> [Vec3<Several<T>>; N] {
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
    pub(super) fn position(&self, node: &Node<T>) -> Vec3<Several<T>> {
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

/// The blend of what jets give to the free points of patches.
#[inline(always)]
pub(super) fn gather_blended<T: Real>(
    plan: &Plan,
    shares: &[Several<T>],
    first: usize,
) -> [Several<T>; FREE] {
    let zero = Several::zero();
    let (mut near, mut far) = ([[zero; ON_EDGE]; 3], [[zero; ON_EDGE]; 3]);
    let mut inside = [[zero; INSIDE]; 3];
    for lane in 0..WIDTH {
        let patch = plan.patch_in(first, lane);
        for corner in 0..3 {
            let [star, other] = patch.stars[corner];
            // The edge that ends here, from its other end.
            let ending = (corner + 2) % 3;
            for k in 0..ON_EDGE {
                near[corner][k].0[lane] = star.read(shares, k);
                far[ending][ON_EDGE - 1 - k].0[lane] = other.read(shares, k);
            }
            for (k, value) in inside[corner].iter_mut().enumerate() {
                value.0[lane] = star.read(shares, ON_EDGE + k);
            }
        }
    }
    let mut sums = [zero; FREE];
    for edge in 0..3 {
        for k in 0..ON_EDGE {
            let [own, next, _] = AROUND[k];
            let weights = [[own, next, 0.0], [next, own, 0.0]].map(blend);
            sums[edge * ON_EDGE + k] = Several::literal(weights[0]) * near[edge][k]
                + Several::literal(weights[1]) * far[edge][k];
        }
    }
    for (corner, inside) in inside.iter().enumerate() {
        for (k, &value) in inside.iter().enumerate() {
            let point = 3 * ON_EDGE + inner_from(corner, k);
            let weight = Several::literal(blend(AROUND[ON_EDGE + k]));
            sums[point] = sums[point] + weight * value;
        }
    }
    sums
}

impl<T: Real> Bars<T> {
    /// Adds the derivative with respect to [`Patches::position`].
    #[inline(always)]
    pub(super) fn add_position(&mut self, node: &Node<T>, given: Vec3<Several<T>>) {
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
    node: &Node<T>,
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

/// The tangent along a local edge, from x_v and x_w.
#[inline(always)]
fn tangent<L: Lane>(edge: usize, v: Vec3<L>, w: Vec3<L>) -> Vec3<L> {
    match edge {
        0 => v,
        1 => sub(w, v),
        _ => sub([L::zero(); 3], w),
    }
}

/// First pass: energies inside patches, the geometry along their edges, and with `GRADIENT` the
/// derivatives of these energies.
pub(super) struct Inside<'a, T, const GRADIENT: bool> {
    pub(super) shape: &'a Shape<T>,
    pub(super) surface: Surface<'a, T>,
    /// Bending modulus and spontaneous curvature.
    pub(super) material: [Field<'a, T>; 2],
}

/// Energies, geometry along edges, and derivatives, for each block of patches.
type InsideSlots<'a, T> = (
    (&'a mut [Several<T>], Strided<'a, Several<T>>),
    &'a mut [Bars<T>],
);

impl<'a, T: Real, const GRADIENT: bool> SlotKernel<(), InsideSlots<'a, T>>
    for Inside<'_, T, GRADIENT>
{
    #[inline(always)]
    fn set(&self, (): &mut (), start: usize, ((energies, edge_values), bars): InsideSlots<'a, T>) {
        use crate::element::Slots;
        let slots = energies.iter_mut().zip(edge_values.into_slots()).zip(bars);
        for (index, ((energy, values), bars)) in slots.enumerate() {
            let first = (start + index) * WIDTH;
            let patches = self.shape.patches(self.surface, first);
            *energy = Several::zero();
            if GRADIENT {
                *bars = Bars::default();
            }
            let [modulus, spontaneous] = [
                self.material[0].on_patches(&self.shape.plan, first),
                self.material[1].on_patches(&self.shape.plan, first),
            ];
            for node in &self.shape.basis.bulk {
                let point = Point::new(patches.derivatives(node));
                let strength = Several::splat(node.weight) * modulus.at(node);
                let spontaneous = spontaneous.at(node);
                *energy = *energy + point.energy(strength, spontaneous);
                if GRADIENT {
                    spread(bars, node, &point.gradient(strength, spontaneous));
                }
            }
            for (number, (node, values)) in (self.shape.basis.edges.iter())
                .zip(values.chunks_exact_mut(EDGE_VALUES))
                .enumerate()
            {
                let derivatives = patches.derivatives(node);
                let point = Point::new(derivatives);
                let along = tangent(number / GAUSS, derivatives[0], derivatives[1]);
                values[..3].copy_from_slice(&along);
                values[3..6].copy_from_slice(&point.normal);
                values[6] = point.mean();
                values[7] = modulus.at(node);
                values[8] = spontaneous.at(node);
            }
            // Entries that no patch is left for count nothing.
            for lane in 0..WIDTH {
                if first + lane >= self.shape.plan.patches.len() {
                    energy.0[lane] = T::zero();
                }
            }
        }
    }
}

/// Last pass: all derivatives with respect to what patches are made of.
pub(super) struct Back<'a, T> {
    pub(super) shape: &'a Shape<T>,
    pub(super) surface: Surface<'a, T>,
    pub(super) inside: &'a [Bars<T>],
    pub(super) edge_gradients: &'a [Several<T>],
    pub(super) material: [Field<'a, T>; 2],
}

impl<'a, T: Real> SlotKernel<(), Strided<'a, Several<T>>> for Back<'_, T> {
    #[inline(always)]
    fn set(&self, (): &mut (), start: usize, slots: Strided<'a, Several<T>>) {
        use crate::element::Slots;
        for (index, returned) in slots.into_slots().enumerate() {
            let first = (start + index) * WIDTH;
            let patches = self.shape.patches(self.surface, first);
            let mut bars = self.inside[start + index].clone();
            self.set_fields(&patches, first, returned);
            for (number, node) in self.shape.basis.edges.iter().enumerate() {
                let (edge, gauss) = (number / GAUSS, number % GAUSS);
                let given = self.edge_gradient(first, edge, gauss);
                let derivatives = patches.derivatives(node);
                let point = Point::new(derivatives);
                let along = tangent(edge, derivatives[0], derivatives[1]);
                let unit = scale(norm(along).reciprocal_or_zero(), along);
                // θ grows as n turns about the tangent of the other side, which runs backward.
                let turn = cross(point.normal, unit);
                let mut by = point.pull(given[1], scale(given[0], turn));
                let stretch = scale(given[2], unit);
                match edge {
                    0 => by[0] = add(by[0], stretch),
                    1 => {
                        by[0] = sub(by[0], stretch);
                        by[1] = add(by[1], stretch);
                    }
                    _ => by[1] = sub(by[1], stretch),
                }
                spread(&mut bars, node, &by);
                self.add_to_fields(returned, node, [given[3], given[4]]);
            }
            patches.give_back(&bars, returned);
        }
    }
}

impl<T: Real> Back<'_, T> {
    /// Sets the derivatives of the energies inside patches with respect to parameters that vary.
    #[inline(always)]
    fn set_fields(&self, patches: &Patches<T>, first: usize, returned: &mut [Several<T>]) {
        let [modulus, spontaneous] = self.material;
        returned[RETURNED..].fill(Several::zero());
        if !(modulus.varies() || spontaneous.varies()) {
            return;
        }
        let modulus = modulus.on_patches(&self.shape.plan, first);
        let spontaneous = spontaneous.on_patches(&self.shape.plan, first);
        for node in &self.shape.basis.bulk {
            let point = Point::new(patches.derivatives(node));
            let weight = Several::splat(node.weight);
            let wanted = spontaneous.at(node);
            let by_modulus = point.energy(weight, wanted);
            let excess = point.mean() - wanted;
            let by_spontaneous =
                Several::literal(-4.0) * weight * modulus.at(node) * excess * point.area;
            self.add_to_fields(returned, node, [by_modulus, by_spontaneous]);
        }
    }

    /// Adds derivatives at a quadrature point to those with respect to values at free points.
    #[inline(always)]
    fn add_to_fields(&self, returned: &mut [Several<T>], node: &Node<T>, by: [Several<T>; 2]) {
        let mut rest = &mut returned[RETURNED..];
        for (field, by) in self.material.iter().zip(by) {
            if field.varies() {
                let (own, others) = rest.split_at_mut(FREE);
                for (sum, &weight) in own.iter_mut().zip(&node.values) {
                    *sum = *sum + Several::splat(weight) * by;
                }
                rest = others;
            }
        }
    }

    /// The derivatives that edges return for a quadrature point.
    #[inline(always)]
    fn edge_gradient(
        &self,
        first: usize,
        edge: usize,
        gauss: usize,
    ) -> [Several<T>; EDGE_GRADIENT] {
        let mut given = [Several::zero(); EDGE_GRADIENT];
        for lane in 0..WIDTH {
            let patch = self.shape.plan.patch_in(first, lane);
            let (shared, reversed) = patch.edges[edge];
            if shared == NONE {
                continue;
            }
            let (block, entry) = (shared as usize / WIDTH, shared as usize % WIDTH);
            let gauss = if reversed { GAUSS - 1 - gauss } else { gauss };
            let rows = &self.edge_gradients[block * EDGE_GRADIENTS + gauss * EDGE_GRADIENT..]
                [..EDGE_GRADIENT];
            for (given, row) in given.iter_mut().zip(rows) {
                given.0[lane] = row.0[entry];
            }
        }
        given
    }
}
