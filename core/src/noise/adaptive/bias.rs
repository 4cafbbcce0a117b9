//! The bias of candidates, from the distances between them as far as noise does not explain these.

use super::{Deviations, Ground, LOCAL, QUANTITIES, REPLICAS, Values};
use crate::element::Execution;
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;

/// Numbers of nearest vertices over which squared distances are averaged: for the bias, and for error bars.
const WIDE: usize = 100;
const NARROW: usize = 32;

/// Number of nearest vertices over which the effect of noise is averaged.
const NOISE_POOL: usize = 32;

/// Squared bias that may stay undetected, and squared distance above which a local bias is significant,
/// both in units of the variance of the distance.
const UNSEEN: f64 = 0.1;
const SIGNIFICANT: f64 = 4.0;

/// Confidence level, in standard deviations, of the lower and the upper bound of the bias over the whole mesh.
const CERTAIN: f64 = 2.0;

/// Number of standard deviations by which the product of two distances has to exceed the effect of noise
/// before their biases count as related. It is larger than [`CERTAIN`], because signs do not show the part
/// of the scatter that is due to the sizes of the errors.
const RELATED: f64 = 2.5;

/// Least ratio of the bias of degree 4 to its distance from degree 6, where their biases are opposite.
const OPPOSITE: f64 = 0.6;

/// Squares of the bias, from squared distances averaged over different pools.
#[derive(Clone, Default)]
pub(super) struct Bias<T> {
    pub(super) wide: Vec<T>,
    pub(super) narrow: Vec<T>,
    /// Detected bias².
    pub(super) seen: Vec<T>,
    /// Lower bound.
    pub(super) local: Vec<T>,
    /// Fraction of `seen` that is real, over the whole mesh.
    pub(super) trust: Trust<T>,
}

/// The fraction of the local excesses of squared distances over the variance that is bias, while the
/// rest is noise that exceeds its variance by chance. Local excesses are cut off at 0, and therefore add
/// up to more than the excess of the mesh as a whole.
#[derive(Clone, Copy, Default)]
pub(super) struct Trust<T> {
    /// The expected fraction: the excess of the mesh as a whole, reduced as far as it may be due to chance
    /// or to the uncertainty of the variance.
    pub(super) likely: T,
    /// The fraction after [`CERTAIN`] standard deviations of the excess by noise alone are subtracted, and
    /// after they are added.
    pub(super) certain: T,
    pub(super) possible: T,
}

/// Two estimates of one quantity, and the changes of each by the replicas.
pub(super) struct FitPair<'a, T> {
    pub(super) values: [&'a [T]; 2],
    pub(super) changes: [&'a [Values<T>]; 2],
}

impl<T: Real> FitPair<'_, T> {
    pub(super) fn difference(&self, vertex: usize) -> T {
        self.values[0][vertex] - self.values[1][vertex]
    }

    pub(super) fn change(&self, vertex: usize, replica: usize) -> T {
        self.changes[0][vertex][replica] - self.changes[1][vertex][replica]
    }
}

/// The sum over the mesh of products of two differences, in units of a variance, less the effect of noise;
/// and the standard deviation of this effect.
struct Excess<T> {
    sum: T,
    scatter: T,
    /// Number of vertices.
    count: T,
}

