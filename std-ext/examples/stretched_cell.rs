//! Draws the diameters of the scene `red-blood-cell-stretched` beside what was measured with optical
//! tweezers:
//!
//! ```console
//! cargo run --release --example stretched_cell -- stretched-cell.png
//! ```
#![expect(clippy::print_stderr, reason = "progress, for whoever waits")]

use helfrich_std::picture::{Axis, Chart, Curve, Marks, Point};
use helfrich_std::run::run;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::build;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let picture = std::env::args().nth(1);
    let picture = picture.ok_or("the name of the picture is missing, as in stretched-cell.png")?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));

    // The equilibrium under each force: of each load only its end is written.
    let overrides = Overrides::new([
        "output.every=1000000",
        "output.surfaces=false",
        "output.pictures=false",
    ])?;
    let scene = root.join("scenes/red-blood-cell-stretched.toml");
    let file = SceneFile::read(&scene, &overrides)?;
    let folder = tempfile::TempDir::new()?;
    let mut said = 0.0;
    run(
        &file.scene,
        build(&file)?,
        &folder.path().join("out"),
        false,
        &|| false,
        &mut |progress| {
            if progress.fraction >= said {
                eprintln!("{:3.0} %, {}", 100.0 * progress.fraction, progress.message);
                said = progress.fraction + 0.05;
            }
        },
    )?;
    let series = SeriesTable::read(&folder.path().join("out/series.csv"))?;
    let column = |name: &str| series.column(name).ok_or(format!("no column {name}"));
    let forces = column("force")?;
    let curve = |name: &str| -> Result<Vec<[f64; 2]>, Box<dyn Error>> {
        // The first row is the start.
        let points = forces.iter().zip(column(name)?).skip(1);
        Ok(points.map(|(&force, diameter)| [force, diameter]).collect())
    };
    let [axial, transverse] = [curve("axial_diameter")?, curve("transverse_diameter")?];

    let data = std::fs::read_to_string(root.join("../tests/data/mills2004.csv"))?;
    let mut measured = [(); 4].map(|()| Vec::new());
    for line in data
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
    {
        let row: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        measured[0].push([row[0], row[1]]);
        measured[1].push([row[3], row[4]]);
        measured[2].push([row[0], row[2]]);
        measured[3].push([row[5], row[6]]);
    }
    let [lengths, length_bounds, widths, width_bounds] = measured;
    let with_bounds = |(at, bounds)| Point {
        bounds: Some(bounds),
        ..Point::from(at)
    };
    let published = |name: &str, points: Vec<[f64; 2]>, bounds: Vec<[f64; 2]>| Curve {
        name: name.to_owned(),
        points: points.into_iter().zip(bounds).map(with_bounds).collect(),
        marks: Marks::Points,
        style: Some(1),
        ..Curve::default()
    };
    let computed = |name: &str, points: Vec<[f64; 2]>| Curve {
        name: name.to_owned(),
        points: points.into_iter().map(Point::from).collect(),
        style: Some(0),
        ..Curve::default()
    };
    let chart = Chart {
        title: "Red blood cell stretched by optical tweezers".to_owned(),
        axes: [
            Axis {
                label: "force (pN)".to_owned(),
                ..Axis::default()
            },
            Axis {
                label: "diameter (µm)".to_owned(),
                range: Some([0.0, 20.0]),
                ..Axis::default()
            },
        ],
        curves: vec![
            published("measured, Mills et al. 2004", widths, width_bounds),
            published("", lengths, length_bounds),
            computed("axial and transverse diameter, computed", axial),
            computed("", transverse),
        ],
        guides: Vec::new(),
    };
    chart.draw([900, 640])?.write_png(Path::new(&picture))?;
    Ok(())
}
