//! Contributions of a point source at a point, where r is the vector from the point to the source.
//! Coinciding points contribute zero.

use crate::flow::vectors::{Vector, Vectors};
use glam::DVec3;
use pulp::{Scalar, Simd};

/// The contribution of one source to a vector of targets, in numbers of type `T`.
///
/// The numbers of a target begin with its position, as do those of a source.
pub(super) trait Kernel<T: Vectors, const TARGET: usize, const SOURCE: usize, const SUM: usize>:
    Copy + Sync
{
    /// `sum` plus the contribution, separately in each lane.
    // No closures here, because they would be compiled without the target features of the caller.
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; TARGET],
        source: [Vector<T, S>; SOURCE],
        sum: [Vector<T, S>; SUM],
    ) -> [Vector<T, S>; SUM];

    /// `sum` plus the contribution to a single target.
    fn add_one(self, target: [T; TARGET], source: &[T; SOURCE], sum: [T; SUM]) -> [T; SUM] {
        let (target, source) = (splat(Scalar, target), splat(Scalar, *source));
        let mut entries = [T::zero(); SUM];
        let sum = self.add(target, source, splat(Scalar, sum));
        for (entry, sum) in entries.iter_mut().zip(sum) {
            T::store(Scalar, std::slice::from_mut(entry), sum.entries());
        }
        entries
    }

    /// The contribution to a single target.
    fn one(self, target: [T; TARGET], source: &[T; SOURCE]) -> [T; SUM] {
        self.add_one(target, source, [T::zero(); SUM])
    }
}

/// A kernel whose sources can be moved to nodes, and its sums interpolated between nodes.
///
/// At a distance a source acts like another one with `FAR` numbers, its moments at a point. Moments
/// contribute to the sum at a target, and to the `LOCAL` numbers of a node, from which [`Self::at`]
/// computes the sum.
pub(super) trait Expansion<
    T: Vectors,
    const TARGET: usize,
    const SOURCE: usize,
    const SUM: usize,
    const FAR: usize,
    const LOCAL: usize,
>: Kernel<T, TARGET, SOURCE, SUM> + Scaled<SOURCE>
{
    /// The kernel of moments.
    type Distant: Kernel<T, TARGET, FAR, SUM> + Kernel<T, 3, FAR, LOCAL>;

    /// The kernel of moments.
    fn distant(self) -> Self::Distant;

    /// The position of a source, and its moments, in which the kernel is linear.
    fn moments(self, source: &[f64; SOURCE]) -> [f64; FAR];

    /// The sum at a target.
    fn at(self, local: [f64; LOCAL], target: [f64; TARGET]) -> [f64; SUM];
}

/// A kernel whose sums can be computed in units.
pub(super) trait Scaled<const SOURCE: usize> {
    /// Units for sums at points within a radius.
    fn units(self, radius: f64, sources: &[[f64; SOURCE]]) -> Units;
}

/// Units of sums, powers of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    /// 1 over the unit of positions.
    pub(super) over_length: f64,
    /// 1 over the unit of the other numbers of sources and targets.
    pub(super) over_strength: f64,
    /// The unit of sums.
    pub(super) of_sum: f64,
}

impl Units {
    pub(super) const NONE: Self = Self {
        over_length: 1.0,
        over_strength: 1.0,
        of_sum: 1.0,
    };

    /// The numbers of a source or a target, its position relative to an origin.
    #[inline(always)]
    pub(super) fn within<T: Vectors, const N: usize>(
        &self,
        origin: [f64; 3],
        numbers: &[f64; N],
    ) -> [T; N] {
        let mut within = [T::zero(); N];
        for k in 0..3 {
            within[k] = T::constant((numbers[k] - origin[k]) * self.over_length);
        }
        for k in 3..N {
            within[k] = T::constant(numbers[k] * self.over_strength);
        }
        within
    }
}

