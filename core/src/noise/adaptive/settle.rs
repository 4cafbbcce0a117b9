//! Final error bars and verdicts, from what the fits at neighbouring vertices say about each other.
//!
//! The error bars of a fit come from its distance to other fits, which share its neighbours. Where these lie in rows,
//! all are wrong together. The curvature that a polynomial has at the neighbours of its vertex, against that of the
//! fits there, shows the error of the fit whether it is determined or not.

use super::choice::BAR;
use super::{Cause, Estimate, Ground, Measured, Verdict};
use crate::lane::Lane;
use crate::noise::doubt::{Doubt, REPORTED, larger, largest_curvature};
use crate::noise::largest_coordinate;
use crate::real::Real;
use alloc::vec::Vec;

/// Number of vertices of a component below which nothing shows the error of a fit, because every fit has all of
/// them.
const TOLD: usize = 20;

/// Number of vertices below which all fits have most vertices of a component, and differ little from each other.
const SHARED: usize = 200;

/// Bars of H and K of vertices in rows, whose neighbours along a row have the same error, and of few vertices, in units
/// of those elsewhere: the disagreement with the neighbours, or half of theirs. On 24 of 26 meshes in rows, these were
/// enough for all vertices.
const IN_ROWS: f64 = 4.0;
const OF_FEW: f64 = 2.0;

/// Spread, in units of the least one that determines a fit, below which even the error is not known where vertices
/// do not lie in rows: on coarse meshes of narrow shapes it is below 1 at some vertices.
const UNDETERMINED: f64 = 0.3;

/// Number of neighbours whose H enters f: those of [`Jet::j6`](crate::Jet::j6).
const REACH: usize = 56;

/// Part of the disagreement with the neighbours that a bar has at least where other jets show the error.
const BY_CHANCE: f64 = 0.5;

/// Least number of neighbours of a pole, and its bars in units of those of its neighbours.
const POLE: usize = 10;
const AT_POLES: f64 = 3.0;

/// Number of estimates at a vertex.
const ESTIMATES: usize = 5;

/// Three standard deviations of a rounded coordinate, in units of the last digit, times the factors by which methods
/// amplify them in H and in f, over powers of the vertex area.
const ROUNDED: [f64; 2] = [1.0, 20.0];

/// Widens bars by the doubts about fits, and sets verdicts where bars are not known.
pub(super) fn settle<T: Real>(
    ground: &Ground<'_, T>,
    doubts: &[Option<Doubt<T>>],
    measured: &mut [Measured<T>],
) {
    let mesh = ground.surface.mesh();
    let bars = (0..measured.len()).map(|vertex| {
        let own = doubts[vertex]?;
        let around = mesh.one_ring(vertex).iter();
        let around = || around.clone().filter_map(|&other| doubts[other as usize]);
        let [_, in_rows] = ground.is_elongated(vertex);
        let times = T::constant(match (in_rows, mesh.vertex_count() < SHARED) {
            (true, _) => IN_ROWS,
            (false, true) => OF_FEW,
            (false, false) => 1.0,
        });
        let [mean, gaussian] = [0, 1].map(|which| {
            let own = own.apart[which];
            let most = around().fold(T::zero(), |most, doubt| larger(most, doubt.apart[which]));
            larger(times * own, T::constant(0.5) * times * most)
        });
        let at = &measured[vertex];
        let of_laplacian = around().fold(own.of_laplacian, |most, doubt| {
            larger(most, doubt.of_laplacian)
        });
        let two = T::constant(2.0);
        let by_mean = T::constant(6.0) * at.mean.value * at.mean.value - two * at.gaussian.value;
        let force = larger(two * of_laplacian, two * by_mean.abs() * mean);
        Some([mean, gaussian, force])
    });
    let bars = Vec::from_iter(bars);
    let last_digit = T::epsilon() * largest_coordinate(ground.surface.positions());
    let is_marked = |at: &Measured<T>| at.cause.is_some();
    let marked = Vec::from_iter(measured.iter().map(is_marked));
    let reach = |vertex: usize| ground.pool(vertex, REACH).any(|other| marked[other]);
    for (vertex, (at, bars)) in measured.iter_mut().zip(bars).enumerate() {
        let is_known = at.mean.value.is_finite();
        if let Some(doubt) = doubts[vertex].filter(|_| is_known) {
            judge(ground, vertex, &doubt, bars, at);
        }
        for estimate in at.estimates_mut() {
            if estimate.value.is_finite() && estimate.error.is_nan() {
                estimate.error = T::infinity();
            }
        }
        add_rounding(last_digit, at);
        if is_known && ground.is_on_grid {
            at.cause = at.cause.or(Some(Cause::Grid));
        }
        if is_known && mesh.vertex_count() < TOLD {
            at.cause = Some(Cause::SmallComponent);
            at.leave(Verdict::Unknown);
        } else if is_known
            && at
                .cause
                .is_some_and(|cause| !matches!(cause, Cause::Rows | Cause::Grid))
        {
            at.leave(Verdict::Unresolved);
        } else if is_known && !ground.marks.is_empty() && reach(vertex) {
            at.force_density.error = T::infinity();
            at.verdict = Verdict::Unresolved;
        }
    }
    settle_poles(ground, measured);
    for at in measured {
        let is_unknown = at
            .estimates_mut()
            .iter()
            .any(|estimate| estimate.value.is_finite() && estimate.error == T::infinity());
        if is_unknown && at.verdict == Verdict::Clean {
            at.verdict = Verdict::Unknown;
        }
    }
}

