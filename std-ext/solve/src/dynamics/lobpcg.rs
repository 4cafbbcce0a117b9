//! The smallest eigenvalues μ of `H q = μ M q`, with a symmetric operator H and a diagonal mass M.
//!
//! Locally optimal block preconditioned conjugate gradients: A. V. Knyazev, SIAM J. Sci. Comput. 23 (2001) 517, with
//! an orthonormal basis of each subspace, as in U. Hetmaniuk and R. Lehoucq, J. Comput. Phys. 218 (2006) 324.

use super::vector::{add_scaled, product};

/// The operator H, its preconditioner and the mass.
pub(super) trait Operator {
    /// The reason why a product cannot be computed.
    type Error;

    /// `H q`.
    fn apply(&mut self, vector: &[f64]) -> Result<Vec<f64>, Self::Error>;

    /// An approximation of `H⁻¹ r` where H is positive.
    fn precondition(&mut self, residual: Vec<f64>) -> Vec<f64>;

    /// M, above 0 wherever vectors are not 0.
    fn mass(&self) -> &[f64];
}

/// An eigenvalue with its vector.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub(super) value: f64,
    /// Normalised: qᵀMq = 1.
    pub(super) vector: Vec<f64>,
    /// `|H q − μ M q|`, in the norm of M⁻¹. H has an eigenvalue that differs by no more from μ.
    pub(super) residual: f64,
}

/// The goal of an iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// Number of eigenvalues.
    pub(super) count: usize,
    /// The largest residual.
    pub(super) residual: f64,
    /// The largest number of iterations.
    pub(super) iterations: usize,
}

/// The length below which a vector counts as one that depends on others.
const DEPENDENT: f64 = 1e-8;

/// Orthonormal vectors, with their images under H.
#[derive(Clone, Debug, Default)]
struct TrialSpace {
    vectors: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
}

impl TrialSpace {
    /// A vector without its components along the basis, normalised, and its image likewise; `None` if it depends
    /// on the basis.
    fn independent(
        &self,
        mass: &[f64],
        mut vector: Vec<f64>,
        mut image: Vec<f64>,
    ) -> Option<[Vec<f64>; 2]> {
        // Twice, because of rounding.
        for _ in 0..2 {
            let length = norm(mass, &vector);
            let scale = length.recip();
            if !(length > 0.0 && scale.is_finite()) {
                return None;
            }
            scale_by(scale, &mut vector);
            scale_by(scale, &mut image);
            for (other, other_image) in self.vectors.iter().zip(&self.images) {
                let part = inner(mass, other, &vector);
                add_scaled(&mut vector, -part, other);
                if !image.is_empty() {
                    add_scaled(&mut image, -part, other_image);
                }
            }
            if norm(mass, &vector) < DEPENDENT {
                return None;
            }
        }
        let scale = norm(mass, &vector).recip();
        scale_by(scale, &mut vector);
        scale_by(scale, &mut image);
        Some([vector, image])
    }

    /// Adds the part of a vector that is independent of the basis, with its exact image.
    fn extend<O: Operator>(&mut self, operator: &mut O, vector: Vec<f64>) -> Result<(), O::Error> {
        if let Some([vector, _]) = self.independent(operator.mass(), vector, Vec::new()) {
            self.images.push(operator.apply(&vector)?);
            self.vectors.push(vector);
        }
        Ok(())
    }

    /// Linear combinations of vectors and images from a place on.
    fn combined(&self, from: usize, factors: &[Vec<f64>]) -> Self {
        let combine = |fields: &[Vec<f64>]| {
            let combination = |factors: &Vec<f64>| {
                let mut sum = vec![0.0; fields[0].len()];
                for (field, factor) in fields.iter().zip(factors).skip(from) {
                    add_scaled(&mut sum, *factor, field);
                }
                sum
            };
            factors.iter().map(combination).collect()
        };
        Self {
            vectors: combine(&self.vectors),
            images: combine(&self.images),
        }
    }

