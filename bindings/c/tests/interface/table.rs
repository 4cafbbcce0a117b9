//! The table of functions, the header and the library name the same functions.

use std::collections::BTreeSet;
use std::path::Path;

fn file(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// The names of functions in a text: words that begin with `hf_` where `is` says so.
fn names(text: &str, is: impl Fn(&str, &str) -> bool) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (at, _) in text.match_indices("hf_") {
        let inside = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = text[at..]
            .find(|c| !inside(c))
            .map_or(text.len(), |length| at + length);
        let begins = !text[..at].ends_with(inside);
        if begins && is(&text[at..end], &text[end..]) {
            names.insert(text[at..end].to_owned());
        }
    }
    names
}

#[test]
fn the_table_has_the_functions_of_the_header() {
    let header = file("include/helfrich.h");
    let declared = names(&header, |_, after| after.starts_with('('));
    assert!(declared.len() > 40, "{declared:?}");
    let quoted = names(&file("../functions.toml"), |_, after| {
        after.starts_with('"')
    });
    let missing = Vec::from_iter(declared.difference(&quoted));
    assert!(
        missing.is_empty(),
        "not in bindings/functions.toml: {missing:?}"
    );
    let unknown = Vec::from_iter(quoted.difference(&declared));
    assert!(unknown.is_empty(), "not in the header: {unknown:?}");
}

#[test]
fn every_function_with_numbers_has_a_twin() {
    let header = file("include/helfrich.h");
    let declared = names(&header, |_, after| after.starts_with('('));
    let twins = declared.iter().filter(|name| name.ends_with("_f32"));
    for twin in twins {
        assert!(declared.contains(twin.trim_end_matches("_f32")), "{twin}");
    }
    // Positions are in f64 alone where targets hold to 1e-10.
    let exact = ["hf_membrane_constraint_gradients", "hf_membrane_restore"];
    for name in declared.iter().filter(|name| !name.ends_with("_f32")) {
        let start = header.find(&format!("{name}(")).unwrap();
        let end = start + header[start..].find(';').unwrap();
        let numbers = header[start..end].contains("(*positions)[3]");
        let twin = declared.contains(&format!("{name}_f32"));
        assert!(!numbers || twin || exact.contains(&name.as_str()), "{name}");
    }
}
