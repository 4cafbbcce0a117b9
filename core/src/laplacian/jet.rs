//! Method J: osculating jets.
//!
//! Fits of polynomial height functions after F. Cazals and M. Pouget, Comput. Aided Geom. Des. 22
//! (2005) 121; here weighted, interpolating at the vertex, after an inversion that flattens the surface, and
//! with neighbours that determine them. The same factorisation gives the row of a general Laplace–Beltrami
//! operator.
//!
//! Δ_S H for the force has two parts. With the polynomial around vertex i, `H^i` is its H in space, and c_ij the
//! row: `Δ_S H = Δ_S H^i + Σ_j c_ij (H_j − H^i(x_j))`. What is left to the row, which is of low order in a field
//! that varies, is small.

mod block;
mod fits;
mod local_polynomial;

use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, Ragged, of_vertices};
use crate::fit::{HIGHEST_DEGREE, NormalEquations, coefficient_count, spacing};
use crate::lane::Lane;
use crate::laplacian::{Cotangent, LaplaceBeltrami, Rows, VertexSums, expect_measured};
use crate::mesh::TriangleMesh;
use crate::mesh_identity::expect_parameter;
use crate::method::{Method, Workspace};
use crate::neighbourhood::Surroundings;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::Vec3;
use alloc::vec;
use alloc::vec::Vec;
use fits::{Derivatives, Fits, Scratch};
pub(crate) use local_polynomial::{JetPoint, LocalPolynomial};

/// Weighted least-squares jets: around each vertex a polynomial height function over the tangent
/// plane is fitted to the nearest vertices along the surface.
///
/// * Neighbours are the nearest in space if they determine a polynomial of this degree in all directions;
///   otherwise, as where vertices lie in rows, offsets along rows count more than those across.
/// * H, K and n are those of the polynomial; on meshes of any kind H and K converge with order
///   d − 1 or better, `Δ_S H` with order d − 3 or better, in the largest error, too.
/// * `Δ_S φ` of any field is that of the polynomial fitted to φ with the same weights: pointwise,
///   not symmetric. Its rows must not be transposed or symmetrised, because convergence would be
///   lost.
/// * Areas are mixed areas.
/// * If the neighbours do not determine a fit of this degree, the degree is lowered, which
///   [`Method::inspect`] reports. If they do not even determine a paraboloid (meshes of a few
///   vertices), H, K and the row are 0.
/// * At a boundary vertex the fit is one-sided, and as good as its neighbours allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T> {
    /// Degree d of the polynomial, 2 … 8.
    pub degree: usize,
    /// Neighbours of a first fit; at least twice the number of coefficients, (d + 1)(d + 2)/2 − 1,
    /// or the regular hexagonal lattice already fails.
    pub neighbours: usize,
    /// Neighbours at most.
    pub most_neighbours: usize,
    /// β of the weights `exp(−β |x_j − x_i|²/ρ²)`, ρ the distance of the farthest neighbour.
    pub sharpness: T,
    /// Least spread of neighbours with which a fit of this degree is accepted: the distance of a monomial from
    /// the monomials before it, in units of the length that it would have if the neighbours lay evenly in all
    /// directions.
    pub conditioning: T,
}

impl<T: Real> Jet<T> {
    /// Degree 6: for meshes of about a thousand vertices and more.
    pub fn j6() -> Self {
        Self {
            degree: 6,
            neighbours: 56,
            most_neighbours: 112,
            sharpness: T::constant(7.0),
            conditioning: T::constant(0.012),
        }
    }

    /// Degree 8: for meshes of a few thousand vertices and more, at two to three times the cost of degree 6.
    pub fn j8() -> Self {
        Self {
            degree: 8,
            neighbours: 96,
            most_neighbours: 192,
            sharpness: T::constant(7.0),
            conditioning: T::constant(0.003),
        }
    }

    /// Degree 4: for coarse meshes, small irregular meshes, and dynamics.
    pub fn j4() -> Self {
        Self {
            degree: 4,
            neighbours: 32,
            most_neighbours: 64,
            sharpness: T::constant(6.0),
            conditioning: T::constant(0.06),
        }
    }

