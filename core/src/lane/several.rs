//! A lane of several numbers, for vector registers.

use crate::lane::Lane;
use crate::real::Real;
use core::ops::{Add, Mul, Neg, Sub};

/// Number of reals in the lane: two vectors of 32 bytes in f64, one in f32. In f64 a lane with half
/// of this number was not faster.
pub(crate) const WIDTH: usize = 8;

/// Several numbers as one lane. Operations are plain loops, which compilers vectorise for the width
/// that the enclosing function allows. The alignment of 32 bytes keeps vectors from crossing cache
/// lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Several<T>(pub(crate) [T; WIDTH]);

impl<T: Real> Default for Several<T> {
    fn default() -> Self {
        Self([T::zero(); WIDTH])
    }
}

impl<T: Real> Add for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] += other.0[k];
        }
        self
    }
}

impl<T: Real> Sub for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] -= other.0[k];
        }
        self
    }
}

impl<T: Real> Mul for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] *= other.0[k];
        }
        self
    }
}

impl<T: Real> Neg for Several<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for k in 0..WIDTH {
            self.0[k] = -self.0[k];
        }
        self
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
        let mut lane = [T::zero(); WIDTH];
        for (k, number) in lane.iter_mut().enumerate() {
            *number = entry(k);
        }
        Self(lane)
    }
    #[inline(always)]
    fn entry(self, index: usize) -> T {
        self.0[index]
    }
    #[inline(always)]
    fn sqrt(mut self) -> Self {
        for k in 0..WIDTH {
            self.0[k] = self.0[k].sqrt();
        }
        self
    }
    #[inline(always)]
    fn atan2(mut self, x: Self) -> Self {
        for k in 0..WIDTH {
            self.0[k] = Lane::atan2(self.0[k], x.0[k]);
        }
        self
    }
    #[inline(always)]
    fn less(self, other: Self) -> [bool; WIDTH] {
        let mut mask = [false; WIDTH];
        for (k, less) in mask.iter_mut().enumerate() {
            *less = self.0[k] < other.0[k];
        }
        mask
    }
    #[inline(always)]
    fn select(mask: [bool; WIDTH], yes: Self, no: Self) -> Self {
        let mut lane = no;
        for (k, &holds) in mask.iter().enumerate() {
            lane.0[k] = if holds { yes.0[k] } else { no.0[k] };
        }
        lane
    }
    #[inline(always)]
    fn reciprocal_or_zero(mut self) -> Self {
        for k in 0..WIDTH {
            let entry = self.0[k];
            let over = entry.recip();
            let extended = entry.abs() >= T::min_positive_value();
            self.0[k] = if extended { over } else { T::zero() };
        }
        self
    }
}
