//! Interpolation of smooth functions in boxes, by polynomials through Chebyshev's nodes.

use glam::{DMat3, DVec3};
use std::array;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Largest number of nodes along an axis.
const MOST: usize = 16;

/// Clusters are apart if the points of each are farther from the centre of the other than this many of
/// its radii. Larger numbers need fewer nodes and more pairs; this one is the fastest for errors from
/// 1e-3 to 1e-5.
pub(super) const SEPARATION: f64 = 1.85;

/// Chebyshev's nodes along the axes of a box.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    centre: DVec3,
    axes: DMat3,
    half: DVec3,
    /// Number of nodes along each axis.
    counts: [usize; 3],
}

/// The factors of a product of one function per axis.
pub(super) type Weights = [[f64; MOST]; 3];

/// For n nodes the value of the basis polynomial of node m as a sum of Chebyshev's polynomials:
/// `BASES[n][m][k]` is the coefficient of T_k.
static BASES: LazyLock<Vec<Vec<[f64; MOST]>>> = LazyLock::new(|| {
    let coefficient = |n: usize, m: usize, k: usize| {
        let twice = if k == 0 { 1.0 } else { 2.0 };
        twice / n as f64 * (k as f64 * angle(n, m)).cos()
    };
    let row = |n, m| array::from_fn(|k| if k < n { coefficient(n, m, k) } else { 0.0 });
    let table = |n| (0..n).map(|m| row(n, m)).collect();
    (0..=MOST).map(table).collect()
});

/// Node m of n nodes, between −1 and 1: `NODES[n][m]`.
static NODES: LazyLock<Vec<[f64; MOST]>> = LazyLock::new(|| {
    let node = |n, m| if m < n { angle(n, m).cos() } else { 0.0 };
    (0..=MOST).map(|n| array::from_fn(|m| node(n, m))).collect()
});

/// The angle whose cosine is node m of n nodes.
fn angle(n: usize, m: usize) -> f64 {
    PI * (m as f64 + 0.5) / n as f64
}

impl Grid {
    /// The nodes in a box for functions with singularities at the points of clusters that are apart,
    /// such that interpolation has this error relative to the function. `None` if this needs more than
    /// the largest number of nodes.
    ///
    /// Along an axis a polynomial through n nodes has an error of ρ^−n, with ρ the sum of the half
    /// axes of the ellipse about the singularity, in units of half the box: Trefethen, Approximation
    /// Theory and Approximation Practice, SIAM 2013, chapter 8.
    pub(super) fn new(
        centre: DVec3,
        axes: DMat3,
        half: DVec3,
        radius: f64,
        error: f64,
    ) -> Option<Self> {
        let distance = SEPARATION * radius;
        let mut counts = [0; 3];
        for (count, half) in counts.iter_mut().zip(half.to_array()) {
            let relative = distance / half;
            // The nearest point of the other cluster may be on this axis.
            let ellipse = relative + (relative * relative - 1.0).sqrt();
            let nodes = (error.recip().ln() / ellipse.ln()).ceil();
            if nodes > MOST as f64 || nodes.is_nan() {
                return None;
            }
            *count = (nodes as usize).max(1);
        }
        Some(Self {
            centre,
            axes,
            half,
            counts,
        })
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// The nodes, the last axis fastest.
    pub(super) fn nodes(&self) -> impl Iterator<Item = DVec3> + '_ {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let (count, half) = (self.counts[axis], self.half[axis]);
            let (column, nodes) = (self.axes.col(axis), &NODES[count]);
            move |m: usize| half * nodes[m] * column
        });
        (0..self.len()).map(move |node| {
            let [_, rows, columns] = self.counts;
            let (plane, row, column) = (
                node / (rows * columns),
                node / columns % rows,
                node % columns,
            );
            self.centre + x(plane) + y(row) + z(column)
        })
    }

    /// The basis polynomials of all nodes at a point.
    #[inline(always)]
    pub(super) fn weights(&self, point: DVec3) -> Weights {
        let from = self.axes.transpose() * (point - self.centre);
        array::from_fn(|axis| {
            let (half, count) = (self.half[axis], self.counts[axis]);
            let over = if half.is_normal() { half.recip() } else { 0.0 };
            let x = over * from[axis];
            let mut polynomials = [0.0; MOST];
            let (mut last, mut next) = (1.0, x);
            for value in &mut polynomials[..count] {
                *value = last;
                (last, next) = (next, 2.0 * x * next - last);
            }
            let mut weights = [0.0; MOST];
            for (weight, row) in weights.iter_mut().zip(&BASES[count]) {
                let terms = row[..count].iter().zip(&polynomials[..count]);
                *weight = terms.map(|(coefficient, value)| coefficient * value).sum();
            }
            weights
        })
    }

    /// Calls `each` with every node's number and weight.
    #[inline(always)]
    pub(super) fn spread(&self, weights: &Weights, mut each: impl FnMut(usize, f64)) {
        let mut node = 0;
        for x in &weights[0][..self.counts[0]] {
            for y in &weights[1][..self.counts[1]] {
                for z in &weights[2][..self.counts[2]] {
                    each(node, x * y * z);
                    node += 1;
                }
            }
        }
    }
}
