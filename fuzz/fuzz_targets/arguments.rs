//! Any arguments of the program, one a line, in a folder with a mesh and a scene: one of the exit codes
//! that its help names, a message where it is not 0, and no panic.
//!
//! The program is the one that HELFRICH names; arguments take it where they will, so its coverage is
//! not seen, and corpora do not grow by it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Long enough for arguments to be refused; what is still at work then is none of this target's.
const PATIENCE: Duration = Duration::from_millis(400);

const TETRAHEDRON: &str =
    "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";

fuzz_target!(|text: &str| {
    // Files elsewhere are not for this target to touch; a NUL cannot be passed at all.
    if text.contains(['/', '\0', '~']) || text.contains("..") {
        return;
    }
    let program = std::env::var_os("HELFRICH").expect("HELFRICH names the program");
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mesh.obj"), TETRAHEDRON).expect("room");
    let scene = include_str!("../checkpoint-scenes/relaxing.toml");
    fs::write(folder.path().join("scene.toml"), scene).expect("room");
    let messages = fs::File::create(folder.path().join("messages")).expect("room");
    let mut child = Command::new(program)
        .args(text.lines())
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(messages)
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("the child is ours") {
            break status;
        }
        if start.elapsed() > PATIENCE {
            let _ = child.kill();
            let _ = child.wait();
            return;
        }
        sleep(Duration::from_micros(300));
    };
    let messages = fs::read(folder.path().join("messages")).expect("the file is there");
    let messages = String::from_utf8_lossy(&messages);
    assert!(!messages.contains("panicked"), "{messages}");
    match status.code() {
        Some(0) => {}
        Some(2 | 3 | 4) => assert!(!messages.is_empty(), "no message for {status}"),
        _ => panic!("{status}: {messages}"),
    }
});
