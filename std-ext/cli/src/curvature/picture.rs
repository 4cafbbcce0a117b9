//! The picture of `helfrich curvature`.

use super::to_f64;
use crate::terminal::{Failure, save};
use helfrich::Surface;
use helfrich_std::measurement::{Column, ColumnValues, Measurement};
use helfrich_std::method::{Evaluated, Fields};
use helfrich_std::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use std::path::Path;

/// Width and height in pixels.
const SIZE: [u32; 2] = [900, 700];

/// The quantities that every surface can be coloured by.
const OF_METHODS: [&str; 3] = ["H", "K", "f"];

/// The quantities that a surface can be coloured by, by the names of their columns. A measurement has those
/// that are not among [`OF_METHODS`].
pub(super) const QUANTITIES: [&str; 15] = [
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

/// Checks a picture's name and quantity before the work starts.
pub(super) fn check(path: &Path, quantity: &str, is_measured: bool) -> Result<(), Failure> {
    let is_png = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("png"));
    if !is_png {
        let path = path.display();
        let message = format!("{path}: pictures are PNG files: give it a name that ends in .png");
        return Err(Failure::Input(message.into()));
    }
    if !is_measured && !OF_METHODS.contains(&quantity) {
        let message = format!("--colour-by {quantity} is for --method jet, or with --errors");
        return Err(Failure::Input(message.into()));
    }
    Ok(())
}

/// A quantity at every vertex; NaN where there is none.
fn values<T: Evaluated>(quantity: &str, fields: &Fields<T>, columns: &[Column]) -> Vec<f64> {
    let numbers = |values: &[Option<T>]| {
        let numbers = values.iter().map(|value| value.map_or(f64::NAN, to_f64));
        numbers.collect()
    };
    match quantity {
        "H" => numbers(&fields.mean),
        "K" => numbers(&fields.gaussian),
        "f" => {
            let both = fields.force_density.iter().zip(&fields.normal);
            let along = both.map(|(density, normal)| {
                let parts = density.iter().flatten().zip(normal);
                let along = parts.map(|(&f, &n)| to_f64(f) * to_f64(n));
                density.map_or(f64::NAN, |_| along.sum())
            });
            along.collect()
        }
        _ => scalars(columns, quantity).to_vec(),
    }
}

/// The numbers of a column; none if there is no such column.
fn scalars<'a>(columns: &'a [Column], name: &str) -> &'a [f64] {
    let column = columns.iter().find(|column| column.name == name);
    match column.map(|column| &column.values) {
        Some(ColumnValues::Scalars(values)) => values,
        _ => &[],
    }
}

/// The finite value below which a fraction of them lies; NaN without any.
fn quantile(values: &[f64], part: f64) -> f64 {
    let mut values = Vec::from_iter(values.iter().copied().filter(|value| value.is_finite()));
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    let at = (part * last) as usize;
    values.get(at).copied().unwrap_or(f64::NAN)
}

/// Draws the surface in the colours of a quantity, with principal directions if they are known.
///
/// Colours span four median error bars at least: noise is not to look like shape. Where twice the bar is
/// more than they span, the surface is grey: a colour would say nothing.
pub(super) fn draw<T: Evaluated>(
    path: &Path,
    quantity: &str,
    surface: Surface<'_, f64>,
    fields: &Fields<T>,
    columns: &[Column],
    measured: Option<&Measurement>,
) -> Result<(), Failure> {
    let mut values = values(quantity, fields, columns);
    let [low, middle, high] = [0.01, 0.5, 0.99].map(|part| quantile(&values, part));
    if middle.is_nan() {
        let message =
            format!("no vertex has a value of {quantity}: choose another --method or --colour-by");
        return Err(Failure::Input(message.into()));
    }
    let errors = scalars(columns, &format!("{quantity}_error"));
    let typical = quantile(errors, 0.5);
    let is_noise = high - low < 4.0 * typical;
    // Values that are equal but for rounding would need more digits than a bar of colours has.
    let half = (2.0 * typical).max(0.01 * middle.abs());
    let span = if is_noise { 2.0 * half } else { high - low };
    for (value, &error) in values.iter_mut().zip(errors) {
        // Also grey where nothing is known of the error.
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
    let mut label = quantity.to_owned();
    if typical.is_finite() {
        label = format!("{quantity} (median error bar {typical:.1e})");
    }
    let vertices = measured.map_or(&[][..], |measured| &measured.vertices);
    let directions = Vec::from_iter(vertices.iter().map(|vertex| vertex.directions));
    let has_directions = directions.iter().any(Option::is_some);
    let picture = Picture {
        size: SIZE,
        title: match has_directions {
            true => "directions of k₁ (long lines) and k₂ (short lines)",
            false => "",
        },
        surfaces: &[PaintedSurface {
            surface,
            field: Some(&values),
            shading: Shading::Smooth,
            edges: false,
            strokes: has_directions.then_some(&directions),
        }],
        colours: Colouring {
            label: &label,
            range,
            map: match is_signed {
                true => ColourMap::Diverging,
                false => ColourMap::Sequential,
            },
        },
        view: View::default(),
        length_unit: None,
    };
    let canvas = picture.draw().map_err(Failure::input)?;
    save(path, |out| canvas.encode_png(out))
}
