//! Parameters with which methods cannot compute.

use crate::real::Real;

/// A parameter with which a method cannot compute.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The parameter is NaN or infinite.
    #[error("the {parameter} is not a finite number")]
    NotFinite {
        /// Description of the parameter.
        parameter: &'static str,
    },
    /// The parameter is finite, but so large that results overflow.
    #[error(
        "the {parameter} is {value:e}: energies and forces overflow where it is above {limit:e}; \
         choose larger units"
    )]
    TooLarge {
        /// Description of the parameter.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// The largest value that this number type computes with.
        limit: f64,
    },
}

impl ParameterError {
    /// Returns an error unless the value of this parameter is finite.
    pub(crate) fn unless_finite<T: Real>(
        parameter: &'static str,
        value: T,
    ) -> Result<(), ParameterError> {
        if value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotFinite { parameter })
        }
    }

    /// Returns an error unless all values of this parameter are finite.
    pub(crate) fn unless_all_finite<T: Real>(
        parameter: &'static str,
        values: impl IntoIterator<Item = T>,
    ) -> Result<(), ParameterError> {
        let mut values = values.into_iter();
        values.try_for_each(|value| Self::unless_finite(parameter, value))
    }

    /// Returns an error unless the value is finite and at most `limit` in magnitude.
    ///
    /// # Errors
    /// The parameter is not finite, or above the limit.
    pub fn unless_within<T: Real>(
        parameter: &'static str,
        value: T,
        limit: T,
    ) -> Result<(), ParameterError> {
        Self::unless_finite(parameter, value)?;
        if value.abs() <= limit {
            return Ok(());
        }
        let double = |x: T| x.to_f64().unwrap_or(f64::NAN);
        Err(Self::TooLarge {
            parameter,
            value: double(value),
            limit: double(limit),
        })
    }

    /// The largest bending modulus, and the largest square of a spontaneous curvature: the square root
    /// of the largest number. Smaller values overflow only on extreme edges, which findings
    /// report.
    pub fn largest_modulus<T: Real>() -> T {
        T::max_value().sqrt()
    }
}
