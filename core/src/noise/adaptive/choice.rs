//! The candidates, their estimated errors, and the choice among them at every vertex.

use super::level::{DEGREES, Kind, Level};
use super::principal::{self, Fitted, JETS};
use super::{
    Deviations, Estimate, Estimates, Ground, Measured, QUANTITIES, Scale, Values, Verdict,
};
use crate::curvature::Curvature;
use crate::element::Execution;
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;

/// Nearest vertices over which squared distances are averaged: for the bias, for error bars, and for
/// places where the bias is larger than around them.
const WIDE: usize = 100;
const NARROW: usize = 32;
const LOCAL: usize = 12;

/// Nearest vertices over which the effect of noise is averaged.
const NOISE_POOL: usize = 32;

/// Bias that may remain undetected, as a part of the variance of a distance; and the multiple of this
/// variance that a local bias has to exceed.
const UNSEEN: f64 = 0.1;
const SIGNIFICANT: f64 = 4.0;

/// Least growth of a neighbourhood with which the distance of two fits measures the bias of the larger
/// one.
const TELLING: f64 = 1.17;

/// Orders with which the bias of H, K and f grows with the number of neighbours: half of the orders in
/// the radius.
const ORDERS: [i32; QUANTITIES] = [3, 3, 2];

/// Ratio of the bias of the first regression jet to its distance from the jet, and of the bias of
/// degree 4 to its distance from degree 6.
const FROM_JET: f64 = 1.5;
const FROM_SIXTH: f64 = 1.2;

/// Bars in estimated standard errors: with noise, and without, where the bias of one fit is known from
/// that of another with which it shares part of its error; and how much larger they are at boundaries.
const BAR: f64 = 2.0;
const CLEAN_BAR: f64 = 3.0;
const ONE_SIDED: f64 = 4.0;

/// Error bars of k₁ and k₂ as a multiple of those of H.
const PRINCIPAL: f64 = 1.75;

/// One kind of fit.
pub(super) struct Candidate<T> {
    kind: Kind<T>,
    degree: Vec<u8>,
    neighbours: Vec<u32>,
    values: [Vec<T>; QUANTITIES],
    /// V, due to noise.
    variance: [Vec<T>; QUANTITIES],
    bias: [Bias<T>; QUANTITIES],
}

/// Squares of the bias, from distances averaged over different pools.
#[derive(Clone, Default)]
struct Bias<T> {
    wide: Vec<T>,
    narrow: Vec<T>,
    /// Without the bias that may remain undetected.
    seen: Vec<T>,
    /// Lower bound.
    local: Vec<T>,
}

/// The candidates so far. The first is followed by those of degree 6, whose places are in `sixth`, and
/// by those of degree 4.
pub(super) struct Chosen<T> {
    all: Vec<Candidate<T>>,
    sixth: Vec<usize>,
    fourth: Vec<usize>,
    /// The changes due to noise, of the jets and then of the last regression jets of degree 6.
    changes: [Vec<Values<T>>; QUANTITIES],
    /// Squared distances of the jets from the first regression jets, less the part due to noise, over
    /// each pool.
    excess: [[Vec<T>; 3]; QUANTITIES],
    /// The least B + V of each quantity so far, and the number of levels since then with a larger one.
    least: Vec<[(T, u8); QUANTITIES]>,
}

/// Squared distances of two estimates of one quantity, averaged over pools, and their variance.
struct Distances<T> {
    wide: Vec<T>,
    narrow: Vec<T>,
    local: Vec<T>,
    variance: Vec<T>,
}

impl<T: Real> Distances<T> {
    fn new(
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
            variance: variance(execution, ground, deviations, |vertex| {
                let both = changes[vertex].iter().zip(&other_changes[vertex]);
                both.map(|(&a, &b)| (a - b) * (a - b)).sum()
            }),
        }
    }
}

/// The variance due to noise, from the sums of squares of samples.
fn variance<T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    deviations: &Deviations<T>,
    sum: impl Fn(usize) -> T,
) -> Vec<T> {
    let over = T::constant(1.0 / super::REPLICAS as f64);
    let squares = (0..deviations.variances.len()).map(|vertex| over * sum(vertex));
    let mut means = ground.means(execution, &Vec::from_iter(squares), NOISE_POOL);
    for (mean, &variance) in means.iter_mut().zip(&deviations.variances) {
        *mean *= variance;
    }
    means
}

