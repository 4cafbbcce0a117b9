//! Doubts about fits: whether their neighbours determine them, and how far fits at neighbouring vertices
//! disagree.
//!
//! If vertices lie in rows (on meshes by longitude and latitude, tubes, stacks of sections, swept
//! surfaces), the nearest neighbours of a vertex may lie on one to three rows, along which a polynomial in
//! two variables is not determined. Two signs show this without knowledge of the surface: a column of the
//! fit is nearly dependent on those before it, relative to its length for evenly spread neighbours; and the
//! curvature of the polynomial at the neighbours is not that of the fits there.

use super::fit::{HeightFit, Model};
use super::normals;
use crate::diagnostic::Finding;
use crate::fit::{Graph, spacing};
use crate::lane::Lane;
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, tangent_frame};
use alloc::vec::Vec;

/// Least spread of neighbours that determine a fit of degree 2 to 8: see [`HeightFit::spread`].
const SPREAD: [f64; 7] = [0.1, 0.08, 0.06, 0.05, 0.03, 0.03, 0.015];

/// Ratios of the spacings of vertices across and along rows: from [`ELONGATED`] on, all fits share their errors; from
/// [`DISAGREEING`] on, fits that disagree are reported; from [`ROWS`] on, vertices count as rows. On discocytes, ratios
/// are up to 2.1 on even meshes, and up to 2.8 where vertices are random; on isosurfaces up to 2.0.
pub(super) const ELONGATED: f64 = 1.9;
const DISAGREEING: f64 = 2.2;
pub(super) const ROWS: f64 = 2.9;

/// Fraction of the curvature above which a disagreement in H is reported.
pub(super) const REPORTED: f64 = 0.05;

/// Factors of this fraction without and with rows: coarse and noisy meshes without rows have larger disagreements.
const IN_DOUBT: [f64; 2] = [2.0, 1.0];

/// Curvature, in inverse radii of a fit, below which a surface counts as flat.
const FLAT: f64 = 1e-3;

/// Comparison of a fit with the fits around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt<T> {
    /// [`HeightFit::spread`], divided by the least value with which neighbours determine the fit.
    pub(super) spread: T,
    /// The largest differences in H and in K, over the one-ring, between this polynomial at a vertex and the
    /// vertex's own fit; infinite if no vertex of the one-ring is among the neighbours of this fit.
    pub(super) apart: [T; 2],
    /// The effect of differences in H on Δ_S H: the absolute value of its sum over the neighbours, if the sum is
    /// known, plus twice the root of the sum of its squared terms.
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
    /// The doubt about the last fit over the plane of `normal`, from its coefficients up to `degree`. `neighbours`
    /// are those of the fit, in its order; `laplacian` is its row of Δ_S, or empty.
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

    /// The fraction `part` of the largest curvature, as a limit of disagreements in H.
    pub(super) fn limit(&self, part: f64, curvature: T) -> T {
        let flat = T::constant(FLAT) * self.radius.reciprocal_or_zero();
        T::constant(part) * curvature.max(flat)
    }
}

/// The larger number; NaN if either is NaN.
pub(super) fn larger<T: Real>(a: T, b: T) -> T {
    if a.is_nan() || a >= b { a } else { b }
}

/// The largest absolute value of the principal curvatures.
pub(super) fn largest_curvature<T: Real>(mean: T, gaussian: T) -> T {
    mean.abs() + (mean * mean - gaussian).max(T::zero()).sqrt()
}

/// The largest ratio of the spacings across and along rows within two edges of each vertex.
pub(super) fn aspects<T: Real>(surface: Surface<'_, T>, normals: &[Vec3<T>]) -> Vec<T> {
    let own = (0..normals.len()).map(|vertex| spacing(surface, normals, vertex).aspect);
    let mut most = Vec::from_iter(own);
    for _ in 0..2 {
        let wider = (0..most.len()).map(|vertex| {
            let ring = surface.mesh().one_ring(vertex).iter();
            ring.fold(most[vertex], |most_of_all, &other| {
                most_of_all.max(most[other as usize])
            })
        });
        most = Vec::from_iter(wider);
    }
    most
}

/// Reports the vertices in rows whose fits are not determined, or disagree with those of their neighbours.
/// `fitted` returns the model and the number of neighbours of a vertex. `mean` has H of the fits; if it is empty, H
/// is not compared.
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
        let [curvature, gaussian] =
            Graph::in_radii(&coefficients, fit.radius().recip()).curvatures();
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
