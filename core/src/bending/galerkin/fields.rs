//! A bending modulus or spontaneous curvature that varies: fitted to neighbours, blended and interpolated
//! as the surface itself is, because f has their second derivatives.

use super::fit::Fit;
use super::material::{Field, differences_of};
use super::plan::{COUNT, Plan};
use super::shape::Shape;
use super::vertices::Work;
use crate::bending::MaterialParameter;
use crate::element::{Execution, Ragged, SlotKernel, Slots};
use crate::lane::{Lane, Several};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// Polynomials of a field, and its values at the points around each vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldMemory<T> {
    pub(super) fits: Vec<[Several<T>; COUNT]>,
    pub(super) shares: Vec<Several<T>>,
}

/// Fits a field to the neighbours of each vertex.
struct Forward<'a, T> {
    plan: &'a Plan,
    surface: Surface<'a, T>,
    normals: &'a [[T; 3]],
    fits: &'a [Fit<T>],
    displacements: &'a [Several<T>],
    values: &'a [T],
}

type ForwardSlots<'a, T> = (&'a mut [[Several<T>; COUNT]], Ragged<'a, Several<T>>);

impl<'a, T: Real> SlotKernel<Work<T>, ForwardSlots<'a, T>> for Forward<'_, T> {
    #[inline(always)]
    fn set(&self, work: &mut Work<T>, start: usize, (fits, shares): ForwardSlots<'a, T>) {
        let plan = self.plan;
        let slots = fits.iter_mut().zip(shares.into_slots());
        for (number, (coefficients, shares)) in (start..).zip(slots) {
            let (block, fit) = (&plan.blocks[number], &self.fits[number]);
            let scratch = &mut work.scratch;
            let neighbours = plan.neighbours_of(number);
            scratch.place_again(fit, self.surface, block, neighbours, self.normals);
            let differences = differences_of(plan, number, self.values);
            let (points, sums) = scratch.points();
            *coefficients = sums.fitted(fit, block.degree, points, differences);
            let own = Several::from_fn(|lane| self.values[block.vertices[lane] as usize]);
            let stars = plan.star_offsets[number]..plan.star_offsets[number + 1];
            let displacements = &self.displacements[stars];
            scratch.set_field(fit, block, displacements, (coefficients, own), shares);
        }
    }
}

impl<T: Real> FieldMemory<T> {
    /// Fits a parameter that varies.
    pub(super) fn set(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        parameter: &MaterialParameter<T>,
        shape: &Shape<T>,
        work: &mut Vec<Work<T>>,
    ) {
        if !parameter.varies() {
            return;
        }
        let Shape {
            plan,
            normals,
            fits,
            displacements,
            ..
        } = shape;
        self.fits.resize(fits.len(), [Several::zero(); COUNT]);
        self.shares.resize(displacements.len(), Several::zero());
        let forward = Forward {
            plan,
            surface,
            normals,
            fits,
            displacements,
            values: parameter.values(),
        };
        let shares = Ragged::new(&mut self.shares, &plan.star_offsets);
        execution.run(work, (&mut self.fits[..], shares), &forward);
    }

    /// The parameter on patches.
    pub(super) fn field<'a>(&'a self, parameter: &'a MaterialParameter<T>) -> Field<'a, T> {
        if parameter.varies() {
            Field::Varying {
                values: parameter.values(),
                fits: &self.fits,
                shares: &self.shares,
            }
        } else {
            Field::Constant(parameter.at(0))
        }
    }
}
