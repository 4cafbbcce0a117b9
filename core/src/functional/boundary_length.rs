//! Length of the boundary.

use super::{ComponentElements, Functional};
use crate::components::Components;
use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{neg, norm, scale};

/// The length L of the boundary of each component: a sum over its boundary edges, 0 on a closed
/// component.
///
/// An edge without length has no gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoundaryLength;

/// `w ∂L/∂x`.
pub(crate) struct LengthGradient<T>(pub(crate) T);

impl<T: Real> ElementKernel<T, 2, 0, 3> for LengthGradient<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 2>,
        _input: &[[T; 0]; 2],
    ) -> [[T; 3]; 2] {
        let edge = corners.difference(0, 1);
        let pull = scale(self.0 * norm(edge).reciprocal_or_zero(), edge);
        [neg(pull), pull]
    }
}

impl<T: Real> Method<T> for BoundaryLength {
    type Memory = ComponentElements<2>;

    fn memory(&self, mesh: &TriangleMesh) -> ComponentElements<2> {
        let edges = mesh.edges().iter().enumerate();
        let boundary = edges.filter(|&(edge, _)| mesh.edge_triangles(edge).1.is_none());
        ComponentElements::new(Components::new(mesh), boundary.map(|(_, &edge)| edge))
    }
}

impl<T: Real> Functional<T> for BoundaryLength {
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
        elements.sums(execution, values, |_, [a, b]| {
            norm(surface.difference(a, b))
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
        elements.scatter(execution, surface, weights, LengthGradient, gradient);
    }
}
