//! `helfrich run --resume`: what is gone on with, what begins again, and what is left alone.

use crate::fixture::{disturbed, obj};
use crate::run::{FLOW, LATTICE, SCENE, command, files, run, sparse, succeed, summary};
use crate::text;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::series::SeriesTable;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;
use tempfile::TempDir;

/// A folder with this scene.
fn folder_with(scene: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    (folder, path)
}

/// A run that is refused, what its message says, and that nothing in its folder has changed.
#[track_caller]
fn refused(scene: &Path, out: &Path, more: &[&str], hints: &[&str]) {
    let before = files(out);
    let output = run(scene, out, more);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    for hint in hints {
        assert!(message.contains(hint), "no {hint} in {message}");
    }
    assert!(files(out) == before);
}

/// A run under way that has stored its state.
fn under_way(scene: &Path, out: &Path, more: &[&str]) -> Child {
    let child = command(scene, out, more)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !out.join("checkpoint").exists() {
        thread::sleep(Duration::from_millis(5));
    }
    child
}

/// Whatever a run has left when it was killed before its first checkpoint.
#[test]
fn a_run_that_was_stopped_at_its_beginning_begins_again() {
    let (folder, scene) = folder_with(&sparse());
    let [whole, begun] = ["whole", "begun"].map(|name| folder.path().join(name));
    succeed(&scene, &whole, &[]);
    let whole = files(&whole);
    let series = String::from_utf8(whole[Path::new("series.csv")].clone()).unwrap();
    let lines = Vec::from_iter(series.split_inclusive('\n'));
    let left: [&[(&str, &str)]; 5] = [
        &[],
        &[("lock", "")],
        &[
            ("lock", "process 1 on another machine"),
            (".helfrich-Xy12", "half"),
        ],
        &[("lock", ""), ("series.csv", lines[0])],
        &[("series.csv", &[lines[0], lines[1]].concat())],
    ];
    for left in left {
        let _ = fs::remove_dir_all(&begun);
        fs::create_dir(&begun).unwrap();
        for (name, content) in left {
            fs::write(begun.join(name), content).unwrap();
        }
        succeed(&scene, &begun, &["--resume"]);
        assert!(files(&begun) == whole, "{left:?}");
    }
}

/// The first state is stored before the first row and the first files: where these cannot be written,
/// nothing is lost.
#[test]
fn the_state_is_stored_before_anything_else() {
    let (folder, scene) = folder_with(&sparse());
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    succeed(&scene, &whole, &[]);
    fs::create_dir(&out).unwrap();
    fs::write(out.join("surfaces"), "in the way").unwrap();
    assert_eq!(run(&scene, &out, &[]).status.code(), Some(3));
    assert!(out.join("checkpoint").exists());
    fs::remove_file(out.join("surfaces")).unwrap();
    succeed(&scene, &out, &["--resume"]);
    assert!(files(&whole) == files(&out));
}

#[test]
fn what_is_no_beginning_is_not_begun_again() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    succeed(&scene, &out, &[]);
    fs::remove_file(out.join("checkpoint")).unwrap();
    refused(
        &scene,
        &out,
        &["--resume"],
        &["has lost its `checkpoint`", "--out"],
    );
    // Somebody else's folder.
    let other = folder.path().join("other");
    fs::create_dir(&other).unwrap();
    fs::write(other.join("notes.txt"), "kept").unwrap();
    refused(&scene, &other, &["--resume"], &["no run here", "--resume"]);
}

#[test]
fn a_second_process_is_refused_and_a_killed_one_leaves_no_lock() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    let large = ["--set", "surface.vesicle.vertices=2562"];
    let mut first = under_way(&scene, &out, &large);
    let holder = format!("process {}", first.id());
    for more in [&large[..], &[&large[..], &["--resume"]].concat()] {
        let output = run(&scene, &out, more);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        for hint in [&holder, text(&out)] {
            assert!(message.contains(hint), "no {hint} in {message}");
        }
    }
    assert!(first.try_wait().unwrap().is_none(), "it was over too soon");
    first.kill().unwrap();
    first.wait().unwrap();
    let short = ["--set", "driver.residual=1e-2", "--resume"];
    succeed(&scene, &out, &[&large[..], &short].concat());
    assert!(!out.join("lock").exists());
}

