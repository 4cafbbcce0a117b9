//! The cotangent operator.
//!
//! U. Pinkall and K. Polthier, Experiment. Math. 2 (1993) 15; mixed areas and the Gaussian
//! curvature after M. Meyer, M. Desbrun, P. Schröder and A. H. Barr, Visualization and Mathematics
//! III (2003) 35.

use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Corners, ElementKernel, Execution, of_vertices};
use crate::lane::Lane;
use crate::laplacian::{LaplaceBeltrami, Rows, expect_measured};
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Method, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::triangle::{Barycentric, DualArea, Kind, Mixed, Voronoi};
use crate::vec3::{dot, neg, normalise};
use alloc::vec::Vec;

/// `Δ_S φ(i) = 1/(2 A_i) Σ_j (cot α + cot β)(φ_j − φ_i)`.
///
/// * Pointwise. The integrated form, without 1/A_i, is symmetric; its negative is the stiffness
///   matrix, [`Cotangent::assemble_stiffness`].
/// * `H = −½ (Δ_S x)·n` with n the normalised sum of the area vectors of the triangles around the
///   vertex (the direction in which the enclosed volume grows), `K = (2π − Σ angles)/A_i`.
/// * At a boundary vertex the operator has a free boundary (no flux through it), n is the sum over
///   the existing triangles, and H and K are 0, because an open fan distinguishes the curvature of
///   the surface from that of the boundary only in the limit.
/// * Where `A_i = 0` the row, H and K are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Cotangent {
    /// The areas A_i.
    pub area: DualArea,
}

impl Cotangent {
    /// The operator with areas of the given kind.
    pub fn new(area: DualArea) -> Self {
        Self { area }
    }

    /// [`Curvatures::curvatures`] without a workspace.
    pub(crate) fn sum<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        sums: &mut VertexSums<T>,
        curvature: &mut [Curvature<T>],
    ) {
        let mesh = surface.mesh();
        let triangles = mesh.triangles();
        let VertexSums(sums) = sums;
        sums.clear();
        sums.resize(mesh.vertex_count(), [T::zero(); 8]);
        match self.area {
            DualArea::Mixed => {
                execution.scatter(&CotangentMeasures(Mixed), surface, triangles, &[], sums);
            }
            DualArea::Voronoi => {
                execution.scatter(&CotangentMeasures(Voronoi), surface, triangles, &[], sums);
            }
            DualArea::Barycentric => {
                execution.scatter(
                    &CotangentMeasures(Barycentric),
                    surface,
                    triangles,
                    &[],
                    sums,
                );
            }
        }
        let half = T::constant(0.5);
        let sums = &*sums;
        execution.map(of_vertices(surface, curvature), |vertex, curvature| {
            let [u, v, w, x, y, z, angles, area] = sums[vertex];
            let kind = mesh.vertex_kind(vertex);
            let normal = normalise([x, y, z]);
            let over_area = match kind {
                VertexKind::Interior => Lane::reciprocal_or_zero(area),
                VertexKind::Boundary | VertexKind::Isolated => T::zero(),
            };
            let mean = -half * dot([u, v, w], normal) * over_area;
            let gaussian = (T::TAU() - angles) * over_area;
            let [mean, gaussian] = finite_or_zero([mean, gaussian]);
            *curvature = Curvature {
                normal,
                mean,
                gaussian,
                direction: [T::zero(); 3],
                area,
                kind,
            };
        });
    }

    /// Sets `areas` to A_i, one entry per vertex: the lumped mass matrix.
    ///
    /// # Panics
    /// If `areas` has fewer entries than the surface has vertices.
    pub fn dual_areas<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        areas: &mut [T],
    ) {
        let areas: &mut [[T; 1]] = areas.as_chunks_mut().0;
        areas.fill([T::zero()]);
        let triangles = surface.mesh().triangles();
        match self.area {
            DualArea::Mixed => execution.scatter(&Areas(Mixed), surface, triangles, &[], areas),
            DualArea::Voronoi => execution.scatter(&Areas(Voronoi), surface, triangles, &[], areas),
            DualArea::Barycentric => {
                execution.scatter(&Areas(Barycentric), surface, triangles, &[], areas);
            }
        }
    }

    /// Fills `rows` with the integrated form, without 1/A_i: `½ (cot α + cot β)` for each edge.
    fn integrate<T: Real>(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        rows: &mut Rows<T>,
    ) {
        let mesh = surface.mesh();
        let CotangentMemory { entries, .. } = workspace.for_mesh(mesh);
        rows.reset(mesh.ring_offsets(), mesh.ring_vertices());
        let half = T::constant(0.5);
        for (corners, entries) in mesh.triangles().iter().zip(&entries.0) {
            let corners = Corners::of(surface, *corners);
            let cotangents = corners.triangle().cotangents();
            for (cotangent, pair) in cotangents.into_iter().zip(entries) {
                for &entry in pair {
                    rows.coefficients[entry as usize] += half * cotangent;
                }
            }
        }
    }
}

/// For each triangle and corner, the positions of the opposite edge in the rows of its two ends.
#[derive(Clone, Debug, PartialEq, Eq)]
struct CornerEntries(Vec<[[u32; 2]; 3]>);

