//! Costs: documents and constants of the program agree with the data file. Nothing is timed here.

use helfrich_std::method::BendingMethod;
use helfrich_studies::costs::documents::{
    CONSTANTS, DATA, END, GUIDES, START, constant, filled, read, texts,
};
use helfrich_studies::costs::{Costs, GalerkinCost, MethodCost};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Guides and constants state what the last measurement found. `UPDATE_COSTS=1` writes them from the data file.
#[test]
fn documents_and_constants_agree_with_the_measurement() {
    let root = root();
    let costs = read(&root).expect("the data file");
    for (path, text) in texts(&root, &costs).expect("the guides") {
        if std::env::var_os("UPDATE_COSTS").is_some() {
            fs::write(&path, &text).expect("a file of the repository");
        }
        let found = fs::read_to_string(&path).expect("a file of the repository");
        let (lines, expected) = (found.lines(), text.lines());
        for (number, (line, expected)) in lines.zip(expected).enumerate() {
            assert_eq!(line, expected, "{}:{}", path.display(), number + 1);
        }
        assert_eq!(found, text, "{}", path.display());
    }
    // The constants are those that the program was compiled with.
    for method in BendingMethod::NAMED {
        let own = costs
            .methods
            .iter()
            .find(|cost| cost.method == method.name());
        let own = own.unwrap_or_else(|| panic!("{DATA} has no `{method}`"));
        assert_eq!(
            method.cost().relative,
            constant(own.relative),
            "{CONSTANTS}: {method}"
        );
    }
    assert_eq!(BendingMethod::GompperKroll.cost().relative, 1.0);
}

/// The guide to the choice has the cost of each method, in the words that it uses of them.
#[test]
fn the_guide_to_the_choice_has_the_cost_of_every_method() {
    let costs = read(&root()).expect("the data file");
    for guide in GUIDES {
        let text = fs::read_to_string(root().join(guide)).expect("a guide");
        assert!(text.contains(START) && text.contains(END), "{guide}");
    }
    let guide = fs::read_to_string(root().join("docs/CHOOSING.md")).expect("the guide");
    let parts = guide.split(START).skip(1);
    let tables = Vec::from_iter(parts.filter_map(|part| part.split(END).next()));
    assert_eq!(tables.len(), 2);
    let all = BendingMethod::ALL.iter().chain(&BendingMethod::CURVATURES);
    for method in all {
        for table in &tables {
            assert!(table.contains(&format!("`{method}` |")), "no `{method}`");
        }
    }
    let of = |method: BendingMethod| {
        let mut methods = costs.methods.iter();
        methods
            .find(|cost| cost.method == method.name())
            .expect("its cost")
    };
    // What is said of them: E costs less than J4; forces in flow by D and J6 take about as long as boundary integrals,
    // those of G and J8 longer, and those of others less.
    assert!(of(BendingMethod::Farutin).relative < of(BendingMethod::J4).relative);
    for method in BendingMethod::ALL {
        let share = of(method).flow.expect("a force");
        match method {
            BendingMethod::Galerkin | BendingMethod::J8 => assert!(share > 1.5, "{share}"),
            BendingMethod::Belkin | BendingMethod::J6 => {
                assert!((0.5..2.0).contains(&share), "{share}");
            }
            _ => assert!(share < 1.0, "{method}: {share}"),
        }
    }
}

/// Cells are filled by the name in their row and the title of their column, inside the marks only, and once filled they
/// stay.
#[test]
fn tables_are_filled_by_names_and_titles() {
    let costs = Costs {
        commit: "c0ffee".to_owned(),
        date: "today".to_owned(),
        build: "rustc".to_owned(),
        machine: "an abacus".to_owned(),
        scatter: 0.0,
        methods: vec![MethodCost {
            method: "meyer".to_owned(),
            relative: 1.62,
            nanoseconds: 153.0,
            bytes: 208.0,
            flow: Some(0.0123),
        }],
        galerkin: vec![GalerkinCost {
            family: "regular".to_owned(),
            energy: 6.51,
            density: 14.4,
        }],
    };
    let guide = "| a | f |\n|---|---|\n| `regular` | old |\n\
        <!-- costs -->\n| of \\| | time, B = 1 | other |\n|---|---:|---|\n| A \\| `meyer` | ? | kept |\n| `j6` | kept | kept |\n\n\
        | family | f | energy and gradient |\n|---|---|---|\n| `regular` | | |\n\nMeasured long ago.\n<!-- end of costs -->\nMeasured here.\n";
    let expected = "| a | f |\n|---|---|\n| `regular` | old |\n\
        <!-- costs -->\n| of \\| | time, B = 1 | other |\n|---|---:|---|\n| A \\| `meyer` | 1.6 | kept |\n| `j6` | kept | kept |\n\n\
        | family | f | energy and gradient |\n|---|---|---|\n| `regular` | 14 | 6.5 |\n\n\
        Measured by `helfrich-studies costs`, one thread, f64: commit c0ffee, today, rustc, an abacus.\n<!-- end of costs -->\nMeasured here.\n";
    let once = filled(guide, &costs);
    assert_eq!(once, expected);
    assert_eq!(filled(&once, &costs), once);
}
