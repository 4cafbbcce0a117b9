//! Regression of the force density, for the part of it that the mass matrix hardly determines.
//!
//! S replaces the value at each vertex by that of a polynomial of degree 8 in the plane of the jet, which is
//! fitted to the values at the vertex and its neighbours with weights `A w (u² + v² + 10⁻³)`, about
//! `A exp(−14 r²)`; w are the weights of the jet, A is a third of the triangles around a vertex. It changes smooth fields by the order h⁹.
//!
//! Let V be the monomials without the constant, W the weights and 1 a vector of ones. With `B = Vᵀ W V`,
//! `b = Vᵀ W 1` and `z = B⁻¹ b`, elimination of all coefficients but the constant leaves
//! `S_j = w_j (1 − V_j z)/(Σ w − b z)`. V is 0 at the vertex itself.

use super::fit::{CORE, COUNT, Fit, Scratch, within};
use super::mass::{Neighbour, columns};
use super::plan::{Plan, coefficient_count};
use super::polynomial::Polynomial;
use super::shape::Shape;
use super::vertices::Work;
use crate::element::{Execution, Ragged, SlotKernel, Slots};
use crate::fit::Points;
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// The matrix S, and means of a field with its positive weights.
#[derive(Clone, Debug, Default)]
pub(super) struct Smoothing<T> {
    weights: Vec<Several<T>>,
    own: Vec<Several<T>>,
    means: Vec<Several<T>>,
    /// The weights with which each vertex is listed, in the order of [`Plan::listed_at`].
    listed: Vec<T>,
    sums: Vec<Several<T>>,
}

/// Sets rows of S.
struct Regressions<'a, T> {
    plan: &'a Plan,
    neighbours: &'a [Neighbour<T>],
    fits: &'a [Fit<T>],
    /// Relative to the mean; 0 where a vertex is not used.
    areas: &'a [T],
    mean_area: T,
    field: &'a [T],
}

type RegressionSlots<'a, T> = (
    (Ragged<'a, Several<T>>, &'a mut [Several<T>]),
    &'a mut [Several<T>],
);

impl<'a, T: Real> SlotKernel<Work<T>, RegressionSlots<'a, T>> for Regressions<'_, T> {
    #[inline(always)]
    fn set(&self, work: &mut Work<T>, start: usize, ((rows, own), means): RegressionSlots<'a, T>) {
        let mut regression = Fit::default();
        let slots = rows.into_slots().zip(own).zip(means);
        for (number, ((rows, own), mean)) in (start..).zip(slots) {
            let (block, fit) = (&self.plan.blocks[number], &self.fits[number]);
            let lists = self.plan.neighbours_of(number);
            let range =
                self.plan.neighbour_offsets[number]..self.plan.neighbour_offsets[number + 1];
            let [us, vs, weights, _] = columns(&self.neighbours[range]);
            let Scratch {
                weights: products,
                sums,
                ..
            } = &mut work.scratch;
            products.clear();
            // On even meshes the matrix is then about that of the fits.
            let over = Several::literal(within(block.degree) / PI) * Several::splat(self.mean_area);
            let over = over * fit.over_radius * fit.over_radius;
            let own_weight = over * gathered(self.areas, &block.vertices);
            let mut sum = own_weight * gathered(self.field, &block.vertices);
            for (row, list) in lists.iter().enumerate() {
                let (u, v) = (us[row], vs[row]);
                // Without the second factor of the weights of the fits, except for heights.
                let closeness = u * u + v * v + Several::literal(CORE);
                let weight = weights[row] * closeness * over * gathered(self.areas, list);
                let used: [bool; WIDTH] = block.counts.map(|count| row < count as usize);
                let weight = Several::select(used, weight, Several::zero());
                products.push(weight);
                sum = sum + weight * gathered(self.field, list);
            }
            let points = Points {
                x: us,
                y: vs,
                weights: products,
            };
            sums.set_matrix(&mut regression, block.degree, points);
            let moments = &sums.moments;
            let count = coefficient_count(block.degree);
            let mut solution = [Several::zero(); COUNT];
            solution[..count].copy_from_slice(&moments[1..=count]);
            regression.solve(&mut solution);
            let total = own_weight + moments[0];
            *mean = sum * total.reciprocal_or_zero();
            let mut left = total;
            for (&moment, &part) in moments[1..=count].iter().zip(&solution) {
                left = left - moment * part;
            }
            let over = left.reciprocal_or_zero();
            *own = own_weight * over;
            let solution = Polynomial::new(&solution);
            for (row, entry) in rows.iter_mut().enumerate() {
                let part = Several::literal(1.0) - solution.value(us[row], vs[row]);
                *entry = points.weights[row] * part * over;
            }
        }
    }
}

