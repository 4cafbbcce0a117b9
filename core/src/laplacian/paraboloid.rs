//! The paraboloid fit: the operator of method E.
//!
//! A. Farutin, T. Biben and C. Misbah, J. Comput. Phys. 275 (2014) 539.

use crate::element::Execution;
use crate::energy::{Finding, Method};
use crate::lane::{Lane, Several};
use crate::laplacian::least_squares::LeastSquares;
use crate::laplacian::{Cotangent, CotangentMemory, Curvature, LaplaceBeltrami, Rows};
use crate::mesh::TriangleMesh;
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, add, dot, normalise, scale, sub, tangent_frame};
use alloc::vec::Vec;

/// At each vertex the least-squares paraboloid `z = a x + b y + ½ c x² + d x y + ½ e y²` through
/// the vertex and near its neighbours, in a frame whose z axis is turned into the paraboloid's
/// normal until it stands still. With `w = 1 + a² + b²`
///
/// `H = −[(1+a²) e − 2ab d + (1+b²) c] / (2 w^{3/2})`,  `K = (c e − d²)/w²`,
///
/// and a field's paraboloid by the same fit gives
/// `Δ_S φ = (1 − a²/w) φ_xx − 2ab/w φ_xy + (1 − b²/w) φ_yy + 2H (a φ_x + b φ_y)/√w`.
///
/// * Pointwise, not symmetric. The area is the mixed area.
/// * The neighbours are the one-ring, and two rings where that has fewer than five vertices.
/// * Five neighbours near a conic section through the vertex do not determine a paraboloid: values
///   then grow without bound. That is the method as published; [`Paraboloid::guarded`] does better.
/// * At a boundary vertex the fit is one-sided, and defines H and K there.
/// * Where the neighbours do not determine a paraboloid at all, because two rings have fewer than
///   five vertices (a tetrahedron) or by symmetry (an octahedron), the row is empty and H = K = 0;
///   [`Method::inspect`] reports it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Paraboloid {
    /// Whether two rings are used also where the one-ring nearly fails to determine the fit: where
    /// its row amplifies, `Σ_j |c_ij| |x_j − x_i|² > 10`. A row that is exact for paraboloids has 4
    /// without the absolute values, and one with positive coefficients has 4 with them.
    pub guarded: bool,
}

/// Unknowns of the fit, and the fewest neighbours that can determine them.
const COEFFICIENTS: usize = 5;

/// Amplification from which on a guarded fit takes two rings. A number that does not depend on how
/// the frame is turned, as diagonal entries of triangular factors do.
const AMPLIFIED: f64 = 10.0;

/// Most fits at one vertex. Each leaves a tilt smaller than the last by the square of edge length
/// times curvature, so that few are needed unless the mesh is too coarse for the surface.
const MOST_FITS: usize = 12;

impl Paraboloid {
    /// With two rings where one ring is nearly singular.
    pub fn guarded() -> Self {
        Self { guarded: true }
    }
}

/// Where each row starts, with room for as many neighbours as it may have, and the end of the last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NeighbourRoom {
    offsets: Vec<usize>,
}

/// Memory of [`Paraboloid`]: the rows of the surface that was measured last.
#[derive(Clone, Debug, Default)]
pub struct ParaboloidMemory<T> {
    cotangent: CotangentMemory<T>,
    rows: Rows<T>,
    fits: Vec<Fit<T>>,
}

/// Scratch memory for one vertex.
#[derive(Clone, Debug, Default)]
struct Fit<T> {
    search: Neighbourhood<T>,
    neighbours: Vec<u32>,
    /// Neighbours' positions relative to the vertex, in units of `radius`.
    offsets: Vec<Vec3<T>>,
    /// The distance of the farthest neighbour.
    radius: T,
    problem: LeastSquares<T, 1>,
}

/// A paraboloid that was fitted: its coefficients a, b, c, d, e in units of the radius, and the
/// normal that follows.
struct Fitted<T> {
    coefficients: [T; COEFFICIENTS],
    normal: Vec3<T>,
}

/// What is found at one vertex, in units of the radius.
struct Found<T> {
    normal: Vec3<T>,
    mean: T,
    gaussian: T,
    /// `Σ_j |c_ij| |x_j − x_i|²`.
    amplification: T,
}

