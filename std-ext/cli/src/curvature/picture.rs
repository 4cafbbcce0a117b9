//! The picture of `helfrich curvature`.

use crate::terminal::{Failure, save};
use helfrich::Surface;
use helfrich_std::measurement::{Column, Measurement};
use helfrich_std::method::{Evaluated, Fields};
use helfrich_std::painting::{OF_METHODS, Painting, scalars, values};
use helfrich_std::picture::{PaintedSurface, Picture, Shading, View};
use std::path::Path;

/// Width and height in pixels.
const SIZE: [u32; 2] = [900, 700];

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

/// Draws the surface in the colours of a quantity, with principal directions if they are known.
pub(super) fn draw<T: Evaluated>(
    path: &Path,
    quantity: &str,
    surface: Surface<'_, f64>,
    fields: &Fields<T>,
    columns: &[Column],
    measured: Option<&Measurement>,
) -> Result<(), Failure> {
    let values = values(quantity, fields, columns);
    let errors = scalars(columns, &format!("{quantity}_error"));
    let Some(painting) = Painting::new(values, errors) else {
        let message =
            format!("no vertex has a value of {quantity}: choose another --method or --colour-by");
        return Err(Failure::Input(message.into()));
    };
    let typical = painting.error;
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
            field: Some(&painting.values),
            shading: Shading::Smooth,
            edges: false,
            strokes: has_directions.then_some(&directions),
        }],
        colours: painting.colouring(&label),
        view: View::default(),
        length_unit: None,
    };
    let canvas = picture.draw().map_err(Failure::input)?;
    save(path, |out| canvas.encode_png(out))
}
