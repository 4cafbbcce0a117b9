//! The scalar.

use core::fmt::Debug;
use core::iter::Sum;
use num_traits::{Float, FloatConst, FromPrimitive, NumAssign};

/// A real number: `f32`, `f64`, and every other type with the same num-traits bounds.
///
/// The implementation is a blanket one, so that dual numbers (exact derivatives in tests) and
/// extended precisions run through the same formulas as `f32` and `f64`. Types of `autodiff` are
/// accepted; those of `num-dual` are not, because they do not implement [`num_traits::Float`].
pub trait Real:
    Float + FloatConst + FromPrimitive + NumAssign + Sum + Debug + Default + Send + Sync + 'static
{
    /// The constant `value`, rounded to this type.
    ///
    /// # Panics
    /// Only for a foreign number type whose `FromPrimitive` refuses a finite `f64`.
    #[inline(always)]
    fn constant(value: f64) -> Self {
        match Self::from_f64(value) {
            Some(constant) => constant,
            None => panic!("this number type cannot represent the constant {value}"),
        }
    }
}

/// The numbers if all of them are finite, otherwise zeros: overflowed numbers are meaningless and
/// must not spread. They occur only where lengths of edges differ by the whole range of the scalar,
/// which [`Method::inspect`](crate::Method::inspect) reports as uneven.
#[inline(always)]
pub(crate) fn finite_or_zero<T: Real, const N: usize>(values: [T; N]) -> [T; N] {
    if values.iter().all(|value| value.is_finite()) {
        values
    } else {
        [T::zero(); N]
    }
}

impl<T> Real for T where
    T: Float
        + FloatConst
        + FromPrimitive
        + NumAssign
        + Sum
        + Debug
        + Default
        + Send
        + Sync
        + 'static
{
}
