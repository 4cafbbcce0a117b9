//! Randomly generated and malicious scenes.

use super::schema::{conforms, json};
use super::{parse, parse_with, shipped, with};
use helfrich_std::scene::{Overrides, SceneFile, json_schema};
use helfrich_tests::meshes::cases;
use proptest::prelude::*;
use std::path::Path;

/// Words from which invalid scenes are composed.
const WORDS: &[&str] = &[
    "[surface.bending]",
    "[[surface]]",
    "[surface.volume]",
    "[driver]",
    "[[interaction]]",
    "units",
    "=",
    "\"none\"",
    "\"micro\"",
    "modulus",
    "\"2e-19 J\"",
    "\"µ\"",
    "-1",
    "0",
    "1e999",
    "nan",
    "{",
    "}",
    "[",
    "]",
    ",",
    ".",
    "\n",
    "shape",
    "\"sphere:1\"",
    "vertices",
    "642",
    "\u{0}",
    "é",
    "target",
    "\"initial\"",
    "reduced",
    "constraint",
    "\"exact\"",
    "\"\"",
    "'",
    "\"",
    "#",
    "true",
    "reference",
    "9999999999999999999999999999999999999999999",
    "\"boundary-integral\"",
    "\"lattice-boltzmann\"",
    "resolution",
    "box",
    "[7, 7, 7]",
    "[[obstacle]]",
    "kind",
    "flow",
    "\"shear\"",
    "rate",
    "strain",
    "gradient",
    "[[0, 1, 0], [0, 0, 0], [0, 0, 0]]",
    "[[output.slice]]",
    "interval",
];

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn any_text_is_read_or_refused(text in "(?s).{0,200}") {
        let _ = parse(&text).map_err(|errors| errors.to_string());
    }

    #[test]
    fn any_words_are_read_or_refused(words in prop::collection::vec(prop::sample::select(WORDS), 0..60)) {
        let _ = parse(&words.join(" ")).map_err(|errors| errors.to_string());
    }

    #[test]
    fn mutated_scenes_are_read_or_refused(
        scene in any::<prop::sample::Index>(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..12_usize, prop::sample::select(WORDS)), 1..4),
    ) {
        let all = shipped();
        let (_, text) = &all[scene.index(all.len())];
        let mut text = Vec::from_iter(text.chars());
        for (at, length, word) in cuts {
            let at = at.index(text.len().max(1)).min(text.len());
            let end = (at + length).min(text.len());
            text.splice(at..end, word.chars());
        }
        let text = String::from_iter(text);
        match parse(&text) {
            // Any scene that is read conforms to the schema.
            Ok(_) => prop_assert!(conforms(&json_schema(), &json(&text)), "{}", text),
            Err(errors) => prop_assert!(!errors.to_string().is_empty()),
        }
    }

    #[test]
    fn any_override_is_read_or_refused(path in "[a-z0-9_.]{0,30}", value in "(?s).{0,30}", inside in any::<bool>()) {
        let start = if inside { "surface.0." } else { "" };
        if let Ok(overrides) = Overrides::new([format!("{start}{path}={value}")]) {
            let text = with("bending = { method = \"B\", modulus = 1 }");
            let read = SceneFile::parse(&text, Path::new("a.toml"), &overrides);
            let _ = read.map_err(|errors| errors.to_string());
        }
    }
}

#[test]
fn deep_texts_do_not_overflow_the_stack() {
    let depth = 100_000;
    let dotted = format!("{}a = 1", "a.".repeat(depth));
    let lists = format!("a = {}{}", "[".repeat(depth), "]".repeat(depth));
    let tables = format!("a = {}{}", "{a = ".repeat(depth), "}".repeat(depth));
    for text in [dotted, lists, tables] {
        assert!(parse(&text).is_err());
        let set = text.replacen(" = ", "=", 1);
        assert!(parse_with(&with(""), &[set]).is_err());
    }
}
