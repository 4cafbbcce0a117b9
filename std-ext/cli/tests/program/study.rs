//! `helfrich study`.

use crate::{fail, is_empty, succeed, text};
use helfrich::{Finding, Surface};
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::method::{BendingMethod, Evaluator};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use tempfile::TempDir;

/// The rows that `study --json -` prints with these arguments.
#[track_caller]
fn rows(arguments: &[&str]) -> Vec<Value> {
    let all = [&["study", "--json", "-"], arguments].concat();
    serde_json::from_str(&succeed(&all)).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

/// The names of all methods, in the order of `all`.
fn methods() -> impl Iterator<Item = BendingMethod> {
    let bending = BendingMethod::ALL.into_iter();
    bending.chain(BendingMethod::CURVATURES)
}

/// The quantities that the study compares.
fn defined(method: BendingMethod) -> Vec<&'static str> {
    let [mean, gaussian, laplacian] = method.description().defines;
    let quantities = [
        ("H", mean),
        ("K", gaussian),
        ("LapH", laplacian),
        ("f", method.has_force()),
    ];
    let defined = quantities.into_iter().filter(|&(_, defined)| defined);
    defined.map(|(symbol, _)| symbol).collect()
}

#[test]
fn json_has_every_combination_and_nothing_else() {
    for (shape, numbers, scalars, families) in [
        ("sphere", "92,162", &["f64"][..], &["irregular"][..]),
        ("ellipsoid", "92,162", &["f64"], &["smooth"]),
        // One shape stands for the others in single precision and in all families: columns do not know shapes.
        (
            "discocyte",
            "92,162",
            &["f32", "f64"],
            &["regular", "smooth", "relaxed", "irregular", "hard"],
        ),
        ("torus", "100,200", &["f64"], &["regular", "irregular"]),
    ] {
        let listed = scalars.join(",");
        let asked = match families.len() {
            5 => "all".to_owned(),
            _ => families.join(","),
        };
        let arguments = [
            "--shape",
            shape,
            "--vertices",
            numbers,
            "--family",
            &asked,
            "--method",
            "all",
            "--scalar",
            &listed,
        ];
        let rows = rows(&arguments);
        let mut rows = rows.iter();
        for &family in families {
            for &scalar in scalars {
                for method in methods() {
                    let mut coarse = Vec::new();
                    for quantity in defined(method) {
                        let row = rows.next().unwrap();
                        check_row(row, method, [shape, family, scalar, quantity]);
                        assert!(row["order_max"].is_null() && row["order_mean"].is_null());
                        coarse.push(row);
                    }
                    for (quantity, coarse) in defined(method).iter().zip(coarse) {
                        let row = rows.next().unwrap();
                        check_row(row, method, [shape, family, scalar, quantity]);
                        check_order(coarse, row);
                    }
                }
            }
        }
        assert_eq!(rows.next(), None);
    }
}

/// Whether there are vertices at which the neighbours do not determine what a method fits.
fn leaves_out_vertices(row: &Value, method: BendingMethod) -> bool {
    let [shape, family] = ["shape", "family"].map(|key| row[key].as_str().unwrap());
    let vertices = row["vertices"].as_u64().unwrap() as usize;
    let (shape, family): (AnyShape, Family) = (shape.parse().unwrap(), family.parse().unwrap());
    let made = generate(&shape, family, vertices, 1).unwrap();
    let surface = Surface::new(&made.mesh, &made.positions).unwrap();
    let mut evaluator = Evaluator::new(method, 1.0, &made.mesh);
    evaluator.evaluate(surface);
    let findings = evaluator.findings(surface);
    let too_few = |finding: &Finding| matches!(finding, Finding::TooFewNeighbours { .. });
    findings.iter().any(too_few)
}

