//! Method J: osculating jets.
//!
//! Fits of polynomial height functions after F. Cazals and M. Pouget, Comput. Aided Geom. Des. 22
//! (2005) 121; here weighted, interpolating at the vertex, with neighbours that adapt, and the
//! same factorisation giving the row of a general Laplace–Beltrami operator.

use crate::element::{Execution, SlotKernel, Slots};
use crate::energy::{Finding, Method};
use crate::laplacian::least_squares::LeastSquares;
use crate::laplacian::{Cotangent, CotangentMemory, Curvature, LaplaceBeltrami, RowSlots, Rows};
use crate::mesh::TriangleMesh;
use crate::neighbourhood::Nearest;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{dot, normalise, scale, sub, tangent_frame};
use alloc::vec::Vec;

/// Weighted least-squares jets: around each vertex a polynomial height function over the tangent
/// plane is fitted to the nearest vertices along the surface.
///
/// * H, K and n are those of the polynomial; on meshes of any kind H and K converge with order
///   d − 1 or better, `Δ_S H` with order d − 3 or better, in the largest error, too.
/// * `Δ_S φ` of any field is that of the polynomial fitted to φ with the same weights: pointwise,
///   not symmetric. Its rows must not be transposed or symmetrised: convergence is lost.
/// * Areas are mixed areas.
/// * Where the neighbours do not carry the degree it is lowered, which [`Method::inspect`] reports;
///   where they do not even carry a paraboloid (meshes of a few vertices) H, K and the row are 0.
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

    /// Degree 4: for coarse meshes, small irregular ones, and dynamics.
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

/// Highest degree that is offered: beyond, rounding outweighs what the degree gains.
const HIGHEST_DEGREE: usize = 8;

/// Slope of the fitted surface against its frame from which on it is fitted again, upright.
const LEAN: f64 = 0.1;

/// Number of monomials `x^a y^b` with 1 ≤ a + b ≤ `degree`.
const fn coefficient_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2 - 1
}

/// Memory of [`Jet`].
#[derive(Clone, Debug)]
pub struct JetMemory<T> {
    cotangent: CotangentMemory<T>,
    rows: Rows<T>,
    /// The degree fitted at each vertex, 0 where there was no fit.
    degrees: Vec<u8>,
    scratches: Vec<Scratch<T>>,
}

impl<T: Real> Default for JetMemory<T> {
    fn default() -> Self {
        Self {
            cotangent: CotangentMemory::default(),
            rows: Rows::new(),
            degrees: Vec::new(),
            scratches: Vec::new(),
        }
    }
}

impl<T> JetMemory<T> {
    /// The degree fitted at each vertex, 0 where the neighbours carry none.
    pub fn degrees(&self) -> &[u8] {
        &self.degrees
    }
}

/// What one fit at a time needs.
#[derive(Clone, Debug, Default)]
struct Scratch<T> {
    nearest: Nearest,
    /// How many of them may be used.
    available: usize,
    differences: Vec<[T; 3]>,
    /// Coordinates in the tangent plane, weights, and weighted heights of each, padded with zeros.
    places: [Vec<T>; 2],
    weights: Vec<T>,
    heights: Vec<T>,
    coefficients: Vec<T>,
    functional: Vec<T>,
    fit: LeastSquares<T>,
}

/// `e^x` for −16 < x ≤ 0, to rounding: the 64th power of the series of `e^(x/64)`. There is no call,
/// which would end a vector.
#[inline(always)]
fn exponential<T: Real>(x: T) -> T {
    let y = x * T::constant(1.0 / 64.0);
    let step = |sum: T, over: f64| T::one() + sum * (y * T::constant(over));
    let sum = step(T::one(), 1.0 / 9.0);
    let sum = step(step(sum, 1.0 / 8.0), 1.0 / 7.0);
    let sum = step(step(sum, 1.0 / 6.0), 1.0 / 5.0);
    let sum = step(step(sum, 1.0 / 4.0), 1.0 / 3.0);
    let sum = step(step(sum, 1.0 / 2.0), 1.0);
    let fourth = (sum * sum) * (sum * sum);
    let sixteenth = (fourth * fourth) * (fourth * fourth);
    (sixteenth * sixteenth) * (sixteenth * sixteenth)
}

