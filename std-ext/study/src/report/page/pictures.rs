//! The surface coloured by each method's error.

use super::accuracy::open_family;
use super::text::{count, escaped, percent, target};
use super::{Page, called, label};
use crate::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use crate::png;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use helfrich::Surface;
use std::io::{self, Write};

/// Common logarithms of the errors that the ends of the pictures' colours stand for.
const COLOURS: [f64; 2] = [-4.0, 1.0];

/// The surface coloured by each method's error, as PNG, by name.
pub(super) fn all(page: &Page<'_>) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut pictures = Vec::new();
    for fields in page.errors {
        let mesh = &fields.mesh;
        let surface = Surface::new(&mesh.mesh, &mesh.positions).map_err(io::Error::other)?;
        for (method, errors) in &fields.methods {
            // An error of 0 is below the range, but gets the lowest colour.
            let field = errors.iter().map(|&error| error.log10().clamp(-99.0, 99.0));
            let field = Vec::from_iter(field);
            let surfaces = [PaintedSurface {
                surface,
                field: Some(&field),
                shading: Shading::Smooth,
                edges: false,
                strokes: None,
            }];
            let picture = Picture {
                size: [420, 280],
                title: "",
                surfaces: &surfaces,
                colours: Colouring {
                    label: "log10 error",
                    range: Some(COLOURS),
                    map: ColourMap::Sequential,
                },
                view: View::default(),
                length_unit: None,
            };
            let canvas = picture.draw().map_err(io::Error::other)?;
            let mut bytes = Vec::new();
            png::encode(&canvas, &mut bytes)?;
            pictures.push((format!("surface-{}-{method}", fields.family), bytes));
        }
    }
    Ok(pictures)
}

pub(super) fn write(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Some(first) = page.errors.first() else {
        return Ok(());
    };
    let [low, high] = COLOURS.map(|exponent| target(10f64.powf(exponent)));
    writeln!(
        out,
        "<section id=\"pictures\"><h2>Where it is off</h2><p>The error of the {} at N = {}, every method on the same colours: \
         from {low} (dark) to {high} (light) of the largest exact value.</p>",
        called(first.quantity),
        count(first.mesh.mesh.vertex_count()),
    )?;
    let pictures = all(page)?;
    let mut pictures = pictures.iter();
    for (number, fields) in page.errors.iter().enumerate() {
        open_family(fields.family.name(), number > 0, out)?;
        writeln!(out, "<div class=\"gallery\">")?;
        for (method, errors) in &fields.methods {
            let Some((_, bytes)) = pictures.next() else {
                break;
            };
            let worst = errors.iter().copied().fold(0.0, f64::max);
            writeln!(
                out,
                "<figure><img loading=\"lazy\" width=\"420\" height=\"280\" alt=\"{}: largest error {}\" src=\"data:image/png;base64,{}\"><figcaption><b>{}</b> {}; worst {}</figcaption></figure>",
                escaped(method.name()),
                percent(worst),
                STANDARD.encode(bytes),
                label(*method),
                escaped(method.title()),
                percent(worst),
            )?;
        }
        writeln!(out, "</div></div>")?;
    }
    writeln!(out, "</section>")
}
