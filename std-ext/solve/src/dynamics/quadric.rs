//! The quadric through a vertex that fits its neighbours.

use super::vector::{self, Vector};
use helfrich::TriangleMesh;

/// Heights `h = p u + q v + r u² + s u v + t v²` over the plane of two axes through a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadric {
    axes: [Vector; 3],
    /// p to t, of lengths in units of `unit`, the root mean square of the edges.
    coefficients: [f64; TERMS],
    unit: f64,
}

impl Quadric {
    /// The least-squares fit to the neighbours over the first two of three orthonormal axes, with
    /// the third near the normal. With three or four neighbours this is the flattest quadric that
    /// fits; without neighbours it is flat.
    pub(crate) fn fit(
        mesh: &TriangleMesh,
        positions: &[Vector],
        vertex: usize,
        axes: [Vector; 3],
    ) -> Self {
        let ring = mesh.one_ring(vertex);
        let edge = |&neighbour: &u32| vector::sub(positions[neighbour as usize], positions[vertex]);
        let squares: f64 = ring
            .iter()
            .map(edge)
            .map(|edge| vector::dot(edge, edge))
            .sum();
        let unit = (squares / ring.len() as f64).sqrt();
        if ring.is_empty() || unit == 0.0 {
            let coefficients = [0.0; TERMS];
            let unit = 1.0;
            return Self {
                axes,
                coefficients,
                unit,
            };
        }
        // Normal equations, the right-hand side as the last column.
        let mut equations = [[0.0; TERMS + 1]; TERMS];
        for edge in ring.iter().map(edge) {
            let [u, v, height] = axes.map(|axis| vector::dot(edge, axis) / unit);
            let row = [u, v, u * u, u * v, v * v, height];
            for (equation, &term) in equations.iter_mut().zip(&row) {
                for (entry, &other) in equation.iter_mut().zip(&row) {
                    *entry += term * other;
                }
            }
        }
        for (term, equation) in equations.iter_mut().enumerate() {
            equation[term] += UNDECIDED;
        }
        Self {
            axes,
            coefficients: solve(equations),
            unit,
        }
    }

    /// The height at a distance from the vertex along the first axis.
    pub(crate) fn height(&self, way: f64) -> f64 {
        let share = way / self.unit;
        self.unit * share * (self.coefficients[0] + self.coefficients[2] * share)
    }

    /// The unit normal at the vertex, on the side of the third axis: `(−p, −q, 1)` in the axes.
    pub(crate) fn normal(&self) -> Vector {
        let [first, second, third] = self.axes;
        let slopes = [
            vector::scale(self.coefficients[0], first),
            vector::scale(self.coefficients[1], second),
        ];
        vector::unit(vector::sub(third, vector::add(slopes[0], slopes[1])))
    }
}

/// Coefficients of a quadric through its origin.
const TERMS: usize = 5;

/// The shift of normal equations whose entries are of order 1: few neighbours leave a quadric
/// undetermined.
const UNDECIDED: f64 = 1e-6;

/// Solves positive definite equations by elimination.
fn solve(mut equations: [[f64; TERMS + 1]; TERMS]) -> [f64; TERMS] {
    for pivot in 0..TERMS {
        let row = equations[pivot];
        for equation in &mut equations[pivot + 1..] {
            let factor = equation[pivot] / row[pivot];
            for (entry, above) in equation.iter_mut().zip(&row) {
                *entry -= factor * above;
            }
        }
    }
    let mut solution = [0.0; TERMS];
    for pivot in (0..TERMS).rev() {
        let row = equations[pivot];
        let known = vector::product(&row[..TERMS], &solution);
        solution[pivot] = (row[TERMS] - known) / row[pivot];
    }
    solution
}
