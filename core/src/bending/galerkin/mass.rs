//! The consistent mass matrix.
//!
//! Let a be normal displacements of the vertices. A jet whose neighbours move changes its height over a
//! point by `δ = g_k a_k + V c′`, where c′ is fitted to `g_j a_j − g_k a_k` with the same weights, and
//! `g_j = ν_j·(n − p_u t₁ − p_v t₂)` at neighbour j; in normal direction by `δ/√(1 + p_u² + p_v²)`. These
//! are blended as the jets are, and interpolated by polynomials of degree 6: `φ = Z a`. The mass matrix is
//! `M = Zᵀ ∫ φ φᵀ dS Z`; it is applied without its entries.

use super::basis::{AROUND, Basis, FREE, INSIDE, ON_EDGE, QUADRATURE, blend, inner_from};
use super::fit::{COUNT, Fit, Scratch};
use super::plan::{Block, Plan, STAR};
use super::polynomial::Polynomial;
use super::shape::Shape;
use super::vertices::Work;
use crate::bending::surface_point::Point;
use crate::element::{Execution, Ragged, SlotKernel, Slots, Strided};
use crate::fit::Points;
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::Vec3;
use alloc::vec::Vec;

/// Numbers for each neighbour: u, v, the weight, and g. Those of a block are a table that is stored by
/// [`columns`].
pub(super) type Neighbour<T> = [Several<T>; 4];

/// Numbers for each point around a vertex: u, v, and the weight of the blend over the root, stored alike.
type Spot<T> = [Several<T>; 3];

/// Data that stay the same while the equations are solved.
#[derive(Clone, Debug, Default)]
pub(super) struct Mass<T> {
    /// The unit normal ν of the jet of each vertex; 0 where there is none.
    pub(super) normals: Vec<[T; 3]>,
    own: Vec<Several<T>>,
    pub(super) neighbours: Vec<Neighbour<T>>,
    spots: Vec<Spot<T>>,
    /// Weighted areas of quadrature points.
    areas: Vec<[Several<T>; QUADRATURE]>,
    /// Displacements by jets, and what patches and jets return.
    shares: Vec<Several<T>>,
    returned: Vec<Several<T>>,
    pulls: Vec<Several<T>>,
    own_pulls: Vec<Several<T>>,
}

/// The columns of a table: all numbers of one kind stand together.
#[inline(always)]
pub(super) fn columns<const N: usize, L>(table: &[[L; N]]) -> [&[L]; N] {
    let (rows, numbers) = (table.len(), table.as_flattened());
    core::array::from_fn(|column| &numbers[column * rows..][..rows])
}

/// The same columns, to be set.
#[inline(always)]
fn columns_mut<const N: usize, L>(table: &mut [[L; N]]) -> [&mut [L]; N] {
    let rows = table.len();
    let mut rest = table.as_flattened_mut();
    core::array::from_fn(|_| {
        let (column, others) = core::mem::take(&mut rest).split_at_mut(rows);
        rest = others;
        column
    })
}

/// Sets what stays the same for a block.
struct Setup<'a, T> {
    plan: &'a Plan,
    surface: Surface<'a, T>,
    /// Normals of vertices, and of jets.
    normals: &'a [[T; 3]],
    jet_normals: &'a [[T; 3]],
    fits: &'a [Fit<T>],
    displacements: &'a [Several<T>],
}

type SetupSlots<'a, T> = (
    (Ragged<'a, Neighbour<T>>, Ragged<'a, Spot<T>>),
    &'a mut [Several<T>],
);