    /// Degree 8 from 2500 vertices of the largest component on, degree 6 from 1000 on, degree 4 below: higher
    /// degrees have larger errors of f on irregular discocytes of fewer vertices.
    pub fn for_mesh(mesh: &TriangleMesh) -> Self {
        let (components, number) = mesh.components();
        let mut sizes = vec![0; number];
        for component in components {
            sizes[component as usize] += 1;
        }
        match sizes.into_iter().max() {
            Some(2500..) => Self::j8(),
            Some(1000..) => Self::j6(),
            _ => Self::j4(),
        }
    }
}

/// Spread of neighbours that determine a fit of degree 2 to 8 without regard to rows, and least spread with
/// regard to them.
const ENOUGH_SPREAD: [f64; 7] = [0.15, 0.13, 0.12, 0.11, 0.1, 0.05, 0.03];
const LEAST_SPREAD: [f64; 7] = [0.05, 0.06, 0.06, 0.03, 0.012, 0.006, 0.003];

/// Part of the curvature from which on a disagreement of fits is reported, and curvature that counts as none, in
/// inverse spacings.
const REPORTED: f64 = 0.03;
const FLAT: f64 = 3e-4;

/// Ratio of spacings from which on vertices count as rows.
const ROWS: f64 = 2.2;

/// Number of neighbours that may determine a fit of a degree.
const fn least_count(degree: usize) -> usize {
    coefficient_count(degree) + if degree > 2 { 2 } else { 0 }
}

/// Memory of [`Jet`].
#[derive(Clone, Debug)]
pub struct JetMemory<T> {
    /// The most neighbours of a fit.
    room: usize,
    surroundings: Surroundings,
    cotangent: VertexSums<T>,
    rows: Rows<T>,
    /// The degree fitted at each vertex, 0 where there was no fit.
    degrees: Vec<u8>,
    /// Bounds of the distances of neighbours in the last evaluation.
    bounds: Vec<i32>,
    /// The normals of the mesh.
    normals: Vec<Vec3<T>>,
    derivatives: Vec<Derivatives<T>>,
    /// H and K of each fit at the vertices of the one-ring, NaN where they are no neighbours of the fit.
    ring_curvatures: Vec<[T; 2]>,
    ring_offsets: Vec<usize>,
    /// The numbers of the polynomials, and the first of each vertex; none unless they are kept.
    polynomials: Vec<T>,
    polynomial_offsets: Vec<usize>,
    disagreements: Vec<[T; 2]>,
    /// Whether these are large.
    apart: Vec<bool>,
    scratches: Vec<Scratch<T>>,
}

impl<T> JetMemory<T> {
    /// The degree fitted at each vertex, 0 where the neighbours do not determine any fit.
    pub fn degrees(&self) -> &[u8] {
        &self.degrees
    }

    /// The largest differences, at the vertices of the one-ring, between H, in 1/length, and K, in 1/length², of
    /// the polynomial of each vertex and of the polynomials of those vertices: estimates of the errors of H and K
    /// without noise; infinite where there is no fit.
    pub fn disagreements(&self) -> &[[T; 2]] {
        &self.disagreements
    }
}

impl<T: Real> JetMemory<T> {
    /// The gradients of H, in 1/length², and of K, in 1/length³, on the polynomial of a vertex; 0 where there is no
    /// fit.
    pub fn gradients(&self, vertex: usize) -> [[T; 3]; 2] {
        self.derivatives[vertex].gradients
    }

    /// Keeps the polynomials of the next evaluations, up to a degree, instead of rows of Δ_S.
    pub(crate) fn keep_polynomials(&mut self, degree: usize) {
        let stride = LocalPolynomial::<T>::numbers(degree);
        let offsets = self.polynomial_offsets.iter_mut().enumerate();
        offsets.for_each(|(vertex, offset)| *offset = vertex * stride);
        let count = self.polynomial_offsets.last().copied().unwrap_or(0);
        self.polynomials.resize(count, T::zero());
    }

