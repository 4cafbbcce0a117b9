//! Every file of the library that implements a method is in the suite of laws.

use helfrich_tests::laws::{Candidate, Law, for_each};
use std::fs;
use std::path::{Path, PathBuf};

/// Modules of the library whose formulas the laws of methods evaluate.
struct Covered(Vec<&'static str>);

impl Law for Covered {
    fn check<C: Candidate>(&mut self, candidate: C) {
        self.0.extend(candidate.modules());
    }
}

/// Modules in a folder of the library that implement a method.
fn method_modules(folder: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../core/src")
        .join(folder);
    let files = fs::read_dir(&folder).expect("a folder of core");
    let files = files.map(|file| file.expect("a file").path());
    let has_method = |file: &PathBuf| {
        let text = fs::read_to_string(file).unwrap_or_default();
        text.contains(" Method<T> for ")
    };
    let name = |file: PathBuf| file.file_stem()?.to_str().map(str::to_owned);
    let modules = Vec::from_iter(files.filter(has_method).filter_map(name));
    assert!(
        !modules.is_empty(),
        "no method found in {}",
        folder.display()
    );
    modules
}

#[test]
fn every_method_of_the_library_is_in_the_suite() {
    let mut covered = Covered(Vec::new());
    for_each(&mut covered);
    for folder in ["bending", "laplacian"] {
        for module in method_modules(folder) {
            assert!(
                covered.0.contains(&&*module),
                "core/src/{folder}/{module}.rs is in no law: add it to the list of methods, or to \
                 laws::for_each or laws::for_each_operator"
            );
        }
    }
}
