//! The arctangent without a branch. A call of the platform's function would prevent vectorisation
//! of loops over elements, and its last bits differ between platforms.

use crate::real::Real;
use core::any::TypeId;

/// Coefficients of `(atan q − q)/q³` in powers of q², for |q| ≤ tan π/8: the minimax polynomial for
/// the relative error of the arctangent (by the Remez algorithm, with 50 digits). The error is
/// 4e-17.
const DOUBLE: [f64; 10] = [
    -0.333_333_333_333_301_45,
    0.199_999_999_990_874_9,
    -0.142_857_141_951_326_15,
    0.111_111_066_481_091_2,
    -0.090_907_822_814_458_75,
    0.076_900_664_172_852_2,
    -0.066_411_045_817_241_03,
    0.056_924_510_271_717_08,
    -0.043_588_386_393_927_966,
    0.021_256_675_993_308_053,
];

/// Coefficients for single precision; the error is 7e-10.
const SINGLE: [f64; 5] = [
    -0.333_333_151_723_339_2,
    0.199_984_704_333_326_7,
    -0.142_435_115_023_107_82,
    0.105_936_428_759_671_38,
    -0.060_777_661_018_736_33,
];

/// The angle of the point (x, y), in (−π, π]: to 2 ulp for `f32` and `f64`, by [`num_traits`] for other
/// types.
#[inline(always)]
pub(super) fn of_point<T: Real>(y: T, x: T) -> T {
    if TypeId::of::<T>() == TypeId::of::<f64>() {
        by_polynomial(y, x, &DOUBLE)
    } else if TypeId::of::<T>() == TypeId::of::<f32>() {
        by_polynomial(y, x, &SINGLE)
    } else {
        y.atan2(x)
    }
}

#[inline(always)]
fn by_polynomial<T: Real, const N: usize>(y: T, x: T, coefficients: &[f64; N]) -> T {
    let zero = T::zero();
    let (right, up) = (x.abs(), y.abs());
    let steep = up > right;
    let (least, most) = if steep { (right, up) } else { (up, right) };
    // Above π/8 the angle is measured from π/4.
    let turned = least > T::constant(TAN_PI_8) * most;
    let (over, under) = if turned {
        (least - most, least + most)
    } else {
        (least, most)
    };
    let quotient = over / under;
    let q = if under == zero { zero } else { quotient };
    let squared = q * q;
    let mut sum = T::constant(coefficients[N - 1]);
    for &coefficient in coefficients[..N - 1].iter().rev() {
        sum = sum * squared + T::constant(coefficient);
    }
    let small = q + q * squared * sum;
    let octant = if turned {
        small + T::FRAC_PI_4()
    } else {
        small
    };
    let quadrant = if steep {
        T::FRAC_PI_2() - octant
    } else {
        octant
    };
    let half = if x < zero {
        T::PI() - quadrant
    } else {
        quadrant
    };
    if y < zero { -half } else { half }
}

const TAN_PI_8: f64 = 0.414_213_562_373_095_03;
