//! Trees of clusters of points, each with the nodes on which functions are interpolated.

use super::interpolation::Grid;
use glam::{DMat3, DVec3};
use helfrich_execute::execute::in_two;
use std::ops::Range;

/// Points in a box along their principal axes.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    /// The points, as a range of [`Tree::order`].
    pub(super) points: Range<usize>,
    pub(super) centre: DVec3,
    /// The largest distance of a point from the centre.
    pub(super) radius: f64,
    /// The distance from the centre within which triangles of the points need better integrals than
    /// sums over points.
    pub(super) reach: f64,
    /// The sum of the squares of the points' reaches.
    pub(super) squared_reaches: f64,
    /// The nodes in the box; `None` if there are at least as many nodes as points.
    pub(super) grid: Option<Grid>,
    /// Number of clusters below this one.
    below: usize,
}

/// Points, halved again and again across their longest axis.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    /// The points of each cluster in succession.
    pub(super) order: Vec<u32>,
    /// Each cluster before those below it.
    pub(super) clusters: Vec<Cluster>,
}

impl Tree {
    /// Clusters of at most `most` points, with nodes for an interpolation of this relative error. Each
    /// point comes with its reach.
    pub(super) fn new(
        points: &(impl Fn(usize) -> (DVec3, f64) + Sync),
        count: usize,
        most: usize,
        error: f64,
        threads: usize,
    ) -> Self {
        let mut order: Vec<u32> = (0..count as u32).collect();
        let division = Division {
            points,
            most,
            error,
        };
        let clusters = division.divide(&mut order, 0, threads);
        Self { order, clusters }
    }

    /// The two clusters into which a cluster is divided; `None` for a leaf.
    pub(super) fn children(&self, cluster: usize) -> Option<[usize; 2]> {
        if self.clusters[cluster].below == 0 {
            return None;
        }
        let first = cluster + 1;
        Some([first, first + 1 + self.clusters[first].below])
    }

    /// The cluster and those below it.
    pub(super) fn family(&self, cluster: usize) -> Range<usize> {
        cluster..cluster + 1 + self.clusters[cluster].below
    }
}

struct Division<'a, P> {
    points: &'a P,
    most: usize,
    error: f64,
}

impl<P: Fn(usize) -> (DVec3, f64) + Sync> Division<'_, P> {
    /// The cluster of these points and all clusters below it; `first` is the number of points before
    /// these.
    fn divide(&self, order: &mut [u32], first: usize, threads: usize) -> Vec<Cluster> {
        let (points, reaches): (Vec<_>, Vec<_>) = order
            .iter()
            .map(|&point| (self.points)(point as usize))
            .unzip();
        let axes = principal_axes(&points);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &point in &points {
            let along = axes.transpose() * point;
            (low, high) = (low.min(along), high.max(along));
        }
        let half = 0.5 * (high - low);
        let centre = axes * (low + half);
        // If a coordinate is NaN, so is the centre, and the cluster is then not apart from any other.
        let [mut radius, mut most_reach, mut squared_reaches] = [0.0_f64; 3];
        for (point, reach) in points.iter().zip(reaches) {
            let distance = point.distance(centre);
            (radius, most_reach) = (radius.max(distance), most_reach.max(distance + reach));
            squared_reaches += reach * reach;
        }
        let mut clusters = vec![Cluster {
            points: first..first + order.len(),
            centre,
            radius,
            reach: most_reach,
            squared_reaches,
            grid: Grid::new(centre, axes, half, radius, self.error)
                .filter(|grid| 2 * grid.len() <= order.len()),
            below: 0,
        }];
        if order.len() > self.most {
            let longest = axes.col(half.max_position());
            let along = points.iter().map(|point| point.dot(longest));
            let mut keyed: Vec<(f64, u32)> = along.zip(order.iter().copied()).collect();
            let middle = order.len() / 2;
            // Equal coordinates are in the order of the points.
            keyed.select_nth_unstable_by(middle, |one, other| {
                one.0.total_cmp(&other.0).then(one.1.cmp(&other.1))
            });
            for (place, (_, point)) in order.iter_mut().zip(keyed) {
                *place = point;
            }
            let (left, right) = order.split_at_mut(middle);
            let [left, right] = in_two(
                threads,
                |threads| self.divide(left, first, threads),
                |threads| self.divide(right, first + middle, threads),
            );
            clusters[0].below = left.len() + right.len();
            clusters.extend(left);
            clusters.extend(right);
        }
        clusters
    }
}

/// The principal axes of points, as columns, by Jacobi's rotations of their covariance.
fn principal_axes(points: &[DVec3]) -> DMat3 {
    let mean = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut covariance = [[0.0; 3]; 3];
    for &point in points {
        let from = (point - mean).to_array();
        for row in 0..3 {
            for column in 0..3 {
                covariance[row][column] += from[row] * from[column];
            }
        }
    }
    let mut axes = DMat3::IDENTITY.to_cols_array_2d();
    // Rotations converge quadratically; boxes need a few digits of their axes.
    for [p, q] in [[0, 1], [0, 2], [1, 2]].repeat(4) {
        let off = covariance[p][q];
        if off == 0.0 {
            continue;
        }
        let cotangent = (covariance[q][q] - covariance[p][p]) / (2.0 * off);
        let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
        let cosine = tangent.hypot(1.0).recip();
        let sine = tangent * cosine;
        for row in &mut covariance {
            (row[p], row[q]) = (
                cosine * row[p] - sine * row[q],
                sine * row[p] + cosine * row[q],
            );
        }
        let [one, other] = [covariance[p], covariance[q]];
        for k in 0..3 {
            covariance[p][k] = cosine * one[k] - sine * other[k];
            covariance[q][k] = sine * one[k] + cosine * other[k];
        }
        let [one, other] = [axes[p], axes[q]];
        for k in 0..3 {
            axes[p][k] = cosine * one[k] - sine * other[k];
            axes[q][k] = sine * one[k] + cosine * other[k];
        }
    }
    DMat3::from_cols_array_2d(&axes)
}

#[cfg(test)]
mod tests {
    use super::principal_axes;
    use glam::{DMat3, DVec3};

    /// Without their mean, coordinates along principal axes have no mean product: boxes along them are tight.
    #[test]
    fn coordinates_along_principal_axes_are_uncorrelated() {
        let (tilt, turn) = (DMat3::from_rotation_x(0.4), DMat3::from_rotation_z(1.1));
        // A slab, over which multiples of the roots are spread evenly.
        let points = Vec::from_iter((0..200).map(|k| {
            let step = f64::from(k);
            let [x, y, z] = [2.0, 3.0, 5.0].map(|n| (f64::sqrt(n) * step).fract() - 0.5);
            tilt * turn * DVec3::new(3.0 * x, y, 0.1 * z) + DVec3::new(5.0, -2.0, 1.0)
        }));
        let axes = principal_axes(&points);
        let mean = points.iter().sum::<DVec3>() / points.len() as f64;
        let product = |p: usize, q: usize| {
            let along = points
                .iter()
                .map(|point| axes.transpose() * (*point - mean));
            let products = along.map(|along| along.to_array()[p] * along.to_array()[q]);
            products.sum::<f64>() / points.len() as f64
        };
        let size = (0..3).map(|p| product(p, p)).sum::<f64>();
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
            let off = product(p, q).abs();
            assert!(off < 1e-9 * size, "{p} and {q}: {off:e} of {size:e}");
        }
    }
}