impl<T: Real> Fit<T> {
    /// Fits the neighbours and sets their coefficients in the row of the Laplacian, in units of the
    /// radius; `None` if they determine no paraboloid.
    fn measure(&mut self, normal: Vec3<T>, row: &mut [T]) -> Option<Found<T>> {
        let fitted = self.settle(normal)?;
        let (mean, gaussian, laplacian) = fitted.curvature();
        let row = &mut row[..self.offsets.len()];
        let laplacian = laplacian.map(|x| Several([x]));
        for (entry, found) in row.iter_mut().zip(self.problem.row_of(&laplacian)) {
            *entry = found.0[0];
        }
        let parts = self.offsets.iter().zip(&*row);
        let amplification = parts
            .map(|(&offset, &coefficient)| coefficient.abs() * dot(offset, offset))
            .sum();
        Some(Found {
            normal: fitted.normal,
            mean,
            gaussian,
            amplification,
        })
    }

    fn set_neighbours(&mut self, surface: Surface<'_, T>, vertex: u32, rings: usize) {
        self.search.rings(surface, vertex, rings);
        let found = &self.search.found;
        self.neighbours.clear();
        self.neighbours.extend(found.iter().map(|found| found.1));
        let farthest = found
            .iter()
            .fold(T::zero(), |most, found| most.max(found.0));
        self.radius = farthest.sqrt();
        let over = Lane::reciprocal_or_zero(self.radius);
        let offset = |&neighbour| scale(over, surface.difference(vertex, neighbour));
        self.offsets.clear();
        self.offsets.extend(self.neighbours.iter().map(offset));
    }

    /// Fits again and again, from a first normal; `None` if the neighbours determine no paraboloid.
    fn settle(&mut self, normal: Vec3<T>) -> Option<Fitted<T>> {
        let mut fitted = self.fit(normal)?;
        for _ in 1..MOST_FITS {
            let [a, b, ..] = fitted.coefficients;
            if a.abs().max(b.abs()) <= T::constant(8.0) * T::epsilon() {
                break;
            }
            fitted = self.fit(fitted.normal)?;
        }
        Some(fitted)
    }

    fn fit(&mut self, normal: Vec3<T>) -> Option<Fitted<T>> {
        let count = self.offsets.len();
        if count < COEFFICIENTS {
            return None;
        }
        let [first, second] = tangent_frame(normal);
        let half = T::constant(0.5);
        let offsets = &self.offsets;
        // A column that is only rounding would be taken for a direction like any other.
        let matrix = self.problem.matrix(count, COEFFICIENTS);
        let height = count;
        for (k, &offset) in offsets.iter().enumerate() {
            let (x, y) = (dot(offset, first), dot(offset, second));
            let basis = [x, y, half * x * x, x * y, half * y * y];
            for (column, entry) in basis.into_iter().enumerate() {
                matrix[column * height + k] = Several([entry]);
            }
            matrix[COEFFICIENTS * height + k] = Several([dot(offset, normal)]);
        }
        let small = |entry: &Several<T, 1>| entry.0[0].abs() <= T::epsilon();
        let noise = matrix
            .chunks_exact(height)
            .take(COEFFICIENTS)
            .any(|column| column[..count].iter().all(small));
        let independence = self.problem.factorise().0[0];
        if noise || independence <= T::constant(count as f64) * T::epsilon() {
            return None;
        }
        let mut coefficients = [Several::zero(); COEFFICIENTS];
        self.problem.solve(&mut coefficients);
        let coefficients = coefficients.map(|x| x.0[0]);
        let [a, b, ..] = coefficients;
        let tilt = add(scale(a, first), scale(b, second));
        Some(Fitted {
            coefficients,
            normal: normalise(sub(normal, tilt)),
        })
    }
}

impl<T: Real> Fitted<T> {
    /// H, K and the functional that takes a field's coefficients to its Laplacian, in units of the
    /// radius.
    fn curvature(&self) -> (T, T, [T; COEFFICIENTS]) {
        let [a, b, c, d, e] = self.coefficients;
        let (one, two) = (T::one(), T::constant(2.0));
        let w = one + a * a + b * b;
        let root = w.sqrt();
        let sum = (one + a * a) * e - two * a * b * d + (one + b * b) * c;
        let mean = -sum / (two * w * root);
        let gaussian = (c * e - d * d) / (w * w);
        let slope = two * mean / root;
        let laplacian = [
            slope * a,
            slope * b,
            one - a * a / w,
            -two * a * b / w,
            one - b * b / w,
        ];
        (mean, gaussian, laplacian)
    }
}

