//! Volume.

use super::{ComponentElements, Functional, closed_triangles, sixfold_volume};
use crate::element::{Corners, ElementKernel, Execution};
use crate::energy::Method;
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::projection::Components;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::scale;

/// The volume V that each component encloses: that of the polyhedron, positive if the triangles
/// run counter-clockwise seen from outside.
///
/// A component with boundary encloses nothing: V = 0, without gradient. (∫ x·n/3 dS over it would
/// depend on the origin.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnclosedVolume;

/// `w ∂V/∂x`: on a closed surface a third of the area times the normal at each corner.
struct VolumeGradient<T>(T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for VolumeGradient<T> {
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 3>,
        _input: &[[L; 0]; 3],
    ) -> [[L; 3]; 3] {
        let sixth = L::literal(1.0 / 6.0) * L::splat(self.0);
        [scale(sixth, corners.triangle().area_vector); 3]
    }
}

impl<T: Real> Method<T> for EnclosedVolume {
    type Plan = ComponentElements<3>;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        closed_triangles(mesh)
    }
}

impl<T: Real> Functional<T> for EnclosedVolume {
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
        plan.sums(execution, values, |first, triangle| {
            sixfold_volume(surface, first[0], triangle) / T::constant(6.0)
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
        plan.scatter(execution, surface, weights, VolumeGradient, gradient);
    }
}
