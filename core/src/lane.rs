//! One or several reals computed at once.

use crate::real::Real;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

/// One or several reals that go through a formula together.
///
/// Kernels are written once over a lane and without data-dependent branches; a [`Real`] is a lane
/// of width 1, a SIMD vector is a lane of its own width. A kernel that runs on a wider lane gives
/// in each entry exactly the operations it does on a single real, so that widths agree bit for bit
/// wherever the elementary functions do.
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
    /// The angle of the point (`x`, `self`), in (-π, π].
    fn atan2(self, x: Self) -> Self;
    /// `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, `no` elsewhere; both are computed.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// `1 / self`, and 0 where the reciprocal of `self` is not a finite number of full precision
    /// (zero and subnormal numbers): what an element without extent contributes.
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
        num_traits::Float::atan2(self, x)
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

/// `W` reals in a row: a lane in plain Rust, which compilers keep in vector registers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Pack<T, const W: usize>([T; W]);

impl<T: Real, const W: usize> Pack<T, W> {
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(T, T) -> T) -> Self {
        Self(core::array::from_fn(|k| operation(self.0[k], other.0[k])))
    }
}

impl<T: Real, const W: usize> Add for Pack<T, W> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<T: Real, const W: usize> Sub for Pack<T, W> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<T: Real, const W: usize> Mul for Pack<T, W> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<T: Real, const W: usize> Neg for Pack<T, W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl<T: Real, const W: usize> Lane for Pack<T, W> {
    type Scalar = T;
    type Mask = [bool; W];
    const WIDTH: usize = W;

    #[inline(always)]
    fn splat(value: T) -> Self {
        Self([value; W])
    }
    #[inline(always)]
    fn from_fn(entry: impl FnMut(usize) -> T) -> Self {
        Self(core::array::from_fn(entry))
    }
    #[inline(always)]
    fn entry(self, index: usize) -> T {
        self.0[index]
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(num_traits::Float::sqrt))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.zip(x, num_traits::Float::atan2)
    }
    #[inline(always)]
    fn less(self, other: Self) -> [bool; W] {
        core::array::from_fn(|k| self.0[k] < other.0[k])
    }
    #[inline(always)]
    fn select(mask: [bool; W], yes: Self, no: Self) -> Self {
        Self(core::array::from_fn(|k| {
            if mask[k] { yes.0[k] } else { no.0[k] }
        }))
    }
    #[inline(always)]
    fn reciprocal_or_zero(self) -> Self {
        Self(self.0.map(Lane::reciprocal_or_zero))
    }
}
