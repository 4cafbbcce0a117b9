//! Normals, principal directions and gradients of curvature, from the fits that were chosen for H.

use super::kind::FitKind;
use super::level::LevelScratch;
use super::{Cause, Ground, Measured, ONE_STAGE};
use crate::element::Execution;
use crate::fit::Graph;
use crate::noise::doubt::{Doubt, Fields};
use crate::noise::fit::Model;
use crate::noise::sharp::Mark;
use crate::real::Real;
use crate::vec3::{Vec3, add, dot, scale, tangent_frame};
use alloc::vec;
use alloc::vec::Vec;

/// Largest standard deviation of a direction, in radians: above it, the vertex counts as umbilic.
const CERTAIN: f64 = 0.2;

/// Rounding errors of H² − K, in units of the last digit of the squares of the curvatures.
const ROUNDING: f64 = 4.0;

/// The fit that was chosen for H at a vertex.
pub(super) struct Fitted<'a, T> {
    pub(super) kind: FitKind<T>,
    pub(super) degree: usize,
    /// H and K of this fit at every vertex.
    pub(super) fields: [&'a [T]; 2],
    /// Square of the bias of H.
    pub(super) bias: T,
    /// The jet of the library, if it is one.
    pub(super) jet: Option<OfJet<T>>,
    /// The doubt about it, if it is known.
    pub(super) doubt: Option<Doubt<T>>,
}

/// A jet of the library.
pub(super) struct OfJet<T> {
    pub(super) model: Model<T>,
    pub(super) neighbours: usize,
    /// The gradients of H and K.
    pub(super) gradients: [Vec3<T>; 2],
    /// The principal directions, if any.
    pub(super) directions: Option<[Vec3<T>; 2]>,
}

/// Sets normals, principal curvatures, directions and gradients. `fitted` returns the fit chosen for H. Returns
/// the doubts about the fits, except for one-sided ones.
pub(super) fn set<'f, T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    fitted: impl Fn(usize) -> Option<Fitted<'f, T>> + Sync,
    measured: &mut [Measured<T>],
) -> Vec<Option<Doubt<T>>> {
    // The curvatures of all vertices are needed while other results are set.
    let values = |of: fn(&Measured<T>) -> T| Vec::from_iter(measured.iter().map(of));
    let mean = values(|at| at.mean.value);
    let gaussian = values(|at| at.gaussian.value);
    let fields = Fields {
        mean: &mean,
        gaussian: &gaussian,
    };
    let mut doubts = vec![None; measured.len()];
    let mut scratch: Vec<(LevelScratch<T>, [Vec<T>; 4])> = Vec::new();
    let slots = (measured, &mut doubts[..]);
    execution.map_with(
        &mut scratch,
        slots,
        |(scratch, rows), vertex, (at, doubt)| {
            let mark = ground.mark(vertex, &[]);
            at.cause = mark.map(|mark| cause_of(mark, true));
            let Some(fitted) = fitted(vertex) else {
                return;
            };
            *doubt = fitted.doubt;
            let count = match &fitted.jet {
                Some(jet) if at.deviation == T::zero() => {
                    if !ground.marks.is_empty() {
                        scratch
                            .near
                            .nearest(ground.surface, vertex as u32, jet.neighbours);
                        at.mark_by(ground.mark(vertex, &scratch.near.found));
                    }
                    let [of_mean, of_gaussian] = jet.gradients;
                    at.gradient_of_mean = of_mean;
                    if at.has_certain_directions(fitted.bias) {
                        at.directions = jet.directions;
                        at.extremalities = extremalities(at, of_gaussian);
                    }
                    return;
                }
                Some(jet) => scratch.fit_nearest(ground, vertex, &jet.model, jet.neighbours),
                None => scratch.fit(ground, vertex, &fitted.kind),
            };
            let model = fitted
                .jet
                .as_ref()
                .map_or(fitted.kind.model, |jet| jet.model);
            if count == 0 {
                return;
            }
            at.mark_by(ground.mark(vertex, scratch.neighbours(count)));
            let (graph, axes) = scratch.graph(&model, fitted.degree);
            let frame = graph.principal(axes);
            let radius = scratch.fit.radius();
            let mut shear = [T::zero(); 6];
            let two = T::constant(2.0);
            let over = (radius * radius).recip();
            for ((entry, &factor), times) in
                shear[3..]
                    .iter_mut()
                    .zip(&frame.by_second)
                    .zip([two, T::one(), two])
            {
                *entry = times * factor * over;
            }
            let mut along = [[T::zero(); 6]; 2];
            (along[0][1], along[1][2]) = (radius.recip(), radius.recip());
            let functionals = [shear, along[0], along[1], graph.laplacian_in_radii(radius)];
            scratch.fit.rows(&model, fitted.degree, &functionals, rows);
            let [shear, along_x, along_y, laplacian] = &*rows;
            if doubt.is_none() && ground.rings[vertex] >= ONE_STAGE {
                let of = (&model, fitted.degree, count);
                *doubt = Some(scratch.doubt(ground, vertex, of, laplacian, fields));
            }
            let vectors = graph.gradient(axes);
            let own = usize::from(!model.interpolates);
            // Vertices with jets have been set already.
            if own == 1 {
                at.normal = graph.normal(axes);
            }
            let neighbours = scratch.neighbours(count);
            let gradient = |field: &[T]| {
                let here = field[vertex];
                let mut derivatives = [T::zero(); 2];
                for (row, &(_, other)) in neighbours.iter().enumerate() {
                    let difference = field[other as usize] - here;
                    derivatives[0] += along_x[row + own] * difference;
                    derivatives[1] += along_y[row + own] * difference;
                }
                add(
                    scale(derivatives[0], vectors[0]),
                    scale(derivatives[1], vectors[1]),
                )
            };
            let [of_mean, of_gaussian] = fitted.fields.map(gradient);
            at.gradient_of_mean = of_mean;
            // Every height has noise; in interpolating fits the error at the vertex enters all differences.
            let mut squares: T = shear.iter().map(|&entry| entry * entry).sum();
            if own == 0 {
                let sum: T = shear.iter().copied().sum();
                squares += sum * sum;
            }
            let of_noise = at.deviation * at.deviation * squares;
            if at.has_certain_directions(fitted.bias + of_noise) {
                at.directions = Some(frame.directions);
                at.extremalities = extremalities(at, of_gaussian);
            }
        },
    );
    doubts
}

