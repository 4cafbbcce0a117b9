//! Private algebra of 3-vectors over a lane.

use crate::lane::Lane;

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

/// `a / |a|`, and 0 for a vector without length.
#[inline(always)]
pub(crate) fn normalise<L: Lane>(a: Vec3<L>) -> Vec3<L> {
    scale(norm(a).reciprocal_or_zero(), a)
}
