//! Numbers in messages.

use std::fmt;

/// A number with at most six significant digits and without trailing zeros; in powers of ten only
/// if it is very large or small.
#[derive(Clone, Copy, Debug)]
pub struct Six(pub f64);

impl fmt::Display for Six {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = format!("{:.5e}", self.0);
        let split = rounded.split_once('e');
        let Some((mantissa, exponent)) = split.and_then(|(m, e)| Some((m, e.parse::<i32>().ok()?)))
        else {
            // NaN or infinite.
            return formatter.pad(&rounded);
        };
        let text = match usize::try_from(5 - exponent) {
            Ok(digits) if exponent >= -4 => {
                without_zeros(&format!("{:.digits$}", self.0)).to_owned()
            }
            _ => format!("{}e{exponent}", without_zeros(mantissa)),
        };
        formatter.pad(&text)
    }
}

/// A number with three digits, for advice.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

fn without_zeros(number: &str) -> &str {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

#[cfg(test)]
mod tests {
    use super::Six;

    #[test]
    fn digits_are_six_and_zeros_are_left_out() {
        for (number, text) in [
            (0.0, "0"),
            (-4.188_790_204_786_391, "-4.18879"),
            (2.5, "2.5"),
            (123_456.7, "123457"),
            (999_999.9, "1e6"),
            (1_234_567.0, "1.23457e6"),
            (0.000_123_456_78, "0.000123457"),
            (0.000_012_3, "1.23e-5"),
            (1e-300, "1e-300"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Six(number).to_string(), text);
        }
    }
}
