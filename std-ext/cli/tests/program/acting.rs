//! Runs in which nothing acts, or nothing is measured: refused, and never an equilibrium.

use crate::fixture::{Fixture, obj};
use crate::run::{SCENE, run, succeed};
use crate::{fail, text};
use helfrich_std::series::SeriesTable;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

const BENDING: &str = r#"
units = "none"
[[surface]]
name = "vesicle"
shape = "ellipsoid:1,1,1.6"
vertices = 162
bending = { method = "juelicher", modulus = 1 }
[driver]
kind = "relax"
# Of so few vertices it is known to some per cent.
energy_error = 0.1
"#;

fn folder_with(scene: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    (folder, path)
}

/// Neither `--check` nor a run lets these pass, and no folder is made.
#[track_caller]
fn refused(sets: &[&str], hints: &[&str]) {
    let (folder, scene) = folder_with(BENDING);
    let out = folder.path().join("out");
    let sets = Vec::from_iter(sets.iter().flat_map(|set| ["--set", set]));
    for more in [["--check"].as_slice(), &["--out", text(&out)]] {
        let arguments = [&["run", text(&scene)], more, &sets].concat();
        let message = fail(2, &arguments);
        for hint in hints {
            assert!(message.contains(hint), "no {hint} in {message}");
        }
        assert!(!out.exists());
    }
}

#[test]
fn surfaces_at_rest_are_no_equilibrium_that_was_found() {
    for effects in [
        &[
            "surface.0.area={modulus=1}",
            "surface.0.volume={constraint=\"exact\"}",
        ][..],
        &["surface.0.local_area={modulus=1}"],
        &["surface.0.area={modulus=1}", "surface.0.volume={modulus=1}"],
    ] {
        let sets = [&["surface.0.bending="], effects].concat();
        refused(&sets, &["nothing acts on \"vesicle\"", "reference"]);
    }
}

/// No fit through the five points around each corner of an octahedron is determined.
#[test]
fn methods_that_leave_out_every_vertex_are_refused() {
    let corners: [[f64; 3]; 6] = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
    ];
    let sides = [
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    let mesh = Fixture::new("octahedron.obj", obj(&corners, &sides));
    let source = format!("surface.0.mesh={}", mesh.path());
    for method in ["j4", "j6", "j8", "farutin"] {
        refused(
            &[
                &format!("surface.0.bending.method={method}"),
                "surface.0.shape=",
                "surface.0.vertices=",
                &source,
            ],
            &[
                "\"vesicle\"",
                method,
                "all of its 6 vertices",
                "more vertices",
            ],
        );
    }
}

#[test]
fn numbers_whose_squares_vanish_are_refused() {
    for set in ["surface.0.scale=1e-90", "surface.0.scale=1e-150"] {
        refused(&[set], &["edges of \"vesicle\"", "other units"]);
    }
    for set in ["1e-300", "1e300"] {
        refused(
            &[&format!("surface.0.bending.modulus={set}")],
            &["κ/R³", "other units"],
        );
    }
}

/// The residual is known from the first row on, and so it is where nothing is left to do.
#[test]
fn the_residual_is_a_number_in_every_row() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    succeed(&scene, &out, &["--set", "output.pictures=false"]);
    let series = SeriesTable::read(&out.join("series.csv")).unwrap();
    let residuals = series.column("residual").unwrap();
    assert!(residuals.iter().all(|it| it.is_finite() && *it > 0.0));
    // From an equilibrium.
    let first = format!("driver.residual={:e}", 2.0 * residuals[0]);
    let out = folder.path().join("at-once");
    let output = run(&scene, &out, &["--set", &first]);
    assert_eq!(output.status.code(), Some(0));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("converged: 0 iterations"), "{printed}");
    assert!(!printed.contains("NaN"), "{printed}");
}

/// Warnings about several surfaces are given once, with six digits at most, and a suspension is
/// not compared with a body in unbounded fluid.
#[test]
fn warnings_are_said_once_and_fit_the_scene() {
    let capsule = |x: f64| {
        format!(
            "[[surface]]\nname = \"at{}\"\nshape = \"sphere:1\"\nfamily = \"regular\"\nvertices = 162\n\
             position = [{x}, 0, 0]\nelasticity = {{ law = \"neo-hookean\", shear_modulus = 1 }}\n",
            x as u32
        )
    };
    let surfaces = [0.0, 3.0, 6.0].map(capsule);
    let driver = "[output]\npictures = false\n[driver]\nkind = \"lattice-boltzmann\"\nviscosity = 1\nresolution = 3\n\
                  flow = { kind = \"shear\", rate = 0.1 }\nbox = [9, 5, 5]\nstrain = 0.01\n\
                  [[interaction]]\nkind = \"repulsion\"\nstrength = 1\ncutoff = 0.0834567891234\n";
    let scene = format!("units = \"none\"\n{}{driver}", surfaces.concat());
    let (folder, path) = folder_with(&scene);
    let out = folder.path().join("out");
    let said = String::from_utf8(run(&path, &out, &[]).stderr).unwrap();
    for what in ["has no bending", "a surface can slip"] {
        assert_eq!(said.matches(what).count(), 1, "{said}");
    }
    assert!(said.contains("(and so for \"at3\", \"at6\")"), "{said}");
    assert!(said.contains("reaches 0.0834568, and"), "{said}");
    for remark in ["unbounded fluid", "Guckenberger", "D by about"] {
        assert!(!said.contains(remark), "{said}");
    }
}