/// Sets `product` to the product of two columns, entry by entry.
#[inline(always)]
fn set_product<T: Real>(product: &mut [T], a: &[T], b: &[T]) {
    for ((product, &a), &b) in product.iter_mut().zip(a).zip(b) {
        *product = a * b;
    }
}

/// A polynomial in lengths of ρ, over the tangent plane of `normal`.
struct Polynomial<T> {
    degree: usize,
    neighbours: usize,
    normal: [T; 3],
    frame: [[T; 3]; 2],
    radius: T,
}

impl<T: Real> Jet<T> {
    /// Fits until the neighbours carry the degree; `None` if they do not even carry a paraboloid.
    #[inline(always)]
    fn fit(
        &self,
        scratch: &mut Scratch<T>,
        surface: Surface<'_, T>,
        centre: u32,
        normal: [T; 3],
    ) -> Option<Polynomial<T>> {
        let available = scratch.available;
        let highest = self.degree.clamp(2, HIGHEST_DEGREE);
        for degree in (2..=highest).rev() {
            let coefficients = coefficient_count(degree);
            if available < coefficients + if degree > 2 { 2 } else { 0 } {
                continue;
            }
            // A lower degree starts from neighbours in proportion to its coefficients.
            let first = (self.neighbours * coefficients).div_ceil(coefficient_count(highest));
            let last = self.most_neighbours.max(coefficients).min(available);
            let mut neighbours = first.clamp(coefficients.min(last), last);
            loop {
                let found = self.fit_with(scratch, surface, centre, normal, degree, neighbours);
                let least = match (neighbours == last, degree) {
                    (false, _) => self.conditioning,
                    (true, 2) => T::epsilon().sqrt(),
                    (true, _) => self.conditioning * T::constant(0.1),
                };
                match found {
                    Some((polynomial, ratio)) if ratio >= least => return Some(polynomial),
                    _ if neighbours == last => break,
                    _ => neighbours = (neighbours + 2.max(neighbours / 4)).min(last),
                }
            }
        }
        None
    }

    /// One fit; its reciprocal condition is returned with it.
    #[inline(always)]
    fn fit_with(
        &self,
        scratch: &mut Scratch<T>,
        surface: Surface<'_, T>,
        centre: u32,
        normal: [T; 3],
        degree: usize,
        neighbours: usize,
    ) -> Option<(Polynomial<T>, T)> {
        let Scratch {
            nearest,
            differences,
            places: [across, along],
            weights,
            heights,
            coefficients,
            fit,
            ..
        } = scratch;
        let sorted = differences.len();
        if sorted < neighbours {
            nearest.sort(sorted, neighbours);
            let found = nearest.vertices().take(neighbours).skip(sorted);
            differences.extend(found.map(|j| surface.difference(centre, j)));
        }
        let farthest = differences[neighbours - 1];
        let radius = dot(farthest, farthest).sqrt();
        if radius < T::min_positive_value() {
            return None;
        }
        let frame = tangent_frame(normal);
        let over = radius.recip();
        let columns = coefficient_count(degree);
        let (matrix, height) = fit.matrix(neighbours, columns);
        for values in [&mut *across, &mut *along, &mut *weights, &mut *heights] {
            values.clear();
            values.resize(height, T::zero());
        }
        for (row, &difference) in differences[..neighbours].iter().enumerate() {
            let local = scale(over, difference);
            across[row] = dot(local, frame[0]);
            along[row] = dot(local, frame[1]);
            heights[row] = dot(local, normal);
            weights[row] = -self.sharpness * dot(local, local);
        }
        for weight in &mut weights[..neighbours] {
            *weight = exponential(*weight);
        }
        for (height, weight) in heights.iter_mut().zip(&*weights) {
            *height *= *weight;
        }
        // Degree after degree: x·(the last degree), and y·(its last monomial).
        set_product(&mut matrix[..height], across, weights);
        set_product(&mut matrix[height..2 * height], along, weights);
        for degree in 2..=degree {
            let (last, start) = (coefficient_count(degree - 2), coefficient_count(degree - 1));
            let (before, now) = matrix.split_at_mut(start * height);
            for (number, column) in now.chunks_exact_mut(height).take(degree + 1).enumerate() {
                let (factor, from) = if number < degree {
                    (&*across, number)
                } else {
                    (&*along, degree - 1)
                };
                set_product(column, factor, &before[(last + from) * height..][..height]);
            }
        }
        let ratio = fit.factorise();
        if ratio <= T::zero() || ratio.is_nan() {
            return None;
        }
        coefficients.resize(columns, T::zero());
        fit.solve(&heights[..neighbours], coefficients);
        Some((
            Polynomial {
                degree,
                neighbours,
                normal,
                frame,
                radius,
            },
            ratio,
        ))
    }
}

