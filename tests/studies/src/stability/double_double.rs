//! Numbers with twice the precision of f64, with which formulas are checked.
//!
//! T. J. Dekker, Numer. Math. 18 (1971) 224; Y. Hida, X. S. Li, D. H. Bailey, Proc. 15th IEEE Symp.
//! Computer Arithmetic (2001) 155.

use num_traits::{Float, FloatConst, FromPrimitive, Num, NumCast, One, ToPrimitive, Zero};
use std::iter::Sum;
use std::num::FpCategory;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};

/// Unevaluated sum of two f64, with about 32 decimal digits and the range of f64.
///
/// Sums, products, quotients, square roots, exponentials, logarithms, sines, cosines and angles have full
/// precision; functions that no formula of the library calls have that of f64.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

const PI: DoubleDouble = DoubleDouble::new(std::f64::consts::PI, 1.224_646_799_147_353_2e-16);
const LN_2: DoubleDouble = DoubleDouble::new(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

/// Whether a number is neither infinite nor NaN. Comparisons are fast without optimisation, too.
fn is_finite(value: f64) -> bool {
    value > f64::NEG_INFINITY && value < f64::INFINITY
}

impl DoubleDouble {
    /// Sum of two f64, the second at most half a unit in the last place of the first.
    pub const fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    /// The nearest f64, and the remainder.
    pub const fn parts(self) -> [f64; 2] {
        [self.high, self.low]
    }

    /// The value of an f64.
    pub const fn of(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    /// `a + b` without error, for |a| ≥ |b|.
    fn of_ordered(a: f64, b: f64) -> Self {
        let high = a + b;
        if is_finite(high) {
            Self::new(high, b - (high - a))
        } else {
            Self::new(high, 0.0)
        }
    }

    /// `a + b` without error.
    fn of_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        if !is_finite(high) {
            return Self::new(high, 0.0);
        }
        let part = high - a;
        Self::new(high, (a - (high - part)) + (b - part))
    }

    /// `a b` without error.
    fn of_product(a: f64, b: f64) -> Self {
        let high = a * b;
        if is_finite(high) {
            Self::new(high, a.mul_add(b, -high))
        } else {
            Self::new(high, 0.0)
        }
    }

    /// Evaluates a function in f64.
    fn roughly(self, function: impl Fn(f64) -> f64) -> Self {
        function(self.high).into()
    }

    /// Rounds to a whole number by `function`.
    fn whole(self, function: impl Fn(f64) -> f64) -> Self {
        let high = function(self.high);
        if high == self.high {
            Self::of_ordered(high, function(self.low))
        } else {
            high.into()
        }
    }

    fn scaled(self, power_of_two: f64) -> Self {
        Self::new(self.high * power_of_two, self.low * power_of_two)
    }

    /// Series Σ ± xᵏ/k! over every second k from `first` on, with alternating signs: cosine or sine.
    fn alternating_series(self, first: u32) -> Self {
        let square = self * self;
        let mut term = if first == 0 { Self::one() } else { self };
        let mut sum = term;
        for k in (first + 2..36).step_by(2) {
            term = -(term * square / Self::of((k * (k - 1)).into()));
            sum += term;
        }
        sum
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self::of(value)
    }
}

// Operations are not inlined, because they are long and formulas made of them would become huge.
impl Add for DoubleDouble {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let (high, low) = (
            Self::of_sum(self.high, other.high),
            Self::of_sum(self.low, other.low),
        );
        let sum = Self::of_ordered(high.high, high.low + low.high);
        Self::of_ordered(sum.high, sum.low + low.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let product = Self::of_product(self.high, other.high);
        let rest = self.high.mul_add(other.low, self.low * other.high);
        Self::of_ordered(product.high, product.low + rest)
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if !is_finite(first) || !is_finite(other.high) {
            return first.into();
        }
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        Self::of_ordered(first, second) + (rest.high / other.high).into()
    }
}

impl Rem for DoubleDouble {
    type Output = Self;
    fn rem(self, other: Self) -> Self {
        self - (self / other).trunc() * other
    }
}

macro_rules! assign {
    ($($name:ident, $method:ident, $operator:tt;)*) => {$(
        impl $name for DoubleDouble {
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    )*};
}

assign! {
    AddAssign, add_assign, +;
    SubAssign, sub_assign, -;
    MulAssign, mul_assign, *;
    DivAssign, div_assign, /;
    RemAssign, rem_assign, %;
}

impl Sum for DoubleDouble {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), Add::add)
    }
}