/// The larger of two; the other one if one is NaN.
fn positive<T: Real>(value: T) -> T {
    if value > T::zero() { value } else { T::zero() }
}

impl<T: Real> Candidate<T> {
    /// The jets. Their bias is taken as zero: no fit on a mesh without noise has less.
    pub(super) fn of_jets(
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &Deviations<T>,
        values: [Vec<T>; QUANTITIES],
        changes: [Vec<Values<T>>; QUANTITIES],
        degree: Vec<u8>,
        neighbours: &[u32],
    ) -> (Self, [Vec<Values<T>>; QUANTITIES]) {
        let none = vec![T::zero(); degree.len()];
        let bias = Bias {
            wide: none.clone(),
            narrow: none.clone(),
            seen: none.clone(),
            local: none,
        };
        let jets = Self {
            degree,
            neighbours: neighbours.to_vec(),
            kind: Kind::interpolating(),
            values,
            variance: variances(execution, ground, deviations, &changes),
            bias: from_fn(|_| bias.clone()),
        };
        (jets, changes)
    }

    fn scale(&self, vertex: usize) -> Scale {
        Scale {
            degree: self.degree[vertex],
            neighbours: self.neighbours[vertex],
            interpolates: self.kind.model.interpolates,
        }
    }
}

fn variances<T: Real>(
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
    /// From distances, times the square of a factor for each vertex; where the factor is `None`, from
    /// the bias of another candidate.
    fn new(distances: &Distances<T>, factor: impl Fn(usize) -> Option<T>, other: &Self) -> Self {
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
        }
    }
}

impl<T: Real> Chosen<T> {
    /// With the jets as the only candidate.
    pub(super) fn new((jets, changes): (Candidate<T>, [Vec<Values<T>>; QUANTITIES])) -> Self {
        let variances = (0..jets.degree.len()).map(|vertex| {
            from_fn(|quantity| {
                let variance: T = jets.variance[quantity][vertex];
                (
                    if variance.is_nan() {
                        T::infinity()
                    } else {
                        variance
                    },
                    0,
                )
            })
        });
        Self {
            least: variances.collect(),
            all: vec![jets],
            sixth: Vec::new(),
            fourth: Vec::new(),
            changes,
            excess: from_fn(|_| from_fn(|_| Vec::new())),
        }
    }

    /// Adds the regression jets of a level; those of degree 4 only if `with_fourth`.
    pub(super) fn add(
        &mut self,
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &Deviations<T>,
        level: Level<T>,
        with_fourth: bool,
    ) {
        let Level {
            kind,
            of_degrees: [fourth, sixth],
            neighbours,
            ..
        } = level;
        let is_first = self.sixth.is_empty();
        let last = self.sixth.last().copied().unwrap_or(0);
        let before = &self.all[last];
        let bias = from_fn(|quantity| {
            let distances = Distances::new(
                execution,
                ground,
                deviations,
                [&sixth.values[quantity], &before.values[quantity]],
                [&sixth.changes[quantity], &self.changes[quantity]],
            );
            if is_first {
                self.excess[quantity] =
                    [&distances.wide, &distances.narrow, &distances.local].map(|means| {
                        let both = means.iter().zip(&distances.variance);
                        both.map(|(&mean, &variance)| positive(mean - variance))
                            .collect()
                    });
            }
            let factor = |vertex: usize| {
                if is_first {
                    return Some(T::constant(FROM_JET));
                }
                let [now, then] = [neighbours[vertex], before.neighbours[vertex]];
                let growth = T::constant(f64::from(now)) / T::constant(f64::from(then));
                let left = growth.powi(ORDERS[quantity]).recip();
                // Also true for NaN, without a fit.
                let is_telling = growth >= T::constant(TELLING) || !growth.is_finite();
                is_telling.then(|| (T::one() - left).recip())
            };
            Bias::new(&distances, factor, &before.bias[quantity])
        });
        let count = neighbours.len();
        let fourth = with_fourth.then(|| {
            let bias = from_fn(|quantity| {
                let distances = Distances::new(
                    execution,
                    ground,
                    deviations,
                    [&fourth.values[quantity], &sixth.values[quantity]],
                    [&fourth.changes[quantity], &sixth.changes[quantity]],
                );
                let factor = T::constant(FROM_SIXTH);
                Bias::new(&distances, |_| Some(factor), &before.bias[quantity])
            });
            Candidate {
                degree: vec![DEGREES[0] as u8; count],
                neighbours: neighbours.clone(),
                kind,
                variance: variances(execution, ground, deviations, &fourth.changes),
                values: fourth.values,
                bias,
            }
        });
        let Estimates { values, changes } = sixth;
        self.all.push(Candidate {
            degree: vec![DEGREES[1] as u8; count],
            neighbours,
            kind,
            variance: variances(execution, ground, deviations, &changes),
            values,
            bias,
        });
        self.changes = changes;
        self.sixth.push(self.all.len() - 1);
        let latest = self.all.len() - 1;
        if let Some(fourth) = fourth {
            self.all.push(fourth);
            self.fourth.push(self.all.len() - 1);
        }
        self.count_gains(latest);
    }

