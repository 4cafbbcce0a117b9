//! The passes over patches: energies inside patches, the geometry along their edges, and the way back.

use super::basis::{FREE, GAUSS, QuadraturePoint};
use super::edges::{EDGE_GRADIENT, EDGE_GRADIENTS, EDGE_VALUES};
use super::material::Field;
use super::patch::{Bars, Patches, spread};
use super::plan::{NONE, RETURNED};
use super::shape::Shape;
use crate::bending::surface_point::Point;
use crate::element::{SlotKernel, Slots, Strided};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, norm, scale, sub};

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
    fn add_to_fields(
        &self,
        returned: &mut [Several<T>],
        node: &QuadraturePoint<T>,
        by: [Several<T>; 2],
    ) {
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
