//! Integrated mean curvature.
//!
//! Integrated mean curvature of polyhedra: J. Steiner, Monatsber. Preuss. Akad. Wiss. (1840) 114.

use super::{ComponentElements, Functional};
use crate::components::Components;
use crate::element::{Corners, ElementKernel, Execution};
use crate::hinge::{Hinge, Hinges};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;

/// The integrated mean curvature `M = ∫ H dS = ½ Σ l θ` of each component, l the length of an
/// interior edge, θ the angle between the normals of its two triangles, positive where the surface
/// is convex: 4πR on a sphere. In units of length.
///
/// The gradient `½ Σ (θ ∂l + l ∂θ)` is exact; on a closed component the second sum is zero (L.
/// Schläfli, Q. J. Pure Appl. Math. 2 (1858) 269), at a boundary it is not. Boundary edges and edges
/// at a triangle without area have no angle. θ jumps by 2π where two triangles fold onto each
/// other, and M with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TotalMeanCurvature;

/// `w ∂M/∂x`.
struct MeanCurvatureGradient<T>(T);

impl<T: Real> ElementKernel<T, 4, 0, 3> for MeanCurvatureGradient<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 4>,
        _input: &[[T; 0]; 4],
    ) -> [[T; 3]; 4] {
        let half = T::constant(0.5) * self.0;
        Hinge::new(corners).length_times_angle_gradient(corners, half)
    }
}

impl<T: Real> Method<T> for TotalMeanCurvature {
    type Memory = ComponentElements<4>;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, mesh: &TriangleMesh) -> ComponentElements<4> {
        let hinges = Hinges::new(mesh).vertices;
        ComponentElements::new(Components::new(mesh), hinges.into_iter())
    }
}

impl<T: Real> Functional<T> for TotalMeanCurvature {
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
        elements.sums(execution, values, |_, hinge| {
            let hinge = Hinge::<T>::new(&Corners::of(surface, hinge));
            T::constant(0.5) * hinge.edge_length * hinge.angle()
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
        elements.scatter(execution, surface, weights, MeanCurvatureGradient, gradient);
    }
}
