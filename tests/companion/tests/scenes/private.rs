//! Private modules of libraries that contain tests. They are compiled here, so that these need not
//! be compiled a second time for their tests.

use helfrich_std::scene::UnitSystem;
use std::fs;
use std::path::Path;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../../std-ext/scene/src/scene/units.rs"]
mod units;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../../std-ext/scene/src/six.rs"]
mod six;

#[path = "../../../../std-ext/run/src/sweep/vary.rs"]
mod vary;

#[path = "../../../../std-ext/run/src/run/curved.rs"]
mod curved;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../../std-ext/scene/src/simulation/once.rs"]
mod once;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../../std-ext/study/src/study/timing.rs"]
mod timing;

#[path = "../../../../std-ext/study/src/study/measured.rs"]
mod measured;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../../std-ext/run/src/run/remedy.rs"]
mod remedy;

#[expect(dead_code, reason = "the program uses what the tests do not")]
#[path = "../../../../std-ext/cli/src/terminal/progress_bar.rs"]
mod progress_bar;

/// The cache to which the module of measurements refers.
mod cache {
    pub(super) use helfrich_std::study::Cache;
}

/// Libraries that are not compiled for tests have no tests but those of the modules above.
#[test]
fn tests_of_private_modules_run() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders = [
        "core",
        "std-ext",
        "std-ext/evaluate",
        "std-ext/scene",
        "std-ext/run",
        "std-ext/study",
        "std-ext/cli",
    ]
    .map(|package| top.join(package).join("src"))
    .to_vec();
    let here = include_str!("private.rs");
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if fs::read_to_string(&path).is_ok_and(|text| text.contains("#[cfg(test)]")) {
                let name = path.strip_prefix(&top).expect("a path below").display();
                assert!(here.contains(&format!("../{name}\"")), "{name}");
                found += 1;
            }
        }
    }
    assert!(found > 0);
}