impl Zero for DoubleDouble {
    fn zero() -> Self {
        0.0.into()
    }
    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for DoubleDouble {
    fn one() -> Self {
        1.0.into()
    }
}

impl Num for DoubleDouble {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::of)
    }
}

impl ToPrimitive for DoubleDouble {
    fn to_i64(&self) -> Option<i64> {
        self.high.to_i64()
    }
    fn to_u64(&self) -> Option<u64> {
        self.high.to_u64()
    }
    fn to_f64(&self) -> Option<f64> {
        Some(self.high)
    }
}

impl FromPrimitive for DoubleDouble {
    fn from_i64(value: i64) -> Option<Self> {
        f64::from_i64(value).map(Self::of)
    }
    fn from_u64(value: u64) -> Option<Self> {
        f64::from_u64(value).map(Self::of)
    }
    fn from_f64(value: f64) -> Option<Self> {
        Some(value.into())
    }
}

impl NumCast for DoubleDouble {
    fn from<V: ToPrimitive>(value: V) -> Option<Self> {
        value.to_f64().map(Self::of)
    }
}

impl FloatConst for DoubleDouble {
    fn PI() -> Self {
        PI
    }
    fn LN_2() -> Self {
        LN_2
    }
    fn E() -> Self {
        Self::one().exp()
    }
    fn LN_10() -> Self {
        Self::of(10.0).ln()
    }
    fn FRAC_1_PI() -> Self {
        PI.recip()
    }
    fn FRAC_2_PI() -> Self {
        PI.recip().scaled(2.0)
    }
    fn FRAC_2_SQRT_PI() -> Self {
        PI.sqrt().recip().scaled(2.0)
    }
    fn FRAC_PI_2() -> Self {
        PI.scaled(0.5)
    }
    fn FRAC_PI_3() -> Self {
        PI / 3.0.into()
    }
    fn FRAC_PI_4() -> Self {
        PI.scaled(0.25)
    }
    fn FRAC_PI_6() -> Self {
        PI / 6.0.into()
    }
    fn FRAC_PI_8() -> Self {
        PI.scaled(0.125)
    }
    fn SQRT_2() -> Self {
        Self::of(2.0).sqrt()
    }
    fn FRAC_1_SQRT_2() -> Self {
        Self::of(0.5).sqrt()
    }
    fn LOG10_E() -> Self {
        Self::LN_10().recip()
    }
    fn LOG2_E() -> Self {
        LN_2.recip()
    }
}