    /// Eigenvalues of H in the subspace, by rising value, and coefficients of their vectors.
    fn ritz(&self) -> (Vec<f64>, Vec<Vec<f64>>) {
        let entry = |i: usize, j: usize| {
            let upper = product(&self.vectors[i], &self.images[j]);
            let lower = product(&self.vectors[j], &self.images[i]);
            0.5 * (upper + lower)
        };
        let count = self.vectors.len();
        let row = |i: usize| (0..count).map(|j| entry(i, j)).collect();
        let matrix: Vec<Vec<f64>> = (0..count).map(row).collect();
        symmetric_eigenvalues(matrix)
    }
}

fn inner(mass: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let terms = a.iter().zip(b).zip(mass);
    terms.map(|((a, b), mass)| mass * a * b).sum()
}

fn norm(mass: &[f64], vector: &[f64]) -> f64 {
    inner(mass, vector, vector).sqrt()
}

fn scale_by(factor: f64, vector: &mut [f64]) {
    vector.iter_mut().for_each(|entry| *entry *= factor);
}

/// `H q − μ M q`, and its norm.
fn residual(mass: &[f64], value: f64, vector: &[f64], image: &[f64]) -> (Vec<f64>, f64) {
    let entries = image.iter().zip(vector).zip(mass);
    let field: Vec<f64> = entries
        .map(|((image, entry), mass)| image - value * mass * entry)
        .collect();
    let squares = field
        .iter()
        .zip(mass)
        .map(|(entry, mass)| match *mass > 0.0 {
            true => entry * entry / mass,
            false => 0.0,
        });
    let size = squares.sum::<f64>().sqrt();
    (field, size)
}

/// The smallest eigenvalues, by rising value. `start` has more vectors than eigenvalues are wanted, so that the
/// last ones converge, too. Eigenvalues whose residual is above the goal at the end are returned all the same.
pub(super) fn smallest<O: Operator>(
    operator: &mut O,
    start: Vec<Vec<f64>>,
    goal: Goal,
) -> Result<Vec<Pair>, O::Error> {
    let mass = operator.mass().to_vec();
    let mut block = TrialSpace::default();
    for vector in start {
        block.extend(operator, vector)?;
    }
    let width = block.vectors.len();
    let count = goal.count.min(width);
    if count == 0 {
        return Ok(Vec::new());
    }
    let (mut values, factors) = block.ritz();
    block = block.combined(0, &factors);
    let mut previous = TrialSpace::default();
    for _ in 0..goal.iterations {
        let residuals: Vec<_> = (0..width)
            .map(|k| residual(&mass, values[k], &block.vectors[k], &block.images[k]))
            .collect();
        if residuals[..count]
            .iter()
            .all(|(_, size)| *size <= goal.residual)
        {
            break;
        }
        let mut basis = block.clone();
        for (vector, image) in previous.vectors.drain(..).zip(previous.images.drain(..)) {
            if let Some([vector, image]) = basis.independent(&mass, vector, image) {
                basis.vectors.push(vector);
                basis.images.push(image);
            }
        }
        for (field, size) in residuals {
            if size > goal.residual {
                let direction = operator.precondition(field);
                basis.extend(operator, direction)?;
            }
        }
        let (found, mut factors) = basis.ritz();
        factors.truncate(width);
        values = found;
        previous = basis.combined(width, &factors);
        block = basis.combined(0, &factors);
    }
    // Images are sums of many: once more from the vectors alone.
    let mut exact = TrialSpace::default();
    for vector in block.vectors {
        exact.extend(operator, vector)?;
    }
    let (values, factors) = exact.ritz();
    let exact = exact.combined(0, &factors);
    let fields = exact.vectors.into_iter().zip(&exact.images).zip(values);
    let pairs = fields.take(count).map(|((vector, image), value)| Pair {
        value,
        residual: residual(&mass, value, &vector, image).1,
        vector,
    });
    Ok(pairs.collect())
}

