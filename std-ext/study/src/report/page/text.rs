//! Formatting of numbers and texts for the page.

use crate::picture::{Axis, AxisScale, Numbers};
use crate::report::SCATTERED;
use crate::study::Row;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;
use std::io::{self, Write};

/// A text with HTML special characters escaped.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Two digits of a positive number; powers of ten where it is very large or small.
pub fn digits(value: f64) -> String {
    significant(value, 2)
}

/// A positive number with `digits` digits; powers of ten where it is very large or small.
pub fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "∞".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    // The digits count for the rounded number: 0.999 is 1.0, not 1.00.
    let rounded = format!("{value:.0$e}", (digits - 1) as usize);
    let exponent = rounded.split_once('e');
    let exponent = exponent.and_then(|(_, exponent)| exponent.parse().ok());
    let exponent: i32 = exponent.unwrap_or(0);
    if !(-4..=4).contains(&exponent) {
        let text = format!("{value:.0e}");
        return match text.split_once('e') {
            Some((digit, exponent)) => format!("{digit}·10{}", raised(exponent)),
            None => text,
        };
    }
    let decimals = digits - 1 - exponent;
    if decimals > 0 {
        return format!("{value:.0$}", decimals as usize);
    }
    let unit = 10f64.powi(-decimals);
    format!("{}", (value / unit).round() * unit)
}

/// Superscript digits.
fn raised(number: &str) -> String {
    let high = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit
            .to_digit(10)
            .and_then(|digit| char::from_u32(0x2070 + digit))
            .unwrap_or(digit),
    };
    number.chars().map(high).collect()
}

/// A share of 1 in per cent.
pub fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

/// A target accuracy, a power of ten in per cent.
pub fn target(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 1))
}

/// Seconds in a unit that suits them.
pub fn time(seconds: f64) -> String {
    let (value, unit) = match seconds {
        seconds if seconds < 1e-6 => (1e9 * seconds, "ns"),
        seconds if seconds < 1e-3 => (1e6 * seconds, "µs"),
        seconds if seconds < 1.0 => (1e3 * seconds, "ms"),
        seconds => (seconds, "s"),
    };
    format!("{} {unit}", digits(value))
}

/// A measured time of a row, marked if the times scatter.
pub(in crate::report) fn time_of(row: &Row, seconds: f64) -> String {
    let mark = if row.is_scattered() { SCATTERED } else { "" };
    format!("{mark}{}", time(seconds))
}

/// Bytes in a unit that suits them.
pub fn bytes(count: f64) -> String {
    let (value, unit) = match count {
        count if count < 1e3 => (count, "B"),
        count if count < 1e6 => (1e-3 * count, "kB"),
        count => (1e-6 * count, "MB"),
    };
    format!("{} {unit}", digits(value))
}

/// An integer with separated thousands.
pub fn count(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// The label of a mark on an axis.
pub fn number_label(value: f64, axis: &Axis) -> String {
    let power = |value: f64| {
        let exponent = value.log10().round() as i32;
        if (-3..=3).contains(&exponent) && (value.log10() - f64::from(exponent)).abs() < 1e-9 {
            format!("{}", 10f64.powi(exponent))
        } else if (value.log10() - f64::from(exponent)).abs() < 1e-9 {
            format!("10{}", raised(&exponent.to_string()))
        } else {
            format!("{}", (value * 1e6).round() / 1e6)
        }
    };
    if axis.scale == AxisScale::Linear {
        return format!("{}", (value * 1e6).round() / 1e6);
    }
    match axis.numbers {
        Numbers::Plain => power(value),
        Numbers::Share => format!("{} %", power(100.0 * value)),
        Numbers::Time => match value {
            value if value < 0.99e-6 => format!("{} ns", power(1e9 * value)),
            value if value < 0.99e-3 => format!("{} µs", power(1e6 * value)),
            value if value < 0.99 => format!("{} ms", power(1e3 * value)),
            value => format!("{} s", power(value)),
        },
        Numbers::Bytes => match value {
            value if value < 0.99e3 => format!("{} B", power(value)),
            value if value < 0.99e6 => format!("{} kB", power(1e-3 * value)),
            value => format!("{} MB", power(1e-6 * value)),
        },
    }
}

/// A table of texts; the first column of each row is its head.
#[derive(Clone, Debug)]
pub struct Table {
    /// The line above it.
    pub caption: String,
    /// The names of its columns.
    pub head: Vec<String>,
    /// Its cells.
    pub rows: Vec<Vec<String>>,
    /// The table in full precision, as CSV: a header and lines.
    pub csv: String,
}

impl Table {
    /// Writes the table, with its numbers as a downloadable file named after `id`.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write(&self, id: &str, out: &mut dyn Write) -> io::Result<()> {
        // The caption is outside of the scrolling element, so that it is not as wide as the table.
        writeln!(
            out,
            "<p class=\"caption\" id=\"{id}-caption\">{}</p><div class=\"scroll\"><table id=\"{id}\" aria-labelledby=\"{id}-caption\"><thead><tr>",
            self.caption
        )?;
        for cell in &self.head {
            write!(out, "<th scope=\"col\">{cell}</th>")?;
        }
        writeln!(out, "</tr></thead><tbody>")?;
        for row in &self.rows {
            write!(out, "<tr>")?;
            for (column, cell) in row.iter().enumerate() {
                if column == 0 {
                    write!(out, "<th scope=\"row\">{cell}</th>")?;
                } else {
                    write!(out, "<td>{cell}</td>")?;
                }
            }
            writeln!(out, "</tr>")?;
        }
        writeln!(out, "</tbody></table></div>")?;
        if !self.csv.is_empty() {
            writeln!(
                out,
                "<p class=\"file\"><a download=\"{id}.csv\" href=\"data:text/csv;charset=utf-8;base64,{}\">{id}.csv</a></p>",
                STANDARD.encode(&self.csv)
            )?;
        }
        Ok(())
    }

    /// Writes the table in a collapsed element with its title.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write_folded(&self, id: &str, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "<details><summary>The numbers</summary>")?;
        self.write(id, out)?;
        writeln!(out, "</details>")
    }
}

/// Appends a line of CSV; numbers have enough digits to identify every f64.
pub fn csv_line(text: &mut String, cells: &[&dyn std::fmt::Display]) {
    for (number, cell) in cells.iter().enumerate() {
        let comma = if number == 0 { "" } else { "," };
        let _ = write!(text, "{comma}{cell}");
    }
    text.push('\n');
}

/// An order of convergence, always with its sign.
pub fn signed(order: f64) -> String {
    if order.is_finite() {
        format!("{order:+.1}").replace('-', "−")
    } else {
        "–".to_owned()
    }
}
