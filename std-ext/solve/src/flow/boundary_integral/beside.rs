//! Adjacent triangles, as corrections of sums over the midpoints of edges.

use super::kernel::{Kernel, Units, splat};
use super::panel::seven_points;
use crate::flow::vectors::{Vector, Vectors};
use pulp::{Arch, Simd, WithSimd};

/// Number of points of a triangle: seven, and three midpoints of edges.
const COUNT: usize = 10;

/// A multiple of every width of vectors.
const LANES: usize = 16;

/// The rule of seven points of a triangle minus that of the midpoints of its edges.
#[derive(Debug)]
pub(super) struct Rule<T> {
    /// Barycentric coordinates of the points, one per lane.
    shares: [[T; LANES]; 3],
    /// The last lanes have weight zero.
    weights: [T; LANES],
    units: Units,
}

impl<T: Vectors> Rule<T> {
    pub(super) fn new(units: Units) -> Self {
        let middle = |opposite| std::array::from_fn(|k| if k == opposite { 0.0 } else { 0.5 });
        let middles = [0, 1, 2].map(|opposite| (middle(opposite), -1.0 / 3.0));
        let mut points = Vec::from(seven_points());
        points.extend(middles);
        points.resize(LANES, ([1.0, 0.0, 0.0], 0.0));
        let share = |corner, lane: usize| T::constant(points[lane].0[corner]);
        Self {
            shares: [0, 1, 2].map(|corner| std::array::from_fn(|lane| share(corner, lane))),
            weights: std::array::from_fn(|lane| T::constant(points[lane].1)),
            units,
        }
    }

    /// The numbers of the corners of a triangle, in units.
    pub(super) fn of<const SOURCE: usize>(&self, corners: [[f64; SOURCE]; 3]) -> [[T; SOURCE]; 3] {
        corners.map(|corner| self.units.within([0.0; 3], &corner))
    }

    /// The sum over these triangles of the integral by seven points minus that by midpoints of edges.
    ///
    /// A triangle is given by its three corners in units, each with the numbers of a source relative to the target,
    /// multiplied by the area. All numbers are linear on it, and the kernel is linear in the last three.
    pub(super) fn corrections<K, const TARGET: usize, const SOURCE: usize, const SUM: usize>(
        &self,
        kernel: K,
        triangles: &[[[T; SOURCE]; 3]],
    ) -> [f64; SUM]
    where
        K: Kernel<T, TARGET, SOURCE, SUM>,
    {
        let mut sums = [[T::zero(); LANES]; SUM];
        Arch::new().dispatch(Task {
            kernel,
            rule: self,
            triangles,
            sums: &mut sums,
        });
        sums.map(|lanes| {
            self.units.of_sum
                * lanes
                    .iter()
                    .map(|lane| lane.to_f64().unwrap_or(f64::NAN))
                    .sum::<f64>()
        })
    }
}

struct Task<'a, T, K, const SOURCE: usize, const SUM: usize, const TARGET: usize> {
    kernel: K,
    rule: &'a Rule<T>,
    triangles: &'a [[[T; SOURCE]; 3]],
    sums: &'a mut [[T; LANES]; SUM],
}

impl<T, K, const TARGET: usize, const SOURCE: usize, const SUM: usize> WithSimd
    for Task<'_, T, K, SOURCE, SUM, TARGET>
where
    T: Vectors,
    K: Kernel<T, TARGET, SOURCE, SUM>,
{
    type Output = ();

    // Each lane has its own sum, so that the result does not depend on the width of vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let shares = (self.rule.shares.each_ref()).map(|shares| T::rows::<S>(shares).0);
        let weights = T::rows::<S>(&self.rule.weights).0;
        let zero = Vector::splat(simd, T::zero());
        for k in 0..COUNT.div_ceil(LANES / weights.len()) {
            let mut share = [zero; 3];
            for corner in 0..3 {
                share[corner] = Vector::new(simd, shares[corner][k]);
            }
            let weight = Vector::new(simd, weights[k]);
            let mut sum = [zero; SUM];
            for [a, b, c] in self.triangles {
                let (a, b, c) = (splat(simd, *a), splat(simd, *b), splat(simd, *c));
                let mut source = [zero; SOURCE];
                for axis in 0..SOURCE {
                    let last = share[1].times_plus(b[axis], share[2] * c[axis]);
                    source[axis] = share[0].times_plus(a[axis], last);
                }
                for number in &mut source[SOURCE - 3..] {
                    *number = weight * *number;
                }
                sum = self.kernel.add([zero; TARGET], source, sum);
            }
            for (lanes, sum) in self.sums.iter_mut().zip(sum) {
                T::rows_mut::<S>(lanes).0[k] = sum.entries();
            }
        }
    }
}
