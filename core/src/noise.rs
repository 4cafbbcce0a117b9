//! Noise of the positions, estimated from the residuals of polynomial fits.
//!
//! On a smooth surface the contributions of polynomials decay with their degree; noise that is
//! independent from vertex to vertex contributes equally to every degree. Around each vertex a
//! polynomial of degree 6 is fitted to the heights of its neighbours. S₄, S₅, S₆ are the contributions
//! of its three highest degrees, and R is the residual, each as the standard deviation of the noise
//! that would explain it, pooled over nearby vertices. Odd and even degrees decay separately: the
//! residual of the shape is expected to be at most `1.8 S₆ max(S₅, S₆) / S₄`, and never more than `0.45
//! S₆`; a larger residual is noise. If R/S₆ indicates no noise but S₆/S₄ is not small, the mesh does
//! not resolve the shape there.
//!
//! Noise is the same everywhere, but the residual of a shape is not: where R is least, most of it is
//! noise. If R agrees between these places, and does not grow for wider fits, it is the noise of a mesh
//! that resolves the shape only in part.
//!
//! The constants were chosen so that no noise is detected on exact meshes of spheres, ellipsoids, tori
//! and discocytes, even or not, of 42 to 5000 vertices, and that σ is correct within 15 % if it exceeds
//! about the residual of such meshes: 1e-4 mean edges at 2562 vertices, 1e-5 at 10242.

mod adaptive;
pub(crate) mod doubt;
mod fit;
mod grid;
mod quiet;

mod sharp;
mod smoothing;

use crate::diagnostic::Finding;
use crate::element::Execution;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, norm, normalise};
pub use adaptive::{AdaptiveJet, Cause, Estimate, FitExtent, Measured, Scale, Verdict};
use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::iter;

pub use smoothing::Smoothing;

use fit::HeightFit;
pub(crate) use fit::Model;
use sharp::Mark;

/// Largest number of vertices around which fits are pooled: their median is known to a few per cent.
const CENTRES: usize = 128;

/// Fits that are pooled around each of them.
const POOL: usize = 100;

/// The degree of the polynomials whose residuals are the noise.
const DEGREE: usize = 6;

/// The degrees of the polynomials that average noise. The lower degree uses the first columns of the
/// same orthogonal basis.
const DEGREES: [usize; 2] = [4, 6];

/// Neighbours of a first fit, and at most.
const NEIGHBOURS: [usize; 2] = [56, 112];

/// Least diagonal entry of the triangular factor with which a fit is accepted: immediately, and with
/// the largest number of neighbours.
const CONDITIONING: [f64; 2] = [0.012, 0.001];

/// Least cosine between the normals of a vertex and of its neighbours. Below it heights over the
/// tangent plane are not a function of the position in the plane.
const UPRIGHT: f64 = 0.0;

/// Rings of vertices at a boundary, whose fits are one-sided and have residuals larger than noise.
const BORDER: usize = 3;

/// The residual that a shape may have.
#[derive(Clone, Copy)]
struct Rule {
    /// Its ratio to `S₆ max(S₅, S₆) / S₄`.
    foretold: f64,
    /// Its largest ratio to S₆.
    ceiling: f64,
    /// Least S₆/S₄ at which R/S₆ has to be that of noise, or far below, because R is then no better known than S₆.
    slow: f64,
}

/// The upper bound, for which exact meshes have no noise as a whole; the value on most meshes; and the value around
/// single vertices, where the noise of the whole mesh is known.
const LARGEST: Rule = Rule {
    foretold: 1.8,
    ceiling: 0.45,
    slow: 0.12,
};
const LIKELY: Rule = Rule {
    foretold: 1.1,
    ..LARGEST
};
const AROUND_VERTICES: Rule = Rule {
    foretold: 1.5,
    ceiling: 0.35,
    slow: 0.15,
};