fn check_row(row: &Value, method: BendingMethod, names: [&str; 4]) {
    let keys = [
        "shape",
        "family",
        "vertices",
        "method",
        "scalar",
        "quantity",
        "max",
        "mean",
        "order_max",
        "order_mean",
        "ns_per_vertex",
        "ns_scatter",
        "bytes_per_vertex",
    ];
    let found: BTreeSet<&str> = row
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    assert_eq!(found, BTreeSet::from(keys));
    let labels = ["shape", "family", "scalar", "quantity"];
    assert_eq!(labels.map(|key| row[key].as_str().unwrap()), names);
    assert_eq!(row["method"].as_str().unwrap(), method.name());
    assert!(number(row, "ns_per_vertex") > 0.0);
    assert!(row["vertices"].is_u64());
    // On so coarse a random mesh some one-ring may determine no fit, and no error is known.
    if names[1] == "irregular" && row["max"].is_null() {
        assert!(leaves_out_vertices(row, method), "{row}");
        return;
    }
    let [max, mean] = ["max", "mean"].map(|key| number(row, key));
    assert!(0.0 < mean && mean <= max && max.is_finite(), "{row}");
}

fn check_order(coarse: &Value, fine: &Value) {
    // Where some vertex has no result there is no order either.
    if coarse["max"].is_null() || fine["max"].is_null() {
        assert!(fine["order_max"].is_null() && fine["order_mean"].is_null());
        return;
    }
    let refinement = (number(fine, "vertices") / number(coarse, "vertices")).sqrt();
    for (error, order) in [("max", "order_max"), ("mean", "order_mean")] {
        let expected = (number(coarse, error) / number(fine, error)).ln() / refinement.ln();
        assert!((number(fine, order) - expected).abs() < 1e-9, "{fine}");
    }
}

#[test]
fn orders_on_regular_meshes_of_the_discocyte() {
    let rows = rows(&[
        "--method",
        "A,B,C",
        "--family",
        "regular",
        "--vertices",
        "2562,10242",
    ]);
    let order = |method: &str, quantity: &str, key: &str| {
        let row = rows.iter().find(|row| {
            let names = ["method", "quantity"].map(|key| row[key].as_str().unwrap());
            names == [method, quantity] && row["vertices"] == 10242
        });
        number(row.unwrap(), key)
    };
    // Valence-5 vertices stall H and K and make f diverge in the largest error; elsewhere H and K
    // are of second order.
    let largest = [
        ("kantor-nelson", "f", -2.0),
        ("gompper-kroll", "f", -2.0),
        ("meyer", "f", -2.0),
        ("meyer", "LapH", -2.0),
        ("gompper-kroll", "H", 0.0),
        ("meyer", "H", 0.0),
        ("meyer", "K", 0.0),
    ];
    for (method, quantity, expected) in largest {
        let found = order(method, quantity, "order_max");
        assert!(
            (found - expected).abs() <= 0.4,
            "{method} {quantity}: {found}"
        );
    }
    for (method, quantity) in [("gompper-kroll", "H"), ("meyer", "H"), ("meyer", "K")] {
        let found = order(method, quantity, "order_mean");
        assert!((found - 2.0).abs() <= 0.4, "{method} {quantity}: {found}");
    }
}

/// All but the times.
fn results(rows: &[Value]) -> Vec<Value> {
    let mut rows = rows.to_vec();
    for row in &mut rows {
        row["ns_per_vertex"] = Value::Null;
        row["ns_scatter"] = Value::Null;
    }
    rows
}

#[test]
fn what_is_listed_in_any_order_or_twice_counts_once_coarse_to_fine() {
    let plain = rows(&[
        "--method",
        "B,C",
        "--family",
        "regular",
        "--vertices",
        "42,162,642",
    ]);
    let muddled = rows(&[
        "--method",
        "b,meyer,Gompper-Kroll",
        "--family",
        "regular,regular",
        "--vertices",
        "642,42,162,642",
    ]);
    assert_eq!(results(&plain), results(&muddled));
    // 640 and 643 have the same nearest lattice.
    let near = rows(&[
        "--shape",
        "torus",
        "--method",
        "A",
        "--family",
        "regular",
        "--vertices",
        "640,643,2560",
    ]);
    assert_eq!(near.len(), 2);
    assert!(near[0]["order_max"].is_null() && near[1]["order_max"].is_f64());
}

