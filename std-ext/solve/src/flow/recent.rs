//! Initial guesses of linear systems that change from one solution to the next.

use serde::{Deserialize, Serialize};

/// Largest number of solutions that are kept.
const MOST: usize = 6;

/// Least distance of a right-hand side from the combinations of newer ones, relative to its length;
/// below it, a right-hand side contains only errors of the solutions.
const NEW: f64 = 1e-5;

/// The last right-hand sides b of systems `A x = b`, where A changes slowly, and the solutions x.
///
/// The combination of these right-hand sides that is nearest to a new one, in the sense of least
/// squares, is found; the same combination of the solutions is a good initial guess. If everything
/// depends smoothly on time, the guess extrapolates; it also follows changes of b alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Recent {
    /// Pairs b, x, the newest last.
    pairs: Vec<[Vec<[f64; 3]>; 2]>,
}

impl Recent {
    /// Sets `solution` to a guess for this right-hand side; leaves it unchanged if there is none.
    pub(super) fn guess(&self, right: &[[f64; 3]], solution: &mut [[f64; 3]]) {
        if self.pairs.is_empty() {
            return;
        }
        let mut left = right.to_vec();
        solution.fill([0.0; 3]);
        let mut basis: Vec<[Vec<[f64; 3]>; 2]> = Vec::new();
        for pair in self.pairs.iter().rev() {
            let mut new = pair.clone();
            let length = dot(&new[0], &new[0]).sqrt();
            for known in &basis {
                let along = dot(&new[0], &known[0]);
                for (new, known) in new.iter_mut().zip(known) {
                    add(new, -along, known);
                }
            }
            let rest = dot(&new[0], &new[0]).sqrt();
            let is_new = rest > NEW * length && rest.is_normal();
            if !is_new {
                continue;
            }
            for field in &mut new {
                field.as_flattened_mut().iter_mut().for_each(|x| *x /= rest);
            }
            let along = dot(&left, &new[0]);
            add(&mut left, -along, &new[0]);
            add(solution, along, &new[1]);
            basis.push(new);
        }
    }

    /// Keeps a solution.
    pub(super) fn keep(&mut self, right: &[[f64; 3]], solution: &[[f64; 3]]) {
        if self.pairs.len() == MOST {
            self.pairs.remove(0);
        }
        self.pairs.push([right.to_vec(), solution.to_vec()]);
    }
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| a * b).sum()
}

/// Adds `factor` times another field.
fn add(sum: &mut [[f64; 3]], factor: f64, other: &[[f64; 3]]) {
    let entries = sum.as_flattened_mut().iter_mut();
    for (sum, other) in entries.zip(other.as_flattened()) {
        *sum += factor * other;
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST, Recent};

    fn field(seed: usize) -> Vec<[f64; 3]> {
        let number = |k: usize| ((7 * k + 13 * seed) as f64).sin();
        (0..20)
            .map(|k| [number(k), number(k + 50), number(k + 90)])
            .collect()
    }

    /// `x = A⁻¹ b` of some diagonal matrix.
    fn solved(right: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let row = |(k, row): (usize, &[f64; 3])| row.map(|b| b / (1.0 + k as f64));
        right.iter().enumerate().map(row).collect()
    }

    fn combined(parts: &[(f64, Vec<[f64; 3]>)]) -> Vec<[f64; 3]> {
        let mut sum = vec![[0.0; 3]; 20];
        for (factor, part) in parts {
            super::add(&mut sum, *factor, part);
        }
        sum
    }

    #[test]
    fn combinations_of_right_sides_are_solved() {
        let mut recent = Recent::default();
        let mut untouched = field(9);
        recent.guess(&field(1), &mut untouched);
        assert_eq!(untouched, field(9));
        for seed in 1..4 {
            recent.keep(&field(seed), &solved(&field(seed)));
        }
        // One twice, and one that is zero, add nothing.
        recent.keep(&field(2), &solved(&field(2)));
        recent.keep(&[[0.0; 3]; 20], &[[0.0; 3]; 20]);
        let right = combined(&[(2.0, field(1)), (-0.5, field(2)), (0.3, field(3))]);
        let mut guess = field(9);
        recent.guess(&right, &mut guess);
        // Orthogonal directions lose a few digits.
        for (guess, exact) in guess.iter().flatten().zip(solved(&right).iter().flatten()) {
            assert!((guess - exact).abs() <= 1e-12, "{guess} and {exact}");
        }
    }

    #[test]
    fn the_oldest_is_forgotten() {
        let mut recent = Recent::default();
        for seed in 0..2 * MOST {
            recent.keep(&field(seed), &solved(&field(seed)));
        }
        let kept = recent.pairs.iter().map(|[right, _]| right.clone());
        assert!(kept.eq((MOST..2 * MOST).map(field)));
    }
}
