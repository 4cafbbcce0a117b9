//! Contributions of a point source at a point, with r from the point to the source. Coinciding points
//! contribute zero.

use glam::DVec3;
use pulp::{Scalar, Simd};

/// The contribution of one source to a vector of targets.
///
/// The numbers of a target begin with its position, and so do those of a source.
pub(super) trait Kernel<const TARGET: usize, const SOURCE: usize, const SUM: usize>:
    Copy + Sync
{
    /// `sum` with it.
    // No closures here, because they would be compiled without the target features of the caller.
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; TARGET],
        source: &[f64; SOURCE],
        sum: [S::f64s; SUM],
    ) -> [S::f64s; SUM];

    /// The same for one target.
    fn one(self, target: [f64; TARGET], source: &[f64; SOURCE]) -> [f64; SUM] {
        self.add(Scalar, target, source, [0.0; SUM])
    }
}

/// The numbers of a source or a target.
pub(super) fn source<const N: usize>(vectors: &[DVec3]) -> [f64; N] {
    std::array::from_fn(|k| vectors[k / 3][k % 3])
}

/// `f/r + r (r·f)/r³`, the source being x, f.
#[derive(Clone, Copy)]
pub(super) struct Stokeslet;

/// `r·f/r³`, the source being x, f.
#[derive(Clone, Copy)]
pub(super) struct Gradient;

/// `r (r·n) (r·(u − u₀))/r⁵`, the target being x₀, u₀ and the source x, n, u.
#[derive(Clone, Copy)]
pub(super) struct Stresslet;

/// `3 (r·n) (r·u)/r⁵ − n·u/r³`, the source being x, n, u.
#[derive(Clone, Copy)]
pub(super) struct StressletPressure;

/// `r·n/r³`, the source being x, n, u.
#[derive(Clone, Copy)]
pub(super) struct SolidAngle;

impl Kernel<3, 6, 3> for Stokeslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; 3],
        source: &[f64; 6],
        [u, v, w]: [S::f64s; 3],
    ) -> [S::f64s; 3] {
        let [x, y, z, f, g, h] = *source;
        let f = splat(simd, [f, g, h]);
        let r = difference(simd, splat(simd, [x, y, z]), target);
        let [over, over_squared] = reciprocals(simd, dot(simd, r, r));
        let along = simd.mul_f64s(dot(simd, r, f), over_squared);
        [
            simd.mul_add_e_f64s(over, simd.mul_add_e_f64s(along, r[0], f[0]), u),
            simd.mul_add_e_f64s(over, simd.mul_add_e_f64s(along, r[1], f[1]), v),
            simd.mul_add_e_f64s(over, simd.mul_add_e_f64s(along, r[2], f[2]), w),
        ]
    }
}

impl Kernel<3, 6, 1> for Gradient {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; 3],
        source: &[f64; 6],
        [sum]: [S::f64s; 1],
    ) -> [S::f64s; 1] {
        let [x, y, z, f, g, h] = *source;
        let f = splat(simd, [f, g, h]);
        let r = difference(simd, splat(simd, [x, y, z]), target);
        let [over, over_squared] = reciprocals(simd, dot(simd, r, r));
        let over_cube = simd.mul_f64s(over, over_squared);
        [simd.mul_add_e_f64s(over_cube, dot(simd, r, f), sum)]
    }
}

impl Kernel<6, 9, 3> for Stresslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; 6],
        source: &[f64; 9],
        [a, b, c]: [S::f64s; 3],
    ) -> [S::f64s; 3] {
        let [x, y, z, k, l, m, u, v, w] = *source;
        let [x0, y0, z0, u0, v0, w0] = target;
        let r = difference(simd, splat(simd, [x, y, z]), [x0, y0, z0]);
        let u = difference(simd, splat(simd, [u, v, w]), [u0, v0, w0]);
        let [over, over_squared] = reciprocals(simd, dot(simd, r, r));
        // Each factor has its own reciprocal, because powers of r alone may overflow.
        let through = simd.mul_f64s(dot(simd, r, splat(simd, [k, l, m])), over_squared);
        let along = simd.mul_f64s(dot(simd, r, u), over_squared);
        let factor = simd.mul_f64s(simd.mul_f64s(through, along), over);
        [
            simd.mul_add_e_f64s(factor, r[0], a),
            simd.mul_add_e_f64s(factor, r[1], b),
            simd.mul_add_e_f64s(factor, r[2], c),
        ]
    }
}

impl Kernel<3, 9, 1> for StressletPressure {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; 3],
        source: &[f64; 9],
        [sum]: [S::f64s; 1],
    ) -> [S::f64s; 1] {
        let [x, y, z, k, l, m, u, v, w] = *source;
        let (n, u) = (splat(simd, [k, l, m]), splat(simd, [u, v, w]));
        let r = difference(simd, splat(simd, [x, y, z]), target);
        let [over, over_squared] = reciprocals(simd, dot(simd, r, r));
        let through = simd.mul_f64s(dot(simd, r, n), over_squared);
        let thrice = simd.mul_f64s(simd.splat_f64s(3.0), dot(simd, r, u));
        let outward = simd.neg_f64s(dot(simd, n, u));
        let both = simd.mul_add_e_f64s(thrice, through, outward);
        let over_cube = simd.mul_f64s(over, over_squared);
        [simd.mul_add_e_f64s(over_cube, both, sum)]
    }
}

impl Kernel<3, 9, 1> for SolidAngle {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; 3],
        source: &[f64; 9],
        sum: [S::f64s; 1],
    ) -> [S::f64s; 1] {
        let [x, y, z, k, l, m, _, _, _] = *source;
        Gradient.add(simd, target, &[x, y, z, k, l, m], sum)
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, [x, y, z]: [f64; 3]) -> [S::f64s; 3] {
    [simd.splat_f64s(x), simd.splat_f64s(y), simd.splat_f64s(z)]
}

#[inline(always)]
fn difference<S: Simd>(simd: S, a: [S::f64s; 3], b: [S::f64s; 3]) -> [S::f64s; 3] {
    [
        simd.sub_f64s(a[0], b[0]),
        simd.sub_f64s(a[1], b[1]),
        simd.sub_f64s(a[2], b[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: [S::f64s; 3], b: [S::f64s; 3]) -> S::f64s {
    let last = simd.mul_f64s(a[2], b[2]);
    simd.mul_add_e_f64s(a[0], b[0], simd.mul_add_e_f64s(a[1], b[1], last))
}

/// `1/r` and `1/r²` by r², and 0 for 0.
#[inline(always)]
fn reciprocals<S: Simd>(simd: S, squared: S::f64s) -> [S::f64s; 2] {
    // The reciprocal and the root are independent, so that neither waits for the other.
    let over_squared = simd.div_f64s(simd.splat_f64s(1.0), squared);
    let apart = simd.greater_than_or_equal_f64s(squared, simd.splat_f64s(f64::MIN_POSITIVE));
    let over_squared = simd.select_f64s(apart, over_squared, simd.splat_f64s(0.0));
    let over = simd.mul_f64s(over_squared, simd.sqrt_f64s(squared));
    [over, over_squared]
}