#[test]
fn relative_errors_do_not_depend_on_modulus_or_size() {
    let base = ["--method", "A,B,C", "--vertices", "162", "--shape"];
    let one = rows(&[&base[..], &["discocyte"]].concat());
    let other = rows(&[&base[..], &["discocyte:3.91e-6", "--modulus", "2e-19"]].concat());
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().zip(&other) {
        for key in ["max", "mean"] {
            let [one, other] = [number(one, key), number(other, key)];
            assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
        }
    }
}

#[test]
fn forces_that_vanish_are_compared_with_the_size() {
    // A sphere under two names, and the Clifford torus.
    for (shape, vertices) in [
        ("sphere", "642"),
        ("ellipsoid:2,2,2", "642"),
        ("torus:1.4142135623730951,1", "2560"),
    ] {
        let arguments = [
            "--shape",
            shape,
            "--vertices",
            vertices,
            "--family",
            "regular",
        ];
        for row in rows(&[&arguments[..], &["--method", "meyer"]].concat()) {
            assert!(number(&row, "max") < 1.0, "{row}");
        }
    }
}

#[test]
fn a_result_that_is_no_number_shows() {
    // The areas of so small a sphere underflow in f32.
    let arguments = [
        "--shape",
        "sphere:1e-12",
        "--scalar",
        "f32",
        "--vertices",
        "42",
    ];
    let found = rows(
        &[
            &arguments[..],
            &["--method", "A,B,C", "--family", "regular"],
        ]
        .concat(),
    );
    assert_eq!(found.len(), 7);
    assert!(
        found
            .iter()
            .all(|row| row["max"].is_null() && row["mean"].is_null())
    );
    let table = succeed(&[&["study"], &arguments[..]].concat());
    assert!(table.contains("inf"), "{table}");
}

#[test]
fn the_table_names_every_method_and_mesh() {
    let table = succeed(&["study", "--vertices", "42,162"]);
    let (explained, _) = table.split_once("discocyte · regular").unwrap();
    for name in [
        "H  mean curvature",
        "K  Gaussian curvature",
        "ΔH Laplacian of H",
        "f  bending force per area",
        "N  number of vertices",
        "A  kantor-nelson  Kantor–Nelson: angles between triangles",
        "B  gompper-kroll ",
        "C  meyer ",
        "J6 j6 ",
    ] {
        assert!(explained.contains(name), "{name}: {table}");
    }
    for name in ["regular", "irregular", "order"] {
        assert!(table.contains(name), "{name}: {table}");
    }
    // What to take is said last.
    let last = Vec::from_iter(table.lines().rev().take(3));
    assert!(last[0].contains("helfrich recommend"), "{table}");
    assert!(
        last[1].starts_with("No method that was studied") || last[1].starts_with("~ No"),
        "{table}"
    );
    assert!(!table.contains('\r') && !table.contains('\x1b'));
}

#[test]
fn json_in_a_file_stands_beside_the_table() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("rows.json");
    fs::write(&path, "old").unwrap();
    let arguments = [
        "study",
        "--vertices",
        "42",
        "--method",
        "A",
        "--json",
        text(&path),
    ];
    assert!(succeed(&arguments).contains("kantor-nelson"));
    let rows: Vec<Value> = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// The numbers of the JSON, in columns of the same names.
