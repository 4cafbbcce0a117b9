//! A lane of several numbers, for vector registers.

use crate::lane::Lane;
use crate::real::Real;
use core::ops::{Add, Mul, Neg, Sub};

/// Number of reals in the lane: two vectors of 32 bytes in f64, one in f32. In f64 a lane with half
/// of this number was not faster.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) const WIDTH: usize = 8;
/// Number of reals in the lane: one vector of 16 bytes in f64, the widest there is. Compilers keep longer arrays in memory,
/// and copy them by function calls.
#[cfg(target_arch = "wasm32")]
pub(crate) const WIDTH: usize = 2;

/// The array whose entry `$k` is `$entry`, written out: a loop over a few entries would have to be unrolled in every
/// formula, which takes half of the time to compile fits.
macro_rules! entries {
    (|$k:ident| $entry:expr) => {{
        #[cfg(not(target_arch = "wasm32"))]
        let entries = entries!(|$k| $entry, 0 1 2 3 4 5 6 7);
        #[cfg(target_arch = "wasm32")]
        let entries = entries!(|$k| $entry, 0 1);
        entries
    }};
    (|$k:ident| $entry:expr, $($index:literal)*) => {
        [$({
            const $k: usize = $index;
            $entry
        }),*]
    };
}

/// Several numbers as one lane. Compilers combine the operations of its entries to vectors of the width that the
/// enclosing function allows. The alignment of 32 bytes keeps vectors from crossing cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(target_arch = "wasm32"), repr(align(32)))]
#[cfg_attr(target_arch = "wasm32", repr(align(16)))]
pub(crate) struct Several<T>(pub(crate) [T; WIDTH]);

/// The operators for the innermost loops of fits.
pub(crate) trait Wide: Lane {
    /// `self + other`.
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    /// `self - other`.
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }
    /// `self * other`.
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self * other
    }
}

impl<T: Real> Wide for T {}

/// Loops, of which compilers make wider vectors in f32, which is a fifth faster.
impl<T: Real> Wide for Several<T> {
    #[inline(always)]
    fn plus(mut self, other: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] += other.0[k];
        }
        self
    }
    #[inline(always)]
    fn minus(mut self, other: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] -= other.0[k];
        }
        self
    }
    #[inline(always)]
    fn times(mut self, other: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] *= other.0[k];
        }
        self
    }
}

impl<T: Real> Default for Several<T> {
    fn default() -> Self {
        Self([T::zero(); WIDTH])
    }
}

impl<T: Real> Add for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(entries!(|K| self.0[K] + other.0[K]))
    }
}

impl<T: Real> Sub for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(entries!(|K| self.0[K] - other.0[K]))
    }
}

impl<T: Real> Mul for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(entries!(|K| self.0[K] * other.0[K]))
    }
}

impl<T: Real> Neg for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(entries!(|K| -self.0[K]))
    }
}

impl<T: Real> Lane for Several<T> {
    type Scalar = T;
    type Mask = [bool; WIDTH];
    const WIDTH: usize = WIDTH;

    #[inline(always)]
    fn splat(value: T) -> Self {
        Self([value; WIDTH])
    }
    #[inline(always)]
    fn from_fn(mut entry: impl FnMut(usize) -> T) -> Self {
        Self(entries!(|K| entry(K)))
    }
    #[inline(always)]
    fn entry(self, index: usize) -> T {
        self.0[index]
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(entries!(|K| self.0[K].sqrt()))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        Self(entries!(|K| Lane::atan2(self.0[K], x.0[K])))
    }
    #[inline(always)]
    fn less(self, other: Self) -> [bool; WIDTH] {
        entries!(|K| self.0[K] < other.0[K])
    }
    #[inline(always)]
    fn select(mask: [bool; WIDTH], yes: Self, no: Self) -> Self {
        Self(entries!(|K| if mask[K] { yes.0[K] } else { no.0[K] }))
    }
    #[inline(always)]
    fn reciprocal_or_zero(self) -> Self {
        Self(entries!(|K| self.0[K].reciprocal_or_zero()))
    }
}
