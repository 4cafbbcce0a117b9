//! The bias of candidates, from the distances between them as far as noise does not explain these.

use super::{Deviations, Ground, QUANTITIES, REPLICAS, Values};
use crate::element::Execution;
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;

/// Numbers of nearest vertices over which squared distances are averaged: for the bias, for error bars,
/// and for places where the bias is larger than in their surroundings.
const WIDE: usize = 100;
const NARROW: usize = 32;
pub(super) const LOCAL: usize = 12;

/// Number of nearest vertices over which the effect of noise is averaged.
const NOISE_POOL: usize = 32;

/// Squared bias that may stay undetected, and squared distance above which a local bias is significant,
/// both in units of the variance of the distance.
const UNSEEN: f64 = 0.1;
const SIGNIFICANT: f64 = 4.0;

/// Number of standard deviations by which the distances over the whole mesh have to exceed the effect of
/// noise before a bias of degree 6 is added to that of degree 4.
const CERTAIN: f64 = 2.0;

/// Squares of the bias, from squared distances averaged over different pools.
#[derive(Clone, Default)]
pub(super) struct Bias<T> {
    pub(super) wide: Vec<T>,
    pub(super) narrow: Vec<T>,
    /// Squares without the part that may stay undetected.
    pub(super) seen: Vec<T>,
    /// Lower bound.
    pub(super) local: Vec<T>,
    /// The part of `seen` that is bias, over the whole mesh.
    pub(super) trust: Trust<T>,
}

/// The fraction of the local excesses of squared distances over the variance that is bias, while the
/// rest is noise that exceeds its variance by chance. Local excesses are cut off at 0, and therefore add
/// up to more than the excess of the mesh as a whole.
#[derive(Clone, Copy, Default)]
pub(super) struct Trust<T> {
    /// The most likely fraction.
    pub(super) likely: T,
    /// The fraction after [`CERTAIN`] standard deviations of the excess by noise alone are subtracted.
    pub(super) certain: T,
}

/// Squared distances between two estimates of one quantity, both at single vertices and averaged over
/// pools, and the variance of the distances.
pub(super) struct Distances<T> {
    squares: Vec<T>,
    pub(super) wide: Vec<T>,
    pub(super) narrow: Vec<T>,
    pub(super) local: Vec<T>,
    pub(super) variance: Vec<T>,
}

impl<T: Real> Distances<T> {
    pub(super) fn new(
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &Deviations<T>,
        [values, others]: [&[T]; 2],
        [changes, other_changes]: [&[Values<T>]; 2],
    ) -> Self {
        let squares = values.iter().zip(others).map(|(&a, &b)| (a - b) * (a - b));
        let squares = Vec::from_iter(squares);
        let pooled = |count: usize| ground.means(execution, &squares, count);
        Self {
            wide: pooled(WIDE),
            narrow: pooled(NARROW),
            local: pooled(LOCAL),
            squares,
            variance: variance(execution, ground, deviations, |vertex| {
                let both = changes[vertex].iter().zip(&other_changes[vertex]);
                both.map(|(&a, &b)| (a - b) * (a - b)).sum()
            }),
        }
    }
}

impl<T: Real> Trust<T> {
    /// Full trust, for distances without noise.
    fn full() -> Self {
        Self {
            likely: T::one(),
            certain: T::one(),
        }
    }

