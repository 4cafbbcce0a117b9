//! The candidates, their estimated errors, and the choice among them at every vertex.

mod results;

use super::bias::{Bias, Distances, FitPair, positive, related, variances};
use super::jets::Jets;
use super::kind::FitKind;
use super::level::Level;
use super::{Deviations, Estimates, FORCE, Ground, QUANTITIES, Scale, Values};
use crate::element::Execution;
use crate::noise::DEGREES;
use crate::noise::doubt::larger;
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;

/// Least ratio of the numbers of neighbours of two fits whose distance shows the bias of the larger one.
const TELLING: f64 = 1.17;

/// Orders with which the bias of H, K and f falls with the number of neighbours: half of those with the
/// radius.
const ORDERS: [i32; QUANTITIES] = [3, 3, 2];

/// Ratios of the bias of the first regression jet to its distance from the jet, and of the bias of
/// degree 4 to its distance from degree 6.
const FROM_JET: f64 = 1.5;
const FROM_SIXTH: f64 = 1.2;

/// Largest ratio of the noise to what explains the distance of f between the jets and the first regression
/// jets. Averaged over 100 vertices, this distance scatters by a third.
const EXPLAINED: f64 = 2.0;

/// Error bars in estimated standard errors, with and without noise; and the factor by which they are
/// larger at boundaries. Bars without noise are wider because the bias of a fit is estimated from
/// another fit that shares part of its error.
pub(super) const BAR: f64 = 2.0;
const CLEAN_BAR: f64 = 3.0;
const ONE_SIDED: f64 = 4.0;

/// Ratio of the error bars of k₁ and k₂ to those of H.
const PRINCIPAL: f64 = 1.75;

/// A candidate, its squared error for the bar, and its expected squared error.
type Choice<T> = (usize, T, T);

/// One kind of fit.
pub(super) struct Candidate<T> {
    kind: FitKind<T>,
    degree: Vec<u8>,
    neighbours: Vec<u32>,
    values: [Vec<T>; QUANTITIES],
    /// V, due to noise.
    variance: [Vec<T>; QUANTITIES],
    bias: [Bias<T>; QUANTITIES],
    /// For degree 4, the index of the candidate of degree 6 over the same neighbours, from which the
    /// bias was estimated.
    beside: Option<usize>,
    /// For degree 4, the bias of degree 6 in units of the distance from it: see [`related`].
    related: [T; QUANTITIES],
}

/// All candidates so far: the jets, then regression jets, whose indices are in `sixth` for degree 6 and
/// in `fourth` for degree 4.
pub(super) struct Chosen<T> {
    all: Vec<Candidate<T>>,
    sixth: Vec<usize>,
    fourth: Vec<usize>,
    /// Changes due to noise: at first those of the jets, later those of the last regression jets of
    /// degree 6.
    changes: [Vec<Values<T>>; QUANTITIES],
    /// Squared distances of the jets from the first regression jets, less the variance due to noise, for
    /// each pool.
    excess: [[Vec<T>; 3]; QUANTITIES],
    /// The squares of the error bars of the jets, without noise.
    of_jets: [Vec<T>; QUANTITIES],
    /// Whether the mesh has no noise.
    is_clean: bool,
    /// The least B + V of each quantity so far, and the number of later levels that did not reduce it.
    least: Vec<[(T, u8); QUANTITIES]>,
}

/// Changes of each quantity due to noise.
type Changes<T> = [Vec<Values<T>>; QUANTITIES];

impl<T: Real> Candidate<T> {
    /// The jets. Their bias counts as zero, because no other fit of a mesh without noise is more
    /// accurate.
    pub(super) fn of_jets(
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &Deviations<T>,
        jets: &Jets<T>,
        changes: &Changes<T>,
    ) -> Self {
        let bias = Bias::none(jets.degrees.len());
        Self {
            degree: jets.degrees.clone(),
            neighbours: jets.neighbours.clone(),
            kind: FitKind::of_jets(jets.model),
            values: jets.values.clone(),
            variance: variances(execution, ground, deviations, changes),
            bias: from_fn(|_| bias.clone()),
            beside: None,
            related: [T::zero(); QUANTITIES],
        }
    }

    fn scale(&self, vertex: usize) -> Scale {
        Scale {
            degree: self.degree[vertex],
            neighbours: self.neighbours[vertex],
            interpolates: self.kind.model.interpolates,
        }
    }
}

