//! Targets of exactly held quantities that cannot be reached at once are approached in steps.

use helfrich::{Surface, Targets, TotalMeanCurvature};
use helfrich_std::io::read;
use helfrich_std::run::{End, Summary, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use helfrich_tests::tolerance;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Bilayer coupling: at once, triangles turn over.
const SCENE: &str = r#"
units = "none"
[[surface]]
shape = "ellipsoid:0.6593,0.6593,1.8404"
vertices = 162
bending = { method = "loop", modulus = 1 }
area = { constraint = "exact" }
volume = { constraint = "exact", reduced = 0.8 }
area_difference = { constraint = "exact", reduced = 1.2 }
[driver]
kind = "relax"
energy_error = 1
residual = 1e-3
[output]
every = 10
checkpoint_every = 7
files_every = 100000
pictures = false
surfaces = false
"#;

/// Runs the scene, at most this number of steps, and tells how it ended.
fn runs(out: &Path, resume: bool, steps: usize) -> Summary {
    let none = Overrides::default();
    let file = SceneFile::parse(SCENE, Path::new("scene.toml"), &none);
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let built = build(&file).unwrap_or_else(|error| panic!("{error}"));
    let made = std::cell::Cell::new(0);
    let interrupted = || {
        made.set(made.get() + 1);
        made.get() >= steps
    };
    let ended = run(&file.scene, built, out, resume, &interrupted, &mut |_| ());
    ended.unwrap_or_else(|error| panic!("{error}"))
}

/// The run converges with every quantity at its target, says in how many steps, and has the same bits when it is
/// interrupted on the way.
#[test]
fn targets_are_approached_in_steps() {
    let folder = TempDir::new().expect("a folder");
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let summary = runs(&whole, false, usize::MAX);
    assert_eq!(summary.end, End::Converged, "{}", summary.message);
    for part in ["brought to their targets in", "steps, because at once"] {
        assert!(summary.message.contains(part), "{}", summary.message);
    }
    let file = read(&whole.join("last.vtp")).expect("a surface");
    let surface = Surface::new(&file.mesh, &file.positions).expect("finite");
    let curvature = Targets::measured(&TotalMeanCurvature, surface).at(0);
    let area = surface.area();
    let reduced = curvature / (4.0 * PI * area).sqrt();
    tolerance::HELD.assert(reduced, 1.2, 1.2, "area difference");
    let volume = surface.volume().expect("closed");
    let reduced = 6.0 * PI.sqrt() * volume / area.powf(1.5);
    tolerance::HELD.assert(reduced, 0.8, 0.8, "reduced volume");

    let mut end = runs(&parts, false, 3).end;
    let mut stops = 0;
    while end == End::Interrupted {
        stops += 1;
        end = runs(&parts, true, 11 + 9 * stops).end;
    }
    assert!(stops > 2 && end == End::Converged, "{stops}, {end:?}");
    let series = |out: &Path| fs::read_to_string(out.join("series.csv")).expect("a series");
    assert!(series(&whole) == series(&parts));
}