impl<'a, T: Real> SlotKernel<Work<T>, SetupSlots<'a, T>> for Setup<'_, T> {
    #[inline(always)]
    fn set(&self, work: &mut Work<T>, start: usize, ((rows, spots), own): SetupSlots<'a, T>) {
        let plan = self.plan;
        let slots = rows.into_slots().zip(spots.into_slots()).zip(own);
        for (number, ((rows, spots), own)) in (start..).zip(slots) {
            let (block, fit) = (&plan.blocks[number], &self.fits[number]);
            let neighbours = plan.neighbours_of(number);
            let scratch: &mut Scratch<T> = &mut work.scratch;
            scratch.place_again(fit, self.surface, block, neighbours, self.normals);
            let facing = |[by_u, by_v]: [Several<T>; 2], normal: Vec3<Several<T>>| {
                let [u, v, h] = fit.in_frame(normal);
                h - by_u * u - by_v * v
            };
            let [p, q, ..] = fit.coefficients;
            let jet = fit.polynomial();
            *own = facing([p, q], self.gather(&block.vertices));
            let [us, vs, weights, gs] = columns_mut(rows);
            for row in 0..us.len() {
                let [u, v] = [0, 1].map(|axis| scratch.places[axis][row]);
                let [_, by_u, by_v] = jet.with_slopes(u, v);
                let g = facing([by_u, by_v], self.gather(&neighbours[row]));
                (us[row], vs[row], weights[row], gs[row]) = (u, v, scratch.weights[row], g);
            }
            let stars = plan.star_offsets[number]..plan.star_offsets[number + 1];
            let displacements = &self.displacements[stars];
            scratch.set_spots(fit, block, displacements, columns_mut(spots));
        }
    }
}

impl<T: Real> Setup<'_, T> {
    #[inline(always)]
    fn gather(&self, vertices: &[u32; WIDTH]) -> Vec3<Several<T>> {
        let mut normal = [Several::zero(); 3];
        for (lane, &vertex) in vertices.iter().enumerate() {
            for (axis, &entry) in self.jet_normals[vertex as usize].iter().enumerate() {
                normal[axis].0[lane] = entry;
            }
        }
        normal
    }
}

/// Weighted areas of the quadrature points of patches.
struct Areas<'a, T> {
    shape: &'a Shape<T>,
    surface: Surface<'a, T>,
}

impl<'a, T: Real> SlotKernel<(), &'a mut [[Several<T>; QUADRATURE]]> for Areas<'_, T> {
    #[inline(always)]
    fn set(&self, (): &mut (), start: usize, slots: &'a mut [[Several<T>; QUADRATURE]]) {
        for (index, areas) in slots.iter_mut().enumerate() {
            let first = (start + index) * WIDTH;
            let patches = self.shape.patches(self.surface, first);
            for (area, node) in areas.iter_mut().zip(&self.shape.basis.bulk) {
                let point = Point::new(patches.derivatives(node));
                *area = Several::splat(node.weight) * point.area;
            }
        }
    }
}

/// Z as far as jets go: displacements at the points around each vertex.
struct Move<'a, T> {
    plan: &'a Plan,
    neighbours: &'a [Neighbour<T>],
    spots: &'a [Spot<T>],
    own: &'a [Several<T>],
    fits: &'a [Fit<T>],
    field: &'a [T],
}

impl<'a, T: Real> SlotKernel<Work<T>, Ragged<'a, Several<T>>> for Move<'_, T> {
    #[inline(always)]
    fn set(&self, work: &mut Work<T>, start: usize, slots: Ragged<'a, Several<T>>) {
        let plan = self.plan;
        for (number, shares) in (start..).zip(slots.into_slots()) {
            let block: &Block = &plan.blocks[number];
            let rows = plan.neighbour_offsets[number]..plan.neighbour_offsets[number + 1];
            let lists = &plan.neighbours[rows.clone()];
            let centre = Several::from_fn(|lane| self.field[block.vertices[lane] as usize]);
            let centre = self.own[number] * centre;
            let [x, y, weights, g] = columns(&self.neighbours[rows]);
            let values = g.iter().zip(lists).map(|(&g, list)| {
                g * Several::from_fn(|lane| self.field[list[lane] as usize]) - centre
            });
            let (sums, points) = (&mut work.scratch.sums, Points { x, y, weights });
            let field = sums.fitted(&self.fits[number], block.degree, points, values);
            let field = Polynomial::new(&field);
            let stars = plan.star_offsets[number]..plan.star_offsets[number + 1];
            let [us, vs, weights] = columns(&self.spots[stars]);
            for (((share, &u), &v), &weight) in shares.iter_mut().zip(us).zip(vs).zip(weights) {
                *share = weight * (centre + field.value(u, v));
            }
        }
    }
}

/// The mass matrix of patches: from displacements by jets and at corners to what the patch returns.
struct Weigh<'a, T> {
    plan: &'a Plan,
    basis: &'a Basis<T>,
    areas: &'a [[Several<T>; QUADRATURE]],
    shares: &'a [Several<T>],
    field: &'a [T],
}

