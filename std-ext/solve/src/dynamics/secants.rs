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