/// The cause of a verdict by a mark of the vertex itself, or of one of the others in its fit.
fn cause_of(mark: Mark, is_own: bool) -> Cause {
    match (mark, is_own) {
        (Mark::Crease, true) => Cause::Crease,
        (Mark::Crease, false) => Cause::BesideCrease,
        (Mark::Outlier, true) => Cause::Outlier,
        (Mark::Outlier, false) => Cause::BesideOutlier,
    }
}

impl<T: Real> Measured<T> {
    /// Takes a mark in the neighbourhood of the fit for the cause.
    fn mark_by(&mut self, mark: Option<Mark>) {
        self.cause = self.cause.or(mark.map(|mark| cause_of(mark, false)));
    }

    /// Whether principal directions are certain, given the variance of the off-diagonal entry of the shape operator.
    fn has_certain_directions(&self, variance: T) -> bool {
        let [larger, smaller] = self.principal.map(|curvature| curvature.value);
        // The gap is the root of a difference, H² − K, that is rounded.
        let rounding = T::constant(ROUNDING) * T::epsilon();
        let rounding = rounding * (larger * larger + smaller * smaller);
        let deviation = (variance + rounding).sqrt() / (larger - smaller);
        // Also false for NaN.
        deviation <= T::constant(CERTAIN)
    }
}

/// The derivatives of both principal curvatures along their own directions.
fn extremalities<T: Real>(at: &Measured<T>, gradient_of_gaussian: Vec3<T>) -> Option<[T; 2]> {
    let [first, second] = at.directions?;
    let [larger, smaller] = at.principal.map(|curvature| curvature.value);
    let gap = larger - smaller;
    let two = T::constant(2.0);
    // k = H ± √(H² − K), and the root is half of the gap.
    let along = |curvature: T, sign: T, direction: Vec3<T>| {
        let of_mean = dot(at.gradient_of_mean, direction);
        let of_gaussian = dot(gradient_of_gaussian, direction);
        sign * (two * curvature * of_mean - of_gaussian) / gap
    };
    Some([
        along(larger, T::one(), first),
        along(smaller, -T::one(), second),
    ])
}

impl<T: Real> LevelScratch<T> {
    /// The graph of the last fit, and its axes along x, y and the height.
    fn graph(&mut self, model: &Model<T>, degree: usize) -> (Graph<T>, [Vec3<T>; 3]) {
        let own = usize::from(!model.interpolates);
        let over = self.fit.radius().recip();
        self.fit.coefficients(model, degree, &mut self.coefficients);
        let [x, y] = tangent_frame(self.normal);
        let graph = Graph::in_radii(&self.coefficients[own..], over);
        (graph, [x, y, self.normal])
    }
}