    /// Counts the levels, from candidate `latest` on, that are worse than earlier ones.
    fn count_gains(&mut self, latest: usize) {
        let candidates = &self.all[latest..];
        for (vertex, least) in self.least.iter_mut().enumerate() {
            for (quantity, (least, worse)) in least.iter_mut().enumerate() {
                let squares = candidates.iter().map(|candidate| {
                    let bias = &candidate.bias[quantity];
                    bias.wide[vertex].max(bias.local[vertex]) + candidate.variance[quantity][vertex]
                });
                let square = squares.fold(T::infinity(), |least, square| least.min(square));
                if square < *least {
                    (*least, *worse) = (square, 0);
                } else {
                    *worse = worse.saturating_add(1);
                }
            }
        }
    }

    /// Fraction of the vertices where one of the last two levels was the best for some quantity.
    pub(super) fn gains(&self) -> f64 {
        let gains = |least: &&[(T, u8); QUANTITIES]| least.iter().any(|&(_, worse)| worse < 2);
        self.least.iter().filter(gains).count() as f64 / self.least.len() as f64
    }

    /// For each candidate, one kind of squared bias at a vertex: the least over this fit and all larger
    /// fits of the same degree, because the bias grows with the scale.
    fn biases(
        &self,
        vertex: usize,
        quantity: usize,
        which: fn(&Bias<T>) -> &[T],
        biases: &mut Vec<T>,
    ) {
        biases.clear();
        let all = self.all.iter();
        biases.extend(all.map(|candidate| which(&candidate.bias[quantity])[vertex]));
        for of_degree in [&self.sixth, &self.fourth] {
            let mut least = T::infinity();
            for &candidate in of_degree.iter().rev() {
                // Also false for NaN.
                if biases[candidate] < least {
                    least = biases[candidate];
                }
                biases[candidate] = least;
            }
        }
    }

    /// The candidate for a quantity at a vertex, and the squared error for its error bar; `None` if
    /// there is no candidate.
    fn choose(
        &self,
        vertex: usize,
        quantity: usize,
        among: &[usize],
        biases: &mut Vec<T>,
    ) -> Option<(usize, T, T)> {
        self.biases(vertex, quantity, |bias| &bias.wide, biases);
        let bias_of = |candidate: usize, biases: &[T]| {
            biases[candidate].max(self.all[candidate].bias[quantity].local[vertex])
        };
        let mut best: Option<(usize, T)> = None;
        for &candidate in among {
            let found = &self.all[candidate];
            let square = bias_of(candidate, biases) + found.variance[quantity][vertex];
            let square = if square.is_nan() {
                T::infinity()
            } else {
                square
            };
            let is_known = found.values[quantity][vertex].is_finite();
            if is_known && best.is_none_or(|(_, least)| square < least) {
                best = Some((candidate, square));
            }
        }
        let (candidate, _) = best?;
        let variance = self.all[candidate].variance[quantity][vertex];
        let mut bias = bias_of(candidate, biases);
        self.biases(vertex, quantity, |bias| &bias.seen, biases);
        let mut expected = bias_of(candidate, biases) + variance;
        if candidate == 0 {
            let [wide, ..] = &self.excess[quantity];
            expected += wide[vertex];
            for excess in &self.excess[quantity] {
                bias = bias.max(excess[vertex]);
            }
        } else {
            self.biases(vertex, quantity, |bias| &bias.narrow, biases);
            bias = bias.max(biases[candidate]);
        }
        Some((candidate, bias + variance, expected))
    }

