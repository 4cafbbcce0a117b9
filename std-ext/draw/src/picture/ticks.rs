//! Ticks of an axis, and their labels.

/// Marks at multiples of 1, 2 or 5 times a power of ten.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// The position of each tick, and its label.
    pub(super) marks: Vec<(f64, String)>,
    /// Marks without labels in between.
    pub(super) minor: Vec<f64>,
    /// Power of ten by which the labels are to be multiplied.
    pub(super) exponent: i32,
}

/// 10^exponent.
fn power_of_ten(exponent: i32) -> f64 {
    libm::exp10(f64::from(exponent))
}

/// Exponent of the largest power of ten that is not above a number.
fn magnitude(number: f64) -> i32 {
    libm::log10(number).floor() as i32
}

impl Ticks {
    /// Marks from `low` to `high`, about `count` of them.
    pub(super) fn linear(low: f64, high: f64, count: f64) -> Self {
        let (digit, step_exponent) = nice_step((high - low) / count);
        let multiple = |number: i64| scaled(number * digit, step_exponent);
        let unit = multiple(1);
        // The slack keeps marks at the very ends of the range despite rounding.
        let slack = 1e-9 * (high - low) / unit;
        let first = (low / unit - slack).ceil();
        let last = (high / unit + slack).floor();
        let largest = low.abs().max(high.abs());
        let top = if largest > 0.0 { magnitude(largest) } else { 0 };
        let exponent = if (-3..=4).contains(&top) { 0 } else { top };
        // At the limits of f64 a step may be 0; then there are no marks.
        let count = if unit > 0.0 && last - first < 100.0 {
            (last - first) as i64 + 1
        } else {
            0
        };
        let numbers = (0..count).map(|at| first as i64 + at);
        Self {
            marks: numbers
                .map(|number| {
                    let label = label(number * digit, step_exponent - exponent);
                    (multiple(number), label)
                })
                .collect(),
            minor: Vec::new(),
            exponent,
        }
    }

    /// Marks at powers of ten from `low` to `high`, both above 0; linear ones if the range contains less than
    /// a decade.
    pub(super) fn logarithmic(low: f64, high: f64, count: f64) -> Self {
        let [first, last] = [libm::log10(low), libm::log10(high)];
        let (first, last) = ((first - 1e-9).ceil() as i32, (last + 1e-9).floor() as i32);
        if last - first < 1 {
            return Self::linear(low, high, count);
        }
        let every = (f64::from(last - first) / count).ceil().max(1.0) as usize;
        let minor = match every {
            1 => (first - 1..=last)
                .flat_map(|decade| (2..10).map(move |digit| scaled(digit, decade)))
                .filter(|mark| (low..=high).contains(mark))
                .collect(),
            _ => (first..=last).map(power_of_ten).collect(),
        };
        Self {
            marks: (first..=last)
                .step_by(every)
                .map(|decade| (power_of_ten(decade), format!("10{}", superscript(decade))))
                .collect(),
            minor,
            exponent: 0,
        }
    }

    /// An axis' label with the power of ten in front of the unit: `f [N/m²]` becomes
    /// `f [10⁻³ N/m²]`.
    pub(super) fn labelled(&self, label: &str) -> String {
        if self.exponent == 0 {
            return label.to_owned();
        }
        let power = format!("10{}", superscript(self.exponent));
        match label.rsplit_once('[') {
            Some((name, unit)) if unit.ends_with(']') => format!("{name}[{power} {unit}"),
            _ => format!("{label} [{power}]").trim_start().to_owned(),
        }
    }
}

/// Number of the form 1, 2 or 5 times a power of ten that is nearest to a number by ratio.
fn nice_step(number: f64) -> (i64, i32) {
    let exponent = magnitude(number);
    let fraction = number / power_of_ten(exponent);
    // The limits are the geometric means √(1 · 2), √(2 · 5) and √(5 · 10).
    match fraction * fraction {
        ..2.0 => (1, exponent),
        ..10.0 => (2, exponent),
        ..50.0 => (5, exponent),
        _ => (1, exponent + 1),
    }
}

/// number · 10^exponent.
fn scaled(number: i64, exponent: i32) -> f64 {
    if exponent < 0 {
        number as f64 / power_of_ten(-exponent)
    } else {
        number as f64 * power_of_ten(exponent)
    }
}

/// Decimal digits of number · 10^exponent, without rounding.
fn label(number: i64, exponent: i32) -> String {
    let sign = if number < 0 { "−" } else { "" };
    let digits = number.unsigned_abs().to_string();
    if number == 0 {
        return "0".to_owned();
    }
    if exponent >= 0 {
        return format!("{sign}{digits}{}", "0".repeat(exponent as usize));
    }
    let decimals = exponent.unsigned_abs() as usize;
    let digits = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    format!("{sign}{whole}.{fraction}")
}

fn superscript(number: i32) -> String {
    let raised = |digit| match digit {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        _ => '⁹',
    };
    number.to_string().chars().map(raised).collect()
}

/// Largest number of the form 1, 2 or 5 times a power of ten that is not above a number, and its label.
pub(super) fn nice_length(most: f64) -> (f64, String) {
    let exponent = magnitude(most);
    let fraction = most / power_of_ten(exponent);
    let digit = match fraction {
        5.0.. => 5,
        2.0.. => 2,
        _ => 1,
    };
    let text = if (-3..=4).contains(&exponent) {
        label(digit, exponent)
    } else {
        format!("{digit}·10{}", superscript(exponent))
    };
    (scaled(digit, exponent), text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> (Vec<String>, String) {
        let ticks = Ticks::linear(low, high, 5.0);
        for (value, _) in &ticks.marks {
            assert!((low..=high).contains(value), "{value}");
        }
        let label = ticks.labelled("f [N]");
        (ticks.marks.into_iter().map(|mark| mark.1).collect(), label)
    }

    #[test]
    fn labels_are_round_numbers() {
        assert_eq!(labels(0.0, 1.0).0, ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-1.0, 1.0).0, ["−1.0", "−0.5", "0", "0.5", "1.0"]);
        assert_eq!(labels(0.0, 193.0).0, ["0", "50", "100", "150"]);
        assert_eq!(
            labels(1.07, 1.13).0,
            ["1.07", "1.08", "1.09", "1.10", "1.11", "1.12", "1.13"]
        );
        let (found, label) = labels(0.0, 4.1e-7);
        assert_eq!(found, ["0", "1", "2", "3", "4"]);
        assert_eq!(label, "f [10⁻⁷ N]");
        let (found, label) = labels(-2.5e12, 0.0);
        assert_eq!(found, ["−2.5", "−2.0", "−1.5", "−1.0", "−0.5", "0"]);
        assert_eq!(label, "f [10¹² N]");
        let decades = Ticks::logarithmic(1e-12, 3.0, 6.0);
        let decades: Vec<_> = decades.marks.into_iter().map(|mark| mark.1).collect();
        assert_eq!(
            decades,
            ["10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]
        );
        assert_eq!(nice_length(7.3), (5.0, "5".to_owned()));
        assert_eq!(nice_length(0.49), (0.2, "0.2".to_owned()));
        assert_eq!(nice_length(3e-7).1, "2·10⁻⁷");
    }
}
