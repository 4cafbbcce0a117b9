//! From what the program is made: for the pages of studies, whose times mean nothing without it.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    // The answer changes with the sources, and with what is checked out. This package is small: the
    // libraries know no commit, and are not compiled again for one.
    for path in [
        "build.rs",
        "src",
        "../src",
        "../evaluate/src",
        "../mesh/src",
        "../solve/src",
        "../draw/src",
        "../scene/src",
        "../run/src",
        "../study/src",
        "../../core/src",
        "../../Cargo.lock",
    ] {
        println!("cargo::rerun-if-changed={path}");
    }
    // A checkout may have no log; a file that is missing counts as changed every time, and all that depends on this
    // package would be compiled again.
    for name in ["HEAD", "logs/HEAD"] {
        let path = output("git", &["rev-parse", "--git-path", name]);
        if let Some(path) = path.filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let variable = |name: &str| env::var(name).unwrap_or_default();
    let rustc = output(&variable("RUSTC"), &["--version"]);
    // Not that of a repository that happens to be around an unpacked archive.
    let own = output("git", &["ls-files", "--error-unmatch", "build.rs"]);
    let commit =
        own.and_then(|_| output("git", &["describe", "--always", "--abbrev=12", "--dirty"]));
    let flags = variable("CARGO_ENCODED_RUSTFLAGS").replace('\u{1f}', " ");
    for (name, value) in [
        ("COMMIT", commit.unwrap_or_default()),
        ("COMPILER", rustc.unwrap_or_default()),
        ("FLAGS", flags),
        (
            "PROFILE",
            format!(
                "{}, opt-level {}",
                variable("PROFILE"),
                variable("OPT_LEVEL")
            ),
        ),
        ("TARGET", variable("TARGET")),
    ] {
        println!("cargo::rustc-env=HELFRICH_{name}={value}");
    }
}

/// The first line that a command prints; none if it fails.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output
        .status
        .success()
        .then(|| text.lines().next().unwrap_or_default().to_owned())
}
