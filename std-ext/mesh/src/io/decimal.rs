//! Numbers as decimal text.

use std::fmt::Write as _;

/// Appends a number with the fewest digits that identify it, in the form of `{:?}` (`{}` writes 1e-18 with 18
/// zeros). If two shortest texts are equally close to the number, `zmij` may choose another one than `{:?}`.
pub fn push_number(text: &mut String, number: f64) {
    // Outside these ranges, `zmij` writes zeros where `{:?}` has an exponent, or `e+16` for its `e16`.
    let size = number.abs();
    if size < 1e-5 || (1e-4..1e16).contains(&size) {
        text.push_str(zmij::Buffer::new().format(number));
    } else {
        let _ = write!(text, "{number:?}");
    }
}

/// Appends a comma and a number for each field of a line; an unknown number leaves the field empty.
pub fn push_fields(text: &mut String, fields: &[Option<f64>]) {
    for field in fields {
        text.push(',');
        if let Some(number) = *field {
            push_number(text, number);
        }
    }
}
