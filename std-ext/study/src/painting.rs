//! Quantities as colours of a surface.

use crate::measurement::{Column, ColumnValues};
use crate::method::{Evaluated, Fields};
use crate::picture::{ColourMap, Colouring};

/// The quantities that every surface can be coloured by.
pub const OF_METHODS: [&str; 3] = ["H", "K", "f"];

/// The quantities that a surface can be coloured by, by the names of their columns. A measurement has those
/// that are not among [`OF_METHODS`].
pub const QUANTITIES: [&str; 15] = [
    "H",
    "K",
    "f",
    "k1",
    "k2",
    "curvedness",
    "shape_index",
    "H_error",
    "K_error",
    "f_error",
    "k1_error",
    "k2_error",
    "curvedness_error",
    "shape_index_error",
    "sigma",
];

/// The unit of a quantity that has this name as a column, in lengths of the file and, for f, κ; empty if it is a
/// number.
pub fn unit(quantity: &str) -> &'static str {
    match quantity.strip_suffix("_error").unwrap_or(quantity) {
        "H" | "k1" | "k2" | "curvedness" => "1/length",
        "K" => "1/length²",
        "f" => "κ/length³",
        "sigma" => "length",
        _ => "",
    }
}

/// A quantity at every vertex; NaN where there is none. f is that along the normal.
pub fn values<T: Evaluated>(quantity: &str, fields: &Fields<T>, columns: &[Column]) -> Vec<f64> {
    let number = |value: T| value.to_f64().unwrap_or(f64::NAN);
    let numbers = |values: &[Option<T>]| {
        let numbers = values.iter().map(|value| value.map_or(f64::NAN, number));
        numbers.collect()
    };
    match quantity {
        "H" => numbers(&fields.mean),
        "K" => numbers(&fields.gaussian),
        "f" => {
            let both = fields.force_density.iter().zip(&fields.normal);
            let along = both.map(|(density, normal)| {
                let parts = density.iter().flatten().zip(normal);
                let along = parts.map(|(&f, &n)| number(f) * number(n));
                density.map_or(f64::NAN, |_| along.sum())
            });
            along.collect()
        }
        _ => scalars(columns, quantity).to_vec(),
    }
}

/// The numbers of a column; none if there is no such column.
pub fn scalars<'a>(columns: &'a [Column], name: &str) -> &'a [f64] {
    let column = columns.iter().find(|column| column.name == name);
    match column.map(|column| &column.values) {
        Some(ColumnValues::Scalars(values)) => values,
        _ => &[],
    }
}

/// The finite value below which a fraction of them lies; NaN without any.
pub fn quantile(values: &[f64], part: f64) -> f64 {
    let mut values = Vec::from_iter(values.iter().copied().filter(|value| value.is_finite()));
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    let at = (part * last) as usize;
    values.get(at).copied().unwrap_or(f64::NAN)
}

/// A quantity as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Painting {
    /// The values that have a colour; NaN where a colour would say nothing.
    pub values: Vec<f64>,
    /// The values at the ends of the colours, if they do not follow from the values.
    pub range: Option<[f64; 2]>,
    /// The colours.
    pub map: ColourMap,
    /// The median error bar; NaN if none is known.
    pub error: f64,
}

impl Painting {
    /// The colours of values with these error bars, of which there may be none. `None` if no value is finite.
    ///
    /// Colours span four median error bars at least: noise is not to look like shape. Where twice the bar is
    /// more than they span, there is no colour: it would say nothing.
    pub fn new(mut values: Vec<f64>, errors: &[f64]) -> Option<Self> {
        let [low, middle, high] = [0.01, 0.5, 0.99].map(|part| quantile(&values, part));
        if middle.is_nan() {
            return None;
        }
        let error = quantile(errors, 0.5);
        let is_noise = high - low < 4.0 * error;
        // Values that are equal but for rounding would need more digits than a bar of colours has.
        let half = (2.0 * error).max(0.01 * middle.abs());
        let span = if is_noise { 2.0 * half } else { high - low };
        for (value, &error) in values.iter_mut().zip(errors) {
            // Also where nothing is known of the error.
            if error.is_nan() || 2.0 * error > span {
                *value = f64::NAN;
            }
        }
        // Values that cannot be told from 0 have a scale on both sides of it.
        let is_zero = is_noise && half > middle.abs();
        let is_signed = is_zero || values.iter().any(|&value| value < 0.0);
        let range = is_noise.then(|| match is_signed {
            true => [-half - middle.abs(), half + middle.abs()],
            false => [middle - half, middle + half],
        });
        let map = match is_signed {
            true => ColourMap::Diverging,
            false => ColourMap::Sequential,
        };
        Some(Self {
            values,
            range,
            map,
            error,
        })
    }

    /// The map from the values to colours, with a label.
    pub fn colouring<'a>(&self, label: &'a str) -> Colouring<'a> {
        Colouring {
            label,
            range: self.range,
            map: self.map,
        }
    }
}