impl CornerEntries {
    fn new(mesh: &TriangleMesh) -> Self {
        let entry = |row: u32, column: u32| {
            let ring = mesh.one_ring(row as usize);
            let place = ring
                .iter()
                .position(|&neighbour| neighbour == column)
                .unwrap_or(0);
            mesh.ring_offsets()[row as usize] + place as u32
        };
        let opposite = |a: u32, b: u32| [entry(a, b), entry(b, a)];
        let entries = |&[a, b, c]: &[u32; 3]| [opposite(b, c), opposite(c, a), opposite(a, b)];
        Self(mesh.triangles().iter().map(entries).collect())
    }
}

/// Memory of [`Cotangent`].
#[derive(Clone, Debug)]
pub struct CotangentMemory<T> {
    entries: CornerEntries,
    sums: VertexSums<T>,
}

/// Integrated Laplacian of the positions, area vector, angles and area of each vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct VertexSums<T>(Vec<[T; 8]>);

impl<T: Real> VertexSums<T> {
    fn over_area(&self, vertex: usize) -> T {
        Lane::reciprocal_or_zero(self.0[vertex][7])
    }
}

struct Areas<K>(K);

impl<T: Real, K: Kind> ElementKernel<T, 3, 0, 1> for Areas<K> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 1]; 3] {
        corners.triangle().dual_areas(self.0).map(|area| [area])
    }
}

/// Integrated Laplacian of the positions, area vector, angle and area, at each corner.
struct CotangentMeasures<K>(K);

impl<T: Real, K: Kind> ElementKernel<T, 3, 0, 8> for CotangentMeasures<K> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 8]; 3] {
        let triangle = corners.triangle();
        let areas = triangle.dual_areas(self.0);
        let angles = triangle.angles();
        let laplacian = triangle.area_gradient().map(neg);
        let [x, y, z] = triangle.area_vector;
        core::array::from_fn(|k| {
            let [u, v, w] = laplacian[k];
            [u, v, w, x, y, z, angles[k], areas[k]]
        })
    }
}

/// Integrated Laplacian of a field of D numbers.
struct Differences;

impl<T: Real, const D: usize> ElementKernel<T, 3, D, D> for Differences {
    #[inline(always)]
    fn evaluate(&self, _first: usize, corners: &Corners<T, 3>, field: &[[T; D]; 3]) -> [[T; D]; 3] {
        let triangle = corners.triangle();
        let half = T::constant(0.5);
        let cotangents = triangle.cotangents().map(|cotangent| half * cotangent);
        let mut result = [[T::zero(); D]; 3];
        for k in 0..D {
            let along = |from: usize, to: usize, opposite: usize| {
                cotangents[opposite] * (field[to][k] - field[from][k])
            };
            let edge = [along(1, 2, 0), along(2, 0, 1), along(0, 1, 2)];
            result[0][k] = edge[2] - edge[1];
            result[1][k] = edge[0] - edge[2];
            result[2][k] = edge[1] - edge[0];
        }
        result
    }
}

impl<T: Real> Method<T> for Cotangent {
    type Memory = CotangentMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> CotangentMemory<T> {
        CotangentMemory {
            entries: CornerEntries::new(mesh),
            sums: VertexSums::default(),
        }
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let CotangentMemory { sums, .. } = workspace.for_mesh(surface.mesh());
        surface.report_uneven_mesh(report);
        surface.report_valences(report);
        surface.report_rough_vertices(report);
        let mesh = surface.mesh();
        let is_used = |vertex: usize| mesh.vertex_kind(vertex) != VertexKind::Isolated;
        let area = |vertex: usize| {
            let [.., area] = sums.0.get(vertex)?;
            is_used(vertex).then_some(*area)
        };
        surface.report_areas(self.area, area, report);
    }
}

impl<T: Real> Curvatures<T> for Cotangent {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let CotangentMemory { sums, .. } = workspace.for_mesh_mut(surface.mesh());
        self.sum(execution, surface, sums, curvature);
    }
}

impl<T: Real> LaplaceBeltrami<T> for Cotangent {
    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) {
        let mesh = surface.mesh();
        let CotangentMemory { sums, .. } = workspace.for_mesh(mesh);
        expect_measured(sums.0.len(), mesh.vertex_count());
        let laplacian = of_vertices(surface, laplacian);
        laplacian.fill([T::zero(); D]);
        execution.scatter(&Differences, surface, mesh.triangles(), field, laplacian);
        execution.map(&mut laplacian[..], |vertex, sum| {
            let over_area = sums.over_area(vertex);
            *sum = finite_or_zero(sum.map(|entry| entry * over_area));
        });
    }

    fn assemble(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        rows: &mut Rows<T>,
    ) {
        let CotangentMemory { sums, .. } = workspace.for_mesh(surface.mesh());
        expect_measured(sums.0.len(), surface.mesh().vertex_count());
        self.integrate(surface, workspace, rows);
        for vertex in 0..surface.mesh().vertex_count() {
            let over_area = sums.over_area(vertex);
            for coefficient in rows.row_mut(vertex) {
                *coefficient *= over_area;
            }
        }
    }
}
