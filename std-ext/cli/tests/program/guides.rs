//! The guides: their links lead somewhere, their commands exist, their scenes pass the check.

use crate::{run, succeed, text};
use helfrich_std::method::BendingMethod;
use helfrich_std::scene::Effects;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Every Markdown file of the root, of `docs` and of the gallery, with its text.
fn guides() -> Vec<(PathBuf, String)> {
    let mut guides = Vec::new();
    for folder in [root(), root().join("docs"), root().join("docs/gallery")] {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "md") {
                let text = fs::read_to_string(&path).unwrap();
                guides.push((path, text));
            }
        }
    }
    assert!(guides.len() >= 9, "{guides:?}");
    guides
}

/// The blocks of one language.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let parts = text.split("\n```").skip(1).step_by(2);
    let block = |part: &'a str| {
        let (first, rest) = part.split_once('\n')?;
        (first == language).then_some(rest)
    };
    parts.filter_map(block).collect()
}

/// A heading as a fragment of an address: `## Speed, memory` is `speed-memory`.
fn fragment(heading: &str) -> String {
    let lower = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = |&c: &char| c.is_alphanumeric() || c == ' ' || c == '-' || c == '_';
    lower
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut count = 0;
    for (path, text) in guides() {
        let targets = text.split("](").skip(1);
        for target in targets.filter_map(|rest| rest.split_once(')').map(|(target, _)| target)) {
            if target.contains("://") {
                continue;
            }
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let file = match file {
                "" => path.clone(),
                file => path.parent().unwrap().join(file),
            };
            assert!(file.exists(), "{}: {target}", path.display());
            if !heading.is_empty() {
                let text = fs::read_to_string(&file).unwrap();
                let mut headings = text.lines().filter(|line| line.starts_with('#'));
                let found = headings.any(|line| fragment(line) == heading);
                assert!(found, "{}: {target}", path.display());
            }
            count += 1;
        }
    }
    assert!(count > 30, "{count} links");
}

/// The arguments of the program in a line of a console, if it runs the program.
fn arguments(line: &str) -> Option<&str> {
    let line = line.split(" #").next()?.trim();
    let starts = ["helfrich ", "cargo run --release -- "];
    starts.iter().find_map(|start| line.strip_prefix(start))
}

#[test]
fn commands_and_their_options_exist() {
    let mut helps = HashMap::new();
    let mut count = 0;
    for (path, guide) in guides() {
        let consoles = blocks(&guide, "console");
        let commands = consoles.iter().flat_map(|block| block.lines());
        for command in commands.filter_map(arguments) {
            let mut words = command.split_whitespace();
            let name = words.next().unwrap();
            let help = helps
                .entry(name.to_owned())
                .or_insert_with(|| succeed(&[name, "--help"]));
            for word in words {
                let option = word.split('=').next().unwrap();
                let mut known = help.split_whitespace().map(|it| it.trim_end_matches(','));
                let found = !option.starts_with("--") || known.any(|it| it == option);
                assert!(found, "{}: {command}: {option}", path.display());
                let found = !word.starts_with("std-ext/") || root().join(word).exists();
                assert!(found, "{}: {command}: {word}", path.display());
            }
            count += 1;
        }
    }
    assert!(count > 10, "{count} commands");
}

#[test]
fn examples_exist() {
    let mut count = 0;
    for (path, guide) in guides() {
        for rest in guide.split("--example ").skip(1) {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            let file = format!("examples/{}.rs", &rest[..end.unwrap()]);
            let found =
                ["core", "std-ext", "tests"].map(|package| root().join(package).join(&file));
            let found = found.iter().any(|file| file.exists());
            assert!(found, "{}: {file}", path.display());
            count += 1;
        }
    }
    assert!(count > 2, "{count} examples");
}

/// The text of a file of the repository.
fn file(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

/// The table of methods has a row of each, in the order of the list.
#[test]
fn the_table_of_methods_has_every_method() {
    let guide = file("docs/CHOOSING.md");
    let start = guide.find("| | name | kind |").unwrap();
    let table = guide[start..].split("\n\n").next().unwrap();
    let names = table.lines().skip(2).map(|row| {
        let cell = row.split('|').nth(2).unwrap();
        cell.trim().trim_matches('`')
    });
    let listed = BendingMethod::ALL.into_iter();
    let listed = listed.chain(BendingMethod::CURVATURES);
    let listed = Vec::from_iter(listed.map(BendingMethod::name));
    assert_eq!(Vec::from_iter(names), listed);
}

/// The first page is short, begins with the reader's own mesh, and explains what its table is about.
#[test]
fn the_readme_has_at_most_900_words() {
    let readme = file("README.md");
    let words = readme.split_whitespace().count();
    assert!(words <= 900, "{words} words");
    let headings = readme.lines().filter(|line| line.starts_with("## "));
    let first = Vec::from_iter(headings.take(4));
    let expected = [
        "## Your mesh",
        "## Your program",
        "## Python",
        "## Which method?",
    ];
    assert_eq!(first, expected);
    for word in ["**H**", "**K**", "**f**", "(A)", "(B)", "(G)", "(J)"] {
        assert!(readme.contains(word), "{word} is not explained");
    }
}

#[test]
fn the_table_of_effects_has_every_effect() {
    let guide = file("docs/SCENES.md");
    let table = guide.split("## Effects").nth(1).unwrap();
    let table = table
        .split("\n\n")
        .find(|part| part.starts_with("| key"))
        .unwrap();
    let keys = table
        .lines()
        .skip(2)
        .map(|row| row.split('|').nth(1).unwrap());
    let keys = keys.collect::<String>();
    for name in Effects::NAMES {
        assert!(keys.contains(&format!("`{name}`")), "no `{name}`");
    }
}

#[test]
fn scenes_pass_the_check() {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("scene.toml");
    let mut count = 0;
    for (path, guide) in guides() {
        for block in blocks(&guide, "toml") {
            let units = if block.contains("units") {
                ""
            } else {
                "units = \"none\"\n"
            };
            fs::write(&scene, format!("{units}{block}")).unwrap();
            let found = run(&["run", "--check", text(&scene)]);
            assert_eq!(found.code, Some(0), "{}: {}", path.display(), found.stderr);
            count += 1;
        }
    }
    assert!(count >= 2, "{count} scenes");
}