/// Smallest and largest R/S₆ of noise, without scatter, and largest R/S₆ of a shape.
const FLAT: [f64; 2] = [0.8, 1.3];
const STEEP: f64 = 0.35;

/// Errors of positions: the distance by which vertices lie off a smooth surface.
///
/// No method can distinguish measured noise, rounded coordinates, and kinks of the surface at the scale
/// of its mesh. An error σ of the positions causes an error of about σ/A in H and of 10 σ/A² in Δ_S H,
/// where A is the area of a vertex: for the same noise, finer meshes have *larger* errors.
///
/// The estimate assumes errors that are independent from vertex to vertex, isotropic or along the
/// normal. It detects only part of errors that neighbours share, and no waves longer than about five
/// edges. The discrete equilibrium of one method is rough at the scale of an edge for all other
/// methods, and counts as noise, too.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise<T> {
    /// Standard deviation σ of the position along the normal; 0 if no noise was detected, that is, if
    /// the shape itself or the rounding of the number type explains the residual.
    pub length: T,
    /// The same in mean lengths of an edge.
    pub edges: T,
}

/// For degrees 4, 5, 6 and the residual: the sum of squares, and its expected value for noise of
/// variance 1. Zeros where there is no fit.
type Spectrum<T> = [[T; 2]; 4];

/// Noise estimated around one vertex.
struct Seen<T> {
    /// Upper estimate: the standard deviation of noise that explains the whole residual.
    most: T,
    /// Lower estimate: the standard deviation of the noise if the shape has its largest residual.
    least: T,
    /// Likely value: the standard deviation of the noise if the shape has its usual residual.
    likely: T,
    /// Whether the contributions decay fast enough to distinguish noise from shape.
    is_resolved: bool,
}

impl<T: Real> Noise<T> {
    /// The noise of a surface: the median of the estimates around evenly numbered vertices.
    ///
    /// If coordinates have few decimals, or only the digits of f32, and their residuals do not
    /// contradict it, the noise is at least that of this rounding.
    pub fn of(execution: &impl Execution, surface: Surface<'_, T>) -> Self {
        let pools = pools(surface, CENTRES);
        let mut fitted: Vec<u32> = pools.iter().flatten().copied().collect();
        fitted.sort_unstable();
        fitted.dedup();
        let smooth = Smooth {
            normals: &normals(surface),
            marks: &sharp::marks(surface),
        };
        let spectra = spectra(execution, surface, smooth, &fitted);
        let of_vertex = |vertex: u32| match fitted.binary_search(&vertex) {
            Ok(place) => spectra[place],
            Err(_) => Spectrum::default(),
        };
        Self::in_pools(surface, smooth, &pools, of_vertex)
    }

    /// The noise of a surface whose spectra are known.
    fn of_spectra(surface: Surface<'_, T>, smooth: Smooth<'_, T>, spectra: &[Spectrum<T>]) -> Self {
        let of_vertex = |vertex: u32| spectra[vertex as usize];
        Self::in_pools(surface, smooth, &pools(surface, CENTRES), of_vertex)
    }

    fn in_pools(
        surface: Surface<'_, T>,
        smooth: Smooth<'_, T>,
        pools: &[Vec<u32>],
        spectrum: impl Fn(u32) -> Spectrum<T>,
    ) -> Self {
        let spectrum = |&vertex: &u32| spectrum(vertex);
        let in_pool = |pool: &Vec<u32>| Seen::in_pool(pool.iter().map(spectrum));
        let seen = pools.iter().map(|pool| Some((pool, in_pool(pool)?)));
        let mut seen = Vec::from_iter(seen.flatten());
        let is_half = |count: usize| 2 * count >= pools.len();
        if !is_half(seen.len()) {
            return Self::default();
        }
        let resolved = seen.iter().filter(|(_, seen)| seen.is_resolved);
        let resolved = Vec::from_iter(resolved.map(|(_, seen)| seen));
        let (mut found, mut most) = (T::zero(), median(seen.iter().map(|(_, seen)| seen.most)));
        if is_half(resolved.len()) {
            found = median(resolved.iter().map(|seen| seen.least));
            most = median(resolved.iter().map(|seen| seen.most));
        }
        if let Some(quiet) = quiet::noise(surface, smooth, &mut seen, found > T::zero()) {
            found = found.max(quiet);
        }
        let length = found.max(rounding(surface.positions(), most));
        let last_digit = T::epsilon() * largest_coordinate(surface.positions());
        if length <= last_digit {
            return Self::default();
        }
        Self::of_length(surface, length)
    }