/// The power of two below a normal number, and 1 for other numbers.
fn power_of_two(number: f64) -> f64 {
    if number.is_normal() {
        f64::from_bits(number.to_bits() & f64::INFINITY.to_bits())
    } else {
        1.0
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

/// The sum of [`Stresslet`]s at a point, from their moments.
#[derive(Clone, Copy)]
pub(super) struct DistantStresslet;

/// `3 (r·n) (r·u)/r⁵ − n·u/r³`, the source being x, n, u.
#[derive(Clone, Copy)]
pub(super) struct StressletPressure;

/// `r·n/r³`, the source being x, n, u.
#[derive(Clone, Copy)]
pub(super) struct SolidAngle;

impl<T: Vectors> Kernel<T, 3, 6, 3> for Stokeslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; 3],
        source: [Vector<T, S>; 6],
        [u, v, w]: [Vector<T, S>; 3],
    ) -> [Vector<T, S>; 3] {
        let [x, y, z, f, g, h] = source;
        let f = [f, g, h];
        let r = difference([x, y, z], target);
        let [over, over_squared] = reciprocals(dot(r, r));
        let along = dot(r, f) * over_squared;
        [
            over.times_plus(along.times_plus(r[0], f[0]), u),
            over.times_plus(along.times_plus(r[1], f[1]), v),
            over.times_plus(along.times_plus(r[2], f[2]), w),
        ]
    }
}

impl<T: Vectors> Kernel<T, 3, 6, 1> for Gradient {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; 3],
        source: [Vector<T, S>; 6],
        [sum]: [Vector<T, S>; 1],
    ) -> [Vector<T, S>; 1] {
        let [x, y, z, f, g, h] = source;
        let f = [f, g, h];
        let r = difference([x, y, z], target);
        let [over, over_squared] = reciprocals(dot(r, r));
        let over_cube = over * over_squared;
        [over_cube.times_plus(dot(r, f), sum)]
    }
}

impl<T: Vectors> Kernel<T, 6, 9, 3> for Stresslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; 6],
        source: [Vector<T, S>; 9],
        [a, b, c]: [Vector<T, S>; 3],
    ) -> [Vector<T, S>; 3] {
        let [x, y, z, k, l, m, u, v, w] = source;
        let [x0, y0, z0, u0, v0, w0] = target;
        let r = difference([x, y, z], [x0, y0, z0]);
        let u = difference([u, v, w], [u0, v0, w0]);
        let [over, over_squared] = reciprocals(dot(r, r));
        // Each factor has its own reciprocal, because powers of r alone may overflow.
        let through = dot(r, [k, l, m]) * over_squared;
        let along = dot(r, u) * over_squared;
        let factor = through * along * over;
        [
            factor.times_plus(r[0], a),
            factor.times_plus(r[1], b),
            factor.times_plus(r[2], c),
        ]
    }
}

impl<T: Vectors> Kernel<T, 3, 9, 1> for StressletPressure {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; 3],
        source: [Vector<T, S>; 9],
        [sum]: [Vector<T, S>; 1],
    ) -> [Vector<T, S>; 1] {
        let [x, y, z, k, l, m, u, v, w] = source;
        let (n, u) = ([k, l, m], [u, v, w]);
        let r = difference([x, y, z], target);
        let [over, over_squared] = reciprocals(dot(r, r));
        let through = dot(r, n) * over_squared;
        let thrice = dot(r, u).times(3.0);
        let both = thrice.times_plus(through, dot(n, u).times(-1.0));
        [(over * over_squared).times_plus(both, sum)]
    }
}

impl<T: Vectors> Kernel<T, 3, 9, 1> for SolidAngle {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; 3],
        source: [Vector<T, S>; 9],
        sum: [Vector<T, S>; 1],
    ) -> [Vector<T, S>; 1] {
        let [x, y, z, k, l, m, _, _, _] = source;
        Gradient.add(target, [x, y, z, k, l, m], sum)
    }
}

