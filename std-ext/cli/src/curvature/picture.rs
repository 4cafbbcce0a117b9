//! The picture of `helfrich curvature`.

use super::to_f64;
use crate::terminal::Failure;
use helfrich::Surface;
use helfrich_std::measurement::{Column, ColumnValues};
use helfrich_std::method::{Evaluated, Fields};
use helfrich_std::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use std::path::Path;

/// Width and height in pixels.
const SIZE: [u32; 2] = [900, 700];

/// The quantities that a surface can be coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Painted {
    /// Mean curvature.
    #[value(name = "H")]
    Mean,
    /// Gaussian curvature.
    #[value(name = "K")]
    Gaussian,
    /// Force density along the normal.
    #[value(name = "f")]
    ForceDensity,
    /// The larger principal curvature.
    #[value(name = "k1")]
    Larger,
    /// The smaller principal curvature.
    #[value(name = "k2")]
    Smaller,
}

impl Painted {
    fn name(self) -> &'static str {
        match self {
            Self::Mean => "H",
            Self::Gaussian => "K",
            Self::ForceDensity => "f",
            Self::Larger => "k1",
            Self::Smaller => "k2",
        }
    }

    /// Whether only a measurement has it.
    pub(super) fn is_measured(self) -> bool {
        matches!(self, Self::Larger | Self::Smaller)
    }

    fn of<T: Evaluated>(self, fields: &Fields<T>, columns: &[Column]) -> Vec<f64> {
        let numbers = |values: &[Option<T>]| {
            let numbers = values.iter().map(|value| value.map_or(f64::NAN, to_f64));
            numbers.collect()
        };
        match self {
            Self::Mean => numbers(&fields.mean),
            Self::Gaussian => numbers(&fields.gaussian),
            Self::ForceDensity => {
                let both = fields.force_density.iter().zip(&fields.normal);
                let along = both.map(|(density, normal)| {
                    let parts = density.iter().flatten().zip(normal);
                    let along = parts.map(|(&f, &n)| to_f64(f) * to_f64(n));
                    density.map_or(f64::NAN, |_| along.sum())
                });
                along.collect()
            }
            Self::Larger | Self::Smaller => scalars(columns, self.name()).to_vec(),
        }
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

/// The vectors of a column; `None` if there is no such column.
fn vectors<'a>(columns: &'a [Column], name: &str) -> Option<&'a [[f64; 3]]> {
    let column = columns.iter().find(|column| column.name == name)?;
    match &column.values {
        ColumnValues::Vectors(values) => Some(values),
        _ => None,
    }
}

/// The part of sorted finite values up to which a fraction of them lies.
fn quantile(values: &[f64], part: f64) -> f64 {
    let mut values = Vec::from_iter(values.iter().copied().filter(|value| value.is_finite()));
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    let at = (part * last) as usize;
    values.get(at).copied().unwrap_or(f64::NAN)
}

/// Draws the surface in the colours of a quantity, with principal directions if they are known. Where the
/// error bar is as wide as the range of the values, the surface is grey: colours would say nothing.
pub(super) fn draw<T: Evaluated>(
    path: &Path,
    quantity: Painted,
    surface: Surface<'_, f64>,
    fields: &Fields<T>,
    columns: &[Column],
) -> Result<(), Failure> {
    let name = quantity.name();
    let mut values = quantity.of(fields, columns);
    let errors = scalars(columns, &format!("{name}_error"));
    let range = quantile(&values, 0.99) - quantile(&values, 0.01);
    let range = range.max(quantile(&values, 0.5).abs());
    for (value, &error) in values.iter_mut().zip(errors) {
        // Also grey where nothing is known of the error.
        if error.is_nan() || error > range {
            *value = f64::NAN;
        }
    }
    let mut label = name.to_owned();
    let typical = quantile(errors, 0.5);
    if typical.is_finite() {
        label = format!("{name} (median error bar {typical:.1e})");
    }
    let directions = ["direction1", "direction2"];
    let strokes = Vec::from_iter(directions.iter().filter_map(|name| vectors(columns, name)));
    let is_signed = values.iter().any(|&value| value < 0.0);
    let picture = Picture {
        size: SIZE,
        title: "",
        surfaces: &[PaintedSurface {
            surface,
            field: Some(&values),
            shading: Shading::Smooth,
            edges: false,
            strokes: &strokes,
        }],
        colours: Colouring {
            label: &label,
            range: None,
            map: match is_signed {
                true => ColourMap::Diverging,
                false => ColourMap::Sequential,
            },
        },
        view: View::default(),
        length_unit: None,
    };
    let canvas = picture.draw().map_err(Failure::input)?;
    canvas
        .write_png(path)
        .map_err(|error| Failure::output(path.display(), &error))
}
