//! One or several reals computed at once.

mod arctangent;
mod several;

use crate::real::Real;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

pub(crate) use several::{Several, WIDTH, Wide};

/// One or several reals that go through a formula together.
///
/// Kernels are written once over a lane and without data-dependent branches; a [`Real`] is a lane
/// of width 1, a SIMD vector is a lane of its own width. A kernel on a wider lane performs in each
/// entry exactly the operations that it performs on a single real. All widths therefore agree bit
/// for bit if the elementary functions do.
pub trait Lane:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The number in each entry.
    type Scalar: Real;
    /// The outcome of a comparison, entry by entry.
    type Mask: Copy;
    /// The number of entries.
    const WIDTH: usize;

    /// The same number in every entry.
    fn splat(value: Self::Scalar) -> Self;
    /// The lane whose entry `k` is `entry(k)`.
    fn from_fn(entry: impl FnMut(usize) -> Self::Scalar) -> Self;
    /// Entry `index`, less than [`Self::WIDTH`].
    fn entry(self, index: usize) -> Self::Scalar;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The angle of the point (`x`, `self`), in (-π, π]; 0 for the origin.
    fn atan2(self, x: Self) -> Self;
    /// `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, `no` elsewhere; both are computed.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// `1 / self`, or 0 where the reciprocal is not a finite number of full precision (zero and
    /// subnormal numbers). With it an element without extent contributes 0.
    fn reciprocal_or_zero(self) -> Self;

    /// The constant `value`, rounded to the scalar, in every entry.
    #[inline(always)]
    fn literal(value: f64) -> Self {
        Self::splat(<Self::Scalar as Real>::constant(value))
    }
    /// Zero in every entry.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(num_traits::Zero::zero())
    }
}

impl<T: Real> Lane for T {
    type Scalar = T;
    type Mask = bool;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: T) -> T {
        value
    }
    #[inline(always)]
    fn from_fn(mut entry: impl FnMut(usize) -> T) -> T {
        entry(0)
    }
    #[inline(always)]
    fn entry(self, _index: usize) -> T {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> T {
        num_traits::Float::sqrt(self)
    }
    #[inline(always)]
    fn atan2(self, x: T) -> T {
        arctangent::of_point(self, x)
    }
    #[inline(always)]
    fn less(self, other: T) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(mask: bool, yes: T, no: T) -> T {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn reciprocal_or_zero(self) -> T {
        if self.abs() >= T::min_positive_value() {
            self.recip()
        } else {
            T::zero()
        }
    }
}