impl<T: Vectors> Expansion<T, 3, 6, 3, 6, 3> for Stokeslet {
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

impl Scaled<6> for Stokeslet {
    fn units(self, radius: f64, sources: &[[f64; 6]]) -> Units {
        let forces = sources.iter().flat_map(|source| &source[3..]);
        let strength = forces.fold(0.0_f64, |most, force| most.max(force.abs()));
        // The squares of distances from 1e-31 to 1e7 radii are then within the range of single precision.
        let length = power_of_two(radius) / 2.0_f64.powi(40);
        let strength = power_of_two(strength);
        Units {
            over_length: length.recip(),
            over_strength: strength.recip(),
            of_sum: strength / length,
        }
    }
}

/// The moments are n and the symmetric part M of n u, in the order xx, yy, zz, yz, zx, xy, and the
/// numbers of a point `r (r·M·r)/r⁵` and `r r (r·n)/r⁵`.
impl Expansion<f64, 6, 9, 3, 12, 9> for Stresslet {
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

impl Scaled<9> for Stresslet {
    fn units(self, _radius: f64, _sources: &[[f64; 9]]) -> Units {
        Units::NONE
    }
}

impl<T: Vectors> Kernel<T, 6, 12, 3> for DistantStresslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        [x, y, z, u, v, w]: [Vector<T, S>; 6],
        source: [Vector<T, S>; 12],
        [a, b, c]: [Vector<T, S>; 3],
    ) -> [Vector<T, S>; 3] {
        let far = moments([x, y, z], source);
        // r·M·r − (r·u₀)(r·n), each over r².
        let own = dot(far.direction, [u, v, w]) * far.through;
        let both = (far.along - own) * far.over_squared;
        [
            both.times_plus(far.direction[0], a),
            both.times_plus(far.direction[1], b),
            both.times_plus(far.direction[2], c),
        ]
    }
}

impl<T: Vectors> Kernel<T, 3, 12, 9> for DistantStresslet {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        target: [Vector<T, S>; 3],
        source: [Vector<T, S>; 12],
        sum: [Vector<T, S>; 9],
    ) -> [Vector<T, S>; 9] {
        let far = moments(target, source);
        let [x, y, z] = far.direction;
        let along = far.along * far.over_squared;
        let through = far.through * far.over_squared;
        let [p, q, r] = [through * x, through * y, through * z];
        [
            along.times_plus(x, sum[0]),
            along.times_plus(y, sum[1]),
            along.times_plus(z, sum[2]),
            p.times_plus(x, sum[3]),
            q.times_plus(y, sum[4]),
            r.times_plus(z, sum[5]),
            q.times_plus(z, sum[6]),
            r.times_plus(x, sum[7]),
            p.times_plus(y, sum[8]),
        ]
    }
}

/// A distant source of stresslets, seen from a target.
struct SourceMoments<V> {
    /// r/r.
    direction: [V; 3],
    over_squared: V,
    /// (r·n)/r.
    through: V,
    /// (r·M·r)/r².
    along: V,
}

#[inline(always)]
fn moments<T: Vectors, S: Simd>(
    target: [Vector<T, S>; 3],
    source: [Vector<T, S>; 12],
) -> SourceMoments<Vector<T, S>> {
    let [x, y, z, k, l, m, xx, yy, zz, yz, zx, xy] = source;
    let r = difference([x, y, z], target);
    let [over, over_squared] = reciprocals(dot(r, r));
    let direction = [over * r[0], over * r[1], over * r[2]];
    let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let product = [
        dot(direction, rows[0]),
        dot(direction, rows[1]),
        dot(direction, rows[2]),
    ];
    SourceMoments {
        direction,
        over_squared,
        through: dot(direction, [k, l, m]),
        along: dot(direction, product),
    }
}

/// The numbers in every lane.
#[inline(always)]
pub(super) fn splat<T: Vectors, S: Simd, const N: usize>(
    simd: S,
    numbers: [T; N],
) -> [Vector<T, S>; N] {
    let mut vectors = [Vector::splat(simd, T::zero()); N];
    for axis in 0..N {
        vectors[axis] = Vector::splat(simd, numbers[axis]);
    }
    vectors
}

#[inline(always)]
fn difference<T: Vectors, S: Simd>(
    a: [Vector<T, S>; 3],
    b: [Vector<T, S>; 3],
) -> [Vector<T, S>; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot<T: Vectors, S: Simd>(a: [Vector<T, S>; 3], b: [Vector<T, S>; 3]) -> Vector<T, S> {
    a[0].times_plus(b[0], a[1].times_plus(b[1], a[2] * b[2]))
}

/// `1/r` and `1/r²` by r², and 0 for 0.
#[inline(always)]
fn reciprocals<T: Vectors, S: Simd>(squared: Vector<T, S>) -> [Vector<T, S>; 2] {
    // The reciprocal and the root are independent, so that neither waits for the other.
    let over_squared = squared.reciprocal().where_positive(squared);
    [over_squared * squared.root(), over_squared]
}