/// Eigenvalues of a symmetric matrix by rising value, and the coefficients of their vectors, by Jacobi's rotations:
/// G. H. Golub and C. F. Van Loan, Matrix Computations (2013), section 8.5.
fn symmetric_eigenvalues(mut matrix: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let count = matrix.len();
    // Rows are eigenvectors.
    let mut vectors: Vec<Vec<f64>> = (0..count)
        .map(|row| {
            (0..count)
                .map(|column| f64::from(u8::from(row == column)))
                .collect()
        })
        .collect();
    let rotate = |rows: &mut [Vec<f64>], [p, q]: [usize; 2], [cosine, sine]: [f64; 2]| {
        let (head, tail) = rows.split_at_mut(q);
        for (a, b) in head[p].iter_mut().zip(&mut tail[0]) {
            (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
        }
    };
    for _ in 0..50 {
        let mut rotated = false;
        for q in 1..count {
            for p in 0..q {
                let off = matrix[p][q];
                if off.abs() <= f64::EPSILON * (matrix[p][p] * matrix[q][q]).abs().sqrt() {
                    continue;
                }
                rotated = true;
                let half = 0.5 * (matrix[q][q] - matrix[p][p]) / off;
                let tangent = half.signum() / (half.abs() + half.hypot(1.0));
                let cosine = tangent.hypot(1.0).recip();
                let angle = [cosine, tangent * cosine];
                rotate(&mut matrix, [p, q], angle);
                for row in &mut matrix {
                    let (a, b) = (row[p], row[q]);
                    row[p] = cosine * a - tangent * cosine * b;
                    row[q] = tangent * cosine * a + cosine * b;
                }
                rotate(&mut vectors, [p, q], angle);
            }
        }
        if !rotated {
            break;
        }
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| matrix[a][a].total_cmp(&matrix[b][b]));
    let values = order.iter().map(|&k| matrix[k][k]).collect();
    let vectors = order
        .iter()
        .map(|&k| std::mem::take(&mut vectors[k]))
        .collect();
    (values, vectors)
}

#[cfg(test)]
mod tests {
    use super::{Goal, Operator, smallest};
    use std::convert::Infallible;
    use std::f64::consts::PI;

    /// A string of masses on springs, fixed at both ends, with a negative shift of all eigenvalues.
    struct Chain {
        mass: Vec<f64>,
        shift: f64,
    }

    impl Operator for Chain {
        type Error = Infallible;

        fn apply(&mut self, vector: &[f64]) -> Result<Vec<f64>, Infallible> {
            let at = |k: usize| vector.get(k).copied().unwrap_or(0.0);
            let entry = |k: usize| {
                let before = if k == 0 { 0.0 } else { at(k - 1) };
                2.0 * at(k) - before - at(k + 1) - self.shift * self.mass[k] * at(k)
            };
            Ok((0..vector.len()).map(entry).collect())
        }

        fn precondition(&mut self, residual: Vec<f64>) -> Vec<f64> {
            // Thomas's algorithm for the operator without the shift.
            let count = residual.len();
            let (mut upper, mut solved) = (vec![0.0; count], residual);
            for k in 0..count {
                let before = if k == 0 {
                    [0.0; 2]
                } else {
                    [upper[k - 1], solved[k - 1]]
                };
                let pivot = 2.0 + before[0];
                upper[k] = -1.0 / pivot;
                solved[k] = (solved[k] + before[1]) / pivot;
            }
            for k in (0..count - 1).rev() {
                solved[k] -= upper[k] * solved[k + 1];
            }
            solved
        }

        fn mass(&self) -> &[f64] {
            &self.mass
        }
    }

    #[test]
    fn a_chain_has_the_eigenvalues_of_its_formula() {
        let (count, mass, shift) = (200, 0.5, 1e-3);
        let mut chain = Chain {
            mass: vec![mass; count],
            shift,
        };
        let start = (0..9).map(|j| {
            let entry = |k: usize| ((k * k * (j + 1) + 7 * k) as f64).sin();
            (0..count).map(entry).collect()
        });
        let goal = Goal {
            count: 6,
            residual: 1e-10,
            iterations: 60,
        };
        let Ok(found) = smallest(&mut chain, start.collect(), goal);
        assert_eq!(found.len(), 6);
        for (k, pair) in found.iter().enumerate() {
            let wave = 0.5 * PI * (k + 1) as f64 / (count + 1) as f64;
            let expected = 4.0 * wave.sin().powi(2) / mass - shift;
            assert!(
                (pair.value - expected).abs() < 1e-10,
                "{k}: {} {expected}",
                pair.value
            );
            assert!(pair.residual < 1e-9, "{k}: {}", pair.residual);
        }
        assert!(found[0].value < 0.0);
    }
}