impl Float for DoubleDouble {
    fn nan() -> Self {
        f64::NAN.into()
    }
    fn infinity() -> Self {
        f64::INFINITY.into()
    }
    fn neg_infinity() -> Self {
        f64::NEG_INFINITY.into()
    }
    fn neg_zero() -> Self {
        (-0.0).into()
    }
    fn min_value() -> Self {
        f64::MIN.into()
    }
    fn min_positive_value() -> Self {
        f64::MIN_POSITIVE.into()
    }
    fn max_value() -> Self {
        f64::MAX.into()
    }
    /// 2⁻¹⁰⁴: the last of the 106 binary digits may be wrong.
    fn epsilon() -> Self {
        2.0_f64.powi(-104).into()
    }
    fn is_nan(self) -> bool {
        self.high.is_nan()
    }
    fn is_infinite(self) -> bool {
        self.high.is_infinite()
    }
    fn is_finite(self) -> bool {
        self.high.is_finite()
    }
    fn is_normal(self) -> bool {
        self.high.is_normal()
    }
    fn classify(self) -> FpCategory {
        self.high.classify()
    }
    fn floor(self) -> Self {
        self.whole(f64::floor)
    }
    fn ceil(self) -> Self {
        self.whole(f64::ceil)
    }
    fn round(self) -> Self {
        (self.abs() + 0.5.into()).floor() * self.signum()
    }
    fn trunc(self) -> Self {
        if self.high < 0.0 {
            self.ceil()
        } else {
            self.floor()
        }
    }
    fn fract(self) -> Self {
        self - self.trunc()
    }
    fn abs(self) -> Self {
        if self.high.is_sign_negative() {
            -self
        } else {
            self
        }
    }
    fn signum(self) -> Self {
        self.high.signum().into()
    }
    fn is_sign_positive(self) -> bool {
        self.high.is_sign_positive()
    }
    fn is_sign_negative(self) -> bool {
        self.high.is_sign_negative()
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    fn recip(self) -> Self {
        Self::one() / self
    }
    fn powi(self, exponent: i32) -> Self {
        let power = (0..exponent.unsigned_abs()).fold(Self::one(), |power, _| power * self);
        if exponent < 0 { power.recip() } else { power }
    }
    fn powf(self, exponent: Self) -> Self {
        (self.ln() * exponent).exp()
    }
    fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root == 0.0 || !root.is_finite() {
            return root.into();
        }
        let rest = self - Self::of_product(root, root);
        Self::of_ordered(root, rest.high / (2.0 * root))
    }
    fn exp(self) -> Self {
        if self.high.abs() > 690.0 {
            return self.roughly(f64::exp);
        }
        let twos = (self.high / LN_2.high).round();
        // e^x − 1 by its series at x/256, then eight times (1 + y)² − 1 = 2y + y².
        let small = (self - LN_2 * twos.into()).scaled(1.0 / 256.0);
        let mut term = small;
        let mut less_one = small;
        for k in 2..14 {
            term = term * small / Self::of(k.into());
            less_one += term;
        }
        for _ in 0..8 {
            less_one = less_one.scaled(2.0) + less_one * less_one;
        }
        (less_one + Self::one()).scaled(2.0_f64.powi(twos as i32))
    }
    fn exp2(self) -> Self {
        (self * LN_2).exp()
    }
    fn ln(self) -> Self {
        let first = self.high.ln();
        if !first.is_finite() {
            return first.into();
        }
        // One step of Newton's iteration for e^y = x.
        let guess = Self::of(first);
        guess + (self * (-guess).exp() - Self::one())
    }
    fn log(self, base: Self) -> Self {
        self.ln() / base.ln()
    }
    fn log2(self) -> Self {
        self.ln() / LN_2
    }
    fn log10(self) -> Self {
        self.ln() / Self::LN_10()
    }
    fn max(self, other: Self) -> Self {
        if self >= other || other.is_nan() {
            self
        } else {
            other
        }
    }
    fn min(self, other: Self) -> Self {
        if self <= other || other.is_nan() {
            self
        } else {
            other
        }
    }
    fn abs_sub(self, other: Self) -> Self {
        (self - other).max(Self::zero())
    }
    fn cbrt(self) -> Self {
        let root = Self::of(self.high.cbrt());
        if root.is_zero() {
            root
        } else {
            root - (root - self / (root * root)) / 3.0.into()
        }
    }
    fn hypot(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    fn tan(self) -> Self {
        let (sine, cosine) = self.sin_cos();
        sine / cosine
    }
    fn sin_cos(self) -> (Self, Self) {
        let quarters = (self.high / PI.scaled(0.5).high).round();
        let rest = self - PI.scaled(0.5) * quarters.into();
        let (sine, cosine) = (rest.alternating_series(1), rest.alternating_series(0));
        match quarters.rem_euclid(4.0) as u32 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
    fn asin(self) -> Self {
        self.atan2((Self::one() - self * self).sqrt())
    }
    fn acos(self) -> Self {
        (Self::one() - self * self).sqrt().atan2(self)
    }
    fn atan(self) -> Self {
        self.atan2(Self::one())
    }
    fn atan2(self, x: Self) -> Self {
        let first = self.high.atan2(x.high);
        if (self.high == 0.0 && x.high >= 0.0) || !first.is_finite() {
            return first.into();
        }
        // After rotation by the first estimate, the remaining angle is so small that it equals its sine.
        let (sine, cosine) = Self::of(first).sin_cos();
        Self::of(first) + (self * cosine - x * sine) / (x * cosine + self * sine)
    }
    fn exp_m1(self) -> Self {
        self.roughly(f64::exp_m1)
    }
    fn ln_1p(self) -> Self {
        self.roughly(f64::ln_1p)
    }
    fn sinh(self) -> Self {
        self.roughly(f64::sinh)
    }
    fn cosh(self) -> Self {
        self.roughly(f64::cosh)
    }
    fn tanh(self) -> Self {
        self.roughly(f64::tanh)
    }
    fn asinh(self) -> Self {
        self.roughly(f64::asinh)
    }
    fn acosh(self) -> Self {
        self.roughly(f64::acosh)
    }
    fn atanh(self) -> Self {
        self.roughly(f64::atanh)
    }
    fn integer_decode(self) -> (u64, i16, i8) {
        self.high.integer_decode()
    }
}
