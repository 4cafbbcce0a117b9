//! Bounds of the bias of many estimates, and the choice of the best.

use super::{Base, Bias, Candidate, Candidates, J6};
use crate::noise::COPIES;

/// Relative uncertainty of the variance of a distance.
const UNCERTAIN: f64 = 0.1;

/// Multiple of its variance beyond which a squared distance is not explained by noise.
const SIGNIFICANT: f64 = 1.5;

/// Factor on the distance of degree 4 from degree 6, and of an average from the fit that is averaged.
pub(super) const FOURTH: f64 = 1.2;

/// Factor on the distance of averages from half as many, because their bias grows with their number.
const DOUBLED: f64 = 2.0;

/// Bounds of the square of a candidate's error without noise.
#[derive(Clone, Copy, Default)]
pub(super) struct Range {
    /// Upper bound.
    most: f64,
    /// Lower bound.
    pub(super) least: f64,
}

/// A candidate that was chosen.
pub(super) struct Choice {
    pub(super) index: usize,
    /// Squares of its errors due to the shape and due to noise.
    pub(super) bias: f64,
    pub(super) variance: f64,
}

impl Candidates {
    /// Square of the distance of two candidates, without the part of noise.
    fn apart(&self, [one, other]: [usize; 2], which: usize, weights: &[f64]) -> Range {
        let [one, other] = [one, other].map(|index| &self.all[index].values[which]);
        let both = || one.iter().zip(other);
        let distance = mean_square(weights, both().map(|(a, b)| a[0] - b[0]));
        let by_noise = (1..COPIES).map(|copy| {
            let changes = both().map(|(a, b)| a[copy] - a[0] - (b[copy] - b[0]));
            mean_square(weights, changes)
        });
        let by_noise = by_noise.sum::<f64>() / (COPIES - 1) as f64;
        Range {
            most: (distance - by_noise).max(0.0) + UNCERTAIN * by_noise,
            least: (distance - SIGNIFICANT * by_noise).max(0.0),
        }
    }

    /// Variance of a candidate under noise.
    pub(super) fn variance(&self, index: usize, which: usize, weights: &[f64]) -> f64 {
        let values = &self.all[index].values[which];
        let changes =
            (1..COPIES).map(|copy| mean_square(weights, values.iter().map(|a| a[copy] - a[0])));
        changes.sum::<f64>() / (COPIES - 1) as f64
    }

    /// Limits of B² from a candidate's own distance.
    pub(super) fn range(&self, index: usize, which: usize, weights: &[f64]) -> Range {
        let (from, factor) = match self.all[index].bias {
            Bias::Unknown => return Range::default(),
            Bias::Distance { from, factors } => (from, factors[usize::from(which > 1)]),
            Bias::Added { to } => (to, FOURTH),
            Bias::Averages { half, .. } => (half, DOUBLED),
        };
        self.apart([index, from], which, weights)
            .times(factor * factor)
    }

    /// B² of each candidate for a quantity. A wider candidate of the same kind has less noise and more
    /// bias.
    fn biases(&self, which: usize, weights: &[f64]) -> Vec<f64> {
        let ranges = (0..self.all.len()).map(|index| self.range(index, which, weights));
        let ranges = Vec::from_iter(ranges);
        let mut biases = Vec::from_iter(ranges.iter().map(|range| range.most));
        for (index, candidate) in self.all.iter().enumerate().rev() {
            if let Some(wider) = candidate.wider {
                biases[index] = biases[index].min(biases[wider]).max(ranges[index].least);
            }
        }
        for (index, candidate) in self.all.iter().enumerate() {
            match candidate.bias {
                Bias::Unknown | Bias::Distance { .. } => {}
                Bias::Added { to } => {
                    biases[index] = (biases[index].sqrt() + biases[to].sqrt()).powi(2);
                }
                Bias::Averages { base, .. } => {
                    let of_base = match base {
                        Base::Sixth(base) => ranges[base].least,
                        Base::Fourth(sixth) => {
                            let apart = self.apart([index, sixth], which, weights);
                            apart.most * FOURTH * FOURTH
                        }
                    };
                    biases[index] = (biases[index].sqrt() + of_base.sqrt()).powi(2);
                }
            }
        }
        biases
    }

