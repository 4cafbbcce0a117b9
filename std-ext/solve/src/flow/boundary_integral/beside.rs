//! Adjacent triangles, as corrections of sums over the midpoints of edges.

use super::kernel::{Kernel, splat};
use super::panel::seven_points;
use pulp::{Arch, Simd, WithSimd};
use std::sync::LazyLock;

/// Number of points of a triangle: seven, and three midpoints of edges.
const COUNT: usize = 10;

/// A multiple of every width of vectors.
const LANES: usize = 16;

/// The points of a triangle, one per lane: their barycentric coordinates, and their weights.
struct Points {
    shares: [[f64; LANES]; 3],
    weights: [f64; LANES],
}

/// The rule of seven points minus that of the midpoints of the edges. The last lanes have weight zero.
static POINTS: LazyLock<Points> = LazyLock::new(|| {
    let middle = |opposite| std::array::from_fn(|k| if k == opposite { 0.0 } else { 0.5 });
    let middles = [0, 1, 2].map(|opposite| (middle(opposite), -1.0 / 3.0));
    let mut points = Vec::from(seven_points());
    points.extend(middles);
    points.resize(LANES, ([1.0, 0.0, 0.0], 0.0));
    Points {
        shares: [0, 1, 2].map(|corner| std::array::from_fn(|lane| points[lane].0[corner])),
        weights: std::array::from_fn(|lane| points[lane].1),
    }
});

/// The sum over these triangles of the integral by seven points minus that by midpoints of edges.
///
/// A triangle is given by its three corners, each with the numbers of a source relative to the target,
/// multiplied by the area. All numbers are linear on it, and the kernel is linear in the last three.
pub(super) fn corrections<K, const TARGET: usize, const SOURCE: usize, const SUM: usize>(
    kernel: K,
    triangles: &[[[f64; SOURCE]; 3]],
) -> [f64; SUM]
where
    K: Kernel<TARGET, SOURCE, SUM>,
{
    let mut sums = [[0.0; LANES]; SUM];
    Arch::new().dispatch(Task {
        kernel,
        points: &POINTS,
        triangles,
        sums: &mut sums,
    });
    sums.map(|lanes| lanes.iter().sum())
}

struct Task<'a, K, const SOURCE: usize, const SUM: usize, const TARGET: usize> {
    kernel: K,
    points: &'a Points,
    triangles: &'a [[[f64; SOURCE]; 3]],
    sums: &'a mut [[f64; LANES]; SUM],
}

impl<K, const TARGET: usize, const SOURCE: usize, const SUM: usize> WithSimd
    for Task<'_, K, SOURCE, SUM, TARGET>
where
    K: Kernel<TARGET, SOURCE, SUM>,
{
    type Output = ();

    // Each lane has its own sum, so that the result does not depend on the width of vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [one, two, three] = &self.points.shares;
        let one = S::as_simd_f64s(one).0;
        let two = S::as_simd_f64s(two).0;
        let three = S::as_simd_f64s(three).0;
        let weights = S::as_simd_f64s(&self.points.weights).0;
        let zero = simd.splat_f64s(0.0);
        for k in 0..COUNT.div_ceil(S::F64_LANES) {
            let mut sum = [zero; SUM];
            for [a, b, c] in self.triangles {
                let (a, b, c) = (splat(simd, *a), splat(simd, *b), splat(simd, *c));
                let mut source = [zero; SOURCE];
                for axis in 0..SOURCE {
                    let last = simd.mul_f64s(three[k], c[axis]);
                    let last = simd.mul_add_e_f64s(two[k], b[axis], last);
                    source[axis] = simd.mul_add_e_f64s(one[k], a[axis], last);
                }
                for number in &mut source[SOURCE - 3..] {
                    *number = simd.mul_f64s(weights[k], *number);
                }
                sum = self.kernel.add(simd, [zero; TARGET], source, sum);
            }
            for (lanes, sum) in self.sums.iter_mut().zip(sum) {
                S::as_mut_simd_f64s(lanes).0[k] = sum;
            }
        }
    }
}
