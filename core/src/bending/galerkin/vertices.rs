//! The loops over vertices: fits and displacements, and their derivatives.

use super::basis::{FREE, ON_EDGE, inner_from};
use super::fit::{FieldPull, Fit, FitScratch};
use super::material::Field;
use super::plan::{COUNT, NONE, Plan, RETURNED, STAR, Vectors, VertexBlock};
use crate::element::{Ragged, SlotKernel, Slots};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, scale, sub};
use alloc::vec::Vec;

/// Memory of a worker.
#[derive(Clone, Debug, Default)]
pub(super) struct Work<T> {
    pub(super) scratch: FitScratch<T>,
    /// Derivatives with respect to displacements.
    pub(super) given: Vec<Several<T>>,
    /// The same with respect to parameters that vary, and their values at neighbours.
    fields: [[Vec<Several<T>>; 2]; 2],
    /// Normals at the one-ring.
    ring: Vec<Vec3<Several<T>>>,
}

/// Fits, and displacements of the points that they place.
pub(super) struct Forward<'a, T> {
    pub(super) plan: &'a Plan,
    pub(super) surface: Surface<'a, T>,
    pub(super) normals: &'a [[T; 3]],
}

impl<'a, T: Real> SlotKernel<Work<T>, (&'a mut [Fit<T>], Ragged<'a, Several<T>>)>
    for Forward<'_, T>
{
    #[inline(always)]
    fn set(
        &self,
        work: &mut Work<T>,
        start: usize,
        (fits, displacements): (&'a mut [Fit<T>], Ragged<'a, Several<T>>),
    ) {
        let slots = fits.iter_mut().zip(displacements.into_slots());
        for (number, (fit, displacements)) in (start..).zip(slots) {
            let block = &self.plan.blocks[number];
            let neighbours = self.plan.neighbours_of(number);
            let scratch = &mut work.scratch;
            scratch.place(fit, self.surface, block, neighbours, self.normals);
            scratch.fit(fit, block.degree);
            scratch.displace(fit, block, displacements);
        }
    }
}

impl Plan {
    #[inline(always)]
    pub(super) fn neighbours_of(&self, block: usize) -> &[[u32; WIDTH]] {
        &self.neighbours[self.neighbour_offsets[block]..self.neighbour_offsets[block + 1]]
    }

    /// Gathers ∂E/∂displacement around the vertices of a block from the patch gradients (`returned`), without the
    /// weights of the blend. Blocks of rows are `stride` apart, and their first `skipped` rows are others. A point on an
    /// edge receives the sum of both patches.
    #[inline(always)]
    pub(super) fn gather_returned<T: Real>(
        &self,
        number: usize,
        (returned, stride, skipped): (&[Several<T>], usize, usize),
        given: &mut Vec<Several<T>>,
    ) {
        let rows = &self.around[self.ring_offsets[number]..self.ring_offsets[number + 1]];
        let block: &VertexBlock = &self.blocks[number];
        given.clear();
        given.resize(rows.len() * STAR, Several::zero());
        for (row, triangles) in rows.iter().enumerate() {
            for (lane, &triangle) in triangles.iter().enumerate() {
                let valence = block.valences[lane] as usize;
                if triangle == NONE || row >= valence {
                    continue;
                }
                let (patch, corner) = (triangle as usize / 3, triangle as usize % 3);
                let read = |point: usize| {
                    returned[patch / WIDTH * stride + skipped + point].0[patch % WIDTH]
                };
                for k in 0..STAR {
                    let point = if k < ON_EDGE {
                        corner * ON_EDGE + k
                    } else {
                        3 * ON_EDGE + inner_from(corner, k - ON_EDGE)
                    };
                    debug_assert!(point < FREE);
                    given[row * STAR + k].0[lane] += read(point);
                }
                // The edge to the other corner, which the patch counts from there.
                let next = (row + 1) % valence;
                for k in 0..ON_EDGE {
                    let point = (corner + 2) % 3 * ON_EDGE + ON_EDGE - 1 - k;
                    given[next * STAR + k].0[lane] += read(point);
                }
            }
        }
    }
}