    /// The polynomial of a vertex, if it was kept and there is a fit.
    pub(crate) fn polynomial(&self, vertex: usize) -> Option<LocalPolynomial<'_, T>> {
        let [start, end] = [0, 1].map(|next| self.polynomial_offsets[vertex + next]);
        let degree = usize::from(self.degrees[vertex]);
        let is_kept = degree > 0 && end > start;
        is_kept.then(|| LocalPolynomial::new(degree, &self.polynomials[start..end]))
    }

    /// The neighbours of a fit, and its row of Δ_S.
    pub(crate) fn row(&self, vertex: usize) -> (&[u32], &[T]) {
        self.rows.row(vertex)
    }
}

/// Degree and number of neighbours with which a fit is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Attempt {
    degree: usize,
    neighbours: usize,
}

impl<T: Real> Jet<T> {
    /// The most neighbours of a fit.
    fn room(&self) -> usize {
        self.most_neighbours.max(coefficient_count(2))
    }

    fn expect(&self, memory: &JetMemory<T>) {
        expect_parameter::<Self, _>("at most so many neighbours:", memory.room, self.room());
    }

    /// The first attempt with this number of available neighbours: the highest degree, at most
    /// `highest`, that they may determine; `None` if they do not even determine a paraboloid.
    fn first_attempt(&self, highest: usize, available: usize) -> Option<Attempt> {
        let whole = coefficient_count(self.highest_degree());
        (2..=highest).rev().find_map(|degree| {
            let coefficients = coefficient_count(degree);
            let enough = available >= least_count(degree);
            // For a lower degree, the number of neighbours is proportional to the number of
            // coefficients.
            let first = (self.neighbours * coefficients).div_ceil(whole);
            let last = self.last_neighbours(degree, available);
            enough.then(|| Attempt {
                degree,
                neighbours: first.clamp(coefficients.min(last), last),
            })
        })
    }

    /// The degree of the first attempt, within the possible ones.
    pub(crate) fn highest_degree(&self) -> usize {
        self.degree.clamp(2, HIGHEST_DEGREE)
    }

    /// The largest number of neighbours of a fit of this degree, if this many are available.
    fn last_neighbours(&self, degree: usize, available: usize) -> usize {
        let least = coefficient_count(degree);
        self.most_neighbours.max(least).min(available)
    }

    /// The least spread with which fits of a degree are accepted, in the spacing of rows.
    #[inline(always)]
    fn least_spread(&self, degree: usize) -> T {
        let own = degree == self.highest_degree();
        let least = T::constant(LEAST_SPREAD[degree - 2]);
        let least = if own { self.conditioning } else { least };
        least.max(NormalEquations::<T>::least_distance())
    }

    /// The spread with which fits of a degree are accepted in any spacing.
    #[inline(always)]
    fn enough_spread(&self, degree: usize) -> T {
        let enough = T::constant(ENOUGH_SPREAD[degree - 2]);
        enough.max(self.least_spread(degree))
    }
}

impl<T: Real> Method<T> for Jet<T> {
    type Memory = JetMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> JetMemory<T> {
        let offsets = mesh.ring_offsets().iter();
        JetMemory {
            room: self.room(),
            surroundings: Surroundings::rings(mesh, |_| self.room()),
            cotangent: VertexSums::default(),
            rows: Rows::new(),
            degrees: Vec::new(),
            bounds: Vec::new(),
            normals: Vec::new(),
            derivatives: Vec::new(),
            ring_curvatures: Vec::new(),
            ring_offsets: offsets.map(|&offset| offset as usize).collect(),
            polynomials: Vec::new(),
            polynomial_offsets: vec![0; mesh.vertex_count() + 1],
            disagreements: Vec::new(),
            apart: Vec::new(),
            scratches: Vec::new(),
        }
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        surface.report_rough_vertices(report);
        for (vertex, &degree) in memory.degrees.iter().enumerate() {
            let vertex = vertex as u32;
            match usize::from(degree) {
                0 => report(Finding::TooFewNeighbours { vertex }),
                lower if lower < self.degree => report(Finding::ReducedDegree { vertex, degree }),
                _ => {}
            }
        }
        let mesh = surface.mesh();
        for (vertex, &is_apart) in memory.apart.iter().enumerate() {
            let aspect = |vertex: usize| spacing(surface, &memory.normals, vertex).aspect;
            let ring = mesh.one_ring(vertex).iter().map(|&other| other as usize);
            let is_long = |vertex: usize| aspect(vertex) >= T::constant(ROWS);
            if is_apart && ring.chain([vertex]).any(is_long) {
                report(Finding::Rows {
                    vertex: vertex as u32,
                });
            }
        }
    }
}

