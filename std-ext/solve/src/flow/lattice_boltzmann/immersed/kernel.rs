//! Kernels that spread a point over the nodes around it.

use serde::{Deserialize, Serialize};
use std::array;

/// The kernel that spreads a point over the nodes around it: a product φ(x) φ(y) φ(z) of the
/// distances along the axes.
///
/// Every kernel satisfies Σ φ = 1 and Σ r φ = 0 over the nodes for every point, so that forces and
/// torques are conserved, and linear fields are interpolated exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// 1 − |r|: linear interpolation. The sharpest; edges of membranes at most 1.5 nodes long.
    Two,
    /// Continuously differentiable, with Σ φ² = 1/2.
    Three,
    /// Continuously differentiable, with Σ φ² = 3/8, and as much on even nodes as on odd ones.
    Four,
}

impl Kernel {
    /// Number of nodes along each axis.
    pub fn points(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
            Self::Four => 4,
        }
    }

    /// φ at a distance in units of the distance of nodes; 0 beyond half of [`Self::points`].
    pub fn weight(self, distance: f64) -> f64 {
        let r = distance.abs();
        match self {
            Self::Two => (1.0 - r).max(0.0),
            Self::Three if r <= 0.5 => (1.0 + (1.0 - 3.0 * r * r).sqrt()) / 3.0,
            Self::Three if r <= 1.5 => {
                let s = 1.0 - r;
                (5.0 - 3.0 * r - (1.0 - 3.0 * s * s).sqrt()) / 6.0
            }
            Self::Four if r <= 1.0 => (3.0 - 2.0 * r + (1.0 + 4.0 * r * (1.0 - r)).sqrt()) / 8.0,
            Self::Four if r <= 2.0 => {
                let squared = 12.0 * r - 7.0 - 4.0 * r * r;
                (5.0 - 2.0 * r - squared.sqrt()) / 8.0
            }
            Self::Three | Self::Four => 0.0,
        }
    }

    /// The first node that a coordinate reaches.
    pub(super) fn first(self, coordinate: f64) -> f64 {
        match self {
            Self::Two => (coordinate - 0.5).floor(),
            Self::Three => coordinate.floor() - 1.0,
            Self::Four => (coordinate - 0.5).floor() - 1.0,
        }
    }

    /// [`Self::weight`] at the first node that a coordinate reaches, and at those that follow: one square root serves all
    /// of them.
    pub(super) fn weights(self, coordinate: f64, first: f64) -> [f64; 4] {
        match self {
            Self::Two => {
                let r = coordinate - 0.5 - first;
                [1.0 - r, r, 0.0, 0.0]
            }
            Self::Three => {
                let r = coordinate - 0.5 - (first + 1.0);
                let root = (1.0 - 3.0 * r * r).sqrt();
                let [before, after] = [-r, r].map(|r| (2.0 + 3.0 * r - root) / 6.0);
                [before, (1.0 + root) / 3.0, after, 0.0]
            }
            Self::Four => {
                let r = coordinate - 0.5 - (first + 1.0);
                let root = (1.0 + 4.0 * r * (1.0 - r)).sqrt();
                let [far, near] = [-root, root].map(|root| (3.0 - 2.0 * r + root) / 8.0);
                let [after_near, after_far] =
                    [root, -root].map(|root| (1.0 + 2.0 * r + root) / 8.0);
                [far, near, after_near, after_far]
            }
        }
    }
}

/// The nodes of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stencil {
    /// The first along each axis, in the lattice.
    pub(super) first: [usize; 3],
    pub(super) weights: [[f64; 4]; 3],
}

impl Stencil {
    /// The nodes along each axis.
    pub(super) fn nodes<const POINTS: usize>(&self, cells: [usize; 3]) -> [[usize; POINTS]; 3] {
        array::from_fn(|axis| {
            array::from_fn(|k| {
                let mut node = self.first[axis] + k;
                // Once at most, but on an axis with fewer nodes than the kernel; no division.
                while node >= cells[axis] {
                    node -= cells[axis];
                }
                node
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Kernel;

    #[test]
    fn weights_of_a_coordinate_are_those_of_distances() {
        for kernel in [Kernel::Two, Kernel::Three, Kernel::Four] {
            for step in -40..=40 {
                let coordinate = 0.025 * f64::from(step);
                let first = kernel.first(coordinate);
                let weights = kernel.weights(coordinate, first);
                for (k, found) in weights.into_iter().enumerate() {
                    let expected = match k < kernel.points() {
                        true => kernel.weight(coordinate - 0.5 - (first + k as f64)),
                        false => 0.0,
                    };
                    assert!(
                        (found - expected).abs() < 4.0 * f64::EPSILON,
                        "{kernel:?} at {coordinate}, node {k}: found {found}, expected {expected}"
                    );
                }
            }
        }
    }
}
