//! Any bytes as the checkpoint of a run that is taken up again, and any state behind a header and a
//! checksum that fit it: an error, or a run that goes on and leaves numbers and files that are whole.
#![no_main]

use helfrich_std::run::run;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::build;
use libfuzzer_sys::fuzz_target;
use sha2::{Digest, Sha256};
use std::cell::Cell;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// Where the length of the body, the checksum and the body start: `checkpoint.rs` says the layout.
const LENGTH: usize = 20;
const CHECKSUM: usize = 28;
const BODY: usize = 60;

/// A run of each driver, of few vertices and few steps.
const SCENES: [&str; 3] = [
    include_str!("../checkpoint-scenes/relaxing.toml"),
    include_str!("../checkpoint-scenes/flowing.toml"),
    include_str!("../checkpoint-scenes/lattice.toml"),
];

fn scene(number: usize) -> SceneFile {
    let overrides = Overrides::new::<String>([]).expect("none");
    SceneFile::parse(SCENES[number], Path::new("scene.toml"), &overrides)
        .expect("the scene is ours")
}

/// Some steps of a run in a folder.
fn go(number: usize, folder: &Path, resume: bool, steps: u32) -> Result<(), String> {
    let file = scene(number);
    let ready = build(&file).map_err(|error| error.to_string())?;
    let left = Cell::new(steps);
    let interrupted = || left.replace(left.get().saturating_sub(1)) == 0;
    let summary = run(
        &file.scene,
        ready,
        folder,
        resume,
        &interrupted,
        &mut |_| {},
    );
    summary.map(|_| ()).map_err(|error| error.to_string())
}

/// The checkpoint and the series of each scene after some steps.
static FILES: LazyLock<[[Vec<u8>; 2]; 3]> = LazyLock::new(|| {
    [0, 1, 2].map(|number| {
        let folder = tempfile::tempdir().expect("a folder");
        go(number, folder.path(), false, 2).expect("the run is ours");
        ["checkpoint", "series.csv"]
            .map(|name| fs::read(folder.path().join(name)).expect("the run has left it"))
    })
});

// The first byte chooses the scene, and whether the rest is a file, or edits of the body of a true
// one: three bytes say where, and one what.
fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let number = usize::from(choice) % 3;
    let [checkpoint, series] = &FILES[number];
    let written = if choice < 128 {
        rest.to_vec()
    } else {
        let mut written = checkpoint.clone();
        for edit in rest.chunks_exact(4) {
            let place =
                usize::from(edit[0]) | usize::from(edit[1]) << 8 | usize::from(edit[2]) << 16;
            let body = written.len() - BODY;
            written[BODY + place % body] = edit[3];
        }
        // What is left of four cuts the end off.
        written.truncate(written.len() - rest.len() % 4);
        let length = (written.len() - BODY) as u64;
        written[LENGTH..CHECKSUM].copy_from_slice(&length.to_le_bytes());
        let mut sum = Sha256::new();
        sum.update(&written[..CHECKSUM]);
        sum.update(&written[BODY..]);
        written[CHECKSUM..BODY].copy_from_slice(&sum.finalize());
        written
    };
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("checkpoint"), written).expect("room");
    fs::write(folder.path().join("series.csv"), series).expect("room");
    match go(number, folder.path(), true, 2) {
        Ok(()) => {
            SeriesTable::read(&folder.path().join("series.csv")).expect("the series is whole");
        }
        Err(message) => assert!(!message.is_empty() && !message.contains('\n')),
    }
});
