//! Private algebra of 3-vectors over a lane.

use crate::lane::Lane;
use num_traits::Float;

pub(crate) type Vec3<L> = [L; 3];

#[inline(always)]
pub(crate) fn add<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn sub<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn neg<L: Lane>(a: Vec3<L>) -> Vec3<L> {
    [-a[0], -a[1], -a[2]]
}

#[inline(always)]
pub(crate) fn scale<L: Lane>(s: L, a: Vec3<L>) -> Vec3<L> {
    [s * a[0], s * a[1], s * a[2]]
}

#[inline(always)]
pub(crate) fn dot<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
pub(crate) fn norm<L: Lane>(a: Vec3<L>) -> L {
    dot(a, a).sqrt()
}

/// `a / |a|`, or 0 for a vector without length. Vectors so short that their squares underflow (area
/// vectors of surfaces of size 1e-12 in f32) are first scaled by a power of two.
#[inline(always)]
pub(crate) fn normalise<L: Lane>(a: Vec3<L>) -> Vec3<L> {
    let least = <L::Scalar as Float>::min_positive_value();
    let epsilon = <L::Scalar as Float>::epsilon();
    let squared = dot(a, a);
    let digits = L::splat(least / (epsilon * epsilon));
    let longer = L::splat(epsilon * epsilon / least);
    let factor = L::select(squared.less(digits), longer, L::literal(1.0));
    let a = scale(factor, a);
    scale(norm(a).reciprocal_or_zero(), a)
}

/// Two unit vectors that form a right-handed frame with the unit vector `normal`, without a branch.
///
/// T. Duff et al., J. Comput. Graph. Tech. 6 (2017) 1.
#[inline(always)]
pub(crate) fn tangent_frame<L: Lane>(normal: Vec3<L>) -> [Vec3<L>; 2] {
    let [x, y, z] = normal;
    let one = L::literal(1.0);
    let sign = L::select(z.less(L::zero()), -one, one);
    let a = -(sign + z).reciprocal_or_zero();
    let b = x * y * a;
    [
        [one + sign * x * x * a, sign * b, -(sign * x)],
        [b, sign + y * y * a, -y],
    ]
}