    /// Noise with the median of standard deviations, for instance those of [`AdaptiveJet::deviations`], which are
    /// sorted.
    pub fn of_deviations(surface: Surface<'_, T>, deviations: &mut [T]) -> Self {
        sort(deviations);
        match deviations.get(deviations.len() / 2) {
            Some(&length) if length > T::zero() => Self::of_length(surface, length),
            _ => Self::default(),
        }
    }

    fn of_length(surface: Surface<'_, T>, length: T) -> Self {
        let edges = surface.mesh().edges();
        let lengths = edges.iter();
        let lengths = lengths.map(|&[from, to]| norm(surface.difference(from, to)));
        let edge = lengths.sum::<T>() / T::constant(edges.len() as f64);
        Self {
            length,
            edges: length / edge,
        }
    }

    /// Reports the vertices where this noise is too large for a fourth derivative by any method.
    pub fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        if self.is_seen() {
            surface.report_noisy_vertices(self.length, report);
        }
    }

    /// Whether any noise was found.
    pub fn is_seen(&self) -> bool {
        self.length > T::zero()
    }
}

/// For each of at most so many evenly numbered vertices, those whose fits are pooled: its breadth-first
/// neighbourhood, without vertices near a boundary.
fn pools<T: Real>(surface: Surface<'_, T>, centres: usize) -> Vec<Vec<u32>> {
    let count = surface.mesh().vertex_count();
    let centres = (0..count).step_by(count.div_ceil(centres.max(1)).max(1));
    let rings = rings_from_border(surface.mesh());
    let mut neighbourhood = Neighbourhood::default();
    let pool = |centre: usize| {
        neighbourhood.at_least(surface, centre as u32, POOL);
        let reached = neighbourhood.found.iter().map(|&(_, vertex)| vertex);
        let all = iter::once(centre as u32).chain(reached).take(POOL);
        all.filter(|&vertex| usize::from(rings[vertex as usize]) == BORDER)
            .collect()
    };
    centres.map(pool).collect()
}

/// The distance of each vertex from a boundary in rings, at most [`BORDER`]; 0 of isolated vertices.
fn rings_from_border(mesh: &TriangleMesh) -> Vec<u8> {
    let of_kind = |kind: &VertexKind| match kind {
        VertexKind::Interior => BORDER as u8,
        _ => 0,
    };
    let mut rings = Vec::from_iter(mesh.vertex_kinds().iter().map(of_kind));
    if mesh.is_closed() {
        return rings;
    }
    for ring in 1..BORDER as u8 {
        for vertex in 0..rings.len() {
            let is_beside = |&other: &u32| rings[other as usize] == ring - 1;
            if rings[vertex] > ring && mesh.one_ring(vertex).iter().any(is_beside) {
                rings[vertex] = ring;
            }
        }
    }
    rings
}

/// The spectrum of the fit around each of `vertices`.
fn spectra<T: Real>(
    execution: &impl Execution,
    surface: Surface<'_, T>,
    smooth: Smooth<'_, T>,
    vertices: &[u32],
) -> Vec<Spectrum<T>> {
    let mut spectra = vec![Spectrum::default(); vertices.len()];
    let mut memory: Vec<(Neighbourhood<T>, HeightFit<T>)> = Vec::new();
    execution.map_with(
        &mut memory,
        &mut spectra[..],
        |(near, fit), place, spectrum| {
            *spectrum = spectrum_at(surface, smooth, vertices[place], NEIGHBOURS, near, fit);
        },
    );
    spectra
}

