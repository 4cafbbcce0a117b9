//! Corrected curvature measures.
//!
//! J.-O. Lachaud, P. Romon, B. Thibert, D. Coeurjolly, *Interpolated corrected curvature measures for
//! polygonal surfaces*, Comput. Graph. Forum 39(5) (2020) 41.

use crate::bending::AreaVectors;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::laplacian::Jet;
use crate::mesh::TriangleMesh;
use crate::mesh_identity::expect_parameter;
use crate::method::{Method, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, normalise, sub};
use alloc::vec::Vec;

/// H and K from a field of normals that the mesh need not have itself: area, mean and Gaussian curvature
/// of a triangle whose normal u is interpolated linearly from its corners,
///
/// `μ0 = ½ ū·(e1 × e2)`, `μ1 = ½ ū·[(u0 − u2) × e1 + (u1 − u0) × e2]`, `μ2 = ½ u0·(u1 × u2)`,
///
/// with ū the mean of the three, `e1 = x1 − x0`, `e2 = x2 − x0`. At interior vertices `H = Σ μ1/(2 Σ μ0)`
/// and `K = Σ μ2/Σ μ0`, sums over the triangles around; A is a third of Σ μ0. H and K converge where the
/// normals do so faster than the edge length, on any mesh, and are exact on a sphere with exact normals.
///
/// There is no energy, no force and no Laplacian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CorrectedCurvature {
    /// The normals at the vertices.
    pub normals: VertexNormals,
}

/// A field of normals at vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VertexNormals {
    /// Means of the triangles' normals, weighted with their areas: cheap; second order where the
    /// neighbours are arranged evenly, first order elsewhere.
    Averaged,
    /// Normals of [`Jet::j4`]: fourth order on any mesh.
    Fitted,
}

/// Memory of [`CorrectedCurvature`].
#[derive(Clone, Debug)]
pub struct CorrectedCurvatureMemory<T: Real> {
    made_for: VertexNormals,
    jet: Jet<T>,
    /// There for fitted normals only.
    fitted: Option<Workspace<T, Jet<T>>>,
    curvature: Vec<Curvature<T>>,
    /// Twice the area vectors, and three times the areas.
    sums: Vec<[T; 4]>,
    normals: Vec<Vec3<T>>,
    /// Σ μ0, Σ μ1, Σ μ2 around each vertex.
    measures: Vec<[T; 3]>,
}

/// μ0, μ1 and μ2 of a triangle, for each corner, from the normals there.
struct Measures;

impl<T: Real> ElementKernel<T, 3, 3, 3> for Measures {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        [a, b, c]: &[[T; 3]; 3],
    ) -> [[T; 3]; 3] {
        let sixth = T::constant(1.0 / 6.0);
        let (first, second) = (corners.difference(0, 1), corners.difference(0, 2));
        let sum = add(add(*a, *b), *c);
        let turn = add(cross(sub(*a, *c), first), cross(sub(*b, *a), second));
        // Of differences: the normals are nearly parallel.
        let solid = dot(*a, cross(sub(*b, *a), sub(*c, *a)));
        let area = sixth * dot(sum, cross(first, second));
        [[area, sixth * dot(sum, turn), T::constant(0.5) * solid]; 3]
    }
}

impl CorrectedCurvature {
    fn set_normals<T: Real>(
        self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut CorrectedCurvatureMemory<T>,
    ) {
        expect_parameter::<Self, _>("normals", memory.made_for, self.normals);
        let vertices = surface.mesh().vertex_count();
        let CorrectedCurvatureMemory {
            jet,
            fitted,
            curvature,
            sums,
            normals,
            ..
        } = memory;
        normals.resize(vertices, [T::zero(); 3]);
        if let Some(fitted) = fitted {
            curvature.resize(vertices, Curvature::default());
            jet.curvatures(execution, surface, fitted, curvature);
            execution.map(&mut normals[..], |vertex, normal| {
                *normal = curvature[vertex].normal;
            });
        } else {
            AreaVectors.sum(execution, surface, sums);
            execution.map(&mut normals[..], |vertex, normal| {
                let [x, y, z, _] = sums[vertex];
                *normal = normalise([x, y, z]);
            });
        }
    }
}

impl<T: Real> Method<T> for CorrectedCurvature {
    type Memory = CorrectedCurvatureMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> CorrectedCurvatureMemory<T> {
        let (jet, fits) = (Jet::j4(), self.normals == VertexNormals::Fitted);
        CorrectedCurvatureMemory {
            made_for: self.normals,
            jet,
            fitted: fits.then(|| jet.workspace(mesh)),
            curvature: Vec::new(),
            sums: Vec::new(),
            normals: Vec::new(),
            measures: Vec::new(),
        }
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        if let Some(fitted) = &memory.fitted {
            memory.jet.inspect(surface, fitted, report);
        } else {
            surface.report_uneven_mesh(report);
            surface.report_rough_vertices(report);
        }
        for (vertex, &[area, ..]) in (0..).zip(&memory.measures) {
            let interior = surface.mesh().is_interior(vertex as usize);
            if interior && area.reciprocal_or_zero() <= T::zero() {
                report(Finding::ZeroArea { vertex });
            }
        }
    }
}

/// H and K are 0 at vertices that are not interior or have no area.
impl<T: Real> Curvatures<T> for CorrectedCurvature {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let mesh = surface.mesh();
        let memory = workspace.for_mesh_mut(mesh);
        self.set_normals(execution, surface, memory);
        let CorrectedCurvatureMemory {
            normals, measures, ..
        } = memory;
        measures.clear();
        measures.resize(mesh.vertex_count(), [T::zero(); 3]);
        execution.scatter(&Measures, surface, mesh.triangles(), normals, measures);
        execution.map(&mut curvature[..measures.len()], |vertex, curvature| {
            let [area, mean, gaussian] = measures[vertex];
            let there = mesh.is_interior(vertex) && area > T::zero();
            let over = T::select(there, area.reciprocal_or_zero(), T::zero());
            let [mean, gaussian] =
                finite_or_zero([T::constant(0.5) * over * mean, over * gaussian]);
            *curvature = Curvature {
                normal: normals[vertex],
                mean,
                gaussian,
                direction: [T::zero(); 3],
                area: T::constant(1.0 / 3.0) * area,
                kind: mesh.vertex_kind(vertex),
            };
        });
    }
}
