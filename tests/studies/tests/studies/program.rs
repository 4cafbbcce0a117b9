//! The program `helfrich-studies` on the command line.

use crate::flow::row;
use helfrich_studies::effects::{EffectCost, EffectCosts};
use helfrich_studies::report::page_section;
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_helfrich-studies");
    let output = Command::new(program).args(arguments).output();
    output.expect("the program starts")
}

/// Outputs are checked before minutes of work, not after.
#[test]
fn outputs_are_checked_before_the_work() {
    for (code, arguments) in [
        (3, &["stability", "--markdown", "/proc/out.md"][..]),
        (3, &["flow", "--json", "/proc/out.json"]),
        (3, &["effects", "--json", "/proc/out.json"]),
        (3, &["costs", "--json", "/proc/out.json"]),
        // Tests run in the folder of their package, which is not that of the guides.
        (2, &["costs", "--update"]),
        (3, &["page", "--html", "/proc/out.html"]),
        (2, &["page"]),
        (2, &["stability", "--group", "none"]),
    ] {
        let output = run(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(message.starts_with("error: "), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}

/// The rows are printed as JSON, which `.ci/builds` compares, and as a table.
#[test]
fn hard_cases_are_printed_as_json_and_as_a_table() {
    let json = run(&["stability", "--group", "input", "--json", "-"]);
    assert!(json.status.success());
    let rows: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let rows = rows.as_array().expect("rows");
    assert!(
        rows.iter()
            .all(|row| row["passed"] == true && row["group"] == "input")
    );
    let table = run(&["stability", "--group", "input"]);
    let text = String::from_utf8_lossy(&table.stdout);
    let all = format!("{0} of {0} rows passed", rows.len());
    assert!(text.trim_end().ends_with(&all), "{text}");
}

#[test]
fn the_part_of_a_page_has_every_run_and_effect() {
    let effects = EffectCosts {
        seconds: 0.01,
        evaluations: 20,
        effects: vec![EffectCost {
            effect: "bending".to_owned(),
            own: Some(0.001),
            without: 0.009,
            evaluations_without: 10,
        }],
    };
    let section = page_section(&[row(6.0, 7.0, 0.1334)], &effects).expect("memory");
    let html = String::from_utf8(section.html).expect("text");
    for part in [
        "<section id=\"flow\">",
        "id=\"flow-steady\"",
        "0.1334",
        "<svg",
        "Guckenberger",
        "<section id=\"effects\">",
        "id=\"effect-costs\"",
        "<code>bending</code>",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert_eq!(
        html.matches("<section").count(),
        html.matches("</section>").count()
    );
    assert_eq!(section.charts.len(), 1);
}
