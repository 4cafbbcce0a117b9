//! Measurements of suspensions.

use super::remeshing::{column, continues, runs};
use helfrich_std::rheology::{block_average, free_layer, means_between};
use helfrich_std::run::{End, Summary};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const KIND: &str = r#"
shape = "sphere:1"
vertices = 162
elasticity = { law = "neo-hookean", shear_modulus = 1 }
bending = { method = "B", modulus = 0.02 }
"#;

/// Capsules in a sheared box of this length and depth, which repel each other and their images.
fn scene(surfaces: &str, [length, depth]: [f64; 2], strain: f64, more: &str) -> String {
    format!(
        r#"
units = "none"
{surfaces}
[[interaction]]
kind = "repulsion"
strength = 5
cutoff = 0.5
[driver]
kind = "lattice-boltzmann"
viscosity = 1
spacing = 0.25
box = [{length}, 4, {depth}]
flow = {{ kind = "shear", rate = 0.4 }}
strain = {strain}
[output]
strain_interval = 0.05
files_every = 1000
pictures = false
checkpoint_every = 20
[output.rheology]
{more}
"#
    )
}

fn one(more: &str) -> String {
    format!("[[surface]]\nname = \"one\"\n{KIND}\n{more}")
}

/// Two capsules at these places.
fn two(places: [(&str, [f64; 3]); 2]) -> String {
    let surface = |(name, place): (&str, [f64; 3])| {
        format!("[[surface]]\nname = \"{name}\"\nposition = {place:?}\n{KIND}\n")
    };
    places.map(surface).concat()
}

fn ended(text: &str, folder: &Path, out: &Path) -> Summary {
    let summary = runs(text, folder, out, false, usize::MAX);
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    summary
}

/// The rows of a table without its header.
fn table(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).expect("a table");
    let fields = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(fields).collect()
}

/// In a steady state the walls feel the stress of the undisturbed fluid and that of the membranes, however capsules push
/// their images, and whatever the viscosity inside. With 0.25 radii from node to node, the step of the viscosity is smeared
/// over the surface, for 0.7 % of the whole stress; it is a half of that with 0.125.
#[test]
fn walls_feel_the_stress_of_membranes() {
    let folder = TempDir::new().expect("a folder");
    for (name, ratio, size, allowed) in [
        ("alone", 1.0, [4.5, 3.0], 0.002),
        ("pushed", 1.0, [2.3, 2.6], 0.003),
        ("viscous", 3.0, [4.5, 3.0], 0.01),
        ("thin", 0.2, [4.5, 3.0], 0.01),
    ] {
        let out = folder.path().join(name);
        let surface = one(&format!("viscosity_ratio = {ratio}"));
        let text = scene(&surface, size, 5.0, "skip = 4.5\nblocks = 2")
            .replace("strain_interval = 0.05", "strain_interval = 0.25");
        let summary = ended(&text, folder.path(), &out);
        let mean = |name: &str| {
            let found = summary.rheology.iter().find(|it| it.quantity == name);
            found.unwrap_or_else(|| panic!("no {name}")).mean
        };
        let (walls, membranes) = (mean("wall_stress"), mean("particle_stress_xy"));
        assert!(membranes > 0.06, "{name}: {membranes}");
        let expected = 0.4 + membranes;
        assert!(
            (walls / expected - 1.0).abs() < allowed,
            "{name}: {walls} for {expected}"
        );
        assert!((mean("viscosity") - walls / 0.4).abs() < 1e-12);
        let [xx, yy, zz] = ["xx", "yy", "zz"].map(|of| mean(&format!("particle_stress_{of}")));
        assert!((mean("N1") - (xx - yy)).abs() < 1e-12 && mean("N1") > 0.02);
        assert!((mean("N2") - (yy - zz)).abs() < 1e-12 && mean("N2") < 0.0);
        let pushing = column(&out, "energy_repulsion");
        assert_eq!(
            pushing.iter().any(|&energy| energy > 1e-3),
            name == "pushed"
        );
    }
}

/// The stress depends neither on the order of surfaces nor on the image by which a surface is named, also while they push
/// each other across the ends of the box.
#[test]
fn stress_knows_neither_order_nor_images() {
    let folder = TempDir::new().expect("a folder");
    let (here, there) = ([-1.0, 0.4, 0.2], [1.2, -0.4, 0.0]);
    let image = [1.2 - 4.5, -0.4, 3.0];
    let written = [
        ("named", two([("a", here), ("b", there)])),
        ("order", two([("b", there), ("a", here)])),
        ("image", two([("a", here), ("b", image)])),
    ];
    let stresses = written.map(|(name, surfaces)| {
        let out = folder.path().join(name);
        ended(&scene(&surfaces, [4.5, 3.0], 0.1, ""), folder.path(), &out);
        assert!(column(&out, "energy_repulsion")[2] > 1e-3);
        let components = ["xx", "yy", "zz", "xy", "xz", "yz"];
        components.map(|of| column(&out, &format!("particle_stress_{of}"))[2])
    });
    let size = stresses[0]
        .iter()
        .fold(0.0, |most: f64, it| most.max(it.abs()));
    for other in &stresses[1..] {
        for (found, expected) in other.iter().zip(&stresses[0]) {
            // Rounding of the flow, and of positions far away.
            assert!((found - expected).abs() < 1e-9 * size, "{stresses:?}");
        }
    }
}

