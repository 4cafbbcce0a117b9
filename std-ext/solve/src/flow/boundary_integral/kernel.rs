//! Contributions of a point source at a point, where r is the vector from the point to the source.
//! Coinciding points contribute zero.

use glam::DVec3;
use pulp::{Scalar, Simd};

/// The contribution of one source to a vector of targets.
///
/// The numbers of a target begin with its position, as do those of a source.
pub(super) trait Kernel<const TARGET: usize, const SOURCE: usize, const SUM: usize>:
    Copy + Sync
{
    /// `sum` plus the contribution, separately in each lane.
    // No closures here, because they would be compiled without the target features of the caller.
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; TARGET],
        source: [S::f64s; SOURCE],
        sum: [S::f64s; SUM],
    ) -> [S::f64s; SUM];

    /// The same for a single target.
    fn one(self, target: [f64; TARGET], source: &[f64; SOURCE]) -> [f64; SUM] {
        self.add(Scalar, target, *source, [0.0; SUM])
    }
}

/// A kernel whose sources can be moved to nodes, and its sums interpolated between nodes.
///
/// At a distance a source acts like another one with `FAR` numbers, its moments at a point. Moments
/// contribute to the sum at a target, and to the `LOCAL` numbers of a node, from which [`Self::at`]
/// computes the sum.
pub(super) trait Expansion<
    const TARGET: usize,
    const SOURCE: usize,
    const SUM: usize,
    const FAR: usize,
    const LOCAL: usize,
>: Kernel<TARGET, SOURCE, SUM>
{
    /// The kernel of moments.
    type Distant: Kernel<TARGET, FAR, SUM> + Kernel<3, FAR, LOCAL>;

    /// The kernel of moments.
    fn distant(self) -> Self::Distant;

    /// The position of a source, and its moments, in which the kernel is linear.
    fn moments(self, source: &[f64; SOURCE]) -> [f64; FAR];

    /// The sum at a target.
    fn at(self, local: [f64; LOCAL], target: [f64; TARGET]) -> [f64; SUM];
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

/// The sum of [`Stresslet`]s at a point, from their moments.
#[derive(Clone, Copy)]
pub(super) struct DistantStresslet;

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
        source: [S::f64s; 6],
        [u, v, w]: [S::f64s; 3],
    ) -> [S::f64s; 3] {
        let [x, y, z, f, g, h] = source;
        let f = [f, g, h];
        let r = difference(simd, [x, y, z], target);
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
        source: [S::f64s; 6],
        [sum]: [S::f64s; 1],
    ) -> [S::f64s; 1] {
        let [x, y, z, f, g, h] = source;
        let f = [f, g, h];
        let r = difference(simd, [x, y, z], target);
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
        source: [S::f64s; 9],
        [a, b, c]: [S::f64s; 3],
    ) -> [S::f64s; 3] {
        let [x, y, z, k, l, m, u, v, w] = source;
        let [x0, y0, z0, u0, v0, w0] = target;
        let r = difference(simd, [x, y, z], [x0, y0, z0]);
        let u = difference(simd, [u, v, w], [u0, v0, w0]);
        let [over, over_squared] = reciprocals(simd, dot(simd, r, r));
        // Each factor has its own reciprocal, because powers of r alone may overflow.
        let through = simd.mul_f64s(dot(simd, r, [k, l, m]), over_squared);
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
        source: [S::f64s; 9],
        [sum]: [S::f64s; 1],
    ) -> [S::f64s; 1] {
        let [x, y, z, k, l, m, u, v, w] = source;
        let (n, u) = ([k, l, m], [u, v, w]);
        let r = difference(simd, [x, y, z], target);
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
        source: [S::f64s; 9],
        sum: [S::f64s; 1],
    ) -> [S::f64s; 1] {
        let [x, y, z, k, l, m, _, _, _] = source;
        Gradient.add(simd, target, [x, y, z, k, l, m], sum)
    }
}

impl Expansion<3, 6, 3, 6, 3> for Stokeslet {
    type Distant = Self;

    fn distant(self) -> Self {
        self
    }

    fn moments(self, source: &[f64; 6]) -> [f64; 6] {
        *source
    }

    fn at(self, local: [f64; 3], _target: [f64; 3]) -> [f64; 3] {
        local
    }
}

/// The moments are n and the symmetric part M of n u, in the order xx, yy, zz, yz, zx, xy, and the
/// numbers of a point `r (r·M·r)/r⁵` and `r r (r·n)/r⁵`.
impl Expansion<6, 9, 3, 12, 9> for Stresslet {
    type Distant = DistantStresslet;

