//! The program as its users meet it: arguments and files in, output, messages and exit codes out.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

mod acting;
mod bad_input;
mod checked;
mod curvature;
mod disasters;
mod error_bars;
mod fixture;
mod guides;
mod info;
mod interrupted;
mod lost;
mod manual;
mod page;
mod paper;
mod recommend;
mod remesh;
mod repair;
mod resume;
mod run;
mod scenes;
mod smooth;
mod split;
mod streams;
mod study;
mod sweep;

/// Output of a run.
#[derive(Debug)]
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_helfrich"));
    command.args(arguments).stdin(Stdio::null());
    command
}

fn run(arguments: &[&str]) -> Run {
    let output = command(arguments).output().unwrap();
    Run {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// The standard output of a run that ends well and says nothing beside it.
#[track_caller]
fn succeed(arguments: &[&str]) -> String {
    let run = run(arguments);
    assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
    assert_eq!(run.stderr, "", "{arguments:?}");
    run.stdout
}

/// The message of a run that ends with this code, and prints nothing.
#[track_caller]
fn fail(code: i32, arguments: &[&str]) -> String {
    let run = run(arguments);
    assert_eq!(run.code, Some(code), "{arguments:?}: {}", run.stderr);
    assert_eq!(run.stdout, "", "{arguments:?}");
    assert!(run.stderr.starts_with("error: "), "{}", run.stderr);
    assert_eq!(run.stderr.matches("error:").count(), 1, "{}", run.stderr);
    run.stderr
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn is_empty(folder: &TempDir) -> bool {
    fs::read_dir(folder.path()).unwrap().next().is_none()
}