/// Widens the bars at poles. The nearest neighbours of a pole lie on circles, by whose symmetry its fit agrees with theirs
/// and with other fits: it had up to 2.5 times their errors.
fn settle_poles<T: Real>(ground: &Ground<'_, T>, measured: &mut [Measured<T>]) {
    let mesh = ground.surface.mesh();
    let poles = (0..measured.len()).filter(|&vertex| mesh.one_ring(vertex).len() >= POLE);
    let bars = poles.map(|pole| {
        let mut most = [T::zero(); ESTIMATES];
        for &other in mesh.one_ring(pole) {
            let others = measured[other as usize].estimates();
            for (most, other) in most.iter_mut().zip(others) {
                // Also false for NaN, where there is no value.
                if other.error > *most {
                    *most = other.error;
                }
            }
        }
        (pole, most)
    });
    for (pole, bars) in Vec::from_iter(bars) {
        for (estimate, bar) in measured[pole].estimates_mut().into_iter().zip(bars) {
            estimate.widen(T::constant(AT_POLES) * bar);
        }
    }
}

/// Whether a number is larger than a limit, or unknown.
fn exceeds<T: Real>(number: T, limit: T) -> bool {
    number > limit || number.is_nan()
}

/// Widens the bars at a vertex, and changes its verdict where the fit is not determined.
fn judge<T: Real>(
    ground: &Ground<'_, T>,
    vertex: usize,
    doubt: &Doubt<T>,
    bars: Option<[T; 3]>,
    at: &mut Measured<T>,
) {
    let [is_elongated, in_rows] = ground.is_elongated(vertex);
    let least = T::constant(if is_elongated { 1.0 } else { UNDETERMINED });
    if exceeds(least, doubt.spread) {
        at.cause = at.cause.or(in_rows.then_some(Cause::Rows));
        at.leave(Verdict::Unknown);
        return;
    }
    // The residual of a shape that is not resolved says nothing about the noise.
    let is_few = ground.normals.len() < SHARED;
    if at.verdict == Verdict::Unresolved && !is_few {
        at.leave(Verdict::Unresolved);
        return;
    }
    // With noise, distances between fits over ever more neighbours say more.
    let bars = bars.filter(|_| at.deviation == T::zero());
    let Some([mean, gaussian, force]) = bars else {
        return;
    };
    let curvature = largest_curvature(at.mean.value, at.gaussian.value);
    if in_rows && exceeds(mean, doubt.limit(IN_ROWS * REPORTED, curvature)) {
        if at.verdict == Verdict::Clean {
            at.verdict = Verdict::Unresolved;
        }
        at.cause = at.cause.or(Some(Cause::Rows));
    }
    // Elsewhere, distances from other jets show the error, except by chance.
    let is_shown = !(is_elongated || is_few || doubt.is_all);
    let part = T::constant(if is_shown { BY_CHANCE } else { 1.0 });
    let [mean, gaussian] = [mean, gaussian].map(|bar| part * bar);
    at.mean.widen(mean);
    at.gaussian.widen(gaussian);
    if !is_shown {
        at.force_density.widen(force);
    }
    for principal in &mut at.principal {
        principal.widen(mean);
    }
}

/// Adds the error of positions that are rounded to the number type, with this last digit.
fn add_rounding<T: Real>(last_digit: T, at: &mut Measured<T>) {
    let over = at.area.reciprocal_or_zero();
    let [once, twice] = ROUNDED.map(|factor| T::constant(factor) * last_digit);
    let mean = once * over;
    let curvature = largest_curvature(at.mean.value, at.gaussian.value);
    let two = T::constant(2.0);
    at.mean.widen(mean);
    at.gaussian.widen(mean * (two * curvature + mean));
    at.force_density.widen(twice * over * over);
    for principal in &mut at.principal {
        principal.widen(two * mean);
    }
}

impl<T: Real> Estimate<T> {
    /// Makes the bar at least this wide, also where it was unknown.
    fn widen(&mut self, bar: T) {
        if self.value.is_finite() && (self.error.is_nan() || exceeds(bar, self.error)) {
            self.error = if bar.is_nan() { T::infinity() } else { bar };
        }
        let least = bar / T::constant(BAR);
        if self.value.is_finite() && (self.expected.is_nan() || exceeds(least, self.expected)) {
            self.expected = if bar.is_nan() { self.error } else { least };
        }
    }
}

impl<T: Real> Measured<T> {
    fn estimates(&self) -> [&Estimate<T>; ESTIMATES] {
        let [larger, smaller] = &self.principal;
        [
            &self.mean,
            &self.gaussian,
            &self.force_density,
            larger,
            smaller,
        ]
    }

    fn estimates_mut(&mut self) -> [&mut Estimate<T>; ESTIMATES] {
        let [larger, smaller] = &mut self.principal;
        [
            &mut self.mean,
            &mut self.gaussian,
            &mut self.force_density,
            larger,
            smaller,
        ]
    }

    /// Leaves values without bars.
    fn leave(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        for estimate in self.estimates_mut() {
            if estimate.value.is_finite() {
                estimate.error = T::infinity();
                if verdict == Verdict::Unknown {
                    estimate.expected = T::infinity();
                }
            }
        }
        if verdict == Verdict::Unknown {
            (self.directions, self.extremalities) = (None, None);
        }
    }
}
