//! A number that counts what is done with it: how many operations a formula takes.

use num_traits::{Float, FloatConst, FromPrimitive, Num, NumCast, One, ToPrimitive, Zero};
use std::cell::Cell;
use std::iter::Sum;
use std::num::FpCategory;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};

/// Operations: sums and products; quotients and square roots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Operations {
    pub(crate) fast: u64,
    pub(crate) slow: u64,
}

thread_local! {
    static DONE: Cell<Operations> = const { Cell::new(Operations { fast: 0, slow: 0 }) };
}

/// The operations of `run` with numbers that count.
pub(crate) fn operations(run: impl FnOnce()) -> Operations {
    DONE.set(Operations::default());
    run();
    DONE.get()
}

fn fast(count: u64) {
    let done = DONE.get();
    DONE.set(Operations {
        fast: done.fast + count,
        ..done
    });
}

fn slow() {
    let done = DONE.get();
    DONE.set(Operations {
        slow: done.slow + 1,
        ..done
    });
}

/// Sums and products that an exponential takes, about.
const EXPONENTIAL: u64 = 20;

#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(crate) struct Counted(f64);

macro_rules! operator {
    ($($trait:ident $method:ident $assigns:ident $assign:ident $count:expr;)*) => {$(
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                $count;
                Self(self.0.$method(other.0))
            }
        }
        impl $assigns for Counted {
            fn $assign(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
    )*};
}
operator! {
    Add add AddAssign add_assign fast(1);
    Sub sub SubAssign sub_assign fast(1);
    Mul mul MulAssign mul_assign fast(1);
    Div div DivAssign div_assign slow();
    Rem rem RemAssign rem_assign slow();
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Sum for Counted {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self(0.0), |sum, term| sum + term)
    }
}

impl Zero for Counted {
    fn zero() -> Self {
        Self(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

impl One for Counted {
    fn one() -> Self {
        Self(1.0)
    }
}

impl Num for Counted {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self)
    }
}

impl ToPrimitive for Counted {
    fn to_i64(&self) -> Option<i64> {
        self.0.to_i64()
    }
    fn to_u64(&self) -> Option<u64> {
        self.0.to_u64()
    }
    fn to_f64(&self) -> Option<f64> {
        Some(self.0)
    }
}

impl FromPrimitive for Counted {
    fn from_i64(value: i64) -> Option<Self> {
        f64::from_i64(value).map(Self)
    }
    fn from_u64(value: u64) -> Option<Self> {
        f64::from_u64(value).map(Self)
    }
    fn from_f64(value: f64) -> Option<Self> {
        Some(Self(value))
    }
}

impl NumCast for Counted {
    fn from<N: ToPrimitive>(value: N) -> Option<Self> {
        value.to_f64().map(Self)
    }
}

macro_rules! constants {
    ($($name:ident)*) => {
        impl FloatConst for Counted {
            $(fn $name() -> Self {
                Self(<f64 as FloatConst>::$name())
            })*
        }
    };
}
constants! {
    E FRAC_1_PI FRAC_1_SQRT_2 FRAC_2_PI FRAC_2_SQRT_PI FRAC_PI_2 FRAC_PI_3 FRAC_PI_4 FRAC_PI_6
    FRAC_PI_8 LN_10 LN_2 LOG10_E LOG2_E PI SQRT_2
}

macro_rules! float {
    (
        values: $($value:ident)*;
        tests: $($test:ident)*;
        free: $($free:ident)*;
        slow: $($slow:ident)*;
        functions: $($function:ident)*;
        pairs: $($pair:ident)*;
    ) => {
        impl Float for Counted {
            $(fn $value() -> Self {
                Self(<f64 as Float>::$value())
            })*
            $(fn $test(self) -> bool {
                Float::$test(self.0)
            })*
            $(fn $free(self) -> Self {
                Self(Float::$free(self.0))
            })*
            $(fn $slow(self) -> Self {
                slow();
                Self(Float::$slow(self.0))
            })*
            $(fn $function(self) -> Self {
                fast(EXPONENTIAL);
                Self(Float::$function(self.0))
            })*
            $(fn $pair(self, other: Self) -> Self {
                fast(1);
                Self(Float::$pair(self.0, other.0))
            })*
            fn classify(self) -> FpCategory {
                self.0.classify()
            }
            fn mul_add(self, factor: Self, term: Self) -> Self {
                self * factor + term
            }
            fn powi(self, exponent: i32) -> Self {
                fast(exponent.unsigned_abs().into());
                Self(self.0.powi(exponent))
            }
            fn sin_cos(self) -> (Self, Self) {
                (self.sin(), self.cos())
            }
            fn integer_decode(self) -> (u64, i16, i8) {
                Float::integer_decode(self.0)
            }
        }
    };
}
float! {
    values: nan infinity neg_infinity neg_zero min_value min_positive_value max_value epsilon;
    tests: is_nan is_infinite is_finite is_normal is_sign_positive is_sign_negative;
    free: floor ceil round trunc fract abs signum;
    slow: recip sqrt;
    functions: exp exp2 ln log2 log10 cbrt sin cos tan asin acos atan exp_m1 ln_1p sinh cosh tanh
        asinh acosh atanh;
    pairs: max min powf log hypot atan2 abs_sub;
}
