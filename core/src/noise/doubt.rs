//! Doubts about fits: whether their neighbours determine them, and how far fits at neighbouring vertices
//! disagree.
//!
//! If vertices lie in rows (on meshes by longitude and latitude, tubes, stacks of sections, swept
//! surfaces), the nearest neighbours of a vertex may lie on one to three rows, along which a polynomial in
//! two variables is not determined. Two signs show this without knowledge of the surface: the columns of
//! the fit are dependent, in units of columns of evenly spread neighbours, and the polynomial has another
//! curvature at the neighbours than the fits there.

use super::fit::{HeightFit, Model};
use super::normals;
use super::slopes::Slopes;
use crate::diagnostic::Finding;
use crate::lane::Lane;
use crate::mesh::VertexKind;
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, dot, tangent_frame};
use alloc::vec::Vec;
use core::array::from_fn;

/// Least spread of neighbours that determine a fit of degree 2 to 8: see [`HeightFit::spread`].
const SPREAD: [f64; 7] = [0.1, 0.08, 0.06, 0.05, 0.03, 0.03, 0.015];

/// Ratio of the spacings of vertices along and across rows from which on all fits share their errors;
/// from which on fits that disagree are reported; and from which on vertices count as rows. On discocytes, ratios are
/// up to 2.1 where vertices are even, and up to 2.8 where they are random; on isosurfaces up to 2.0.
pub(super) const ELONGATED: f64 = 1.9;
const DISAGREEING: f64 = 2.2;
pub(super) const ROWS: f64 = 2.9;

/// Part of the curvature above which a disagreement is reported.
pub(super) const REPORTED: f64 = 0.05;

/// Factors of this part: coarse and noisy meshes without rows have larger disagreements.
const IN_DOUBT: [f64; 2] = [2.0, 1.0];

/// Curvature, in inverse radii of a fit, that counts as none.
const FLAT: f64 = 1e-3;

/// A fit and the fits around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt<T> {
    /// See [`HeightFit::spread`], over the least value of neighbours that determine the fit.
    pub(super) spread: T,
    /// The largest difference, at the vertices of the one-ring, between H, and K, of this fit there and of the
    /// fits of these vertices; infinite if the fit has none of these vertices.
    pub(super) apart: [T; 2],
    /// The same for Δ_S H: the change by these differences, and the root of the sum of its squared terms.
    pub(super) of_laplacian: T,
    /// The distance of the farthest neighbour.
    pub(super) radius: T,
    /// Whether this is all that is known about the error of the fit.
    pub(super) is_all: bool,
}

/// H and K of the fits of all vertices; empty if they are not known.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a, T> {
    pub(super) mean: &'a [T],
    pub(super) gaussian: &'a [T],
}

impl<T: Real> Doubt<T> {
    /// The doubt about the last fit, over the plane of `normal`, by its coefficients of a degree and its row of
    /// Δ_S. `neighbours` are those of the fit, in its order.
    pub(super) fn new(
        fit: &HeightFit<T>,
        model: &Model<T>,
        (degree, normal, coefficients): (usize, Vec3<T>, &[T]),
        (ring, neighbours): (&[u32], &[(T, u32)]),
        laplacian: &[T],
        fields: Fields<'_, T>,
    ) -> Self {
        let own = usize::from(!model.interpolates);
        let axes = tangent_frame(normal);
        let mut apart = [T::zero(); 2];
        let mut seen = 0;
        let (mut sum, mut squares) = (T::zero(), T::zero());
        for (place, &(_, other)) in neighbours.iter().enumerate() {
            let is_beside = ring.contains(&other);
            let entry = laplacian.get(place + own).copied();
            if !is_beside && entry.is_none() {
                continue;
            }
            let [mean, gaussian] =
                fit.curvatures_at(&coefficients[own..], degree, place + own, axes);
            let known = |field: &[T]| field.get(other as usize).copied().unwrap_or(T::nan());
            let off = mean - known(fields.mean);
            if is_beside {
                seen += 1;
                let of_gaussian = gaussian - known(fields.gaussian);
                for (most, off) in apart.iter_mut().zip([off, of_gaussian]) {
                    *most = larger(*most, off.abs());
                }
            }
            let term = entry.unwrap_or(T::zero()) * off;
            sum += term;
            squares += term * term;
        }
        if seen == 0 {
            apart = [T::infinity(); 2];
        }
        Self {
            spread: fit.spread(model, degree) / T::constant(SPREAD[degree - 2]),
            apart,
            of_laplacian: sum.abs() + squares.sqrt() + squares.sqrt(),
            radius: fit.radius(),
            is_all: true,
        }
    }

    /// Whether the neighbours determine the fit.
    pub(super) fn is_determined(&self) -> bool {
        self.spread >= T::one()
    }

    /// This part of the largest curvature, as a limit of disagreements in H.
    pub(super) fn limit(&self, part: f64, curvature: T) -> T {
        let flat = T::constant(FLAT) * self.radius.reciprocal_or_zero();
        T::constant(part) * curvature.max(flat)
    }
}

/// The larger number; NaN if either is NaN.
pub(super) fn larger<T: Real>(a: T, b: T) -> T {
    if a.is_nan() || a >= b { a } else { b }
}

/// The largest principal curvature, without its sign.
pub(super) fn largest_curvature<T: Real>(mean: T, gaussian: T) -> T {
    mean.abs() + (mean * mean - gaussian).max(T::zero()).sqrt()
}

