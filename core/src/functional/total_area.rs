//! Area.

use super::{ComponentElements, Functional};
use crate::element::{Corners, ElementKernel, Execution};
use crate::energy::{Finding, Method};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::projection::Components;
use crate::real::Real;
use crate::surface::Surface;

/// The area A of each component, a sum over its triangles.
///
/// A triangle without area has no gradient, and is reported by [`Method::inspect`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TotalArea;

/// `w ∂A/∂x`.
struct AreaGradient<T>(T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for AreaGradient<T> {
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 3>,
        _input: &[[L; 0]; 3],
    ) -> [[L; 3]; 3] {
        let half = L::literal(0.5) * L::splat(self.0);
        corners.triangle().outward_edges(half)
    }
}

impl<T: Real> Method<T> for TotalArea {
    type Plan = ComponentElements<3>;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        ComponentElements::new(Components::new(mesh), mesh.triangles().iter().copied())
    }

    fn inspect(
        &self,
        _plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &(),
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_degenerate_triangles(report);
    }
}

impl<T: Real> Functional<T> for TotalArea {
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components {
        plan.components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        values: &mut [T],
    ) {
        plan.sums(execution, values, |_, triangle| {
            let corners = Corners::<T, 3>::of(surface, triangle);
            T::constant(0.5) * corners.triangle().doubled_area
        });
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        plan.scatter(execution, surface, weights, AreaGradient, gradient);
    }
}