    /// Compares, over the vertices where `is_telling`, the sum of squared distances in units of their
    /// variance with that of the replicas, each of which has the effect of noise alone. `None` if there
    /// are fewer than [`WIDE`] such vertices.
    fn new(
        deviations: &Deviations<T>,
        distances: &Distances<T>,
        [changes, other_changes]: [&[Values<T>]; 2],
        is_telling: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let (mut found, mut cut_off, mut count) = (T::zero(), T::zero(), 0_u32);
        let mut by_noise = [T::zero(); REPLICAS];
        for (vertex, &variance) in distances.variance.iter().enumerate() {
            let square = distances.squares[vertex] / variance;
            if !(square.is_finite() && is_telling(vertex)) {
                continue;
            }
            count += 1;
            found += square;
            cut_off += positive(distances.wide[vertex] - variance) / variance;
            let both = changes[vertex].iter().zip(&other_changes[vertex]);
            for (sum, (&a, &b)) in by_noise.iter_mut().zip(both) {
                *sum += deviations.variances[vertex] * (a - b) * (a - b) / variance;
            }
        }
        if (count as usize) < WIDE {
            return None;
        }
        let over = T::constant(1.0 / REPLICAS as f64);
        let mean = over * by_noise.iter().copied().sum::<T>();
        let squares = by_noise.iter().map(|&sum| (sum - mean) * (sum - mean));
        let scatter = (squares.sum::<T>() / T::constant(REPLICAS as f64 - 1.0)).sqrt();
        let part = |excess: T| positive(excess / cut_off).min(T::one());
        Some(Self {
            likely: part(found - mean),
            certain: part(found - mean - T::constant(CERTAIN) * scatter),
        })
    }
}

/// The variance due to noise, from the sums of squares over the replicas.
fn variance<T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    deviations: &Deviations<T>,
    sum: impl Fn(usize) -> T,
) -> Vec<T> {
    let over = T::constant(1.0 / REPLICAS as f64);
    let squares = (0..deviations.variances.len()).map(|vertex| over * sum(vertex));
    let mut means = ground.means(execution, &Vec::from_iter(squares), NOISE_POOL);
    for (mean, &variance) in means.iter_mut().zip(&deviations.variances) {
        *mean *= variance;
    }
    means
}

/// The value if it is positive; otherwise 0, also for NaN.
pub(super) fn positive<T: Real>(value: T) -> T {
    if value > T::zero() { value } else { T::zero() }
}

pub(super) fn variances<T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    deviations: &Deviations<T>,
    changes: &[Vec<Values<T>>; QUANTITIES],
) -> [Vec<T>; QUANTITIES] {
    from_fn(|quantity| {
        variance(execution, ground, deviations, |vertex| {
            let changes = changes[quantity][vertex].iter();
            changes.map(|&change| change * change).sum()
        })
    })
}

impl<T: Real> Bias<T> {
    /// No bias at any of `count` vertices.
    pub(super) fn none(count: usize) -> Self {
        let none = vec![T::zero(); count];
        Self {
            wide: none.clone(),
            narrow: none.clone(),
            seen: none.clone(),
            local: none,
            trust: Trust::full(),
        }
    }

    /// The bias from squared distances, times the square of a factor at each vertex; where the factor is
    /// `None`, the bias of another candidate is taken over.
    pub(super) fn new(
        deviations: &Deviations<T>,
        distances: &Distances<T>,
        changes: [&[Values<T>]; 2],
        factor: impl Fn(usize) -> Option<T>,
        other: &Self,
    ) -> Self {
        let unseen = T::constant(UNSEEN);
        let of = |means: &[T], inherited: &[T], formula: &dyn Fn(T, T) -> T| {
            let all = means.iter().zip(&distances.variance).enumerate();
            let all = all.map(|(vertex, (&mean, &variance))| match factor(vertex) {
                Some(factor) => factor * factor * formula(mean, variance),
                None => inherited[vertex],
            });
            all.collect()
        };
        let beyond = |mean: T, variance: T| positive(mean - variance) + unseen * variance;
        let seen = |mean: T, variance: T| positive(mean - variance);
        let significant =
            |mean: T, variance: T| positive(mean - T::constant(SIGNIFICANT) * variance);
        Self {
            wide: of(&distances.wide, &other.wide, &beyond),
            narrow: of(&distances.narrow, &other.narrow, &beyond),
            seen: of(&distances.wide, &other.seen, &seen),
            local: of(&distances.local, &other.local, &significant),
            trust: Trust::new(deviations, distances, changes, |vertex| {
                factor(vertex).is_some()
            })
            .unwrap_or(other.trust),
        }
    }
}