/// The largest ratio of the spacings in different directions at the vertices within two edges of each.
pub(super) fn aspects<T: Real>(surface: Surface<'_, T>, normals: &[Vec3<T>]) -> Vec<T> {
    let mesh = surface.mesh();
    let own = normals.iter().enumerate();
    let own = Vec::from_iter(own.map(|(vertex, &normal)| elongation(surface, normal, vertex)));
    // Tensors around a pole or a single needle cancel, those of rows do not.
    let mean = normals.iter().enumerate().map(|(vertex, &normal)| {
        let ring = mesh.one_ring(vertex);
        let sum = ring.iter().fold(own[vertex], |sum, &other| {
            from_fn(|k| sum[k] + own[other as usize][k])
        });
        let [x, y] = tangent_frame(normal);
        let part = |a: Vec3<T>, b: Vec3<T>| {
            let [xx, xy, xz, yy, yz, zz] = sum;
            dot(
                a,
                [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| dot(row, b)),
            )
        };
        let half = T::constant(0.5);
        let [off, mixed] = [half * (part(x, x) - part(y, y)), part(x, y)];
        let over = T::constant((ring.len() + 1) as f64).recip();
        (over * (off * off + mixed * mixed).sqrt()).exp()
    });
    let mut most = Vec::from_iter(mean);
    for _ in 0..2 {
        let wider = (0..most.len()).map(|vertex| {
            let ring = mesh.one_ring(vertex).iter();
            ring.fold(most[vertex], |most_of_all, &other| {
                most_of_all.max(most[other as usize])
            })
        });
        most = Vec::from_iter(wider);
    }
    most
}

/// Largest ratio of spacings that counts as such.
const LONGEST: f64 = 36.0;

/// The logarithm of the ratio of the spacings around a vertex where they are longest and shortest, times the
/// difference of the projections onto these directions; entries xx, xy, xz, yy, yz, zz.
fn elongation<T: Real>(surface: Surface<'_, T>, normal: Vec3<T>, vertex: usize) -> [T; 6] {
    let mesh = surface.mesh();
    let ring = mesh.one_ring(vertex);
    let axes = tangent_frame(normal);
    let mut sums = [T::zero(); 3];
    let mut add = |edge: Vec3<T>| {
        let [x, y] = axes.map(|axis| dot(edge, axis));
        for (sum, square) in sums.iter_mut().zip([x * x, x * y, y * y]) {
            *sum += square;
        }
    };
    let rims = match mesh.vertex_kind(vertex) {
        VertexKind::Interior => ring.len(),
        _ => ring.len().saturating_sub(1),
    };
    for (place, &other) in ring.iter().enumerate() {
        add(surface.difference(vertex as u32, other));
        if place < rims {
            add(surface.difference(other, ring[(place + 1) % ring.len()]));
        }
    }
    let [xx, xy, yy] = sums;
    let half = T::constant(0.5);
    let (middle, off) = (half * (xx + yy), half * (xx - yy));
    let apart = (off * off + xy * xy).sqrt();
    let ratio = (middle + apart) / (middle - apart).max(T::zero());
    let size = (half * ratio.ln()).min(T::constant(LONGEST).ln());
    // A symmetric tensor without trace whose larger eigenvalue is the size.
    let factor = size * apart.reciprocal_or_zero();
    let [x, y] = axes;
    let (of_squares, of_product) = (factor * off, factor * xy);
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| {
        let entry =
            of_squares * (x[i] * x[j] - y[i] * y[j]) + of_product * (x[i] * y[j] + y[i] * x[j]);
        if entry.is_finite() { entry } else { T::zero() }
    })
}

/// Reports the vertices in rows whose fits are not determined, or disagree with those of their neighbours.
/// `fitted` returns the model and the number of neighbours of a vertex, `mean` has H of the fits, or nothing if it
/// is not to be compared.
pub(crate) fn report_rows<T: Real>(
    surface: Surface<'_, T>,
    fitted: impl Fn(usize) -> Option<(Model<T>, usize)>,
    mean: &[T],
    report: &mut dyn FnMut(Finding),
) {
    let normals = normals(surface);
    let aspects = aspects(surface, &normals);
    let mut near = Neighbourhood::default();
    let mut fit = HeightFit::default();
    let mut coefficients = Vec::new();
    for vertex in 0..normals.len() {
        let Some((model, count)) =
            fitted(vertex).filter(|_| aspects[vertex] >= T::constant(DISAGREEING))
        else {
            continue;
        };
        near.nearest(surface, vertex as u32, count);
        fit.gather(surface, vertex as u32, &near.found, &model);
        let mut normal = normals[vertex];
        let finding = Finding::Rows {
            vertex: vertex as u32,
        };
        if fit.fit(&mut normal, &model) <= T::zero() {
            report(finding);
            continue;
        }
        fit.coefficients(&model, model.degree, &mut coefficients);
        let fields = Fields {
            mean,
            gaussian: &[],
        };
        let doubt = Doubt::new(
            &fit,
            &model,
            (model.degree, normal, &coefficients),
            (surface.mesh().one_ring(vertex), &near.found),
            &[],
            fields,
        );
        let [curvature, gaussian] = Slopes::new(&coefficients, fit.radius()).curvatures();
        let is_long = aspects[vertex] >= T::constant(ROWS);
        let part = REPORTED * IN_DOUBT[usize::from(is_long)];
        let large = doubt.limit(part, largest_curvature(curvature, gaussian));
        let [apart, _] = doubt.apart;
        let is_apart = !mean.is_empty() && (apart > large || apart.is_nan());
        if is_apart || is_long && !doubt.is_determined() {
            report(finding);
        }
    }
}
