//! The values of the chosen fits, with error bars.

use super::{BAR, CLEAN_BAR, Candidate, Choice, Chosen, ONE_SIDED, PRINCIPAL, QUANTITIES};
use crate::element::Execution;
use crate::noise::DEGREES;
use crate::noise::adaptive::bias::positive;
use crate::noise::adaptive::jets::Jets;
use crate::noise::adaptive::kind::FitKind;
use crate::noise::adaptive::principal::{self, Fitted, OfJet};
use crate::noise::adaptive::{Deviations, Estimate, Ground, LOCAL, Measured, ONE_STAGE, Verdict};
use crate::noise::doubt::{Doubt, larger};
use crate::noise::fit::Model;
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;

impl<T: Real> Chosen<T> {
    /// The largest distance of a fit from the chosen one at a vertex or one near it. Where the mesh does not resolve
    /// the shape, the residual is no measure of the noise, and no fit is known to be better than others.
    fn farthest(
        &self,
        ground: &Ground<'_, T>,
        vertex: usize,
        quantity: usize,
        choices: &[[Option<Choice<T>>; QUANTITIES]],
    ) -> T {
        let mut most = T::zero();
        for other in ground.pool(vertex, LOCAL) {
            let Some((chosen, ..)) = choices[other][quantity] else {
                continue;
            };
            let value = |candidate: &Candidate<T>| candidate.values[quantity][other];
            for candidate in &self.all {
                most = most.max((value(candidate) - value(&self.all[chosen])).abs());
            }
        }
        most
    }

    /// The results at every vertex; if `is_fixed`, the fits with the most neighbours take precedence
    /// over all others.
    pub(in crate::noise::adaptive) fn measured(
        &self,
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        deviations: &Deviations<T>,
        is_fixed: bool,
        jets: &Jets<T>,
    ) -> (Vec<Measured<T>>, Vec<Option<Doubt<T>>>) {
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
        let times = |vertex: usize| {
            let is_clean = deviations.variances[vertex] == T::zero();
            T::constant(match (self.is_clean, is_clean) {
                (true, _) => 1.0,
                (false, true) => CLEAN_BAR,
                (false, false) => BAR,
            })
        };
        // Distances at neighbours may show a bias that is not visible at this vertex.
        let largest = |vertex: usize, quantity: usize| {
            let around = ground.pool(vertex, LOCAL);
            let squares = around.filter_map(|other| choices[other][quantity].map(|(_, s, _)| s));
            let most = squares.fold(T::zero(), larger);
            // Without noise, other signs may give a bar where this one is unknown.
            match most.is_nan() && !self.is_clean {
                true => T::infinity(),
                false => most,
            }
        };
        let at_border = |vertex: usize| !ground.surface.mesh().is_interior(vertex);
        let nothing = Measured::unknown();
        let estimate = |vertex: usize, quantity: usize| {
            let Some((candidate, _, expected)) = choices[vertex][quantity] else {
                return nothing.mean;
            };
            let one_sided = if at_border(vertex) { ONE_SIDED } else { 1.0 };
            let error = times(vertex) * T::constant(one_sided) * largest(vertex, quantity).sqrt();
            let is_resolved =
                deviations.verdicts[vertex] != Verdict::Unresolved && !ground.is_on_grid;
            let farthest = || T::constant(BAR) * self.farthest(ground, vertex, quantity, &choices);
            Estimate {
                value: self.all[candidate].values[quantity][vertex],
                error: if is_resolved {
                    error
                } else {
                    larger(error, farthest())
                },
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
                normal: jets.curvature[vertex].normal,
                area: jets.curvature[vertex].area,
                mean,
                gaussian: estimate(vertex, 1),
                force_density: estimate(vertex, 2),
                principal,
                deviation: deviations.variances[vertex].sqrt(),
                verdict: match mean.value.is_finite() {
                    true => deviations.verdicts[vertex],
                    false => Verdict::Unknown,
                },
                ..nothing
            }
        });
        let mut measured = Vec::from_iter(measured);
        let fitted = |vertex: usize| {
            let (candidate, ..) = choices[vertex][0]?;
            let found = &self.all[candidate];
            let [mean, gaussian, _] = &found.values;
            let square = larger(largest(vertex, 0), T::zero());
            let square = if square.is_nan() {
                T::infinity()
            } else {
                square
            };
            let is_jet = candidate == 0 && ground.rings[vertex] >= ONE_STAGE;
            let degree = usize::from(found.degree[vertex]);
            let model = Model {
                degree,
                ..found.kind.model
            };
            Some(Fitted {
                doubt: jets.doubts[vertex].filter(|_| is_jet),
                jet: is_jet.then(|| OfJet {
                    model,
                    neighbours: found.neighbours[vertex] as usize,
                    gradients: jets.gradients[vertex],
                    directions: jets.curvature[vertex].directions(),
                }),
                kind: match candidate {
                    0 => FitKind::interpolating(),
                    _ => found.kind,
                },
                degree: match (candidate, is_jet) {
                    (0, false) => DEGREES[1],
                    _ => degree,
                },
                fields: [mean, gaussian],
                bias: match self.is_clean {
                    true => T::constant(PRINCIPAL * PRINCIPAL) * square,
                    // The bias is scaled because bars without noise are wider: see [`CLEAN_BAR`].
                    false => {
                        let times = times(vertex) / T::constant(BAR);
                        times * times * positive(square - found.variance[0][vertex])
                    }
                },
            })
        };
        let doubts = principal::set(execution, ground, fitted, &mut measured);
        (measured, doubts)
    }
}