/// Vertex normals, and what is not smooth; no marks if all is.
#[derive(Clone, Copy)]
struct Smooth<'a, T> {
    normals: &'a [Vec3<T>],
    marks: &'a [Option<Mark>],
}

impl<T> Smooth<'_, T> {
    fn is_marked(&self, vertex: u32) -> bool {
        self.marks
            .get(vertex as usize)
            .is_some_and(|mark| mark.is_some())
    }
}

/// The spectrum of the fit around a vertex, with the first and the largest number of neighbours given;
/// zeros if the fit fails, or includes a crease or an outlier.
fn spectrum_at<T: Real>(
    surface: Surface<'_, T>,
    smooth: Smooth<'_, T>,
    vertex: u32,
    [first, most]: [usize; 2],
    near: &mut Neighbourhood<T>,
    fit: &mut HeightFit<T>,
) -> Spectrum<T> {
    let model = Model {
        degree: DEGREE,
        sharpness: T::constant(7.0),
        interpolates: true,
    };
    let normals = smooth.normals;
    let here = normals[vertex as usize];
    near.nearest(surface, vertex, most);
    let mut count = first;
    loop {
        count = count.min(near.found.len());
        let neighbours = &near.found[..count];
        let upright =
            |&(_, other): &(T, u32)| dot(normals[other as usize], here) >= T::constant(UPRIGHT);
        let is_marked = |&(_, other): &(T, u32)| smooth.is_marked(other);
        let is_marked = smooth.is_marked(vertex) || neighbours.iter().any(is_marked);
        if is_marked || !neighbours.iter().all(upright) {
            return Spectrum::default();
        }
        fit.gather(surface, vertex, neighbours, &model);
        let last = count == near.found.len();
        let required = T::constant(CONDITIONING[usize::from(last)]);
        let conditioning = fit.fit(&mut here.clone(), &model);
        if conditioning >= required {
            return fit.spectrum(&model);
        }
        if last {
            return Spectrum::default();
        }
        count += count / 4;
    }
}

/// Area-weighted vertex normals.
fn normals<T: Real>(surface: Surface<'_, T>) -> Vec<Vec3<T>> {
    let mesh = surface.mesh();
    let mut normals = vec![[T::zero(); 3]; mesh.vertex_count()];
    for (triangle, corners) in mesh.triangles().iter().enumerate() {
        let area_vector = surface.triangle(triangle).area_vector;
        for &corner in corners {
            let normal = &mut normals[corner as usize];
            *normal = add(*normal, area_vector);
        }
    }
    normals.into_iter().map(normalise).collect()
}

impl<T: Real> Seen<T> {
    /// The noise according to the spectra of a pool; `None` where half of the fits failed.
    fn in_pool(spectra: impl Iterator<Item = Spectrum<T>>) -> Option<Self> {
        let mut sums = Spectrum::<T>::default();
        let mut fits = 0;
        for spectrum in spectra {
            fits += usize::from(spectrum[3][1] > T::zero());
            for (sum, term) in sums.iter_mut().flatten().zip(spectrum.iter().flatten()) {
                *sum += *term;
            }
        }
        if 2 * fits < POOL {
            return None;
        }
        let decay = Decay::new(sums);
        if decay.0.iter().any(|part| !part.is_finite()) {
            return None;
        }
        let [least, likely] =
            [LARGEST, LIKELY].map(|rule| decay.variance(&rule).max(T::zero()).sqrt());
        Some(Self {
            most: decay.residual().sqrt(),
            least,
            likely,
            is_resolved: decay.is_resolved(&LARGEST),
        })
    }
}

/// S₄², S₅², S₆² and R² of a pool of fits.
#[derive(Clone, Copy)]
struct Decay<T>([T; 4]);