/// A stretched sheet of a capsule, whose mesh and reference are files.
const FILES: &str = r#"
units = "none"
[[surface]]
mesh = "mesh.obj"
elasticity = { law = "neo-hookean", shear_modulus = 1, reference = { mesh = "reference.obj" } }
bending = { method = "gompper-kroll", modulus = 0.1 }
[driver]
kind = "relax"
iterations = 4
[output]
every = 2
pictures = false
"#;

#[test]
fn a_scene_is_the_same_wherever_its_path_begins() {
    let (folder, scene) = folder_with(FILES);
    let mesh = |radius: f64| {
        let shape: AnyShape = "ellipsoid:1,1,1.2".parse().unwrap();
        let made = generate(&shape, Family::Regular, 42, 1).unwrap();
        let positions = made.positions.iter().map(|x| x.map(|x| radius * x));
        obj(&Vec::from_iter(positions), made.mesh.triangles())
    };
    let write = |name: &str, radius| fs::write(folder.path().join(name), mesh(radius)).unwrap();
    write("mesh.obj", 1.0);
    write("reference.obj", 0.9);
    let out = folder.path().join("out");
    let output = run(&scene, &out, &[]);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let before = files(&out);
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).unwrap();
    for (from, name) in [
        (folder.path(), "scene.toml"),
        (folder.path(), "./scene.toml"),
        (&inside, "../scene.toml"),
        (folder.path(), "inside/../scene.toml"),
    ] {
        let mut again = crate::command(&["run", name, "--out", text(&out), "--resume"]);
        let output = again.current_dir(from).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{name}: {message}");
        assert!(files(&out) == before, "{name}");
    }
    // Another file by the same name is another scene.
    for name in ["reference.obj", "mesh.obj"] {
        let kept = fs::read(folder.path().join(name)).unwrap();
        write(name, 0.8);
        refused(&scene, &out, &["--resume"], &["another scene"]);
        fs::write(folder.path().join(name), kept).unwrap();
    }
}

/// A later end, or less residual, goes on from where the run has ended, as if it had been the scene's
/// from the start.
#[test]
fn a_run_goes_on_to_a_later_end() {
    for (scene_text, first, last) in [
        (SCENE, "driver.iterations=8", "driver.iterations=10000"),
        (SCENE, "driver.residual=1e-3", "driver.residual=1e-7"),
        (FLOW, "driver.strain=0.5", "driver.strain=1"),
        (LATTICE, "driver.strain=0.25", "driver.strain=0.5"),
    ] {
        let (folder, scene) = folder_with(scene_text);
        let [whole, extended] = ["whole", "extended"].map(|name| folder.path().join(name));
        // Numbers of intervals are times without rounding. Slices need solutions: both ends have them.
        let rate: &[&str] = match scene_text {
            FLOW => &[
                "--set",
                "driver.flow.rate=0.25",
                "--set",
                "output.files_every=5",
            ],
            _ => &[],
        };
        let no_pictures = &["--set", "output.pictures=false"];
        let with = |end: &[&'static str]| [rate, no_pictures, &["--set"], end].concat();
        succeed(&scene, &whole, &with(&[last]));
        run(&scene, &extended, &with(&[first]));
        let before = summary(&extended)["iterations"].as_u64();
        succeed(&scene, &extended, &with(&[last, "--resume"]));
        let [whole_summary, extended_summary] = [&whole, &extended].map(|it| summary(it));
        assert!(before < whole_summary["iterations"].as_u64(), "{first}");
        for key in ["iterations", "right_hand_sides", "last"] {
            assert_eq!(whole_summary[key], extended_summary[key], "{first}: {key}");
        }
        // No evaluation more than without a stop.
        let counts = |summary: &serde_json::Value| {
            let effects = summary["effects"].as_array().unwrap().iter();
            Vec::from_iter(effects.map(|effect| effect["evaluations"].as_u64()))
        };
        assert_eq!(counts(&whole_summary), counts(&extended_summary), "{first}");
        let rows = [&whole, &extended].map(|folder| {
            let series = SeriesTable::read(&folder.join("series.csv")).unwrap();
            let bits = |row: &Vec<f64>| Vec::from_iter(row.iter().map(|number| number.to_bits()));
            Vec::from_iter(series.rows.iter().map(bits))
        });
        // The row of the first end may be one more.
        let [whole, extended] = rows;
        assert!(whole.iter().all(|row| extended.contains(row)), "{first}");
        assert!(extended.len() <= whole.len() + 1, "{first}");
    }
}

/// Measured vertices, whose noise is taken out at the start.
const NOISY: &str = r#"
units = "none"
[[surface]]
mesh = "mesh.obj"
bending = { method = "jet", modulus = 1 }
volume = { constraint = "exact" }
area = { constraint = "exact" }
[driver]
kind = "relax"
iterations = 6
[output]
every = 2
checkpoint_every = 3
pictures = false
"#;

/// Noise is found anew when a run is taken up again, in the same file: the run goes on with the same
/// positions, and says the same.
#[test]
fn a_run_without_its_noise_goes_on() {
    let (folder, scene) = folder_with(NOISY);
    let shape: AnyShape = "ellipsoid:1,0.8,0.6".parse().unwrap();
    let made = generate(&shape, Family::Smooth, 642, 1).unwrap();
    let mesh = obj(&disturbed(&made.positions, 1e-3), made.mesh.triangles());
    fs::write(folder.path().join("mesh.obj"), mesh).unwrap();
    let [whole, extended] = ["whole", "extended"].map(|name| folder.path().join(name));
    run(&scene, &whole, &[]);
    run(&scene, &extended, &["--set", "driver.iterations=4"]);
    let output = run(&scene, &extended, &["--resume"]);
    // Six steps are too few for an equilibrium.
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("is noisy"), "{said}");
    let [first, second] = [&whole, &extended].map(|out| summary(out));
    for key in ["iterations", "last", "warnings", "fingerprint"] {
        assert_eq!(first[key], second[key], "{key}");
    }
    assert!(first["warnings"][0].as_str().unwrap().contains("is noisy"));
    let [first, second] = [&whole, &extended].map(|out| files(out));
    for name in ["last.vtp", "series.csv"] {
        let name = Path::new(name);
        assert!(first[name] == second[name], "{name:?}");
    }
}