impl<T: Real> Excess<T> {
    /// Compares the sum over the vertices where `is_telling` with those of the replicas, each of which has
    /// the effect of noise alone. `None` if there are fewer than [`WIDE`] such vertices.
    fn new(
        deviations: &Deviations<T>,
        variances: &[T],
        [first, second]: [&FitPair<'_, T>; 2],
        is_telling: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let (mut found, mut count) = (T::zero(), 0_u32);
        let mut by_noise = [T::zero(); REPLICAS];
        for (vertex, &variance) in variances.iter().enumerate() {
            let product = first.difference(vertex) * second.difference(vertex) / variance;
            if !(product.is_finite() && is_telling(vertex)) {
                continue;
            }
            count += 1;
            found += product;
            let over = deviations.variances[vertex] / variance;
            for (replica, sum) in by_noise.iter_mut().enumerate() {
                *sum += over * first.change(vertex, replica) * second.change(vertex, replica);
            }
        }
        if (count as usize) < WIDE {
            return None;
        }
        let over = T::constant(1.0 / REPLICAS as f64);
        let mean = over * by_noise.iter().copied().sum::<T>();
        let squares = by_noise.iter().map(|&sum| (sum - mean) * (sum - mean));
        Some(Self {
            sum: found - mean,
            scatter: (squares.sum::<T>() / T::constant(REPLICAS as f64 - 1.0)).sqrt(),
            count: T::constant(f64::from(count)),
        })
    }
}

/// The bias of degree 6 in units of the distance d of degree 4 from it, as far as the distance of degree 6
/// from the next smaller fit is proportional to d: positive if both degrees lose the same waves of the shape,
/// negative if their errors are opposite, so that d is larger than either. 0 if noise hides it. `None` if too
/// few vertices tell.
pub(super) fn related<T: Real>(
    deviations: &Deviations<T>,
    variances: &[T],
    [degrees, scales]: [&FitPair<'_, T>; 2],
    is_telling: impl Fn(usize) -> bool,
) -> Option<T> {
    let both = Excess::new(deviations, variances, [degrees, scales], &is_telling)?;
    let own = Excess::new(deviations, variances, [degrees, degrees], &is_telling)?;
    let is_seen = both.sum.abs() > T::constant(RELATED) * both.scatter && own.sum > T::zero();
    let least = T::constant(OPPOSITE - 1.0);
    Some(if is_seen {
        (both.sum / own.sum).max(least)
    } else {
        T::zero()
    })
}

/// Squared distances between two estimates of one quantity, both at single vertices and averaged over
/// pools, and the variance of the distances.
pub(super) struct Distances<T> {
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
        pair: &FitPair<'_, T>,
    ) -> Self {
        let square = |difference: T| difference * difference;
        let vertices = 0..deviations.variances.len();
        let squares = vertices.map(|vertex| square(pair.difference(vertex)));
        let squares = Vec::from_iter(squares);
        let pooled = |count: usize| ground.means(execution, &squares, count);
        Self {
            wide: pooled(WIDE),
            narrow: pooled(NARROW),
            local: pooled(LOCAL),
            variance: variance(execution, ground, deviations, |vertex| {
                let changes = (0..REPLICAS).map(|replica| pair.change(vertex, replica));
                changes.map(square).sum()
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
            possible: T::one(),
        }
    }

    /// The excess over the vertices where `is_telling`, as a fraction of the local excesses. `None` if there
    /// are fewer than [`WIDE`] such vertices.
    fn new(
        deviations: &Deviations<T>,
        distances: &Distances<T>,
        pair: &FitPair<'_, T>,
        is_telling: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let variances = &distances.variance;
        let Excess {
            sum,
            scatter,
            count,
        } = Excess::new(deviations, variances, [pair, pair], &is_telling)?;
        let local = variances.iter().zip(&distances.wide).enumerate();
        let local = local.filter(|&(vertex, _)| is_telling(vertex));
        let local = local.map(|(_, (&variance, &wide))| positive(wide - variance) / variance);
        let cut_off: T = local.filter(|excess| excess.is_finite()).sum();
        let part = |excess: T| positive(excess / cut_off).min(T::one());
        // W. James and C. Stein's estimate of the square of an uncertain value (Proc. 4th Berkeley Symp. 1
        // (1961) 361): its own uncertainty is subtracted.
        let unknown = T::constant(UNSEEN) * count;
        let chance = scatter * scatter + unknown * unknown;
        let certain = T::constant(CERTAIN) * scatter;
        Some(Self {
            likely: part(sum - chance / positive(sum)),
            certain: part(sum - certain),
            possible: part(sum + certain),
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
    if !deviations.is_seen() {
        return vec![T::zero(); deviations.variances.len()];
    }
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
        pair: &FitPair<'_, T>,
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
            trust: Trust::new(deviations, distances, pair, |vertex| {
                factor(vertex).is_some()
            })
            .unwrap_or(other.trust),
        }
    }
}
