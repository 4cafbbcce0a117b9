//! Streams that nobody reads, or that take nothing.

use crate::fixture::{Fixture, obj, sheet};
use crate::{command, succeed};
use std::process::{Command, Stdio};
#[cfg(target_os = "linux")]
use {crate::fail, std::fs};

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for arguments in [
        &["study", "--vertices", "12", "--family", "regular"][..],
        &[
            "study",
            "--vertices",
            "12",
            "--family",
            "regular",
            "--json",
            "-",
        ],
        &["curvature", file.path(), "--method", "corrected"],
        &["info", file.path()],
    ] {
        let mut child = command(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    }
}

#[test]
fn the_exit_code_tells_even_if_nobody_reads_the_message() {
    let mut child = command(&["info", "missing.obj"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_output_error() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for arguments in [
        &["study", "--vertices", "12", "--family", "regular"][..],
        &["curvature", file.path(), "--method", "corrected"],
        &["info", file.path()],
    ] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = command(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: standard output"));
    }
    fail(
        3,
        &[
            "curvature",
            file.path(),
            "--method",
            "corrected",
            "--csv",
            "/dev/full",
        ],
    );
}

/// The words of a table are explained to those who read it on a screen, and not to programs that read it.
#[cfg(target_os = "linux")]
#[test]
fn columns_are_explained_on_a_screen() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let words = [
        "mean curvature",
        "Gaussian curvature",
        "bending force per area",
    ];
    let screen = Command::new("script")
        .args(["--quiet", "--command"])
        .arg(format!(
            "'{}' curvature '{}' --method corrected",
            env!("CARGO_BIN_EXE_helfrich"),
            file.path()
        ))
        .arg("/dev/null")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let screen = String::from_utf8_lossy(&screen.stdout);
    let help = succeed(&["curvature", "--help"]);
    let piped = succeed(&["curvature", file.path(), "--method", "corrected"]);
    for word in words {
        assert!(
            screen.contains(word) && help.contains(word),
            "{word}: {screen}"
        );
        assert!(!piped.contains(word), "{word}");
    }
}