impl Paraboloid {
    /// Fits one vertex: sets its curvature, whose normal is the first guess, and its row, and
    /// returns the row's length.
    fn measure_vertex<T: Real>(
        &self,
        surface: Surface<'_, T>,
        fit: &mut Fit<T>,
        vertex: u32,
        curvature: &mut Curvature<T>,
        (columns, coefficients): (&mut [u32], &mut [T]),
    ) -> usize {
        let start = curvature.normal;
        (curvature.mean, curvature.gaussian) = (T::zero(), T::zero());
        let narrow = surface.mesh().valence(vertex as usize) < COEFFICIENTS;
        fit.set_neighbours(surface, vertex, if narrow { 2 } else { 1 });
        let mut found = fit.measure(start, coefficients);
        let most = T::constant(AMPLIFIED);
        let settled = |found: &Found<T>| found.amplification <= most;
        if self.guarded && !narrow && !found.as_ref().is_some_and(settled) {
            fit.set_neighbours(surface, vertex, 2);
            found = fit.measure(start, coefficients);
        }
        let Some(found) = found else {
            return 0;
        };
        let over = fit.radius.recip();
        let (mean, gaussian) = (found.mean * over, found.gaussian * over * over);
        if ![mean, gaussian, over * over]
            .iter()
            .all(|value| value.is_finite())
        {
            return 0;
        }
        curvature.normal = found.normal;
        (curvature.mean, curvature.gaussian) = (mean, gaussian);
        let length = fit.neighbours.len();
        columns[..length].copy_from_slice(&fit.neighbours);
        for coefficient in &mut coefficients[..length] {
            *coefficient = *coefficient * over * over;
        }
        length
    }
}

impl<T: Real> Method<T> for Paraboloid {
    type Plan = NeighbourRoom;
    type Memory = ParaboloidMemory<T>;

    fn plan(&self, mesh: &TriangleMesh) -> NeighbourRoom {
        let mut offsets = Vec::with_capacity(mesh.vertex_count() + 1);
        let mut end = 0;
        offsets.push(end);
        for vertex in 0..mesh.vertex_count() {
            let ring = mesh.one_ring(vertex);
            // No more than these: some lie in both rings or are neighbours of several.
            let both = ring.len()
                + ring
                    .iter()
                    .map(|&v| mesh.valence(v as usize))
                    .sum::<usize>();
            let one = !self.guarded && ring.len() >= COEFFICIENTS;
            end += if one { ring.len() } else { both };
            offsets.push(end);
        }
        NeighbourRoom { offsets }
    }

    fn inspect(
        &self,
        _plan: &NeighbourRoom,
        surface: Surface<'_, T>,
        memory: &ParaboloidMemory<T>,
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_uneven_mesh(report);
        surface.report_rough_vertices(report);
        for vertex in 0..memory.rows.len() {
            let isolated = surface.mesh().one_ring(vertex).is_empty();
            let (columns, coefficients) = memory.rows.row(vertex);
            let place = vertex as u32;
            if !isolated && columns.is_empty() {
                report(Finding::TooFewNeighbours { vertex: place });
            }
            let parts = columns.iter().zip(coefficients);
            let amplification: T = parts
                .map(|(&column, &coefficient)| {
                    let offset = surface.difference(place, column);
                    coefficient.abs() * dot(offset, offset)
                })
                .sum();
            if amplification > T::constant(AMPLIFIED) {
                report(Finding::Amplified { vertex: place });
            }
        }
    }
}

impl<T: Real> LaplaceBeltrami<T> for Paraboloid {
    fn measure(
        &self,
        execution: &impl Execution,
        plan: &NeighbourRoom,
        surface: Surface<'_, T>,
        memory: &mut ParaboloidMemory<T>,
        curvature: &mut [Curvature<T>],
    ) {
        let mesh = surface.mesh();
        let ParaboloidMemory {
            cotangent,
            rows,
            fits,
        } = memory;
        let curvature = &mut curvature[..mesh.vertex_count()];
        // Areas, and normals to start from.
        Cotangent::new(DualArea::Mixed).sum(execution, surface, cotangent, curvature);
        let slots = rows.ragged_slots(&plan.offsets);
        execution.map_with(
            fits,
            (curvature, slots),
            |fit, vertex, (curvature, (length, row))| {
                *length = self.measure_vertex(surface, fit, vertex as u32, curvature, row) as u32;
            },
        );
    }

    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        _plan: &NeighbourRoom,
        _surface: Surface<'_, T>,
        memory: &ParaboloidMemory<T>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) {
        memory.rows.apply(execution, field, laplacian);
    }

    fn assemble(
        &self,
        _plan: &NeighbourRoom,
        _surface: Surface<'_, T>,
        memory: &ParaboloidMemory<T>,
        rows: &mut Rows<T>,
    ) {
        rows.clone_from(&memory.rows);
    }
}
