//! Volume.

use super::{ComponentElements, Functional, closed_triangles, sixfold_volume};
use crate::components::Components;
use crate::element::{Corners, ElementKernel, Execution};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::scale;

/// The volume V that each component encloses: that of the polyhedron, positive if the triangles
/// run counter-clockwise seen from outside.
///
/// A component with boundary encloses no volume: V = 0, without gradient. (∫ x·n/3 dS over it would
/// depend on the origin.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnclosedVolume;

/// `w ∂V/∂x`: on a closed surface a third of the area times the normal at each corner.
pub(crate) struct VolumeGradient<T>(pub(crate) T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for VolumeGradient<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 3]; 3] {
        let sixth = T::constant(1.0 / 6.0) * self.0;
        [scale(sixth, corners.triangle().area_vector); 3]
    }
}

impl<T: Real> Method<T> for EnclosedVolume {
    type Memory = ComponentElements<3>;

    fn memory(&self, mesh: &TriangleMesh) -> ComponentElements<3> {
        closed_triangles(mesh)
    }
}

impl<T: Real> Functional<T> for EnclosedVolume {
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
        elements.sums(execution, values, |first, triangle| {
            sixfold_volume(surface, first[0], triangle) / T::constant(6.0)
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
        elements.scatter(execution, surface, weights, VolumeGradient, gradient);
    }
}
