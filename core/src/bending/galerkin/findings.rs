//! Findings about fits and patches.

use super::GalerkinMemory;
use super::basis::GAUSS;
use super::edges::angle_of;
use super::fit::{SHARPNESS, within};
use super::points::settled;
use super::shape::Shape;
use crate::diagnostic::Finding;
use crate::noise::Model;
use crate::noise::doubt::report_rows;
use crate::real::Real;
use crate::surface::Surface;

/// Least pivot, over the diagonal entry, of a fit that neighbours determine well.
const WEAKEST: f64 = 1e-6;

/// Least degree of fits whose energy is known to many digits.
const LEAST_DEGREE: usize = 6;

/// Largest angle between patches that are resolved.
const LARGEST_ANGLE: f64 = 1e-3;

impl<T: Real> Shape<T> {
    /// Reports vertices without fits, fits of less than degree 6, fits that are hardly determined, and jets
    /// that are no graph over the triangles around their vertex.
    pub(super) fn report_fits(&self, report: &mut dyn FnMut(Finding)) {
        for &vertex in &self.plan.without_fit {
            report(Finding::TooFewNeighbours { vertex });
        }
        for (vertex, member) in (0..).zip(&self.plan.members) {
            let Some((block, lane)) = *member else {
                continue;
            };
            let (block, lane) = (block as usize, usize::from(lane));
            let degree = self.plan.blocks[block].degree;
            if degree < LEAST_DEGREE {
                report(Finding::ReducedDegree {
                    vertex,
                    degree: degree as u8,
                });
            }
            let Some(fit) = self.fits.get(block) else {
                continue;
            };
            let (weakest, unsettled) = (fit.weakest.0[lane], fit.unsettled.0[lane]);
            if weakest.is_nan() || weakest < T::constant(WEAKEST) {
                report(Finding::Amplified { vertex });
            }
            if unsettled.is_nan() || unsettled >= settled() {
                report(Finding::NoGraph { vertex });
            }
        }
    }
}

impl<T: Real> Shape<T> {
    /// Reports vertices in rows that do not determine their fits.
    pub(super) fn report_rows(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        let fitted = |vertex: usize| {
            let (block, _) = *self.plan.members.get(vertex)?.as_ref()?;
            let degree = self.plan.blocks[block as usize].degree;
            let model = Model {
                degree,
                // Rows have the roots of the weights.
                sharpness: T::constant(0.5 * SHARPNESS),
                interpolates: true,
            };
            Some((model, within(degree) as usize))
        };
        report_rows(surface, fitted, &[], report);
    }
}

impl<T: Real> GalerkinMemory<T> {
    /// Reports the first vertices of edges where patches meet at an angle.
    pub(super) fn report_angles(&self, report: &mut dyn FnMut(Finding)) {
        if self.edge_values.is_empty() {
            return;
        }
        for shared in &self.shape.plan.interior_edges {
            let mut angles = (0..GAUSS).map(|gauss| angle_of(&self.edge_values, shared, gauss));
            if angles.any(|angle| angle.abs() > T::constant(LARGEST_ANGLE)) {
                let (patch, edge) = shared.sides[0];
                let corners = self.shape.plan.patches[patch as usize].corners;
                report(Finding::Unresolved {
                    vertex: corners[usize::from(edge)],
                });
            }
        }
    }
}