impl<T: Real> Curvatures<T> for Jet<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let vertices = surface.mesh().vertex_count();
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.expect(memory);
        let JetMemory {
            room,
            surroundings,
            cotangent,
            rows,
            degrees,
            bounds,
            normals,
            derivatives,
            ring_curvatures,
            ring_offsets,
            polynomials,
            polynomial_offsets,
            disagreements,
            apart,
            scratches,
        } = memory;
        let curvature = of_vertices(surface, curvature);
        // Areas, and initial normals.
        Cotangent::new(DualArea::Mixed).sum(execution, surface, cotangent, curvature);
        normals.clear();
        normals.extend(curvature.iter().map(|at| at.normal));
        degrees.resize(vertices, 0);
        bounds.resize(vertices, 0);
        derivatives.resize(vertices, Derivatives::default());
        disagreements.resize(vertices, [T::zero(); 2]);
        apart.resize(vertices, false);
        ring_curvatures.resize(surface.mesh().ring_vertices().len(), [T::zero(); 2]);
        let numbers = (&mut degrees[..], (&mut bounds[..], &mut derivatives[..]));
        let of_fits = (
            Ragged::new(ring_curvatures, ring_offsets),
            (
                rows.slots(vertices, *room),
                Ragged::new(polynomials, polynomial_offsets),
            ),
        );
        let output = ((&mut *curvature, numbers), of_fits);
        let fits = Fits {
            jet: self,
            surroundings,
            surface,
            normals,
        };
        execution.run(scratches, output, &fits);
        let (curvature, degrees) = (&*curvature, &*degrees);
        execution.map(
            (&mut disagreements[..], &mut apart[..]),
            |vertex, (most, is_apart)| {
                let none = match degrees[vertex] {
                    0 => T::infinity(),
                    _ => T::zero(),
                };
                *most = [none; 2];
                let start = ring_offsets[vertex];
                let ring = surface.mesh().one_ring(vertex).iter();
                for (&other, &[mean, gaussian]) in ring.zip(&ring_curvatures[start..]) {
                    let there = &curvature[other as usize];
                    if degrees[other as usize] == 0 {
                        continue;
                    }
                    let apart = [mean - there.mean, gaussian - there.gaussian];
                    for (most, apart) in most.iter_mut().zip(apart) {
                        // NaN, where the fit does not reach that vertex, is not larger.
                        if apart.abs() > *most {
                            *most = apart.abs();
                        }
                    }
                }
                let Curvature {
                    mean,
                    gaussian,
                    area,
                    ..
                } = curvature[vertex];
                let bend = (mean * mean - gaussian).max(T::zero()).sqrt();
                let flat = T::constant(FLAT) * area.sqrt().reciprocal_or_zero();
                *is_apart = most[0] > T::constant(REPORTED) * (mean.abs() + bend).max(flat);
            },
        );
    }

    fn reaches_boundary(&self) -> bool {
        true
    }
}

impl<T: Real> LaplaceBeltrami<T> for Jet<T> {
    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.expect(memory);
        expect_measured(memory.rows.len(), surface.mesh().vertex_count());
        memory.rows.apply(execution, field, laplacian);
    }

    /// Δ_S of the fitted surfaces' own H, and the rows of the differences: two applications of fits, of
    /// which the first leaves only what it does not resolve to the second.
    fn apply_to_mean(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        (field, factor): (&[T], impl Fn(usize) -> T + Sync),
        laplacian: &mut [T],
    ) {
        self.apply_to_scalar(execution, surface, workspace, field, laplacian);
        let derivatives = &workspace.for_mesh(surface.mesh()).derivatives;
        execution.map(&mut laplacian[..derivatives.len()], |vertex, value| {
            *value += factor(vertex) * derivatives[vertex].missing;
        });
    }

    fn assemble(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        rows: &mut Rows<T>,
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.expect(memory);
        expect_measured(memory.rows.len(), surface.mesh().vertex_count());
        rows.copy_from(&memory.rows);
    }
}
