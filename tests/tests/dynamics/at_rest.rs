//! Relaxations of surfaces that touch others and obstacles.

use crate::scenes::last;
use helfrich_std::io::read;
use helfrich_std::run::{End, Summary, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::build;
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::PI;
use tempfile::TempDir;

/// Curvature of a drop's cap in the mouth of a pipette with fifty vertices, relative.
const CAP: Tolerance = Tolerance::new(
    2e-2,
    "second order in edges of a sixth of its radius; 4 times as many vertices leave 1e-3",
);

const RELAX: &str = "[driver]\nkind = \"relax\"\niterations = 2000\nresidual = 1e-3\n[output]\nevery = 100\npictures = false\n";

/// Runs a relaxation of drops; returns the last positions of a surface, too.
fn relaxed(surfaces: &str, name: &str) -> (Summary, SeriesTable, Vec<[f64; 3]>) {
    let folder = TempDir::new().expect("a folder");
    let text = format!("units = \"none\"\n{surfaces}{RELAX}");
    let path = folder.path().join("drops.toml");
    let file = SceneFile::parse(&text, &path, &Overrides::default());
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let out = folder.path().join("out");
    let built = build(&file).unwrap_or_else(|error| panic!("{error}"));
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {}).expect("a run");
    assert_eq!(summary.end, End::Converged, "{}", summary.message);
    let series = SeriesTable::read(&out.join("series.csv")).expect("a series");
    let last = read(&out.join(name)).expect("the end").positions;
    (summary, series, last)
}

/// Curvature 1/R of the sphere nearest to points on the axis z and around it: `x² + y² + z² = 2 c z + d`.
fn curvature(points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let mut sums = [0.0; 5];
    for [x, y, z] in points {
        let square = x * x + y * y + z * z;
        for (sum, term) in sums.iter_mut().zip([1.0, z, z * z, square, square * z]) {
            *sum += term;
        }
    }
    let [count, z, zz, square, cross] = sums;
    let twice = (count * cross - z * square) / (count * zz - z * z);
    let rest = (square - twice * z) / count;
    (rest + 0.25 * twice * twice).sqrt().recip()
}

/// A drop that is sucked against the rim of a pipette rests with a cap in its mouth whose curvature is Δp/2σ larger than
/// that of the drop outside: the pressures on both are those of Young and Laplace.
#[test]
fn a_drop_rests_in_the_mouth_of_a_pipette() {
    let pressure = 3.0;
    let scene = format!(
        r#"
[[surface]]
shape = "sphere:1"
vertices = 2562
family = "smooth"
tension.value = 1
volume.constraint = "exact"
aspiration = {{ pressure = {pressure}, mouth = [0, 0, 0.94], axis = [0, 0, 2], width = 0.03 }}
[[obstacle]]
name = "rim"
shape = "torus:0.5,0.2"
vertices = 1000
position = [0, 0, 1.13]
[[interaction]]
kind = "repulsion"
strength = 300
cutoff = 0.06
"#
    );
    let (summary, _, positions) = relaxed(&scene, "last.vtp");
    let near = |[x, y, _]: &[f64; 3]| x.hypot(*y) < 0.25;
    let inside = curvature(positions.iter().copied().filter(|x| near(x) && x[2] > 0.0));
    let outside = curvature(positions.iter().copied().filter(|x| x[2] < 0.3));
    CAP.assert(inside, outside + 0.5 * pressure, inside, "1/R");
    let crossed = |warning: &&String| warning.contains("rim");
    assert_eq!(summary.warnings.iter().find(crossed), None);
}

/// Two drops with the tension σ adhere with the contact angle θ of T. Young and A. Dupré, `cos θ = 1 − W/2σ`, in the limit
/// of a short range; with one of a tenth of their radius they gain up to half as much again, by the rim around the contact.
#[test]
fn drops_adhere_as_young_and_dupre_have_it() {
    let drop = |name: &str, x: f64| {
        format!(
            "[[surface]]\nname = \"{name}\"\nshape = \"sphere:1\"\nvertices = 642\nfamily = \"smooth\"\n\
             position = [{x}, 0, 0]\ntension.value = 1\nvolume.constraint = \"exact\"\n"
        )
    };
    let (left, right) = (drop("left", 0.0), drop("right", 2.15));
    let energy: f64 = 0.6;
    let scene = format!(
        "{left}{right}[[interaction]]\nkind = \"adhesion\"\nenergy = {energy}\ndistance = 0.1\ncutoff = 0.25\n"
    );
    let (_, series, _) = relaxed(&scene, "last-left.vtp");
    let volume = last(&series, "volume_left");
    // Spheres of this radius without their caps beyond the contact.
    let cosine = 1.0 - 0.5 * energy;
    let share = 4.0 / 3.0 - (1.0 - cosine).powi(2) * (2.0 + cosine) / 3.0;
    let squared = (volume / (PI * share)).powf(2.0 / 3.0);
    let contact = (1.0 - 0.5 * energy) * (1.0 - cosine * cosine);
    let adhered = 2.0 * PI * squared * (2.0 * (1.0 + cosine) + contact);
    let free = 8.0 * PI * (0.75 * volume / PI).powf(2.0 / 3.0);
    let gain = (free - last(&series, "energy")) / (free - adhered);
    assert!((1.0..1.5).contains(&gain), "{gain}");
}
