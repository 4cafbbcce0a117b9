//! Limited-memory secants (L-BFGS).
//!
//! J. Nocedal, Math. Comp. 35 (1980) 773.

use super::vector;
use serde::{Deserialize, Serialize};

/// The last steps with their changes of force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Secants {
    /// The pairs, the oldest first.
    pairs: Vec<Pair>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Pair {
    step: Vec<f64>,
    /// The decrease of the force.
    fall: Vec<f64>,
}

impl Secants {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Stores a step. Steps along which the force did not fall are skipped, because the
    /// approximation would not stay positive definite.
    pub(super) fn push(&mut self, limit: usize, step: Vec<f64>, fall: Vec<f64>) {
        let product = vector::product(&step, &fall);
        let sizes = vector::product(&step, &step) * vector::product(&fall, &fall);
        let falls = product > LEAST_COSINE * sizes.sqrt();
        if !falls {
            return;
        }
        if self.pairs.len() >= limit {
            self.pairs.remove(0);
        }
        self.pairs.push(Pair { step, fall });
    }

    /// Replaces a force by the displacement that would cancel it, with `precondition` as the
    /// inverse stiffness in directions that are not stored.
    pub(super) fn apply(&self, force: &mut [f64], precondition: impl FnOnce(&mut [f64])) {
        let mut shares = Vec::with_capacity(self.pairs.len());
        for pair in self.pairs.iter().rev() {
            let over = vector::product(&pair.step, &pair.fall).recip();
            let share = over * vector::product(&pair.step, force);
            vector::add_scaled(force, -share, &pair.fall);
            shares.push((share, over));
        }
        precondition(force);
        for (pair, (share, over)) in self.pairs.iter().zip(shares.into_iter().rev()) {
            let back = over * vector::product(&pair.fall, force);
            vector::add_scaled(force, share - back, &pair.step);
        }
    }
}

/// The least cosine between step and decrease of force with which a pair is stored.
const LEAST_COSINE: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::Secants;
    use crate::dynamics::vector;

    /// The approximate inverse stiffness maps the last fall of the force to its step, and is symmetric.
    #[test]
    fn the_last_step_answers_its_fall() {
        let stiffness = [2.0, 0.5, 3.0, 1.5];
        let steps = [[1.0, -2.0, 0.5, 0.3], [0.2, 1.0, 1.0, -0.7]];
        let mut secants = Secants::default();
        let falls = steps.map(|step| std::array::from_fn(|k| stiffness[k] * step[k]));
        for (step, fall) in steps.iter().zip::<[[f64; 4]; 2]>(falls) {
            secants.push(5, step.to_vec(), fall.to_vec());
        }
        let applied = |force: [f64; 4]| {
            let mut found = force.to_vec();
            secants.apply(&mut found, |force| {
                force.iter_mut().for_each(|entry| *entry *= 0.8);
            });
            found
        };
        for (found, expected) in applied(falls[1]).into_iter().zip(steps[1]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
        let [one, other] = [[1.0, 0.0, 2.0, -1.0], [0.3, 1.0, -0.4, 0.8]];
        let [there, back] = [
            vector::product(&other, &applied(one)),
            vector::product(&one, &applied(other)),
        ];
        assert!((there - back).abs() < 1e-14, "{there} {back}");
    }
}
