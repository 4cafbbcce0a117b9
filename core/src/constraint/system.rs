//! The small system of linear equations of one component's constraints.

use crate::element::Execution;
use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::dot;
use alloc::vec::Vec;

/// The equations of one component, for unit gradients: their scalar products on the left.
#[derive(Clone, Debug, Default)]
pub(super) struct System<T> {
    matrix: Vec<T>,
    /// The matrix after elimination.
    reduced: Vec<T>,
    /// The right-hand side, then the solution.
    pub(super) right: Vec<T>,
    /// One over the gradients' lengths; 0 for one without.
    pub(super) over_norms: Vec<T>,
    solved: Vec<bool>,
}

impl<T: Real> System<T> {
    /// Sets the matrix, and allocates the right-hand side.
    pub(super) fn set_matrix(
        &mut self,
        execution: &impl Execution,
        vertices: &[[u32; 1]],
        gradients: &[[T; 3]],
        count: usize,
    ) {
        let all = gradients.len() / count.max(1);
        let product = |j: usize, k: usize| {
            execution.sum(vertices.len(), |at| {
                let vertex = vertices[at][0] as usize;
                dot(gradients[j * all + vertex], gradients[k * all + vertex])
            })
        };
        self.right.resize(count, T::zero());
        self.over_norms.clear();
        let over = |k| product(k, k).sqrt().reciprocal_or_zero();
        self.over_norms.extend((0..count).map(over));
        self.matrix.resize(count * count, T::zero());
        for j in 0..count {
            for k in 0..=j {
                let cosine = product(j, k) * self.over_norms[j] * self.over_norms[k];
                self.matrix[j * count + k] = cosine;
                self.matrix[k * count + j] = cosine;
            }
        }
    }

    /// Solves by elimination in rows and columns, the largest pivot first; a pivot is sin² of the
    /// angle between a gradient and the span of those before. Unknowns whose pivot is not above
    /// `least` are 0; the first of them is returned.
    pub(super) fn solve(&mut self, least: T) -> Option<usize> {
        let count = self.right.len();
        let Self {
            matrix,
            reduced,
            right,
            solved,
            ..
        } = self;
        reduced.clone_from(matrix);
        solved.clear();
        solved.resize(count, false);
        let mut lost = None;
        for _ in 0..count {
            let left = (0..count).filter(|&k| !solved[k]);
            let larger = |best: usize, k: usize| {
                if reduced[k * count + k] > reduced[best * count + best] {
                    k
                } else {
                    best
                }
            };
            let Some(pivot) = left.reduce(larger) else {
                break;
            };
            let over = reduced[pivot * count + pivot];
            if over <= least || over.is_nan() {
                lost = Some(pivot);
                break;
            }
            solved[pivot] = true;
            for row in (0..count).filter(|&row| row != pivot) {
                let factor = reduced[row * count + pivot] / over;
                for column in 0..count {
                    let part = factor * reduced[pivot * count + column];
                    reduced[row * count + column] -= part;
                }
                let part = factor * right[pivot];
                right[row] -= part;
            }
        }
        for k in 0..count {
            right[k] = if solved[k] {
                right[k] / reduced[k * count + k]
            } else {
                T::zero()
            };
        }
        lost
    }
}