    /// The choice at every vertex; if `is_fixed`, among the fits with the most neighbours only.
    pub(super) fn measured(
        &self,
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &Deviations<T>,
        is_fixed: bool,
        curvature: &[Curvature<T>],
    ) -> Vec<Measured<T>> {
        let count = deviations.variances.len();
        let every = Vec::from_iter(0..self.all.len());
        let last = [self.sixth.last(), self.fourth.last()];
        let last = Vec::from_iter(last.into_iter().flatten().copied());
        let mut choices = vec![[None; QUANTITIES]; count];
        let mut scratch: Vec<Vec<T>> = Vec::new();
        execution.map_with(&mut scratch, &mut choices[..], |biases, vertex, choices| {
            for (quantity, choice) in choices.iter_mut().enumerate() {
                let mut choose = |among: &[usize]| self.choose(vertex, quantity, among, biases);
                *choice = if is_fixed { choose(&last) } else { None };
                *choice = choice.or_else(|| choose(&every));
            }
        });
        let two_or_three = |vertex: usize| {
            let is_clean = deviations.variances[vertex] == T::zero();
            T::constant(if is_clean { CLEAN_BAR } else { BAR })
        };
        // A neighbour may reveal a bias that is not visible at this vertex.
        let largest = |vertex: usize, quantity: usize| {
            let around = ground.pool(vertex, LOCAL);
            let squares = around.filter_map(|other| choices[other][quantity].map(|(_, s, _)| s));
            squares.fold(T::zero(), |most, square: T| most.max(square))
        };
        let at_border = |vertex: usize| !ground.surface.mesh().is_interior(vertex);
        let estimate = |vertex: usize, quantity: usize| {
            let nothing = Estimate {
                value: T::nan(),
                error: T::nan(),
                expected: T::nan(),
                scale: Scale::default(),
            };
            let Some((candidate, _, expected)) = choices[vertex][quantity] else {
                return nothing;
            };
            let one_sided = if at_border(vertex) { ONE_SIDED } else { 1.0 };
            Estimate {
                value: self.all[candidate].values[quantity][vertex],
                error: two_or_three(vertex)
                    * T::constant(one_sided)
                    * largest(vertex, quantity).sqrt(),
                expected: expected.sqrt(),
                scale: self.all[candidate].scale(vertex),
            }
        };
        let measured = (0..count).map(|vertex| {
            let mean = estimate(vertex, 0);
            let principal = choices[vertex][0].map_or([mean; 2], |(candidate, ..)| {
                let gaussian = self.all[candidate].values[1][vertex];
                let root = positive(mean.value * mean.value - gaussian).sqrt();
                [root, -root].map(|root| Estimate {
                    value: mean.value + root,
                    error: T::constant(PRINCIPAL) * mean.error,
                    expected: T::constant(PRINCIPAL) * mean.expected,
                    scale: mean.scale,
                })
            });
            Measured {
                normal: curvature[vertex].normal,
                area: curvature[vertex].area,
                mean,
                gaussian: estimate(vertex, 1),
                force_density: estimate(vertex, 2),
                principal,
                directions: None,
                gradient_of_mean: [T::nan(); 3],
                extremalities: None,
                deviation: deviations.variances[vertex].sqrt(),
                verdict: match mean.value.is_finite() {
                    true => deviations.verdicts[vertex],
                    false => Verdict::Unknown,
                },
            }
        });
        let mut measured = Vec::from_iter(measured);
        let fitted = |vertex: usize| {
            let (candidate, ..) = choices[vertex][0]?;
            let found = &self.all[candidate];
            let [mean, gaussian, _] = &found.values;
            let square = largest(vertex, 0);
            Some(Fitted {
                kind: found.kind,
                degree: if candidate == 0 {
                    JETS
                } else {
                    usize::from(found.degree[vertex])
                },
                fields: [mean, gaussian],
                // Bars without noise are wider: see [`CLEAN_BAR`].
                bias: (two_or_three(vertex) / T::constant(BAR)).powi(2)
                    * positive(square - found.variance[0][vertex]),
            })
        };
        principal::set(execution, ground, fitted, &mut measured);
        measured
    }
}