/// Derivatives with respect to the positions of neighbours, to the normals at the one-ring, and to the
/// vertices' own positions and normals.
pub(super) struct Backward<'a, T> {
    pub(super) plan: &'a Plan,
    pub(super) surface: Surface<'a, T>,
    pub(super) normals: &'a [[T; 3]],
    pub(super) fits: &'a [Fit<T>],
    pub(super) displacements: &'a [Several<T>],
    pub(super) returned: &'a [Several<T>],
    pub(super) material: [Field<'a, T>; 2],
}

type BackwardSlots<'a, T> = (
    (Ragged<'a, Vectors<T>>, Ragged<'a, Vectors<T>>),
    &'a mut [[Vec3<Several<T>>; 2]],
);

impl<'a, T: Real> SlotKernel<Work<T>, BackwardSlots<'a, T>> for Backward<'_, T> {
    #[inline(always)]
    fn set(&self, work: &mut Work<T>, start: usize, ((pulls, turns), own): BackwardSlots<'a, T>) {
        let slots = pulls.into_slots().zip(turns.into_slots()).zip(own);
        let plan = self.plan;
        for (number, ((pulls, turns), own)) in (start..).zip(slots) {
            let block = &plan.blocks[number];
            // The radius of a fit, its frame and its normal are set again, to the same bits.
            let fit = &self.fits[number];
            let neighbours = plan.neighbours_of(number);
            let Work {
                scratch,
                given,
                fields,
                ring,
            } = work;
            scratch.place_again(fit, self.surface, block, neighbours, self.normals);
            let stride = self.stride();
            plan.gather_returned(number, (self.returned, stride, 0), given);
            let stars = plan.star_offsets[number]..plan.star_offsets[number + 1];
            let displacements = &self.displacements[stars];
            let [first, second] = fields;
            let [modulus, spontaneous] = self.material;
            let mut pulls_of_fields = [
                self.field(modulus, number, RETURNED, first),
                self.field(
                    spontaneous,
                    number,
                    RETURNED + if modulus.varies() { FREE } else { 0 },
                    second,
                ),
            ];
            let (by_coefficient, by_radius) =
                scratch.pull_points(fit, block, displacements, given, &mut pulls_of_fields);
            ring.clear();
            for neighbours in neighbours.iter().take(turns.len()) {
                let mut normal = [Several::zero(); 3];
                for (lane, &neighbour) in neighbours.iter().enumerate() {
                    for (axis, &entry) in self.normals[neighbour as usize].iter().enumerate() {
                        normal[axis].0[lane] = entry;
                    }
                }
                ring.push(normal);
            }
            let turn = scratch.pull(
                fit,
                block,
                by_coefficient,
                by_radius,
                ring,
                &mut pulls_of_fields,
            );
            let mut push = [Several::zero(); 3];
            for (row, (pull, bars)) in pulls.iter_mut().zip(&scratch.bars).enumerate() {
                let used: [bool; WIDTH] = block.counts.map(|count| row < count as usize);
                let used = Several::select(used, Several::literal(1.0), Several::zero());
                push = sub(push, scale(used, *bars));
                *pull = entries(bars);
            }
            for (turn, bars) in turns.iter_mut().zip(&scratch.normal_bars) {
                *turn = entries(bars);
            }
            *own = [push, turn];
        }
    }
}

/// The vectors of the members.
#[inline(always)]
fn entries<T: Real>(vectors: &Vec3<Several<T>>) -> Vectors<T> {
    core::array::from_fn(|lane| vectors.map(|axis| axis.0[lane]))
}

impl<T: Real> Backward<'_, T> {
    /// A parameter that varies, with what patches return for it after `skipped` rows.
    #[inline(always)]
    fn field<'b>(
        &'b self,
        field: Field<'b, T>,
        number: usize,
        skipped: usize,
        [given, values]: &'b mut [Vec<Several<T>>; 2],
    ) -> Option<FieldPull<'b, T>> {
        let coefficients = field.of_block(self.plan, number, values)?;
        let returned = (self.returned, self.stride(), skipped);
        self.plan.gather_returned(number, returned, given);
        Some(FieldPull {
            coefficients,
            values,
            given,
            by_coefficient: [Several::zero(); COUNT],
        })
    }

    /// Rows of a patch gradient.
    fn stride(&self) -> usize {
        RETURNED + FREE * self.material.iter().filter(|field| field.varies()).count()
    }
}
