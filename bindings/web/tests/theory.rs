//! The energies of vesicles that the page shows are those of the theory of axisymmetric shapes.
//!
//! `UPDATE_BRANCHES=1 cargo test --package helfrich-web --test theory` writes them.

use helfrich_tests::axisymmetric::{Branch, Vesicle};
use std::path::Path;

/// Number of coefficients: energies have six digits.
const COEFFICIENTS: usize = 40;

/// Digits of the energies in the file.
const DIGITS: f64 = 1e4;

#[test]
fn energies_of_branches_are_those_of_the_theory() {
    let branches = [
        ("prolate", Branch::Prolate, 50..=99),
        ("oblate", Branch::Oblate, 52..=99),
        ("stomatocyte", Branch::Stomatocyte, 46..=64),
    ];
    let all = branches.map(|(name, branch, hundredths)| {
        let points = hundredths.step_by(2).filter_map(|hundredth| {
            let volume = f64::from(hundredth) / 100.0;
            let energy = Vesicle::new(branch, volume, COEFFICIENTS).ok()?.energy();
            Some([volume, (DIGITS * energy).round() / DIGITS])
        });
        serde_json::json!({ "name": name, "points": Vec::from_iter(points) })
    });
    let made = serde_json::json!(all).to_string() + "\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("page/branches.json");
    if std::env::var_os("UPDATE_BRANCHES").is_some() {
        std::fs::write(&path, &made).expect("a writable file");
    }
    let kept = std::fs::read_to_string(&path).expect("the file of energies");
    assert_eq!(kept, made, "written by UPDATE_BRANCHES=1");
    assert!(
        all.iter()
            .all(|branch| branch["points"].as_array().is_some_and(|all| all.len() > 8))
    );
}
