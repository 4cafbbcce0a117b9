//! `helfrich run`: what a run leaves, and how it survives being stopped.

use crate::text;
use helfrich_std::series::SeriesTable;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;
use tempfile::TempDir;

pub(crate) const SCENE: &str = r#"
title = "Small vesicle"
units = "none"

[[surface]]
name = "vesicle"
shape = "ellipsoid:1,1,1.6"
vertices = 162

[surface.bending]
method = "juelicher"
modulus = 2.0

[surface.area]
constraint = "exact"

[surface.volume]
constraint = "exact"

[driver]
kind = "relax"
residual = 1e-7
# With so few vertices the energy is known to some per cent.
energy_error = 0.1

[output]
every = 4
checkpoint_every = 3
"#;

/// A capsule whose velocities are solutions of linear systems, with all that is drawn. Drawing takes more time
/// than the flow.
pub(crate) const FLOW: &str = r#"
title = "Small capsule"
units = "none"

[[surface]]
name = "capsule"
shape = "sphere:1"
family = "regular"
vertices = 42
viscosity_ratio = 3
membrane_viscosity = { shear = 0.5 }
elasticity = { law = "neo-hookean", shear_modulus = 1 }
bending = { method = "meyer", modulus = 0.05 }

[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 0.3 }
strain = 2

[output]
strain_interval = 0.1
files_every = 10
checkpoint_every = 3

[[output.plot]]
column = "deformation"

[[output.slice]]
name = "middle"
centre = [0, 0, 0]
normal = [0, 0, 1]
size = [4, 3]
points = [9, 7]
"#;

pub(crate) const LATTICE: &str = r#"
title = "Small capsule in a channel"
units = "none"

[[surface]]
name = "capsule"
shape = "sphere:1"
family = "regular"
vertices = 162
viscosity_ratio = 3
membrane_viscosity = { shear = 20, dilational = 20 }
elasticity = { law = "neo-hookean", shear_modulus = 1 }
bending = { method = "meyer", modulus = 0.05 }

[[obstacle]]
name = "bump"
shape = "sphere:1"
family = "regular"
vertices = 162
position = [2.5, -3.5, 0]

[driver]
kind = "lattice-boltzmann"
viscosity = 1
flow = { kind = "channel", centre_velocity = 1 }
resolution = 3
box = [8, 7, 7]
precision = "f32"
strain = 0.5

[output]
strain_interval = 0.05
files_every = 10
checkpoint_every = 7

[[output.probe]]
name = "behind"
point = [-3, 1, 0]

[[output.volume]]
stride = 4

[[output.slice]]
name = "middle"
centre = [0, 0, 0]
normal = [0, 0, 1]
size = [8, 7]
points = [33, 21]
"#;

/// The scene with pictures of every third row only: drawing takes more time than the relaxation.
pub(crate) fn sparse() -> String {
    format!("{SCENE}files_every = 3\n")
}

/// A folder with the scene, and `extra` at its end.
fn scene(extra: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, format!("{SCENE}{extra}")).unwrap();
    (folder, path)
}

pub(crate) fn command(scene: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = crate::command(&["run", text(scene), "--out", text(out)]);
    command.args(more);
    command
}

pub(crate) fn run(scene: &Path, out: &Path, more: &[&str]) -> Output {
    command(scene, out, more).output().unwrap()
}

#[track_caller]
pub(crate) fn succeed(scene: &Path, out: &Path, more: &[&str]) -> String {
    let output = run(scene, out, more);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), &*errors), (Some(0), ""));
    String::from_utf8(output.stdout).unwrap()
}

/// Every file under a folder but those that tell the time and the checkpoint.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.ends_with("summary.json") && !path.ends_with("checkpoint") {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

pub(crate) fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

