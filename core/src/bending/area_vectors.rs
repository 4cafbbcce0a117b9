//! Area vectors and areas around vertices, and forces by their change.

use crate::element::{Corners, ElementKernel, Execution};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{add, cross};
use alloc::vec::Vec;

/// Sums around a vertex: twice the area vectors, three times the area.
pub(crate) struct AreaVectors;

impl AreaVectors {
    /// Sets `sums`, an entry for each vertex.
    pub(crate) fn sum<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        sums: &mut Vec<[T; 4]>,
    ) {
        let mesh = surface.mesh();
        sums.clear();
        sums.resize(mesh.vertex_count(), [T::zero(); 4]);
        execution.scatter(self, surface, mesh.triangles(), &[], sums);
    }
}

impl<T: Real> ElementKernel<T, 3, 0, 4> for AreaVectors {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 4]; 3] {
        let triangle = corners.triangle();
        let [x, y, z] = triangle.area_vector;
        [[x, y, z, T::constant(0.5) * triangle.doubled_area]; 3]
    }
}

/// Forces by the change of these sums: from −∂E/∂(2N), N the area vectors around a vertex, and
/// −∂E/∂A, A a third of the triangles around it.
pub(crate) struct AreaVectorForce;

impl<T: Real> ElementKernel<T, 3, 4, 3> for AreaVectorForce {
    /// With g the sum of the corners' −∂E/∂(2N): `g × e_k`, because moving corner k by δ changes the
    /// doubled area vector by e_k × δ.
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        [a, b, c]: &[[T; 4]; 3],
    ) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let turn = core::array::from_fn(|axis| a[axis] + b[axis] + c[axis]);
        let grow = triangle.outward_edges(T::constant(1.0 / 6.0) * (a[3] + b[3] + c[3]));
        core::array::from_fn(|corner| add(cross(turn, triangle.edges[corner]), grow[corner]))
    }
}
