//! Runs of populations.

use super::remeshing::{column, continues, runs};
use helfrich_std::io::read_with_columns;
use helfrich_std::run::End;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use std::fmt::Write as _;
use tempfile::TempDir;

const KIND: &str = r#"
shape = "ellipsoid:1,1,0.6"
vertices = 162
elasticity = { law = "skalak", shear_modulus = 1, area_ratio = 10 }
"#;

fn scene(surfaces: &str) -> String {
    format!(
        r#"
units = "none"
{surfaces}
[[interaction]]
kind = "repulsion"
strength = 10
cutoff = 0.4
[driver]
kind = "lattice-boltzmann"
viscosity = 1
spacing = 0.3
box = [5.1, 5.1, 5.1]
flow = {{ kind = "shear", rate = 0.5 }}
duration = 0.2
[output]
interval = 0.05
pictures = false
"#
    )
}

/// A population moves as its surfaces written one by one, to the last bit; its columns are their means and standard
/// deviations, on request those of each surface, its files have all of them, and runs continue to the bit.
#[test]
fn a_population_is_its_surfaces() {
    let folder = TempDir::new().expect("a folder");
    let [whole, apart] = ["whole", "apart"].map(|name| folder.path().join(name));
    let text = scene(&format!(
        "[[population]]\nname = \"cells\"\ncount = 5\nper_cell = true\n{KIND}"
    ));
    let summary = runs(&text, folder.path(), &whole, false, usize::MAX);
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    let file = SceneFile::parse(&text, folder.path(), &Overrides::default()).expect("a scene");
    let mut surfaces = String::new();
    for surface in &file.scene.surfaces {
        let (name, position) = (&surface.name, surface.position);
        let turned = surface.orientation.expect("a random orientation");
        let _ = writeln!(
            surfaces,
            "[[surface]]\nname = \"{name}\"\nposition = {position:?}\norientation = {{ axis = {:?}, angle = {:?} }}\n{KIND}",
            turned.axis, turned.angle
        );
    }
    runs(&scene(&surfaces), folder.path(), &apart, false, usize::MAX);
    let names = Vec::from_iter(
        file.scene
            .surfaces
            .iter()
            .map(|surface| surface.name.clone()),
    );
    for of in [
        "deformation",
        "energy_elasticity",
        "centroid_x",
        "smallest_angle",
    ] {
        let all = Vec::from_iter(
            names
                .iter()
                .map(|name| column(&apart, &format!("{of}_{name}"))),
        );
        let own = SeriesTable::read(&whole.join("series-cells.csv")).expect("a series");
        let numbers = own.column("cell").expect("numbers").into_iter();
        let numbers = numbers.zip(own.column(of).expect("a column"));
        let expected = (0..all[0].len()).flat_map(|row| all.iter().map(move |one| one[row]));
        let expected = (1..=5).map(f64::from).cycle().zip(expected);
        assert!(numbers.eq(expected), "{of}");
        let means = column(&whole, &format!("cells_mean_{of}"));
        let deviations = column(&whole, &format!("cells_sd_{of}"));
        for (row, (mean, deviation)) in means.into_iter().zip(deviations).enumerate() {
            let values = || all.iter().map(|values| values[row]);
            let expected = values().sum::<f64>() / 5.0;
            let squares = values()
                .map(|value| (value - expected).powi(2))
                .sum::<f64>();
            assert_eq!(mean, expected, "{of}, row {row}");
            assert!(
                (deviation - (squares / 4.0).sqrt()).abs() <= 1e-12 * deviation,
                "{of}, row {row}"
            );
        }
    }
    assert!(
        column(&whole, "cells_sd_deformation")
            .iter()
            .all(|&sd| sd > 0.0)
    );
    let (together, columns) = read_with_columns(&whole.join("last.vtp")).expect("a mesh");
    let cell = columns
        .iter()
        .find(|column| column.name == "cell")
        .expect("a column");
    let mut begin = 0;
    for (number, name) in names.iter().enumerate() {
        let (own, _) = read_with_columns(&apart.join(format!("last-{name}.vtp"))).expect("a mesh");
        let end = begin + own.positions.len();
        assert_eq!(together.positions[begin..end], own.positions, "{name}");
        assert!(
            cell.values[begin..end]
                .iter()
                .all(|&value| value == number as f64 + 1.0)
        );
        begin = end;
    }
    assert_eq!(begin, together.positions.len());
    let costs = summary
        .effects
        .iter()
        .filter(|cost| cost.effect.contains("elasticity"));
    let costs = Vec::from_iter(costs.map(|cost| cost.effect.as_str()));
    assert_eq!(costs, ["elasticity_cells"]);
    continues(&text, folder.path(), &whole, 3);
}