    /// The candidates that have a value at every vertex with a weight, judged by these weights, whose
    /// sum is 1.
    fn choices(&self, which: usize, weights: &[f64]) -> Vec<Choice> {
        let biases = self.biases(which, weights);
        let is_eligible = |candidate: &Candidate| {
            // Noise that remains in long waves of degree 6 is large, and looks like the shape.
            let averages = candidate.bias.is_of_averages_of_degree_6();
            let mut known = candidate.values[which].iter().zip(weights);
            !averages && known.all(|(value, weight)| *weight == 0.0 || value[0].is_finite())
        };
        let indices = J6..self.all.len();
        let eligible = indices.filter(|&index| is_eligible(&self.all[index]));
        let choice = |index| Choice {
            index,
            bias: biases[index],
            variance: self.variance(index, which, weights),
        };
        eligible.map(choice).collect()
    }

    /// The candidate with the least B² + V for a quantity.
    pub(super) fn choose(&self, which: usize) -> Choice {
        let choices = self.choices(which, &self.areas).into_iter();
        let best = choices.min_by(|a, b| a.square().total_cmp(&b.square()));
        best.unwrap_or(Choice {
            index: J6,
            bias: 0.0,
            variance: 0.0,
        })
    }

    /// The largest absolute value of a quantity on the surface without noise: the geometric mean of the
    /// candidates' values, weighted by their errors, because a single candidate may be wrong at the one
    /// vertex that counts.
    pub(super) fn largest(&self, which: usize) -> f64 {
        let found = &self.all[self.choose(which).index].values[which];
        // Errors matter where values are large.
        let squares = found.iter().zip(&self.areas);
        let squares = squares.map(|(value, area)| match *area {
            0.0 => 0.0,
            area => area * value[0] * value[0],
        });
        let mut weights = Vec::from_iter(squares);
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let choices = self.choices(which, &weights);
        let least = choices.iter().map(Choice::square).fold(f64::MAX, f64::min);
        let (mut sum, mut all) = (0.0, 0.0);
        for choice in &choices {
            // Weights are the inverse cube of the error, by trial on 13 shapes at 1e-2 edges: with the
            // inverse square, forces of tubes are up to 1.5 times too small; with the fourth power,
            // others are too large.
            let part = least / choice.square();
            let trust = part * part.sqrt();
            sum += trust * self.largest_of(choice.index, which).ln();
            all += trust;
        }
        if all > 0.0 {
            (sum / all).exp()
        } else {
            self.largest_of(J6, which)
        }
    }

    /// The largest absolute value of a candidate, corrected for noise: additional noise of the same
    /// size shows the factor by which noise increases it.
    fn largest_of(&self, index: usize, which: usize) -> f64 {
        let found = &self.all[index].values[which];
        let largest = |copy: usize| {
            let known = found.iter().zip(&self.areas);
            let known = known.filter(|(_, area)| **area > 0.0);
            known.fold(0.0_f64, |most, (value, _)| value[copy].abs().max(most))
        };
        let again = (1..COPIES).map(|copy| largest(copy).powi(2)).sum::<f64>();
        let again = (again / (COPIES - 1) as f64).sqrt();
        let here = largest(0);
        if again > here {
            here * here / again
        } else {
            here
        }
    }
}

impl Bias {
    fn is_of_averages_of_degree_6(self) -> bool {
        let Self::Averages { base, .. } = self else {
            return false;
        };
        matches!(base, Base::Sixth(_))
    }
}

impl Choice {
    /// Square of its error.
    fn square(&self) -> f64 {
        self.bias + self.variance
    }
}

impl Range {
    fn times(self, factor: f64) -> Self {
        Self {
            most: factor * self.most,
            least: factor * self.least,
        }
    }
}

/// Σ wᵢ xᵢ², without terms of weight 0 or NaN.
fn mean_square(weights: &[f64], values: impl Iterator<Item = f64>) -> f64 {
    let terms = weights.iter().zip(values);
    let terms = terms.filter(|(weight, value)| **weight > 0.0 && value.is_finite());
    terms.map(|(weight, value)| weight * value * value).sum()
}