impl<T: Real> Decay<T> {
    fn new(sums: Spectrum<T>) -> Self {
        Self(sums.map(|[squares, gain]| squares / gain))
    }

    /// R².
    fn residual(&self) -> T {
        let [.., left] = self.0;
        left
    }

    /// The variance of the noise, if the shape has the residual of the rule; below 0 where that is larger than R.
    fn variance(&self, rule: &Rule) -> T {
        let square = |factor: f64| T::constant(factor * factor);
        let [fourth, fifth, sixth, left] = self.0;
        let ceiling = square(rule.ceiling);
        let foretold = square(rule.foretold) * fifth.max(sixth) * sixth;
        if foretold < ceiling * sixth * fourth {
            left - foretold / fourth
        } else {
            // Noise contributes equally to S₆ and R.
            (left - ceiling * sixth) / (T::one() - ceiling)
        }
    }

    /// Whether the residual is that of noise, or far below.
    fn is_resolved(&self, rule: &Rule) -> bool {
        let square = |factor: f64| T::constant(factor * factor);
        let [fourth, _, sixth, left] = self.0;
        let [least_flat, most_flat] = FLAT.map(|ratio| square(ratio) * sixth);
        let is_slow = sixth > square(rule.slow) * fourth;
        let is_between = left > square(STEEP) * sixth && left < least_flat;
        !(left > most_flat || (is_between && is_slow))
    }
}

fn median<T: Real>(values: impl Iterator<Item = T>) -> T {
    let mut values = Vec::from_iter(values);
    sort(&mut values);
    values.get(values.len() / 2).copied().unwrap_or(T::zero())
}

/// Sorts numbers from low to high; compiled once for each scalar.
fn sort<T: Real>(values: &mut [T]) {
    values.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
}

fn largest_coordinate<T: Real>(positions: &[[T; 3]]) -> T {
    positions
        .iter()
        .flatten()
        .fold(T::zero(), |most, x| most.max(x.abs()))
}

/// Largest number of decimals of coordinates that count as rounded.
const DECIMALS: i32 = 9;

/// Standard deviation of the rounding of coordinates to a few decimals or to f32; 0 if neither, or if residuals with
/// the median `most` contradict it, as those of a cube with integer coordinates.
fn rounding<T: Real>(positions: &[[T; 3]], most: T) -> T {
    let rounding = rounding_of_digits(positions);
    if most >= T::constant(0.5) * rounding {
        rounding
    } else {
        T::zero()
    }
}

fn rounding_of_digits<T: Real>(positions: &[[T; 3]]) -> T {
    let over = T::constant(12.0).sqrt().recip();
    let coordinates = || positions.iter().flatten();
    for decimals in -DECIMALS..=DECIMALS {
        let inverse = T::constant(10.0).powi(decimals);
        // Number types without digits beyond the decimals cannot show whether coordinates are rounded.
        let told = |x: T| x * inverse * T::epsilon() < T::constant(1e-3);
        let on_grid = |&x: &T| {
            let scaled = x * inverse;
            let off = (scaled - scaled.round()).abs();
            told(x.abs()) && off <= T::constant(4.0) * T::epsilon() * scaled.abs()
        };
        if coordinates().all(on_grid) {
            return over * inverse.recip();
        }
    }
    let single = T::constant(f64::from(f32::EPSILON));
    let is_single = |&x: &T| x.to_f32().and_then(T::from_f32) == Some(x);
    if T::epsilon() < single && coordinates().all(is_single) {
        // One unit in the last place of a number is ε/2 to ε of the number.
        let count = T::constant(3.0 * positions.len() as f64);
        let squares = coordinates().map(|&x| {
            let digit = single * T::constant(0.7) * x.abs();
            digit * digit
        });
        return over * (squares.sum::<T>() / count).sqrt();
    }
    T::zero()
}