/// Outputs may change on the way: rows go on at the multiples of the new interval.
#[test]
fn outputs_may_change_on_the_way() {
    let (folder, scene) = folder_with(FLOW);
    let out = folder.path().join("out");
    let set = ["--set", "driver.strain=1.05"];
    succeed(&scene, &out, &set);
    let sets = [
        "driver.strain=2",
        "output.strain_interval=0.25",
        "output.pictures=false",
        "title=Another title",
    ];
    let sets = sets.map(|set| ["--set", set]);
    succeed(&scene, &out, &[sets.as_flattened(), &["--resume"]].concat());
    let series = SeriesTable::read(&out.join("series.csv")).unwrap();
    let strains = series.column("strain").unwrap();
    let expected = (0..=10).map(|k| 0.1 * f64::from(k));
    let expected = expected.chain([1.05, 1.25, 1.5, 1.75, 2.0]);
    let expected = Vec::from_iter(expected);
    assert_eq!(strains.len(), expected.len(), "{strains:?}");
    for (found, expected) in strains.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-12 * expected, "{strains:?}");
    }
    refused(
        &scene,
        &out,
        &["--set", "driver.strain=1.5", "--resume"],
        &["has already reached", "longer `duration` or `strain`"],
    );
    for other in [
        "driver.tolerance=1e-3",
        "driver.flow.course={kind=\"oscillation\", period=3}",
    ] {
        refused(
            &scene,
            &out,
            &["--set", "driver.strain=3", "--set", other, "--resume"],
            &["another scene"],
        );
    }
}

/// The last row of a run, by column.
fn last(out: &Path, column: &str) -> f64 {
    let series = SeriesTable::read(&out.join("series.csv")).unwrap();
    *series.column(column).unwrap().last().unwrap()
}

/// Relative, to a hundred roundings.
#[track_caller]
fn assert_same(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 100.0 * f64::EPSILON * expected.abs(),
        "{found} {expected}"
    );
}