impl<'a, T: Real> SlotKernel<(), Strided<'a, Several<T>>> for Weigh<'_, T> {
    #[inline(always)]
    fn set(&self, (): &mut (), start: usize, slots: Strided<'a, Several<T>>) {
        for (index, returned) in slots.into_slots().enumerate() {
            let first = (start + index) * WIDTH;
            let mut points = [Several::zero(); FREE];
            let mut corners = [Several::zero(); 3];
            for lane in 0..WIDTH {
                let patch = self.plan.patch_in(first, lane);
                for (corner, value) in corners.iter_mut().enumerate() {
                    value.0[lane] = self.field[patch.corners[corner] as usize];
                    let [star, other] = patch.stars[corner];
                    for k in 0..ON_EDGE {
                        let point = corner * ON_EDGE + k;
                        points[point].0[lane] += star.read(self.shares, k);
                        let point = (corner + 2) % 3 * ON_EDGE + ON_EDGE - 1 - k;
                        points[point].0[lane] += other.read(self.shares, k);
                    }
                    for k in 0..INSIDE {
                        let point = 3 * ON_EDGE + inner_from(corner, k);
                        points[point].0[lane] += star.read(self.shares, ON_EDGE + k);
                    }
                }
            }
            let mut sums = [Several::zero(); FREE + 3];
            for (node, &area) in self.basis.bulk.iter().zip(&self.areas[start + index]) {
                let mut value = Several::zero();
                for (&weight, &point) in node.values.iter().zip(&points) {
                    value = value + Several::splat(weight) * point;
                }
                for (&weight, &corner) in node.corners.iter().zip(&corners) {
                    value = value + Several::splat(weight) * corner;
                }
                let value = area * value;
                for (sum, &weight) in sums.iter_mut().zip(node.values.iter().chain(&node.corners)) {
                    *sum = *sum + Several::splat(weight) * value;
                }
            }
            returned[..FREE + 3].copy_from_slice(&sums);
        }
    }
}

/// The transpose of [`Move`].
struct Return<'a, T> {
    plan: &'a Plan,
    neighbours: &'a [Neighbour<T>],
    spots: &'a [Spot<T>],
    own: &'a [Several<T>],
    fits: &'a [Fit<T>],
    returned: &'a [Several<T>],
}

impl<'a, T: Real> SlotKernel<Work<T>, (Ragged<'a, Several<T>>, &'a mut [Several<T>])>
    for Return<'_, T>
{
    #[inline(always)]
    fn set(
        &self,
        work: &mut Work<T>,
        start: usize,
        (pulls, own): (Ragged<'a, Several<T>>, &'a mut [Several<T>]),
    ) {
        let plan = self.plan;
        for (number, (pulls, own)) in (start..).zip(pulls.into_slots().zip(own)) {
            plan.gather_returned(number, (self.returned, FREE + 3, 0), &mut work.given);
            let stars = plan.star_offsets[number]..plan.star_offsets[number + 1];
            let [x, y, weights] = columns(&self.spots[stars]);
            let (degree, points) = (plan.blocks[number].degree, Points { x, y, weights });
            let given = work.given.iter().copied();
            let by_coefficient = work.scratch.sums.project(degree, points, given);
            let mut centre = by_coefficient[0];
            let mut dual = [Several::zero(); COUNT];
            dual[..by_coefficient.len() - 1].copy_from_slice(&by_coefficient[1..]);
            self.fits[number].solve(&mut dual);
            let dual = Polynomial::new(&dual);
            let rows = plan.neighbour_offsets[number]..plan.neighbour_offsets[number + 1];
            let [us, vs, weights, gs] = columns(&self.neighbours[rows]);
            for (row, pull) in pulls.iter_mut().enumerate() {
                let share = weights[row] * dual.value(us[row], vs[row]);
                centre = centre - share;
                *pull = gs[row] * share;
            }
            *own = self.own[number] * centre;
        }
    }
}

