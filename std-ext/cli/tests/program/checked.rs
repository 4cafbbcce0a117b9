//! `helfrich run --check`: it refuses all that a run would refuse before it writes anything.

use crate::run::{FLOW, LATTICE, SCENE};
use crate::{command, fail, text};
use std::fs;
use tempfile::TempDir;

/// Scenes that no run begins, with a value of each that is at fault, and what the message says.
#[test]
fn what_a_run_refuses_at_once_a_check_refuses() {
    let unreadable = "output.plot=[{column = \"deformation\", published = \"none.csv\"}]";
    for (scene, set, hint) in [
        (
            FLOW,
            "output.plot=[{column = \"inclinaton\"}]",
            "inclination",
        ),
        (FLOW, unreadable, "none.csv"),
        (
            SCENE,
            "output.plot=[{column = \"deformation\"}]",
            "smallest_angle",
        ),
        (
            FLOW,
            "output.strain_interval=1e-300",
            "longer `strain_interval`",
        ),
        (FLOW, "output={interval = 1e-9}", "longer `interval`"),
        (
            LATTICE,
            "output.strain_interval=1e-300",
            "longer `strain_interval`",
        ),
        (FLOW, "driver.strain=1e300", "shorter `strain`"),
        (FLOW, "driver.tolerance=1e-300", "has to be larger"),
        (
            FLOW,
            "driver={kind=\"boundary-integral\", viscosity=1, strain=6, integrator=\"rk4\", \
                step=1e-300, flow={kind=\"shear\", rate=0.3}}",
            "longer `step`",
        ),
        (LATTICE, "driver.step=1e-30", "longer `step`"),
        (
            SCENE,
            "surface.vesicle.bending=",
            "surface \"vesicle\" has the moduli 0e0 (bending) and 0e0 (in plane)",
        ),
        (
            SCENE,
            "surface.vesicle.bending.spontaneous_curvature=1e100",
            "overflow where it is above",
        ),
        (
            FLOW,
            "surface.0.bending.modulus=1e200",
            "overflow where it is above",
        ),
        (
            SCENE,
            "surface.vesicle.gravity={density_difference=1e308, acceleration=[0, 0, 1e308]}",
            "the weight per volume is not a finite number",
        ),
        (
            SCENE,
            "surface.vesicle.elasticity={law=\"skalak\", shear_modulus=1e308, area_ratio=1e308}",
            "the area modulus is not a finite number",
        ),
        (
            SCENE,
            "surface.vesicle.volume.reduced=1e-300",
            "reduced volume of 1e-300",
        ),
        (
            SCENE,
            "surface.vesicle.volume={modulus=1, reduced=1e-300}",
            "lost in rounding",
        ),
        (
            SCENE,
            "surface.vesicle.volume={modulus=1, target=1e-300}",
            "lost in rounding",
        ),
        (
            SCENE,
            "surface.vesicle.volume={modulus=1, target=1e300}",
            "never reached",
        ),
        (
            SCENE,
            "surface.vesicle.area={modulus=1, target=1e-300}",
            "target area of 1e-300",
        ),
        (
            SCENE,
            "surface.vesicle.area_difference={modulus=1, reduced=1e300}",
            "never reached",
        ),
    ] {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, scene).unwrap();
        let out = folder.path().join("out");
        let said = [["--check"].as_slice(), &["--out", text(&out)]].map(|more| {
            let message = fail(2, &[&["run", text(&path), "--set", set], more].concat());
            assert!(message.contains(hint), "{set}: {message}");
            message
        });
        assert_eq!(said[0], said[1]);
        assert!(!out.exists(), "{set}");
    }
}

/// Files are relative to the scene, wherever the program is called.
#[test]
fn a_scene_is_checked_from_any_folder() {
    let folder = TempDir::new().unwrap();
    let below = folder.path().join("scenes");
    let elsewhere = folder.path().join("elsewhere");
    for path in [&below, &elsewhere] {
        fs::create_dir(path).unwrap();
    }
    let octahedron = "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n\
                      3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n";
    for name in ["cell.off", "rest.off"] {
        fs::write(below.join(name), octahedron).unwrap();
    }
    fs::write(below.join("curve.csv"), "curve,x,y\nsomebody,0.3,0.09\n").unwrap();
    let scene = r#"
units = "none"
surface = [{ mesh = "cell.off", elasticity = { law = "neo-hookean", shear_modulus = 1, reference.mesh = "rest.off" } }]
driver = { kind = "boundary-integral", viscosity = 1, flow = { kind = "shear", rate = 1 }, strain = 0.1 }
output.plot = [{ column = "deformation", published = "curve.csv" }]
"#;
    fs::write(below.join("scene.toml"), scene).unwrap();
    for (from, files, path) in [
        (below.as_path(), 4, "scene.toml"),
        (&elsewhere, 0, "../scenes/scene.toml"),
        (folder.path(), 2, "scenes/scene.toml"),
    ] {
        let output = command(&["run", path, "--check"])
            .current_dir(from)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{path}: {said}");
        // Nothing is written.
        assert_eq!(fs::read_dir(from).unwrap().count(), files);
    }
}