#[test]
fn csv_has_what_json_has() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("rows.csv");
    let arguments = [
        "--vertices",
        "42,100",
        "--method",
        "C,E",
        "--areas",
        "voronoi",
    ];
    let rows = rows(&[&arguments[..], &["--csv", text(&path)]].concat());
    let csv = fs::read_to_string(&path).unwrap();
    let mut lines = csv.lines();
    let names = Vec::from_iter(lines.next().unwrap().split(','));
    let lines = Vec::from_iter(lines);
    assert_eq!(lines.len(), rows.len());
    for (line, row) in lines.into_iter().zip(&rows) {
        let cells = Vec::from_iter(line.split(','));
        assert_eq!(cells.len(), names.len(), "{line}");
        for (name, cell) in names.iter().zip(cells) {
            match &row[*name] {
                Value::Null if *name == "options" => {
                    let options = row.get("areas").map_or("", |_| "voronoi areas");
                    assert_eq!(cell, options);
                }
                Value::Null => assert_eq!(cell, "", "{name}"),
                Value::String(text) => assert_eq!(cell, text),
                number => {
                    let expected = number.as_f64().unwrap();
                    // The reader of JSON rounds to one of the two nearest.
                    let rounding = f64::EPSILON * expected.abs();
                    assert!(
                        (cell.parse::<f64>().unwrap() - expected).abs() <= rounding,
                        "{name}"
                    );
                }
            }
        }
    }
    let both = ["study", "--vertices", "42", "--json", "-", "--csv", "-"];
    assert!(fail(2, &both).contains("standard output"));
    let table = succeed(&["study", "--vertices", "42", "--csv", "-"]);
    assert!(table.starts_with("shape,family,vertices,method,options,scalar,quantity,"));
}

#[test]
fn wrong_study_arguments() {
    for (arguments, hint) in [
        (&["--method", "nope"][..], "kantor-nelson (A)"),
        (&["--method", ""], "kantor-nelson (A)"),
        (&["--method", "A,,B"], "kantor-nelson (A)"),
        (
            &["--family", "nope"],
            "regular, smooth, relaxed, irregular or hard",
        ),
        (
            &["--shape", "nope"],
            "sphere, ellipsoid, torus or discocyte",
        ),
        (
            &["--areas", "circumcentric"],
            "mixed, voronoi or barycentric",
        ),
        (
            &["--method", "S", "--areas", "voronoi"],
            "gompper-kroll (B) and meyer (C) have",
        ),
        (&["--method", "B", "--bandwidth", "0.5"], "belkin (D) has"),
        (&["--method", "D", "--bandwidth", "0"], "published"),
        (&["--shape", "torus:1,2"], "tube radius"),
        (&["--shape", "torus:1"], "torus:2,1"),
        (&["--shape", "sphere:nan"], "radius"),
        (&["--shape", "sphere:1e-120"], "out of range"),
        (&["--scalar", "f16"], "f32, f32-pair and f64"),
        (&["--vertices", ""], "empty"),
        (&["--vertices", "0"], "between 12 and"),
        (&["--vertices", "-642"], "-6"),
        (&["--vertices", "11"], "between 12 and"),
        (
            &["--vertices", "642,11", "--family", "hard"],
            "between 12 and",
        ),
        (&["--vertices", "642,,2562"], "empty"),
        (&["--vertices", "642.0"], "642.0"),
        (&["--vertices", "1000000000000"], "between 12 and"),
        (
            &["--vertices", "1000000000000", "--family", "irregular"],
            "between 12 and",
        ),
        (
            &["--vertices", "1000000000000", "--shape", "torus"],
            "between 16 and",
        ),
        (
            &["--vertices", "18446744073709551615,18446744073709551614"],
            "between 12 and",
        ),
        (&["--vertices", "1e12"], "1e12"),
        (&["--vertices", "99999999999999999999999"], "too large"),
        (&["--modulus", "0"], "above 0"),
        (&["--modulus", "-1"], "above 0"),
        (&["--modulus", "inf"], "above 0"),
        // The square of the modulus has to be in range.
        (&["--modulus", "1e100", "--scalar", "f64,f32"], "in f32"),
        (&["--modulus", "1e300", "--scalar", "f64,f32"], "in f64"),
        (&["--seed", "x"], "seed"),
        (&["--nope"], "--nope"),
    ] {
        let message = fail(2, &[&["study"], arguments].concat());
        assert!(message.contains(hint), "{arguments:?}: {message}");
    }
}

