//! A bending modulus or spontaneous curvature that varies: fitted to neighbours, blended and interpolated
//! as the surface itself is, because f has their second derivatives.

use super::basis::{FREE, Node};
use super::fit::{COUNT, Fit};
use super::patch::gather_blended;
use super::plan::Plan;
use super::shape::Shape;
use super::vertices::Work;
use crate::bending::MaterialParameter;
use crate::element::{Execution, Ragged, SlotKernel, Slots};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// Polynomials of a field, and its values at the points around each vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldMemory<T> {
    pub(super) fits: Vec<[Several<T>; COUNT]>,
    pub(super) shares: Vec<Several<T>>,
}

/// A parameter of the material on the patches.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field<'a, T> {
    /// The same everywhere.
    Constant(T),
    /// Values at the vertices, polynomials around them, and values at the points around them.
    Varying {
        values: &'a [T],
        fits: &'a [[Several<T>; COUNT]],
        shares: &'a [Several<T>],
    },
}

/// Its values on eight patches: at free points and corners.
pub(super) enum OnPatches<T> {
    Constant(Several<T>),
    Points([Several<T>; FREE], [Several<T>; 3]),
}

impl<T: Real> OnPatches<T> {
    /// The value at a quadrature point.
    #[inline(always)]
    pub(super) fn at(&self, node: &Node<T>) -> Several<T> {
        let (points, corners) = match self {
            Self::Constant(constant) => return *constant,
            Self::Points(points, corners) => (points, corners),
        };
        let mut value = Several::zero();
        for (&weight, &point) in node.values.iter().zip(points) {
            value = value + Several::splat(weight) * point;
        }
        for (&weight, &corner) in node.corners.iter().zip(corners) {
            value = value + Several::splat(weight) * corner;
        }
        value
    }
}

impl<'a, T: Real> Field<'a, T> {
    /// Whether it varies.
    #[inline(always)]
    pub(super) fn varies(&self) -> bool {
        matches!(self, Self::Varying { .. })
    }

    /// The field on the patches from number `first` on.
    #[inline(always)]
    pub(super) fn on_patches(&self, plan: &Plan, first: usize) -> OnPatches<T> {
        let (values, shares) = match *self {
            Self::Constant(constant) => return OnPatches::Constant(Several::splat(constant)),
            Self::Varying { values, shares, .. } => (values, shares),
        };
        let mut corners = [Several::zero(); 3];
        for lane in 0..WIDTH {
            let patch = plan.patch_in(first, lane);
            for (corner, &vertex) in corners.iter_mut().zip(&patch.corners) {
                corner.0[lane] = values[vertex as usize];
            }
        }
        OnPatches::Points(gather_blended(plan, shares, first), corners)
    }

    /// Polynomials of a block, and the values at its neighbours less those at its vertices.
    #[inline(always)]
    pub(super) fn of_block(
        &self,
        plan: &Plan,
        number: usize,
        differences: &mut Vec<Several<T>>,
    ) -> Option<&'a [Several<T>; COUNT]> {
        let Self::Varying { values, fits, .. } = *self else {
            return None;
        };
        differences.clear();
        differences.extend(differences_of(plan, number, values));
        Some(&fits[number])
    }
}

/// The values at the neighbours of a block less those at its vertices.
#[inline(always)]
fn differences_of<T: Real>(
    plan: &Plan,
    number: usize,
    values: &[T],
) -> impl Iterator<Item = Several<T>> {
    let own = plan.blocks[number].vertices.map(|v| values[v as usize]);
    plan.neighbours_of(number).iter().map(move |neighbours| {
        Several::from_fn(|lane| values[neighbours[lane] as usize] - own[lane])
    })
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
