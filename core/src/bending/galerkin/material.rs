//! A bending modulus or spontaneous curvature on patches.

use super::basis::{FREE, QuadraturePoint};
use super::plan::{COUNT, Plan, gather_blended};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::Real;
use alloc::vec::Vec;

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
    pub(super) fn at(&self, node: &QuadraturePoint<T>) -> Several<T> {
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
pub(super) fn differences_of<T: Real>(
    plan: &Plan,
    number: usize,
    values: &[T],
) -> impl Iterator<Item = Several<T>> {
    let own = plan.blocks[number].vertices.map(|v| values[v as usize]);
    plan.neighbours_of(number).iter().map(move |neighbours| {
        Several::from_fn(|lane| values[neighbours[lane] as usize] - own[lane])
    })
}
