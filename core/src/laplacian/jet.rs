//! Method J: osculating jets.
//!
//! Fits of polynomial height functions after F. Cazals and M. Pouget, Comput. Aided Geom. Des. 22
//! (2005) 121; here weighted, interpolating at the vertex, and with an adaptive number of
//! neighbours. The same factorisation gives the row of a general Laplace–Beltrami operator.

mod fits;
mod normal_equations;

use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, of_vertices};
use crate::laplacian::{Cotangent, LaplaceBeltrami, Rows, VertexSums, expect_measured};
use crate::mesh::TriangleMesh;
use crate::mesh_identity::expect_parameter;
use crate::method::{Method, Workspace};
use crate::neighbourhood::Surroundings;
use crate::noise::Model;
use crate::noise::doubt::report_rows;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use alloc::vec::Vec;
use fits::{Block, Fits};

pub(crate) use fits::exponential;
pub(crate) use normal_equations::{MONOMIALS, Points as MomentPoints, place_of, set_moments};

/// Weighted least-squares jets: around each vertex a polynomial height function over the tangent
/// plane is fitted to the nearest vertices along the surface.
///
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
    /// Least |R_nn|/|R_11| of the scaled, pivoted QR factorisation with which a fit is accepted.
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

    /// Degree 6 from 1000 vertices on, degree 4 below.
    pub fn for_mesh(mesh: &TriangleMesh) -> Self {
        if mesh.vertex_count() < 1000 {
            Self::j4()
        } else {
            Self::j6()
        }
    }
}

/// Highest degree: beyond it, rounding errors outweigh the gain.
const HIGHEST_DEGREE: usize = 8;

/// Number of monomials `x^a y^b` with 1 ≤ a + b ≤ `degree`.
const fn coefficient_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2 - 1
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
    /// H of the last evaluation.
    means: Vec<T>,
    /// Bounds of the distances of neighbours in the last evaluation.
    bounds: Vec<i32>,
    blocks: Vec<Block<T>>,
}

impl<T> JetMemory<T> {
    /// The degree fitted at each vertex, 0 where the neighbours do not determine any fit.
    pub fn degrees(&self) -> &[u8] {
        &self.degrees
    }
}

impl<T: Real> JetMemory<T> {
    /// The number of neighbours of a fit.
    pub(crate) fn neighbours(&self, vertex: usize) -> usize {
        self.rows.row(vertex).0.len()
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
            let enough = available >= coefficients + if degree > 2 { 2 } else { 0 };
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

    /// The polynomials of a degree; `None` for degree 0.
    pub(crate) fn model(&self, degree: u8) -> Option<Model<T>> {
        (degree > 0).then(|| Model {
            degree: usize::from(degree),
            sharpness: self.sharpness,
            interpolates: true,
        })
    }

    fn highest_degree(&self) -> usize {
        self.degree.clamp(2, HIGHEST_DEGREE)
    }

    /// The largest number of neighbours of a fit of this degree, if this many are available.
    fn last_neighbours(&self, degree: usize, available: usize) -> usize {
        let least = coefficient_count(degree);
        self.most_neighbours.max(least).min(available)
    }

    /// The attempt after a failed one: with more neighbours, then of a lower degree.
    fn next_attempt(&self, failed: Attempt, available: usize) -> Option<Attempt> {
        let Attempt { degree, neighbours } = failed;
        let last = self.last_neighbours(degree, available);
        if neighbours == last {
            return self.first_attempt(degree - 1, available);
        }
        let neighbours = (neighbours + 2.max(neighbours / 4)).min(last);
        Some(Attempt { degree, neighbours })
    }

    /// The least |R_nn|/|R_11| with which an attempt is accepted.
    #[inline(always)]
    fn least_ratio(&self, attempt: Attempt, available: usize) -> T {
        let Attempt { degree, neighbours } = attempt;
        match (
            neighbours == self.last_neighbours(degree, available),
            degree,
        ) {
            (false, _) => self.conditioning,
            (true, 2) => T::epsilon().sqrt(),
            (true, _) => self.conditioning * T::constant(0.1),
        }
    }
}

impl<T: Real> Method<T> for Jet<T> {
    type Memory = JetMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> JetMemory<T> {
        JetMemory {
            room: self.room(),
            surroundings: Surroundings::new(mesh, self.room()),
            cotangent: VertexSums::default(),
            rows: Rows::new(),
            degrees: Vec::new(),
            means: Vec::new(),
            bounds: Vec::new(),
            blocks: Vec::new(),
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
        let fitted = |vertex: usize| {
            let model = self.model(*memory.degrees.get(vertex)?)?;
            Some((model, memory.neighbours(vertex)))
        };
        report_rows(surface, fitted, &memory.means, report);
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
            means,
            bounds,
            blocks,
        } = memory;
        let curvature = of_vertices(surface, curvature);
        // Areas, and initial normals.
        Cotangent::new(DualArea::Mixed).sum(execution, surface, cotangent, curvature);
        degrees.resize(vertices, 0);
        bounds.resize(vertices, 0);
        let slots = rows.slots(vertices, *room);
        let output = (
            (&mut *curvature, (&mut degrees[..], &mut bounds[..])),
            slots,
        );
        let fits = Fits {
            jet: self,
            surroundings,
            surface,
        };
        execution.run(blocks, output, &fits);
        means.clear();
        means.extend(curvature.iter().map(|at| at.mean));
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