#[test]
fn a_run_leaves_its_series_surfaces_and_summary() {
    let (folder, scene) = scene("");
    let out = folder.path().join("out");
    let printed = succeed(&scene, &out, &[]);
    assert!(
        printed.contains("Small vesicle") && printed.contains("converged"),
        "{printed}"
    );

    let series = SeriesTable::read(&out.join("series.csv")).unwrap();
    let columns = [
        "iteration",
        "residual",
        "energy",
        "energy_bending",
        "area",
        "volume",
        "reduced_volume",
        "smallest_angle",
        "flagged_vertices",
        "flagged_triangles",
        "flagged_share",
    ];
    assert_eq!(series.columns, columns);
    // The constraints hold in every row, and the energy never rises.
    let column = |name: &str| series.column(name).unwrap();
    for name in ["area", "volume"] {
        let values = column(name);
        for value in &values[1..] {
            assert!(
                (value / values[1] - 1.0).abs() < 1e-10,
                "{name}: {values:?}"
            );
        }
    }
    let energies = column("energy");
    assert!(
        energies.is_sorted_by(|a, b| *b <= a * (1.0 + 1e-14)),
        "{energies:?}"
    );

    let summary = summary(&out);
    // Effects and other parts are all seconds of the run, and their shares are printed as 100 %.
    let seconds = |costs: &Value| {
        let costs = costs.as_array().unwrap().iter();
        costs
            .map(|cost| cost["seconds"].as_f64().unwrap())
            .sum::<f64>()
    };
    let [effects, parts] = ["effects", "parts"].map(|costs| seconds(&summary[costs]));
    let all = summary["seconds"].as_f64().unwrap();
    assert!(
        ((effects + parts) / all - 1.0).abs() < 1e-9,
        "{effects} + {parts}, {all}"
    );
    let (_, table) = printed.split_once("share\n").unwrap();
    let rows = table.lines().take_while(|line| !line.is_empty());
    let rows = rows.map(|row| Vec::from_iter(row.split_whitespace()));
    let rows = Vec::from_iter(rows);
    let names = Vec::from_iter(rows.iter().map(|row| row[0]));
    assert_eq!(names, ["bending", "driver", "quality", "files", "pictures"]);
    let shares = rows.iter().map(|row| row[3].parse::<u32>().unwrap());
    assert_eq!(shares.sum::<u32>(), 100, "{table}");
    assert_eq!(summary["end"], "converged");
    assert_eq!(summary["scene"]["surfaces"][0]["name"], "vesicle");
    assert_eq!(summary["effects"][0]["effect"], "bending");
    assert!(summary["effects"].as_array().unwrap().len() == 1);
    let last = series.rows.last().unwrap();
    for (entry, value) in summary["last"].as_array().unwrap().iter().zip(last) {
        let found = entry[1].as_f64().unwrap();
        // The reader of JSON rounds the last place.
        assert!(
            (found - value).abs() <= 1e-15 * value.abs(),
            "{entry} {value}"
        );
    }

    let times = column("iteration");
    let index = fs::read_to_string(out.join("surfaces.pvd")).unwrap();
    for time in times {
        let name = format!("surfaces/vesicle-{time:08}.vtp");
        assert!(index.contains(&name), "{name} in {index}");
        let surface = fs::read_to_string(out.join(&name)).unwrap();
        for field in ["\"H\"", "\"K\"", "\"f\"", "force_bending"] {
            assert!(surface.contains(field), "{field} in {name}");
        }
    }
}

/// Pictures are drawn with every set of files, with none, or by default with as many as the run can afford: of
/// a short one the last.
#[test]
fn a_short_run_draws_its_end() {
    let (folder, scene) = scene("");
    let drawn = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let more = [&["--set", "surface.vesicle.vertices=162"], more].concat();
        succeed(&scene, &out, &more);
        let count = |folder: &str| fs::read_dir(out.join(folder)).map_or(0, Iterator::count);
        [count("pictures"), count("surfaces")]
    };
    let [pictures, sets] = drawn("default", &[]);
    assert!(pictures == 1 && sets > 4, "{pictures} of {sets}");
    let always = ["--set", "output.pictures=true"];
    assert_eq!(drawn("always", &always), [sets, sets]);
    let never = ["--set", "output.pictures=false"];
    assert_eq!(drawn("never", &never), [0, sets]);
}