    fn distant(self) -> DistantStresslet {
        DistantStresslet
    }

    fn moments(self, source: &[f64; 9]) -> [f64; 12] {
        let [x, y, z, k, l, m, u, v, w] = *source;
        let mixed = |a: f64, b: f64| 0.5 * (a + b);
        [
            x,
            y,
            z,
            k,
            l,
            m,
            k * u,
            l * v,
            m * w,
            mixed(l * w, m * v),
            mixed(m * u, k * w),
            mixed(k * v, l * u),
        ]
    }

    fn at(self, local: [f64; 9], target: [f64; 6]) -> [f64; 3] {
        let [a, b, c, xx, yy, zz, yz, zx, xy] = local;
        let [_, _, _, u, v, w] = target;
        [
            a - (xx * u + xy * v + zx * w),
            b - (xy * u + yy * v + yz * w),
            c - (zx * u + yz * v + zz * w),
        ]
    }
}

impl Kernel<6, 12, 3> for DistantStresslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        [x, y, z, u, v, w]: [S::f64s; 6],
        source: [S::f64s; 12],
        [a, b, c]: [S::f64s; 3],
    ) -> [S::f64s; 3] {
        let far = moments(simd, [x, y, z], source);
        // r·M·r − (r·u₀)(r·n), each over r².
        let own = simd.mul_f64s(dot(simd, far.direction, [u, v, w]), far.through);
        let both = simd.mul_f64s(simd.sub_f64s(far.along, own), far.over_squared);
        [
            simd.mul_add_e_f64s(both, far.direction[0], a),
            simd.mul_add_e_f64s(both, far.direction[1], b),
            simd.mul_add_e_f64s(both, far.direction[2], c),
        ]
    }
}

impl Kernel<3, 12, 9> for DistantStresslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        target: [S::f64s; 3],
        source: [S::f64s; 12],
        sum: [S::f64s; 9],
    ) -> [S::f64s; 9] {
        let far = moments(simd, target, source);
        let [x, y, z] = far.direction;
        let along = simd.mul_f64s(far.along, far.over_squared);
        let through = simd.mul_f64s(far.through, far.over_squared);
        let [p, q, r] = [
            simd.mul_f64s(through, x),
            simd.mul_f64s(through, y),
            simd.mul_f64s(through, z),
        ];
        [
            simd.mul_add_e_f64s(along, x, sum[0]),
            simd.mul_add_e_f64s(along, y, sum[1]),
            simd.mul_add_e_f64s(along, z, sum[2]),
            simd.mul_add_e_f64s(p, x, sum[3]),
            simd.mul_add_e_f64s(q, y, sum[4]),
            simd.mul_add_e_f64s(r, z, sum[5]),
            simd.mul_add_e_f64s(q, z, sum[6]),
            simd.mul_add_e_f64s(r, x, sum[7]),
            simd.mul_add_e_f64s(p, y, sum[8]),
        ]
    }
}

/// A distant source of stresslets, seen from a target.
struct Moments<V> {
    /// r/r.
    direction: [V; 3],
    over_squared: V,
    /// (r·n)/r.
    through: V,
    /// (r·M·r)/r².
    along: V,
}

#[inline(always)]
fn moments<S: Simd>(simd: S, target: [S::f64s; 3], source: [S::f64s; 12]) -> Moments<S::f64s> {
    let [x, y, z, k, l, m, xx, yy, zz, yz, zx, xy] = source;
    let r = difference(simd, [x, y, z], target);
    let [over, over_squared] = reciprocals(simd, dot(simd, r, r));
    let direction = [
        simd.mul_f64s(over, r[0]),
        simd.mul_f64s(over, r[1]),
        simd.mul_f64s(over, r[2]),
    ];
    let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let product = [
        dot(simd, direction, rows[0]),
        dot(simd, direction, rows[1]),
        dot(simd, direction, rows[2]),
    ];
    Moments {
        direction,
        over_squared,
        through: dot(simd, direction, [k, l, m]),
        along: dot(simd, direction, product),
    }
}

/// The numbers in every lane.
#[inline(always)]
pub(super) fn splat<S: Simd, const N: usize>(simd: S, numbers: [f64; N]) -> [S::f64s; N] {
    let mut vectors = [simd.splat_f64s(0.0); N];
    for axis in 0..N {
        vectors[axis] = simd.splat_f64s(numbers[axis]);
    }
    vectors
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