#[inline(always)]
fn gathered<T: Real>(field: &[T], vertices: &[u32; WIDTH]) -> Several<T> {
    Several::from_fn(|lane| field[vertices[lane] as usize])
}

/// S times a field.
struct Smooth<'a, T> {
    plan: &'a Plan,
    weights: &'a [Several<T>],
    own: &'a [Several<T>],
    field: &'a [T],
}

impl<'a, T: Real> SlotKernel<(), &'a mut [Several<T>]> for Smooth<'_, T> {
    #[inline(always)]
    fn set(&self, (): &mut (), start: usize, sums: &'a mut [Several<T>]) {
        for (number, sum) in (start..).zip(sums) {
            let rows = self.plan.neighbour_offsets[number]..self.plan.neighbour_offsets[number + 1];
            let lists = &self.plan.neighbours[rows.clone()];
            *sum = self.own[number] * gathered(self.field, &self.plan.blocks[number].vertices);
            for (&weight, list) in self.weights[rows].iter().zip(lists) {
                *sum = *sum + weight * gathered(self.field, list);
            }
        }
    }
}

impl<T: Real> Smoothing<T> {
    /// Sets S, and the means of `field`. `areas` are relative to `mean_area`, and 0 where a vertex is not used.
    pub(super) fn set(
        &mut self,
        execution: &impl Execution,
        (shape, neighbours): (&Shape<T>, &[Neighbour<T>]),
        work: &mut Vec<Work<T>>,
        (areas, mean_area): (&[T], T),
        field: &[T],
    ) {
        let plan = &shape.plan;
        let count = plan.blocks.len();
        let zero = Several::zero();
        self.weights.resize(plan.neighbour_offsets[count], zero);
        for blocks in [&mut self.own, &mut self.means, &mut self.sums] {
            blocks.resize(count, zero);
        }
        let regressions = Regressions {
            plan,
            neighbours,
            fits: &shape.fits,
            areas,
            mean_area,
            field,
        };
        let rows = Ragged::new(&mut self.weights, &plan.neighbour_offsets);
        let slots = ((rows, &mut self.own[..]), &mut self.means[..]);
        execution.run(work, slots, &regressions);
        self.listed.resize(plan.listed.len(), T::zero());
        let weights = &self.weights;
        execution.map(&mut self.listed[..], |k, weight| {
            *weight = plan.listed[k].read(weights, 0);
        });
    }

    /// The mean around a vertex of the field that was given to [`Self::set`].
    pub(super) fn mean(&self, plan: &Plan, vertex: usize) -> T {
        let member = plan.members[vertex];
        member.map_or(T::zero(), |(block, lane)| {
            self.means[block as usize].0[usize::from(lane)]
        })
    }

    /// Sets `image` to S times `field`.
    pub(super) fn smooth(
        &mut self,
        execution: &impl Execution,
        plan: &Plan,
        field: &[T],
        image: &mut [T],
    ) {
        let smooth = Smooth {
            plan,
            weights: &self.weights,
            own: &self.own,
            field,
        };
        execution.run(&mut Vec::new(), &mut self.sums[..], &smooth);
        let sums = &self.sums;
        execution.map(image, |vertex, image| {
            *image = plan.members[vertex].map_or(T::zero(), |(block, lane)| {
                sums[block as usize].0[usize::from(lane)]
            });
        });
    }

    /// Sets `image` to Sᵀ times `field`.
    pub(super) fn spread(
        &self,
        execution: &impl Execution,
        plan: &Plan,
        field: &[T],
        image: &mut [T],
    ) {
        let (own, weights) = (&self.own, &self.listed);
        execution.map(image, |vertex, image| {
            let Some((block, lane)) = plan.members[vertex] else {
                *image = T::zero();
                return;
            };
            let mut sum = own[block as usize].0[usize::from(lane)] * field[vertex];
            let weights = &weights[plan.listed_offsets[vertex]..];
            for (place, &weight) in plan.listed_at(vertex).iter().zip(weights) {
                sum += weight * field[place.vertex as usize];
            }
            *image = sum;
        });
    }
}