impl<T: Real> Mass<T> {
    /// Sets what stays the same for the surface that was measured, whose jets are set.
    pub(super) fn set(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        shape: &Shape<T>,
        work: &mut Vec<Work<T>>,
    ) {
        let Shape {
            plan,
            normals,
            fits,
            displacements,
            ..
        } = shape;
        let count = plan.blocks.len();
        let zero = Several::zero();
        self.normals.resize(normals.len(), [T::zero(); 3]);
        execution.map(&mut self.normals[..], |vertex, normal| {
            let jet = shape.jet(vertex);
            *normal = jet.map_or([T::zero(); 3], |jet| jet.normal);
        });
        let rows = plan.neighbour_offsets[count];
        self.neighbours.resize(rows, [zero; 4]);
        self.pulls.resize(rows, zero);
        let stars = plan.star_offsets[count];
        self.spots.resize(stars, [zero; 3]);
        self.shares.resize(stars, zero);
        self.own.resize(count, zero);
        self.own_pulls.resize(count, zero);
        let blocks = plan.patches.len().div_ceil(WIDTH);
        self.areas.resize(blocks, [zero; QUADRATURE]);
        self.returned.resize(blocks * (FREE + 3), zero);
        let setup = Setup {
            plan,
            surface,
            normals,
            jet_normals: &self.normals,
            fits,
            displacements,
        };
        let slots = (
            (
                Ragged::new(&mut self.neighbours, &plan.neighbour_offsets),
                Ragged::new(&mut self.spots, &plan.star_offsets),
            ),
            &mut self.own[..],
        );
        execution.run(work, slots, &setup);
        let areas = Areas { shape, surface };
        execution.run(&mut Vec::new(), &mut self.areas[..], &areas);
    }

    /// Sets `image` to M times `field`.
    pub(super) fn apply(
        &mut self,
        execution: &impl Execution,
        shape: &Shape<T>,
        work: &mut Vec<Work<T>>,
        field: &[T],
        image: &mut [T],
    ) {
        let Shape { plan, fits, .. } = shape;
        let move_out = Move {
            plan,
            neighbours: &self.neighbours,
            spots: &self.spots,
            own: &self.own,
            fits,
            field,
        };
        let slots = Ragged::new(&mut self.shares, &plan.star_offsets);
        execution.run(work, slots, &move_out);
        self.weigh(execution, shape, work, field, image);
    }

    /// Sets `image` to `Zᵀ ∫ φ dS`: for each vertex the integral of the displacement that follows from a
    /// unit displacement of this vertex. `ones` is 1 everywhere.
    pub(super) fn integrate(
        &mut self,
        execution: &impl Execution,
        shape: &Shape<T>,
        work: &mut Vec<Work<T>>,
        ones: &[T],
        image: &mut [T],
    ) {
        execution.map(&mut self.shares[..], |row, share| {
            *share = Several::literal(blend(AROUND[row % STAR]));
        });
        self.weigh(execution, shape, work, ones, image);
    }

    /// Sets `image` from displacements by jets in `shares` and of the corners in `field`.
    fn weigh(
        &mut self,
        execution: &impl Execution,
        shape: &Shape<T>,
        work: &mut Vec<Work<T>>,
        field: &[T],
        image: &mut [T],
    ) {
        let Shape {
            plan, basis, fits, ..
        } = shape;
        let (neighbours, spots, own) = (&self.neighbours[..], &self.spots[..], &self.own[..]);
        let weigh = Weigh {
            plan,
            basis,
            areas: &self.areas,
            shares: &self.shares,
            field,
        };
        let slots = Strided::new(&mut self.returned, FREE + 3);
        execution.run(&mut Vec::new(), slots, &weigh);
        let bring_back = Return {
            plan,
            neighbours,
            spots,
            own,
            fits,
            returned: &self.returned,
        };
        let slots = (
            Ragged::new(&mut self.pulls, &plan.neighbour_offsets),
            &mut self.own_pulls[..],
        );
        execution.run(work, slots, &bring_back);
        let Self {
            pulls,
            own_pulls,
            returned,
            ..
        } = self;
        execution.map(image, |vertex, image| {
            let Some((block, lane)) = plan.members[vertex] else {
                *image = T::zero();
                return;
            };
            let mut sum = own_pulls[block as usize].0[usize::from(lane)];
            for place in plan.listed_at(vertex) {
                sum += place.read(pulls, 0);
            }
            for (patch, corner) in plan.patches_at(vertex) {
                sum += returned[patch / WIDTH * (FREE + 3) + FREE + corner].0[patch % WIDTH];
            }
            *image = sum;
        });
    }
}