#[test]
fn a_study_refuses_before_it_computes() {
    // Families and numbers that can be made come first.
    let late = ["--vertices", "163842,400000000"];
    assert!(fail(2, &[&["study"], &late[..]].concat()).contains("400000000"));
    let folder = TempDir::new().unwrap();
    for path in [
        folder.path().join("none/rows.json"),
        folder.path().to_owned(),
    ] {
        let message = fail(3, &["study", "--vertices", "163842", "--json", text(&path)]);
        assert!(message.contains(text(&path)), "{message}");
    }
    assert!(is_empty(&folder));
}

/// A second study with the same cache would undo measurements of the first, and is refused.
#[test]
fn a_cache_is_of_one_study_at_a_time() {
    let folder = TempDir::new().unwrap();
    let cache = folder.path().join("cache");
    let arguments = ["study", "--vertices", "12", "--cache", text(&cache)];
    let lock = helfrich_std::lock::Lock::of_file(&cache).unwrap();
    let message = fail(2, &arguments);
    let holder = format!("process {}", std::process::id());
    assert!(message.contains(&holder), "{message}");
    drop(lock);
    succeed(&arguments);
    let left = fs::read_dir(folder.path()).unwrap();
    assert_eq!(left.count(), 1);
}

/// Figures of two studies in one folder would be of neither.
#[test]
fn a_folder_of_figures_is_of_one_study_at_a_time() {
    let folder = TempDir::new().unwrap();
    let [figures, page] = ["figures", "page.html"].map(|name| folder.path().join(name));
    let cache = folder.path().join("cache");
    let arguments = [
        "study",
        "--vertices",
        "12",
        "--method",
        "B",
        "--cache",
        text(&cache),
        "--html",
        text(&page),
        "--figures",
        text(&figures),
    ];
    fs::create_dir(&figures).unwrap();
    let lock = helfrich_std::lock::Lock::of_folder(&figures).unwrap();
    let message = fail(2, &arguments);
    let holder = format!("process {}", std::process::id());
    for part in [text(&figures), &holder] {
        assert!(message.contains(part), "{message}");
    }
    assert!(!page.exists());
    drop(lock);
    succeed(&arguments);
    assert!(page.exists() && !figures.join("lock").exists());
}

/// Options reach the methods that have them, and are said in the rows.
#[test]
fn options_of_methods_are_those_of_the_rows() {
    let study = |options: &[&str]| {
        let meshes = [
            "--vertices",
            "400",
            "--family",
            "irregular",
            "--method",
            "B,A",
        ];
        rows(&[&meshes[..], options].concat())
    };
    let of = |rows: &[Value], method: &str| -> Vec<Value> {
        let own = rows.iter().filter(|row| row["method"] == method);
        own.cloned().collect()
    };
    let error = |rows: &[Value]| Vec::from_iter(rows.iter().map(|row| row["max"].clone()));
    let (default, voronoi) = (study(&[]), study(&["--areas", "voronoi"]));
    let mixed = study(&["--areas", "mixed"]);
    let [of_default, of_voronoi, of_mixed] =
        [&default, &voronoi, &mixed].map(|rows| of(rows, "gompper-kroll"));
    assert_eq!(error(&of_default), error(&of_mixed));
    assert_ne!(error(&of_default), error(&of_voronoi));
    assert!(of_voronoi.iter().all(|row| row["areas"] == "voronoi"));
    assert!(of_default.iter().all(|row| row.get("areas").is_none()));
    assert!(
        of(&voronoi, "kantor-nelson")
            .iter()
            .all(|row| row.get("areas").is_none())
    );
}