/// From the end of one run to the start of the next: an equilibrium stays one, and a stretched
/// membrane keeps its stress, over the reference of the first run.
#[test]
fn a_run_begins_with_the_surface_that_another_has_left() {
    let (folder, scene) = folder_with(SCENE);
    let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
    // Without other surfaces, too.
    let first_sets = ["surface.vesicle.vertices=642", "output.surfaces=false"];
    succeed(
        &scene,
        &first,
        first_sets.map(|set| ["--set", set]).as_flattened(),
    );
    let sets = [
        "surface.vesicle.shape=",
        "surface.vesicle.vertices=",
        "surface.vesicle.mesh=first/last.vtp",
    ];
    succeed(
        &scene,
        &second,
        sets.map(|set| ["--set", set]).as_flattened(),
    );
    let series = SeriesTable::read(&second.join("series.csv")).unwrap();
    for column in ["energy", "area", "volume"] {
        assert_same(series.column(column).unwrap()[0], last(&first, column));
    }
    // Normals are chosen anew: some steps may follow.
    let steps = [&second, &first].map(|out| summary(out)["iterations"].as_u64().unwrap());
    assert!(steps[0] < steps[1] / 2, "{steps:?}");
    let mesh = first.join("last.vtp");
    let info = crate::succeed(&["info", text(&mesh)]);
    assert!(info.contains("642"), "{info}");
    let table = crate::run(&["curvature", text(&mesh)]).stdout;
    assert_eq!(table.lines().count(), 643);
    let fine = folder.path().join("fine.vtp");
    crate::succeed(&["subdivide", text(&mesh), "--output", text(&fine)]);
    let info = crate::succeed(&["info", text(&fine)]);
    assert!(info.contains("2562"), "{info}");

    let (folder, scene) = folder_with(FLOW);
    let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
    succeed(&scene, &first, &["--set", "driver.strain=1"]);
    let sets = [
        "surface.capsule.shape=",
        "surface.capsule.family=",
        "surface.capsule.vertices=",
        "surface.capsule.mesh=first/last.vtp",
        "surface.capsule.elasticity.reference={mesh=\"first/surfaces/capsule-00000000.vtp\"}",
        "driver.strain=0.1",
    ];
    succeed(
        &scene,
        &second,
        sets.map(|set| ["--set", set]).as_flattened(),
    );
    let series = SeriesTable::read(&second.join("series.csv")).unwrap();
    for column in ["energy_elasticity", "energy_bending", "deformation", "area"] {
        assert_same(series.column(column).unwrap()[0], last(&first, column));
    }
}

#[test]
fn killed_at_any_moment_and_resumed_nothing_is_different() {
    let implicit = FLOW.replace(
        "viscosity = 1\n",
        "viscosity = 1\nintegrator = \"rosenbrock\"\n",
    );
    assert_ne!(implicit, FLOW);
    // Long enough that most of the kills come before its end.
    let relaxed = sparse().replace("vertices = 162", "vertices = 642");
    for text in [&*relaxed, FLOW, &implicit, LATTICE, RENEWED] {
        check_killed(text);
    }
}

/// A drop that gets a new mesh again and again.
const RENEWED: &str = r#"
units = "none"
[[surface]]
name = "drop"
shape = "sphere:1"
vertices = 162
match_volume = true
remesh = "auto"
tension.value = 1
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 0.8 }
strain = 6
[output]
strain_interval = 1
files_every = 2
checkpoint_every = 1
pictures = false
"#;

/// Two runs, and what is left of one of them that is killed again and again.
fn check_killed(text: &str) {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, text).unwrap();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.path().join(name));
    succeed(&scene, &whole, &[]);
    let mut kills = 0;
    let mut more: &[&str] = &[];
    for wait in [30, 45, 20, 60, 35, 50, 25, 40] {
        let mut child = command(&scene, &killed, more)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        thread::sleep(Duration::from_millis(wait));
        // `Child::kill` is SIGKILL.
        child.kill().unwrap();
        kills += usize::from(child.wait().unwrap().code().is_none());
        if killed.exists() {
            more = &["--resume"];
        }
    }
    assert!(kills > 0);
    succeed(&scene, &killed, more);
    let [whole, killed] = [&whole, &killed].map(|folder| files(folder));
    assert_eq!(
        whole.keys().collect::<Vec<_>>(),
        killed.keys().collect::<Vec<_>>()
    );
    for (name, content) in whole {
        assert!(killed[&name] == content, "{} differs", name.display());
    }
}
