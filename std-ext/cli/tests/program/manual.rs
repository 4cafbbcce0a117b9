//! The manual and the completions of shells, which are files of the package.

use clap_complete::{Shell, generate};
use clap_mangen::Man;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Every file, by its path in the package.
fn files() -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        let mut text = Vec::new();
        generate(shell, &mut helfrich_cli::command(), "helfrich", &mut text);
        files.insert(format!("completions/helfrich.{shell}"), text);
    }
    let mut program = helfrich_cli::command().disable_help_subcommand(true);
    program.build();
    let commands = Vec::from_iter(program.get_subcommands().cloned());
    for command in commands.into_iter().chain([program]) {
        // Without a version at its foot: nothing to change for a release.
        let page = Man::new(command).source("helfrich");
        let mut text = Vec::new();
        page.render(&mut text).unwrap();
        files.insert(format!("man/{}", page.get_filename()), text);
    }
    files
}

#[test]
fn the_manual_and_completions_are_up_to_date() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (name, text) in files() {
        let path = package.join(&name);
        if std::env::var_os("UPDATE_MANUAL").is_some() {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, &text).unwrap();
        }
        assert!(
            fs::read(&path).is_ok_and(|found| found == text),
            "{name} is out of date: run this test with UPDATE_MANUAL=1"
        );
    }
}