/// The shares of all slices together are the volume of the surfaces, velocities of slices those of the walls with the rate
/// between them, and a run that is interrupted has the same bits, also in its means.
#[test]
fn profiles_have_all_volume_and_continue() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("whole");
    // A population has one file at the end.
    let surfaces = format!("[[population]]\nname = \"cells\"\ncount = 2\ngap = 0.2\n{KIND}");
    let text = scene(
        &surfaces,
        [4.5, 3.0],
        0.4,
        "profiles = 7\nskip = 0.1\nblocks = 3",
    );
    let summary = ended(&text, folder.path(), &out);
    let rows = table(&out.join("profiles.csv"));
    let number = |column: usize| {
        let numbers = rows
            .iter()
            .map(|row| row[column].parse::<f64>().expect("a number"));
        Vec::from_iter(numbers)
    };
    assert_eq!(rows.len(), 7);
    let volume = 2.0 * column(&out, "cells_mean_volume")[0];
    let share = number(3).iter().sum::<f64>() / 7.0;
    // Volumes are kept to rounding; 4.5 × 4 × 3 is the box.
    assert!((share * 54.0 / volume - 1.0).abs() < 1e-12, "{share}");
    let heights = number(0);
    assert!((heights[0] + 2.0 - 2.0 / 7.0).abs() < 1e-12 && heights[3].abs() < 1e-12);
    // Without capsules the velocity would be 0.4 y, and they move with the fluid.
    let mut velocities = heights.iter().zip(number(1));
    assert!(velocities.all(|(height, found)| (found - 0.4 * height).abs() < 0.08));
    assert!(number(1)[6] > 0.6 && number(4).iter().all(|&error| error >= 0.0));
    assert_eq!(
        summary.rheology.last().expect("means").quantity,
        "free_layer"
    );
    continues(&text, folder.path(), &out, 12);
    for name in ["rheology.csv", "profiles.csv"] {
        let file = |folder: &Path| fs::read(folder.join(name)).expect("a file");
        assert!(file(&out) == file(&folder.path().join("parts")), "{name}");
    }
}

/// The apparent viscosity of a channel is the undisturbed flow rate over that with capsules, 1 without them in the way.
#[test]
fn channels_have_a_flow_rate() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let text = scene(&one(""), [4.5, 3.0], 2.0, "profiles = 4\nblocks = 2").replace(
        "kind = \"shear\", rate = 0.4",
        "kind = \"channel\", centre_velocity = 0.4",
    );
    ended(&text, folder.path(), &out);
    let [rates, viscosities, stresses] =
        ["flow_rate", "viscosity", "wall_stress"].map(|name| column(&out, name));
    // Between plates the mean is 2/3 of the velocity in the middle, and the driving force 8 μU/H² is carried by two walls;
    // the sum over 16 nodes of a parabola is 1 + 1/(2 · 16²) times its integral.
    let undisturbed = 2.0 / 3.0 * 0.4 * 12.0 * (1.0 + 0.5 / 256.0);
    let last = rates.len() - 1;
    assert!((viscosities[last] * rates[last] / undisturbed - 1.0).abs() < 1e-9);
    assert!(viscosities[last] > 1.01 && viscosities[last] < 1.5);
    let driven = 8.0 * 0.4 / 16.0 * 4.0 / 2.0;
    assert!((stresses[last] / driven - 1.0).abs() < 0.01, "{stresses:?}");
}

/// A run that is too short for means says so, and has none.
#[test]
fn too_few_rows_have_no_means() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let text = scene(&one(""), [4.5, 3.0], 0.1, "profiles = 4");
    let summary = ended(&text, folder.path(), &out);
    assert!(summary.rheology.is_empty());
    let said = summary.warnings.iter();
    let said = said.filter(|warning| warning.contains("2 rows after the strain 0 are too few"));
    assert_eq!(said.count(), 1, "{:?}", summary.warnings);
    for name in ["rheology.csv", "profiles.csv"] {
        assert!(!out.join(name).exists(), "{name}");
    }
}

#[test]
fn means_are_those_of_blocks() {
    let values = [1.0, 3.0, 2.0, 6.0, 5.0, 7.0];
    // Blocks with the means 2, 4 and 6, whose standard deviation is 2.
    let [mean, error] = block_average(&values, 3).expect("enough");
    assert!((mean - 4.0).abs() < 1e-15 && (error - 2.0 / 3f64.sqrt()).abs() < 1e-15);
    assert_eq!(block_average(&values, 7), None);
    assert_eq!(block_average(&values, 1), None);
    // The mean share is 0.5: 0.05 is reached at a tenth of the way from the first middle to the second, on one side, and
    // on the other a half of the way from the wall to the last middle.
    let layer = free_layer(&[0.0, 0.5, 1.4, 0.1], 8.0);
    assert!((layer - 0.5 * (1.2 + 0.5)).abs() < 1e-15, "{layer}");
    assert!(free_layer(&[0.0, 0.0], 1.0).is_nan());
    // A corner in a slice: its mean is that of the two straight parts.
    let means = means_between(&[[0.0, 0.0], [1.0, 2.0], [3.0, 2.0]], &[0.0, 2.0, 3.0]);
    assert_eq!(means, [1.5, 2.0]);
}
