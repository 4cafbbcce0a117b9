//! The numbers of callers: f64, which is used in place, and f32, which is widened exactly and to which results
//! are rounded once.

use std::borrow::Cow;

/// A number type of callers.
pub(crate) trait Number: Copy + Default + 'static {
    /// The same number in f64.
    fn wide(self) -> f64;

    /// The nearest number of this type; infinite beyond its range.
    fn nearest(value: f64) -> Self;

    /// The same numbers in f64.
    fn widen<const D: usize>(values: &[[Self; D]]) -> Cow<'_, [[f64; D]]>;

    /// Calls `compute` with numbers in f64, and rounds what it leaves there to `values`.
    fn compute<const D: usize, R>(
        values: &mut [[Self; D]],
        compute: impl FnOnce(&mut [[f64; D]]) -> R,
    ) -> R;
}

impl Number for f64 {
    fn wide(self) -> f64 {
        self
    }

    fn nearest(value: f64) -> f64 {
        value
    }

    fn widen<const D: usize>(values: &[[f64; D]]) -> Cow<'_, [[f64; D]]> {
        Cow::Borrowed(values)
    }

    fn compute<const D: usize, R>(
        values: &mut [[f64; D]],
        compute: impl FnOnce(&mut [[f64; D]]) -> R,
    ) -> R {
        compute(values)
    }
}

impl Number for f32 {
    fn wide(self) -> f64 {
        f64::from(self)
    }

    fn nearest(value: f64) -> f32 {
        value as f32
    }

    fn widen<const D: usize>(values: &[[f32; D]]) -> Cow<'_, [[f64; D]]> {
        values.iter().map(|value| value.map(f64::from)).collect()
    }

    fn compute<const D: usize, R>(
        values: &mut [[f32; D]],
        compute: impl FnOnce(&mut [[f64; D]]) -> R,
    ) -> R {
        let mut wide = Self::widen(values).into_owned();
        let result = compute(&mut wide);
        for (value, wide) in values.iter_mut().zip(wide) {
            *value = wide.map(|component| component as f32);
        }
        result
    }
}