/// The last numbers have the units of the scene, and those that are not known are dashes.
#[test]
fn the_end_of_a_run_has_units() {
    let scene = SCENE.replace("\"none\"", "\"micro\"");
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    let sets = ["surface.vesicle.vertices=162", "output.pictures=false"];
    let sets = sets.map(|set| ["--set", set]);
    let printed = succeed(&path, &folder.path().join("out"), sets.as_flattened());
    for (name, unit) in [
        ("energy", "pN·µm"),
        ("energy_bending", "pN·µm"),
        ("area", "µm²"),
        ("volume", "µm³"),
        ("smallest_angle", "degrees"),
    ] {
        let mut rows = printed
            .lines()
            .map(|row| Vec::from_iter(row.split_whitespace()));
        let row = rows.find(|row| row.first() == Some(&name)).unwrap();
        assert_eq!(row[2..], [unit], "{printed}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_says_so_and_can_be_resumed() {
    let (folder, scene) = scene("");
    let [whole, stopped] = ["whole", "stopped"].map(|name| folder.path().join(name));
    // Long enough that it is still running, with few pictures.
    let set = [
        "--set",
        "surface.vesicle.vertices=2562",
        "--set",
        "output.files_every=5",
    ];
    let child = command(&scene, &stopped, &set)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !stopped.join("checkpoint").exists() {
        thread::sleep(Duration::from_millis(5));
    }
    let pid = child.id().to_string();
    Command::new("kill").args(["-INT", &pid]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("--resume"), "{printed}");
    assert_eq!(summary(&stopped)["end"], "interrupted");

    succeed(&scene, &stopped, &[&set[..], &["--resume"]].concat());
    succeed(&scene, &whole, &set);
    assert!(files(&whole) == files(&stopped));
}

#[test]
fn runs_are_neither_overwritten_nor_mixed() {
    let (folder, scene) = scene("");
    let out = folder.path().join("out");
    succeed(&scene, &out, &[]);
    let before = files(&out);
    let refused = |more: &[&str], hints: &[&str]| {
        let output = run(&scene, &out, more);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        for hint in hints {
            assert!(message.contains(hint), "{message}");
        }
        assert!(files(&out) == before);
    };
    refused(&[], &["--resume", "--out"]);
    refused(
        &["--resume", "--set", "surface.vesicle.bending.modulus=3"],
        &["another scene"],
    );
    // A finished run is finished.
    succeed(&scene, &out, &["--resume"]);
    assert!(files(&out) == before);

    let none = folder.path().join("none");
    let output = run(&scene, &none, &["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!none.exists());
}

#[test]
fn a_run_that_does_not_converge_says_so() {
    let (folder, scene) = scene("");
    let out = folder.path().join("out");
    let output = run(&scene, &out, &["--set", "driver.iterations=5"]);
    assert_eq!(output.status.code(), Some(4));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("limit"), "{message}");
    assert_eq!(summary(&out)["end"], "iteration-limit");
}

/// Each load has the limit for itself, and one that ends before its equilibrium is not forgotten.
#[test]
fn no_load_of_a_sequence_ends_early_in_silence() {
    let (folder, scene) = scene("");
    let out = folder.path().join("out");
    let sets = [
        "--set",
        "surface.vesicle.stretching={axis=[0,0,1],force=[20,0]}",
        "--set",
        "driver.iterations=6",
        "--set",
        "driver.residual=1e-3",
    ];
    let output = run(&scene, &out, &sets);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(message.contains("load 1 of 2"), "{message}");
    let series = SeriesTable::read(&out.join("series.csv")).unwrap();
    let forces = series.column("force").unwrap();
    assert!(
        forces.contains(&20.0) && forces.last() == Some(&0.0),
        "{forces:?}"
    );
    assert!(
        summary(&out)["warnings"][0]
            .as_str()
            .unwrap()
            .contains("load 1 of 2")
    );
}

#[test]
fn a_scene_is_checked_and_explained_without_a_run() {
    let (folder, scene) = scene("");
    crate::succeed(&["run", text(&scene), "--check"]);
    let explained = crate::succeed(&["explain", text(&scene)]);
    assert!(
        explained.contains("juelicher") && explained.contains("reduced volume"),
        "{explained}"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);

    fs::write(&scene, SCENE.replace("modulus", "modolus")).unwrap();
    for command in ["run", "explain"] {
        let message = crate::fail(2, &[command, text(&scene)]);
        assert!(
            message.contains("scene.toml:12") && message.contains("modulus"),
            "{message}"
        );
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn outputs_that_cannot_be_written_are_exit_code_3() {
    let (folder, scene) = scene("");
    let file = folder.path().join("file");
    fs::write(&file, "kept").unwrap();
    let output = run(&scene, &file.join("out"), &[]);
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(fs::read(&file).unwrap(), b"kept");
}

/// A sphere encloses the most: none of its volume can be taken at the same area, to first order.
#[test]
fn constraints_out_of_reach_are_refused_before_anything_is_written() {
    let (folder, scene) = scene("");
    let out = folder.path().join("out");
    let sets = [
        "surface.vesicle.shape=sphere",
        "surface.vesicle.volume.reduced=0.9",
    ];
    let sets = sets.map(|set| ["--set", set]);
    let output = run(&scene, &out, sets.as_flattened());
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    // The prolate with a reduced volume of 0.9 and the area of the unit sphere.
    for hint in [
        "vesicle",
        "sphere",
        "begin with shape = \"ellipsoid:0.7712,0.7712,1.513\"",
    ] {
        assert!(message.contains(hint), "{message}");
    }
    assert!(!out.exists());
}

#[test]
fn a_run_in_flow_leaves_numbers_plots_and_slices() {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, FLOW).unwrap();
    let out = folder.path().join("out");
    let printed = succeed(&scene, &out, &[]);
    for said in [
        "the end is reached",
        "evaluations of the velocities",
        "double_layer",
        "membrane_viscosity",
    ] {
        assert!(printed.contains(said), "no {said} in {printed}");
    }
    let before = files(&out);
    for name in [
        "plots/deformation.png",
        "slices.pvd",
        "slices/middle-00000000.vti",
        "slices/middle-00000020.png",
        "surfaces/capsule-00000010.vtp",
        "pictures/00000020.png",
    ] {
        assert!(before.contains_key(Path::new(name)), "no {name}");
    }
    assert!(!before.contains_key(Path::new("surfaces/capsule-00000015.vtp")));
    let series = SeriesTable::read(&out.join("series.csv")).unwrap();
    let column = |name: &str| series.column(name).unwrap();
    assert_eq!(series.rows.len(), 21);
    assert!((column("strain")[7] - 0.7).abs() < 1e-12);
    assert!(column("deformation")[20] > 0.1);
    assert!(
        column("step")[1..]
            .iter()
            .zip(&column("step_limit")[1..])
            .all(|(step, limit)| step <= limit)
    );
    assert_eq!(summary(&out)["end"], "completed");
    assert!(summary(&out)["right_hand_sides"].as_u64().unwrap() > 20);
    // A finished run is finished.
    succeed(&scene, &out, &["--resume"]);
    assert!(files(&out) == before);
}

/// Columns that a plot needs are looked for before anything is computed.
#[test]
fn plots_that_cannot_be_drawn_are_refused_at_first() {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("scene.toml");
    let out = folder.path().join("out");
    for (plot, hint) in [
        ("column = \"inclinaton\"", "inclination"),
        (
            "column = \"deformation\"\npublished = \"none.csv\"",
            "none.csv",
        ),
    ] {
        fs::write(&scene, format!("{FLOW}\n[[output.plot]]\n{plot}\n")).unwrap();
        let output = run(&scene, &out, &[]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(hint), "{message}");
        assert!(!out.exists());
    }
}

/// How many threads there are shows in no number.
#[test]
fn threads_change_no_result() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, FLOW).unwrap();
    let series = ["1", "2", "3"].map(|threads| {
        let out = folder.path().join(threads);
        let numbers_only = [
            "--set",
            "output.pictures=false",
            "--set",
            "output.files_every=20",
        ];
        succeed(
            &path,
            &out,
            &[&numbers_only[..], &["--threads", threads]].concat(),
        );
        fs::read(out.join("series.csv")).unwrap()
    });
    assert!(series[0] == series[1] && series[1] == series[2]);
    for threads in ["0", "1025", "-1", "2.5", "all"] {
        let message = crate::fail(2, &["run", text(&path), "--check", "--threads", threads]);
        assert!(
            message.contains("from 1 to 1024") || message.contains("'-1'"),
            "{message}"
        );
    }
}
