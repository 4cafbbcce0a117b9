//! `helfrich scenes`, and scenes by name.

use crate::{command, fail, succeed, text};
use std::fs;
use tempfile::TempDir;

#[test]
fn scenes_are_listed_written_and_run_by_name() {
    let folder = TempDir::new().unwrap();
    let list = succeed(&["scenes"]);
    let line = list.lines().find(|line| line.starts_with("capsule-shear "));
    assert!(line.unwrap().contains("capsule"), "{list}");
    let checked = succeed(&["run", "capsule-shear", "--check"]);
    assert!(checked.contains("is a valid scene"), "{checked}");

    let out = folder.path().join("scenes");
    succeed(&["scenes", "--out", text(&out)]);
    let scene = out.join("capsule-shear.toml");
    succeed(&["run", text(&scene), "--check"]);
    // Without a line about what is kept nothing would tell that a new one was not written.
    fs::write(&scene, "changed").unwrap();
    let again = command(&["scenes", "--out", text(&out)]).output().unwrap();
    let message = String::from_utf8(again.stderr).unwrap();
    assert!(message.contains("capsule-shear.toml: exists already, and was not overwritten"));
    assert_eq!(fs::read_to_string(&scene).unwrap(), "changed");

    let message = fail(2, &["run", "no-such-scene", "--check"]);
    assert!(message.contains("helfrich scenes"), "{message}");
}

/// A folder of the scene's name, which an earlier run has left, is no scene file.
#[test]
fn a_shipped_scene_runs_into_a_folder_of_its_name() {
    let folder = TempDir::new().unwrap();
    let run = |more: &[&str]| {
        let short = [
            "--set",
            "driver.strain=0.02",
            "--set",
            "surface.0.vertices=42",
            "--set",
            "output.pictures=false",
        ];
        let mut command = command(&[&["run", "capsule-shear"], &short[..], more].concat());
        command.current_dir(folder.path()).output().unwrap()
    };
    let first = run(&[]);
    assert!(first.status.success(), "{first:?}");
    assert!(folder.path().join("capsule-shear/summary.json").is_file());
    let again = run(&["--resume"]);
    assert!(again.status.success(), "{again:?}");
}

#[test]
fn the_version_names_the_program() {
    let version = succeed(&["--version"]);
    assert_eq!(
        version.trim_end(),
        concat!("helfrich ", env!("CARGO_PKG_VERSION"))
    );
}
