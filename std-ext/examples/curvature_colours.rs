//! Colours a mesh file by its mean curvature: a picture, and a colour a vertex for a renderer of your
//! own.
//!
//! ```console
//! cargo run --release --example curvature_colours -- cell.ply cell.png
//! ```
//!
//! Without arguments it draws the shape of a red blood cell into `curvature.png`.
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use helfrich::Surface;
use helfrich_std::generate::{Family, generate};
use helfrich_std::io::{MeshFile, read};
use helfrich_std::method::{BendingMethod, Evaluator};
use helfrich_std::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let MeshFile {
        positions, mesh, ..
    } = match arguments.first() {
        Some(file) => read(Path::new(file))?,
        None => {
            let cell = generate(&"discocyte".parse()?, Family::Smooth, 2562, 1)?;
            MeshFile::new(cell.positions, cell.mesh)
        }
    };
    let surface = Surface::new(&mesh, &positions)?;
    let mut evaluator = Evaluator::new(BendingMethod::Jet, 1.0, &mesh);
    let fields = evaluator.fields(surface);
    // Vertices at a boundary have no curvature, and are drawn grey.
    let mean: Vec<f64> = fields.mean.iter().map(|h| h.unwrap_or(f64::NAN)).collect();

    // Blue where the surface is hollow, red where it bulges, by what most of it has.
    let mut sizes: Vec<f64> = mean
        .iter()
        .filter(|h| h.is_finite())
        .map(|h| h.abs())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let most = sizes.get(sizes.len() * 95 / 100).copied().unwrap_or(1.0);
    let colour = |h: f64| {
        let share = (h / most).clamp(-1.0, 1.0);
        let pale = 1.0 - share.abs();
        match share {
            share if share.is_nan() => [0.5; 3],
            share if share < 0.0 => [pale, pale, 1.0],
            _ => [1.0, pale, pale],
        }
    };
    let colours: Vec<[f64; 3]> = mean.iter().map(|&h| colour(h)).collect();
    println!("{} colours, the first {:?}", colours.len(), colours[0]);

    let surfaces = [PaintedSurface {
        surface,
        field: Some(&mean),
        shading: Shading::Smooth,
        edges: false,
        strokes: None,
    }];
    let picture = Picture {
        size: [900, 700],
        title: "mean curvature",
        surfaces: &surfaces,
        colours: Colouring {
            label: "H",
            range: None,
            map: ColourMap::Diverging,
        },
        view: View::default(),
        length_unit: None,
    };
    let file = arguments.get(1).map_or("curvature.png", String::as_str);
    picture.draw()?.write_png(Path::new(file))?;
    println!("written to {file}");
    Ok(())
}
