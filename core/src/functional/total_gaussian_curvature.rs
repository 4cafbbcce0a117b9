//! Integrated Gaussian curvature.
//!
//! Gauss–Bonnet for polyhedra: T. F. Banchoff, J. Differ. Geom. 1 (1967) 245. The gradient is our own.

use super::{ComponentElements, Functional};
use crate::components::Components;
use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{add, cross, dot, neg, scale};
use alloc::vec::Vec;

/// The integrated Gaussian curvature `∫ K dS = Σ_i (2π − Σ angles)` of each component, over its interior
/// vertices: a number without unit.
///
/// By Gauss and Bonnet it is `2πχ − Σ_b (π − Σ angles)` over the boundary vertices, and is computed in
/// this form. It therefore depends on the angles at the boundary alone, and on a closed component it is
/// the constant 2πχ, without gradient: 4π on every sphere.
///
/// The sum leaves out the curvature that belongs to the boundary vertices, about half a row of triangles:
/// an error of first order in the edge length.
///
/// A triangle without area has no gradient, and is reported by [`Method::inspect`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TotalGaussianCurvature;

/// Memory of [`TotalGaussianCurvature`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GaussianCurvatureMemory {
    /// The triangles at each boundary vertex, begun at that vertex.
    corners: ComponentElements<3>,
    /// 2χ less the number of boundary vertices, of each component.
    half_turns: Vec<i64>,
}

/// `w ∂φ/∂x`, φ the angle at the first corner.
struct AngleGradient<T>(T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for AngleGradient<T> {
    /// The end of an edge that leaves the corner turns about the corner: by the inverse of the edge's
    /// length.
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let normal = scale(self.0, triangle.normal());
        let turn = |edge: [T; 3]| scale(dot(edge, edge).reciprocal_or_zero(), cross(normal, edge));
        let [_, last, first] = triangle.edges;
        let (first, last) = (neg(turn(first)), neg(turn(last)));
        [neg(add(first, last)), first, last]
    }
}

impl<T: Real> Method<T> for TotalGaussianCurvature {
    type Memory = GaussianCurvatureMemory;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, mesh: &TriangleMesh) -> GaussianCurvatureMemory {
        let components = Components::new(mesh);
        let mut half_turns = alloc::vec![0; components.count()];
        let of_vertex = components.of_vertex();
        let mut count =
            |vertex: u32, by: i64| half_turns[of_vertex[vertex as usize] as usize] += by;
        for (vertex, kind) in (0..).zip(mesh.vertex_kinds()) {
            match kind {
                VertexKind::Interior => count(vertex, 2),
                VertexKind::Boundary => count(vertex, 1),
                VertexKind::Isolated => {}
            }
        }
        mesh.edges().iter().for_each(|edge| count(edge[0], -2));
        let triangles = mesh.triangles();
        triangles.iter().for_each(|triangle| count(triangle[0], 2));
        let corners = triangles.iter().flat_map(|&[a, b, c]| {
            let at_boundary =
                |of: &[u32; 3]| mesh.vertex_kind(of[0] as usize) == VertexKind::Boundary;
            [[a, b, c], [b, c, a], [c, a, b]]
                .into_iter()
                .filter(at_boundary)
        });
        GaussianCurvatureMemory {
            corners: ComponentElements::new(components.clone(), corners),
            half_turns,
        }
    }
}

impl<T: Real> Functional<T> for TotalGaussianCurvature {
    fn components<'a>(&self, workspace: &'a Workspace<T, Self>) -> &'a Components {
        workspace.memory().corners.components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        values: &mut [T],
    ) {
        let GaussianCurvatureMemory {
            corners,
            half_turns,
        } = workspace.for_mesh(surface.mesh());
        corners.sums(execution, values, |_, corner| {
            let triangle = Corners::<T, 3>::of(surface, corner).triangle();
            triangle.doubled_area.atan2(triangle.dots[0])
        });
        for (value, &half_turns) in values.iter_mut().zip(half_turns) {
            *value += T::constant(half_turns as f64 * core::f64::consts::PI);
        }
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        let corners = &workspace.for_mesh(surface.mesh()).corners;
        corners.scatter(execution, surface, weights, AngleGradient, gradient);
    }
}