impl<T: Real> Polynomial<T> {
    /// The surface's normal at the vertex.
    fn surface_normal(&self, coefficients: &[T]) -> [T; 3] {
        let [p, q] = [coefficients[0], coefficients[1]];
        let along = sub(self.normal, scale(p, self.frame[0]));
        normalise(sub(along, scale(q, self.frame[1])))
    }

    /// Whether curvatures and the weights of the Laplacian stay within the range of the scalar.
    fn is_bounded(&self, coefficients: &[T], functional: &mut Vec<T>) -> bool {
        let (mean, gaussian) = self.curvatures(coefficients, functional);
        let over = self.radius.recip();
        [mean, gaussian, over * over]
            .iter()
            .all(|value| value.is_finite())
    }

    /// H and K of the height function `p x + q y + c₂₀ x² + c₁₁ x y + c₀₂ y² + …`, and the
    /// functional that takes the coefficients of any field to its Δ_S.
    fn curvatures(&self, coefficients: &[T], functional: &mut Vec<T>) -> (T, T) {
        let one = T::one();
        let two = T::constant(2.0);
        let [p, q, c20, c11, c02] = [0, 1, 2, 3, 4].map(|k| coefficients[k]);
        let (xx, xy, yy) = (two * c20, c11, two * c02);
        let w = one + p * p + q * q;
        let root = w.sqrt();
        let bend = (one + q * q) * xx - two * p * q * xy + (one + p * p) * yy;
        let mean = -bend / (two * w * root);
        let gaussian = (xx * yy - xy * xy) / (w * w);
        functional.clear();
        functional.resize(coefficients.len(), T::zero());
        functional[0] = two * mean * p / root;
        functional[1] = two * mean * q / root;
        functional[2] = two * (one - p * p / w);
        functional[3] = -two * p * q / w;
        functional[4] = two * (one - q * q / w);
        let over = self.radius.recip();
        (mean * over, gaussian * over * over)
    }
}

/// The fits around all vertices.
struct Fits<'a, T> {
    jet: &'a Jet<T>,
    surface: Surface<'a, T>,
}

/// What a fit sets: the curvature, whose normal is the one to start from, the degree, and a row.
type FitSlots<'a, T> = ((&'a mut [Curvature<T>], &'a mut [u8]), RowSlots<'a, T>);

