//! Area.

use super::{ComponentElements, Functional};
use crate::components::Components;
use crate::element::{Corners, ElementKernel, Execution};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;

/// The area A of each component, a sum over its triangles.
///
/// A triangle without area has no gradient, and is reported by [`Method::inspect`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TotalArea;

/// `w ∂A/∂x`.
pub(crate) struct AreaGradient<T>(pub(crate) T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for AreaGradient<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 3]; 3] {
        let half = T::constant(0.5) * self.0;
        corners.triangle().outward_edges(half)
    }
}

impl<T: Real> Method<T> for TotalArea {
    type Memory = ComponentElements<3>;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, mesh: &TriangleMesh) -> ComponentElements<3> {
        ComponentElements::new(Components::new(mesh), mesh.triangles().iter().copied())
    }
}

impl<T: Real> Functional<T> for TotalArea {
    fn components<'a>(&self, workspace: &'a Workspace<T, Self>) -> &'a Components {
        workspace.memory().components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        values: &mut [T],
    ) {
        let elements = workspace.for_mesh(surface.mesh());
        elements.sums(execution, values, |_, triangle| {
            let corners = Corners::<T, 3>::of(surface, triangle);
            T::constant(0.5) * corners.triangle().doubled_area
        });
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        let elements = workspace.for_mesh(surface.mesh());
        elements.scatter(execution, surface, weights, AreaGradient, gradient);
    }
}
