//! Runs of several ranks, which are threads here.

use super::remeshing::runs;
use helfrich_std::run::{End, RunError, Summary, assist, run};
use helfrich_std::scene::{Overrides, Scene, SceneFile};
use helfrich_std::simulation::{Simulation, build};
use helfrich_std::team::Team;
use std::cell::Cell;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn prepared(text: &str, folder: &Path, team: Team) -> (Scene, Simulation, Vec<[f64; 3]>) {
    let none = Overrides::default();
    let file = SceneFile::parse(text, &folder.join("scene.toml"), &none);
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let (mut simulation, positions) = build(&file).unwrap_or_else(|error| panic!("{error}"));
    simulation.share(team, &positions);
    (file.scene, simulation, positions)
}

/// A run of this scene by this number of ranks. By `steps` looks for an interruption, it is interrupted.
fn shared(
    text: &str,
    folder: &Path,
    (out, resume): (&Path, bool),
    ranks: usize,
    steps: usize,
) -> Result<Summary, RunError> {
    let mut teams = Team::of_threads(ranks).into_iter();
    let first = teams.next().expect("a rank");
    std::thread::scope(|scope| {
        for team in teams {
            scope.spawn(move || {
                let (scene, simulation, positions) = prepared(text, folder, team.clone());
                if assist(&scene, (simulation, positions)).is_err() {
                    assert_eq!(team.listen(), None, "the first rank has the same error");
                }
            });
        }
        let made = Cell::new(0);
        let interrupted = || {
            made.set(made.get() + 1);
            made.get() >= steps
        };
        let (scene, simulation, positions) = prepared(text, folder, first.clone());
        let simulation = (simulation, positions);
        let ended = run(&scene, simulation, out, resume, &interrupted, &mut |_| ());
        first.dismiss();
        ended
    })
}

const OBSTACLE: &str = r#"
[[obstacle]]
name = "post"
shape = "sphere:0.5"
vertices = 162
position = [0, -1.6, -0.4]
"#;

/// Cells of two kinds in a box, with all that a step can have: walls, an obstacle, fluid of another viscosity inside, contact
/// with images, vertices that slide, a flow that changes, and what is read of the fluid.
fn everything(kind: &str) -> String {
    let (membrane, obstacle, stress) = match kind {
        // The stress is that of membranes on which no obstacle exerts forces.
        "viscous" => ("membrane_viscosity = { shear = 0.5 }", "", true),
        _ => ("", OBSTACLE, false),
    };
    format!(
        r#"
units = "none"
[[population]]
name = "cells"
count = 5
per_cell = true
shape = "sphere:0.7"
vertices = 162
viscosity_ratio = 3
elasticity = {{ law = "skalak", shear_modulus = 1, area_ratio = 10 }}
{membrane}
[[surface]]
name = "vesicle"
shape = "ellipsoid:0.8,0.6,0.6"
position = [0, 1, 1]
vertices = 162
bending = {{ method = "B", modulus = 0.02 }}
area = {{ modulus = 20 }}
{obstacle}
[[interaction]]
kind = "repulsion"
strength = 10
cutoff = 0.4
[driver]
kind = "lattice-boltzmann"
viscosity = 1
spacing = 0.25
box = [5, 5, 4.5]
flow = {{ kind = "shear", rate = 0.5, course = {{ kind = "oscillation", period = 2 }} }}
duration = 0.25
redistribution = true
[output]
interval = 0.05
pictures = false
checkpoint_every = 5
[output.rheology]
stress = {stress}
profiles = 8
blocks = 2
[[output.probe]]
name = "middle"
point = [0.1, 0.2, 0.3]
"#
    )
}

fn same_files(expected: &Path, found: &Path, what: &str) {
    for name in [
        "series.csv",
        "series-cells.csv",
        "profiles.csv",
        "last-cells.vtp",
        "last-vesicle.vtp",
    ] {
        let [one, other] = [expected, found].map(|out| fs::read(out.join(name)).expect("a file"));
        assert!(one == other, "{what}: {name} differs");
    }
}

/// To the last bit, also of runs that go on with another number of ranks.
#[test]
fn runs_are_the_same_on_any_number_of_ranks() {
    let folder = TempDir::new().expect("a folder");
    for kind in ["elastic", "viscous"] {
        let text = everything(kind);
        let alone = folder.path().join(kind);
        let summary = runs(&text, folder.path(), &alone, false, usize::MAX);
        assert_eq!(summary.end, End::Completed, "{}", summary.message);
        for ranks in [2, 3] {
            let out = folder.path().join(format!("{kind}-{ranks}"));
            let ended = shared(&text, folder.path(), (&out, false), ranks, usize::MAX);
            let ended = ended.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(ended.end, End::Completed, "{}", ended.message);
            same_files(&alone, &out, &format!("{kind}, {ranks} ranks"));
        }
        let out = folder.path().join(format!("{kind}-parts"));
        for (part, ranks) in [2, 1, 3].into_iter().enumerate() {
            let steps = if part == 2 { usize::MAX } else { 7 };
            let ended = shared(&text, folder.path(), (&out, part > 0), ranks, steps);
            ended.unwrap_or_else(|error| panic!("{error}"));
        }
        same_files(&alone, &out, &format!("{kind}, in parts"));
    }
}

/// A failure has the same words on one rank and on several, and all of them end.
#[test]
fn ranks_end_with_the_error_of_one() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    // The step is too long for so stiff cells.
    let text = everything("elastic").replace("shear_modulus = 1,", "shear_modulus = 1e4,");
    let text = text.replace("duration = 0.25", "duration = 0.25\nstep = 0.01");
    let alone = folder.path().join("alone");
    let expected = runs(&text, folder.path(), &alone, false, usize::MAX);
    assert_eq!(expected.end, End::Failed);
    let found = shared(&text, folder.path(), (&out, false), 2, usize::MAX).expect("a run");
    assert_eq!((found.end, found.message), (End::Failed, expected.message));
}

fn refusal(text: &str, ranks: usize) -> String {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let refused = shared(text, folder.path(), (&out, false), ranks, usize::MAX);
    assert!(!out.exists(), "nothing is written");
    refused.expect_err("is refused").to_string()
}

#[test]
fn what_ranks_cannot_share_is_refused() {
    let too_many = refusal(&everything("elastic"), 7);
    assert!(
        too_many.contains("7 ranks cannot share 18 planes"),
        "{too_many}"
    );
    let relaxation = "units = \"none\"\n[[surface]]\nname = \"v\"\nshape = \"sphere:1\"\nvertices = 162\n\
                      bending = { method = \"B\", modulus = 1 }\nvolume = { constraint = \"exact\", reduced = 0.9 }\n\
                      [driver]\nkind = \"relax\"\n";
    let relax = refusal(relaxation, 2);
    assert!(relax.contains("`relax` runs on one"), "{relax}");
    let remeshed = everything("elastic").replace(
        "position = [0, 1, 1]",
        "position = [0, 1, 1]\nremesh = \"auto\"",
    );
    let remesh = refusal(&remeshed, 2);
    assert!(
        remesh.contains("\"vesicle\"") && remesh.contains("`remesh` works on one"),
        "{remesh}"
    );
}