impl<'a, T: Real> SlotKernel<Scratch<T>, FitSlots<'a, T>> for Fits<'_, T> {
    #[inline(always)]
    fn set(
        &self,
        scratch: &mut Scratch<T>,
        vertex: usize,
        ((curvature, degree), (length, (columns, coefficients))): <FitSlots<'a, T> as Slots>::Slot,
    ) {
        let (surface, centre) = (self.surface, vertex as u32);
        scratch.nearest.search(surface, centre, columns.len());
        scratch.available = scratch.nearest.len().min(columns.len());
        scratch.differences.clear();
        let mut normal = curvature.normal;
        let mut fitted = None;
        // Twice at most, by one call: two would be too much to be compiled as part of the loop.
        for upright in [false, true] {
            fitted = self.jet.fit(scratch, surface, centre, normal);
            let Some(polynomial) = &fitted else {
                break;
            };
            let [p, q] = [scratch.coefficients[0], scratch.coefficients[1]];
            // A frame that leans little serves as well: the formulas know p and q.
            if upright || p * p + q * q <= T::constant(LEAN * LEAN) {
                break;
            }
            normal = polynomial.surface_normal(&scratch.coefficients);
        }
        let bounded = fitted.filter(|polynomial| {
            polynomial.is_bounded(&scratch.coefficients, &mut scratch.functional)
        });
        let Some(polynomial) = bounded else {
            (curvature.mean, curvature.gaussian) = (T::zero(), T::zero());
            (*degree, *length) = (0, 0);
            return;
        };
        let Scratch {
            nearest,
            weights,
            coefficients: found,
            functional,
            fit,
            ..
        } = scratch;
        curvature.normal = polynomial.surface_normal(found);
        (curvature.mean, curvature.gaussian) = polynomial.curvatures(found, functional);
        *degree = polynomial.degree as u8;
        *length = polynomial.neighbours as u32;
        let row = &mut coefficients[..polynomial.neighbours];
        fit.row_of(functional, row);
        let over = polynomial.radius.recip();
        for (entry, &weight) in row.iter_mut().zip(weights.iter()) {
            *entry *= weight * over * over;
        }
        for (column, neighbour) in columns.iter_mut().zip(nearest.vertices()) {
            *column = neighbour;
        }
    }
}

impl<T: Real> Method<T> for Jet<T> {
    type Plan = ();
    type Memory = JetMemory<T>;

    fn plan(&self, _mesh: &TriangleMesh) {}

    fn inspect(
        &self,
        (): &(),
        surface: Surface<'_, T>,
        memory: &JetMemory<T>,
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_rough_vertices(report);
        for (vertex, &degree) in memory.degrees.iter().enumerate() {
            let vertex = vertex as u32;
            match usize::from(degree) {
                0 => report(Finding::TooFewNeighbours { vertex }),
                lower if lower < self.degree => report(Finding::ReducedDegree { vertex, degree }),
                _ => {}
            }
        }
    }
}

impl<T: Real> LaplaceBeltrami<T> for Jet<T> {
    fn measure(
        &self,
        execution: &impl Execution,
        (): &(),
        surface: Surface<'_, T>,
        memory: &mut JetMemory<T>,
        curvature: &mut [Curvature<T>],
    ) {
        let vertices = surface.mesh().vertex_count();
        let JetMemory {
            cotangent,
            rows,
            degrees,
            scratches,
        } = memory;
        let curvature = &mut curvature[..vertices];
        // Areas, and normals to start from.
        Cotangent::new(DualArea::Mixed).sum(execution, surface, cotangent, curvature);
        degrees.resize(vertices, 0);
        let slots = rows.slots(vertices, self.most_neighbours.max(coefficient_count(2)));
        let output = ((curvature, &mut degrees[..]), slots);
        execution.run(scratches, output, &Fits { jet: self, surface });
    }

    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        (): &(),
        _surface: Surface<'_, T>,
        memory: &JetMemory<T>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) {
        memory.rows.apply(execution, field, laplacian);
    }

    fn assemble(
        &self,
        (): &(),
        _surface: Surface<'_, T>,
        memory: &JetMemory<T>,
        rows: &mut Rows<T>,
    ) {
        rows.copy_from(&memory.rows);
    }
}