impl<T: Real> Chosen<T> {
    /// A choice with the jets as the only candidate; `of_jets` has the squares of their error bars without noise.
    pub(super) fn new(
        jets: Candidate<T>,
        changes: Changes<T>,
        of_jets: [Vec<T>; QUANTITIES],
        is_clean: bool,
    ) -> Self {
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
            of_jets,
            is_clean,
        }
    }

    /// Reduces the estimated noise where f of jets that change by noise as these do, `force`, is closer to f of the first regression jets than with
    /// such noise: there, the residual of the shape was taken for noise. No other quantity has as much noise
    /// compared with its bias.
    pub(super) fn limit_noise(
        &mut self,
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &mut Deviations<T>,
        force: &[T],
        level: &Level<T>,
    ) {
        let [_, sixth] = &level.of_degrees;
        let jets = &mut self.all[0];
        let pair = FitPair {
            values: [&sixth.values[FORCE], force],
            changes: [&sixth.changes[FORCE], &self.changes[FORCE]],
        };
        let Distances { wide, variance, .. } = Distances::new(execution, ground, deviations, &pair);
        for (vertex, (square, variance)) in wide.into_iter().zip(variance).enumerate() {
            let fraction = T::constant(EXPLAINED) * square / variance;
            let fraction = deviations.reduce(vertex, fraction);
            for (quantity, (least, _)) in self.least[vertex].iter_mut().enumerate() {
                jets.variance[quantity][vertex] *= fraction;
                *least *= fraction;
            }
        }
    }

    /// Adds the regression jets of a level: those of degree 6, and those of degree 4 if `with_fourth`.
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
        let scales: [FitPair<'_, T>; QUANTITIES] = from_fn(|quantity| FitPair {
            values: [&sixth.values[quantity], &before.values[quantity]],
            changes: [&sixth.changes[quantity], &self.changes[quantity]],
        });
        let factor = |vertex: usize, quantity: usize| {
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
        let bias = from_fn(|quantity| {
            let pair = &scales[quantity];
            let distances = Distances::new(execution, ground, deviations, pair);
            if is_first {
                self.excess[quantity] =
                    [&distances.wide, &distances.narrow, &distances.local].map(|means| {
                        let both = means.iter().zip(&distances.variance);
                        // Unknown where there is no fit to compare with.
                        both.map(|(&mean, &variance)| match (mean - variance).is_nan() {
                            true => T::infinity(),
                            false => positive(mean - variance),
                        })
                        .collect()
                    });
            }
            let factor = |vertex: usize| factor(vertex, quantity);
            let other = &before.bias[quantity];
            Bias::new(deviations, &distances, pair, factor, other)
        });
        let count = neighbours.len();
        let last = self.fourth.last().map(|&last| &self.all[last]);
        let fourth = with_fourth.then(|| {
            let both: [_; QUANTITIES] = from_fn(|quantity| {
                let degrees = &FitPair {
                    values: [&fourth.values[quantity], &sixth.values[quantity]],
                    changes: [&fourth.changes[quantity], &sixth.changes[quantity]],
                };
                let distances = Distances::new(execution, ground, deviations, degrees);
                let of_sixth = |_| Some(T::constant(FROM_SIXTH));
                let other = &before.bias[quantity];
                let bias = Bias::new(deviations, &distances, degrees, of_sixth, other);
                let pairs = [degrees, &scales[quantity]];
                let is_telling = |vertex: usize| factor(vertex, quantity).is_some();
                let related = related(deviations, &distances.variance, pairs, is_telling);
                let before = || last.map_or(T::one(), |last| last.related[quantity]);
                (bias, related.unwrap_or_else(before))
            });
            Candidate {
                degree: vec![DEGREES[0] as u8; count],
                neighbours: neighbours.clone(),
                kind,
                variance: variances(execution, ground, deviations, &fourth.changes),
                related: from_fn(|quantity| both[quantity].1),
                bias: both.map(|(bias, _)| bias),
                values: fourth.values,
                beside: Some(self.all.len()),
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
            beside: None,
            related: [T::zero(); QUANTITIES],
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

    /// Records at which vertices the candidates from `latest` on are better than all earlier ones.
    fn count_gains(&mut self, latest: usize) {
        let candidates = &self.all[latest..];
        for (vertex, least) in self.least.iter_mut().enumerate() {
            for (quantity, (least, worse)) in least.iter_mut().enumerate() {
                let squares = candidates.iter().map(|candidate| {
                    let bias = &candidate.bias[quantity];
                    larger(bias.wide[vertex], bias.local[vertex])
                        + candidate.variance[quantity][vertex]
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

    /// The fraction of the vertices where one of the last two levels was the best for at least one
    /// quantity.
    pub(super) fn gains(&self) -> f64 {
        let gains = |least: &&[(T, u8); QUANTITIES]| least.iter().any(|&(_, worse)| worse < 2);
        self.least.iter().filter(gains).count() as f64 / self.least.len() as f64
    }

    /// The fraction of the vertices where the last level is the best for at least one quantity, and has as
    /// many neighbours as it should have.
    pub(super) fn rising(&self) -> f64 {
        let rising = self.all.last().map_or(0, |last| {
            let [wanted, _] = last.kind.neighbours;
            let both = self.least.iter().zip(&last.neighbours);
            let best = both.filter(|(least, found)| {
                **found as usize >= wanted && least.iter().any(|&(_, worse)| worse == 0)
            });
            best.count()
        });
        rising as f64 / self.least.len() as f64
    }

    /// Sets `biases` to one of the squares of the bias of each candidate at a vertex. Within a degree,
    /// this is the least value of a fit and all larger fits, because the bias grows with the scale.
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

    /// The candidate for a quantity at a vertex, its squared error for the bar, and its expected squared
    /// error; `None` if there is no candidate.
    fn choose(
        &self,
        vertex: usize,
        quantity: usize,
        among: &[usize],
        biases: &mut Vec<T>,
    ) -> Option<Choice<T>> {
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
        let of_jets = self.of_jets[quantity][vertex];
        let expected_of_jets = of_jets * T::constant(1.0 / (BAR * BAR));
        if self.is_clean {
            return Some((candidate, of_jets, expected_of_jets));
        }
        let mut bias = bias_of(candidate, biases);
        let (expected, shared) = self.seen(vertex, quantity, candidate, biases);
        let mut expected =
            expected.max(self.all[candidate].bias[quantity].local[vertex]) + variance;
        if candidate == 0 {
            // The first regression jets may be far worse than the jets.
            let [wide, ..] = &self.excess[quantity];
            expected += wide[vertex].min(expected_of_jets);
            for excess in &self.excess[quantity] {
                bias = bias.max(excess[vertex].min(expected_of_jets));
            }
        } else {
            self.biases(vertex, quantity, |bias| &bias.narrow, biases);
            bias = self.possible(vertex, quantity, candidate, bias.max(biases[candidate]));
        }
        // Both biases have the same sign, because both fits lose the same waves of the shape.
        let both = bias.sqrt() + shared.sqrt();
        Some((candidate, both * both + variance, expected))
    }

    /// The squared bias, capped by its estimate over the whole mesh. The distance of degree 4
    /// from degree 6 has several times the noise of degree 4, and local distances that exceed it by chance
    /// would dominate the error.
    fn possible(&self, vertex: usize, quantity: usize, candidate: usize, square: T) -> T {
        let found = &self.all[candidate];
        let bias = &found.bias[quantity];
        match found.beside {
            Some(_) => (bias.trust.possible * square).max(bias.local[vertex]),
            None => square,
        }
    }

    /// E[bias²] of a candidate, and the bias² that it may share with degree 6. The distance of degree 4 from degree 6 does not show the bias that both
    /// share, and it is larger than both if they are opposite: see [`related`]. The bias of degree 6 is less
    /// than that of degree 4; the shared part is therefore limited by the part that the distance shows.
    fn seen(
        &self,
        vertex: usize,
        quantity: usize,
        candidate: usize,
        biases: &mut Vec<T>,
    ) -> (T, T) {
        self.biases(vertex, quantity, |bias| &bias.seen, biases);
        let trust = |candidate: usize| self.all[candidate].bias[quantity].trust;
        let own = trust(candidate).likely * biases[candidate];
        let Some(beside) = self.all[candidate].beside else {
            return (own, T::zero());
        };
        let related = self.all[candidate].related[quantity];
        let of_distance = (T::one() + related.min(T::zero())) / T::constant(FROM_SIXTH);
        let own = own * of_distance * of_distance;
        let shared = positive(trust(beside).certain * biases[beside]).min(own);
        // Noise may hide that the biases are related, which error bars must allow for.
        if related > T::zero() {
            (own + shared, shared)
        } else if related == T::zero() {
            (own, shared)
        } else {
            (own, T::zero())
        }
    }
}
