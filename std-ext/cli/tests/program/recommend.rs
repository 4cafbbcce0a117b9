//! `helfrich recommend`.

use crate::fixture::{Fixture, disturbed, obj, sheet};
use crate::{fail, run, succeed, text};
use helfrich::Surface;
use helfrich::shapes::Shape;
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_std::method::{BendingMethod, Evaluator, MethodOptions};
use helfrich_std::scalar::Scalar;
use helfrich_std::study::{Session, Study};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

fn mesh(shape: &str, family: Family, vertices: usize) -> Fixture {
    let made = generate(&shape.parse().unwrap(), family, vertices, 1).unwrap();
    Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()))
}

#[track_caller]
fn answer(file: &Fixture, arguments: &[&str]) -> Value {
    let all = [&["recommend", file.path(), "--json", "-"], arguments].concat();
    let found = run(&all);
    assert_eq!(found.code, Some(0), "{}", found.stderr);
    serde_json::from_str(&found.stdout).unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(f64::INFINITY)
}

/// The errors on a discocyte, whose exact values are known, as `study` prints them.
fn exact_errors(family: Family, vertices: usize, scalars: &[Scalar]) -> Vec<Value> {
    let methods = BendingMethod::ALL.into_iter();
    let methods = methods.chain(BendingMethod::CURVATURES).map(Into::into);
    let study = Study {
        shape: "discocyte".parse().unwrap(),
        families: vec![family],
        vertices: vec![vertices],
        methods: methods.collect(),
        options: MethodOptions::default(),
        scalars: scalars.to_vec(),
        modulus: 1.0,
        seed: 1,
    };
    let rows = study.run_in(&mut Session {
        progress: &mut |_| (),
        interrupted: &|| false,
        cache: None,
        allocated: None,
        timed: false,
    });
    let rows = rows.unwrap().into_iter();
    rows.map(|row| serde_json::to_value(row).unwrap()).collect()
}

/// Errors that are promised without the exact shape are kept on it.
#[test]
fn what_is_expected_holds() {
    // The two that take longer than all others together: what is expected of f at the worst vertex follows the same
    // rule for all methods but jets, and is asked of the others.
    let is_quick = |name: &&str| !["belkin", "galerkin"].contains(name);
    let quick = BendingMethod::ALL.into_iter();
    let quick = quick.chain(BendingMethod::CURVATURES);
    let names = Vec::from_iter(quick.map(BendingMethod::name).filter(is_quick)).join(",");
    let quick = names.as_str();
    for (family, vertices, scalars) in [
        (Family::Regular, 2562, &[Scalar::F32, Scalar::F64][..]),
        (Family::Irregular, 2562, &[Scalar::F64]),
    ] {
        let file = mesh("discocyte", family, vertices);
        let name = family.name();
        let exact = exact_errors(family, vertices, scalars);
        let scalars = Vec::from_iter(scalars.iter().map(|scalar| scalar.name())).join(",");
        let of_regular = if family == Family::Regular {
            "all"
        } else {
            quick
        };
        for (quantity, norm, target, methods) in [
            ("H", "max", "5%", of_regular),
            ("f", "mean", "0.05", "all"),
            ("f", "max", "20%", quick),
        ] {
            let asked = ["--quantity", quantity, "--norm", norm, "--error", target];
            let asked = [&asked[..], &["--method", methods]].concat();
            let found = answer(&file, &[&asked[..], &["--scalar", &scalars]].concat());
            // `jet`, which is none of the study, has tests of its own.
            let mut candidates = found["candidates"].as_array().unwrap().clone();
            candidates.retain(|candidate| candidate["method"] != "jet");
            let truth = |method: &Value, scalar: &Value| {
                let same = |row: &&Value| {
                    row["quantity"] == quantity
                        && row["method"] == *method
                        && row["scalar"] == *scalar
                };
                number(exact.iter().find(same).unwrap(), norm)
            };
            let of_j6 = truth(&"j6".into(), &"f64".into());
            let is_asked = |row: &&Value| {
                let method = row["method"].as_str().unwrap();
                row["quantity"] == quantity && (methods == "all" || is_quick(&method))
            };
            assert_eq!(candidates.len(), exact.iter().filter(is_asked).count());
            for candidate in &candidates {
                let expected = number(candidate, "expected");
                let truth = truth(&candidate["method"], &candidate["scalar"]);
                // The reference, jets of degree 8, is not exact either, and on a mesh as coarse as this hardly
                // better than degree 6. The true error is at most the expected one, which is not many times
                // larger than it, or than that of degree 6 for methods that are more accurate.
                assert!(
                    truth <= 1.3 * expected,
                    "{name} {quantity} {norm}: {truth} {candidate}"
                );
                assert!(
                    expected <= 8.0 * truth.max(of_j6),
                    "{name} {quantity} {norm}: {truth} {candidate}"
                );
            }
            let choice = &found["choice"];
            assert!(!choice.is_null(), "{name} {quantity} {norm}: {found}");
            let reaching = candidates
                .iter()
                .filter(|candidate| candidate["reaches"] == true);
            let target = number(&found, "target");
            for candidate in reaching {
                assert!(number(candidate, "expected") <= target);
                assert!(number(choice, "seconds") <= number(candidate, "seconds"));
            }
        }
    }
}

#[test]
fn what_cannot_be_reached_is_said() {
    let file = mesh("discocyte", Family::Regular, 2562);
    let asked = [
        "--quantity",
        "f",
        "--error",
        "0.001%",
        "--method",
        "B,j4,j6",
    ];
    let found = answer(&file, &asked);
    assert!(found["choice"].is_null(), "{found}");
    assert_eq!(found["candidates"].as_array().unwrap().len(), 6);
    let nearest = number(&found["nearest"], "expected");
    let all = found["candidates"].as_array().unwrap().iter();
    assert!(
        all.clone()
            .all(|candidate| nearest <= number(candidate, "expected"))
    );
    // h³, by theory.
    let needed = 2562.0 * (number(&found, "reference_error") / 1e-5).powf(2.0 / 3.0);
    assert_eq!(number(&found, "vertices_needed"), needed.ceil());
    let said = run(&[&["recommend", file.path()], &asked[..]].concat());
    assert_eq!(said.code, Some(0));
    assert!(
        said.stdout
            .starts_with("Nothing is known to reach 0.0010 %"),
        "{}",
        said.stdout
    );
    for part in [
        "j6 in f64 needs about",
        "f: bending force per area",
        "polynomials fitted to many neighbours",
    ] {
        assert!(said.stdout.contains(part), "{}", said.stdout);
    }
}

/// On meshes that are too coarse, degrees 4, 6 and 8 may agree on average, and be far off, or be the same fits.
#[test]
fn what_is_not_resolved_is_not_recommended() {
    for (shape, vertices) in [
        ("ellipsoid:1,1,0.5", 42),
        ("ellipsoid:1,1,0.5", 162),
        ("ellipsoid:1,0.8,0.6", 162),
    ] {
        let file = mesh(shape, Family::Irregular, vertices);
        let asked = ["--quantity", "f", "--norm", "mean", "--error", "20%"];
        let found = answer(&file, &asked);
        assert_eq!(found["is_resolved"], false, "{found}");
        assert!(found["choice"].is_null(), "{found}");
        let mut candidates = found["candidates"].as_array().unwrap().iter();
        assert!(candidates.all(|candidate| candidate["reaches"] == false));
        assert!(number(&found, "vertices_needed") > 1.2 * vertices as f64);
        let said = succeed(&[&["recommend", file.path()], &asked[..]].concat());
        assert!(
            said.starts_with("This mesh is too coarse or too rough to say"),
            "{said}"
        );
    }
}

#[test]
fn forces_that_vanish_are_compared_with_the_curvature() {
    let file = mesh("sphere", Family::Regular, 642);
    let found = answer(
        &file,
        &["--error", "5%", "--quantity", "f", "--method", "j4,j6"],
    );
    assert!(!found["choice"].is_null(), "{found}");
}

#[test]
fn a_boundary_is_left_out() {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..20u32 {
        for column in 0..20u32 {
            let [x, y] = [column, row].map(|place| f64::from(place) / 10.0);
            positions.push([x, y, 0.1 * x * x + 0.2 * x * y]);
            if row < 19 && column < 19 {
                let corner = 20 * row + column;
                triangles.push([corner, corner + 1, corner + 21]);
                triangles.push([corner, corner + 21, corner + 20]);
            }
        }
    }
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let found = answer(&file, &["--quantity", "H", "--error", "1%"]);
    assert_eq!(number(&found, "compared"), 18.0 * 18.0);
    // The sheet is a polynomial.
    assert!(number(&found, "reference_error") < 1e-3, "{found}");
    assert!(!found["choice"].is_null());
    let said = succeed(&["recommend", file.path(), "--quantity", "H"]);
    assert!(said.contains("Compared at 324 of 400 vertices"), "{said}");
}

#[test]
fn wrong_wishes() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for (arguments, hint) in [
        (&["--error", "0"][..], "above 0"),
        (&["--error", "-1%"], "above 0"),
        (&["--error", "nan"], "above 0"),
        (&["--error", "1e-400%"], "above 0"),
        (&["--error", "%"], "above 0"),
        (&["--error", ""], "above 0"),
        (&["--quantity", "x"], "H, K, LapH and f"),
        (&["--norm", "rms"], "max and mean"),
        (&["--method", "nope"], "kantor-nelson (A)"),
        (&["--scalar", "f16"], "f32, f32-pair and f64"),
        (&["--json", file.path()], "would replace the mesh"),
    ] {
        let message = fail(2, &[&["recommend", file.path()], arguments].concat());
        assert!(message.contains(hint), "{arguments:?}: {message}");
    }
    fail(2, &["recommend", "missing.obj"]);
    fail(
        3,
        &["recommend", file.path(), "--json", "/nowhere/at/all.json"],
    );
    // One triangle has no vertex inside.
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let one = Fixture::new("one.obj", obj(&corners, &[[0, 1, 2]]));
    assert!(fail(2, &["recommend", one.path()]).contains("no vertex"));
}

/// The exact H or f·n over the vertices, and the mean error of a method on other positions, relative to
/// the largest of them.
fn true_mean_error(
    made: &GeneratedMesh,
    positions: &[[f64; 3]],
    method: BendingMethod,
    quantity: &str,
) -> f64 {
    let surface = Surface::new(&made.mesh, positions).unwrap();
    let fields = Evaluator::new(method, 1.0, &made.mesh).fields(surface);
    let (mut errors, mut areas, mut largest) = (0.0, 0.0, 0.0_f64);
    for (vertex, &preimage) in made.preimages.iter().enumerate() {
        let exact = made.shape.at(preimage);
        let (error, size) = match quantity {
            "H" => (fields.mean[vertex].unwrap() - exact.mean, exact.mean),
            _ => {
                let density = exact.force_density(1.0);
                let found = fields.force_density[vertex].unwrap();
                let squares =
                    (0..3).map(|axis| (found[axis] - density * exact.normal[axis]).powi(2));
                (squares.sum::<f64>().sqrt(), density)
            }
        };
        errors += fields.area[vertex] * error.abs();
        areas += fields.area[vertex];
        largest = largest.max(size.abs());
    }
    errors / areas / largest
}

/// Differences between methods do not show errors that all share: errors of jets by noise are within a factor of
/// 1.5 of the true ones, those of others no larger than is said.
#[test]
fn noise_counts() {
    for (shape, vertices, edges, methods, quantities) in [
        ("discocyte", 2562, 1e-4, "j4,j6,B,farutin", &["H", "f"][..]),
        ("discocyte", 2562, 1e-3, "j4,j6,meyer,loop", &["f"]),
        ("ellipsoid:1,0.8,0.5", 1280, 1e-2, "j4,j6,juelicher", &["H"]),
    ] {
        let made = generate(&shape.parse().unwrap(), Family::Irregular, vertices, 1).unwrap();
        let area = Surface::new(&made.mesh, &made.positions).unwrap().area();
        // Of equilateral triangles of the same mean area; the mean edge is some per cent longer.
        let edge = (4.0 / 3_f64.sqrt() * area / made.mesh.triangles().len() as f64).sqrt();
        let positions = disturbed(&made.positions, edges * edge);
        let file = Fixture::new("cell.obj", obj(&positions, made.mesh.triangles()));
        for &quantity in quantities {
            let asked = ["--quantity", quantity, "--norm", "mean", "--scalar", "f64"];
            let found = answer(&file, &[&asked[..], &["--method", methods]].concat());
            let noise = &found["noise"];
            let seen = [number(noise, "length") / edge, number(noise, "edges")];
            for seen in seen {
                assert!(
                    (0.75..1.25).contains(&(seen / edges)),
                    "{shape} {edges}: {noise}"
                );
            }
            for candidate in found["candidates"].as_array().unwrap() {
                let method: BendingMethod = candidate["method"].as_str().unwrap().parse().unwrap();
                let truth = true_mean_error(&made, &positions, method, quantity);
                let ratio = number(candidate, "expected") / truth;
                let is_jet = matches!(
                    method,
                    BendingMethod::J4 | BendingMethod::J6 | BendingMethod::J8
                );
                assert_eq!(candidate["is_bound"], !is_jet);
                let allowed = if is_jet {
                    1.0 / 1.5..1.5
                } else {
                    1.0..f64::INFINITY
                };
                assert!(
                    allowed.contains(&ratio),
                    "{shape} {edges} {quantity}: {ratio}, {truth} {candidate}"
                );
            }
        }
    }
}

/// Where noise rules, finer meshes are no remedy.
#[test]
fn coarser_meshes_are_advised_where_noise_rules() {
    let made = generate(&"sphere".parse().unwrap(), Family::Irregular, 2562, 1).unwrap();
    let positions = disturbed(&made.positions, 1e-3 * 0.076);
    let file = Fixture::new("cell.obj", obj(&positions, made.mesh.triangles()));
    let asked = ["--method", "j6", "--scalar", "f64", "--norm", "mean"];
    let of_mean = |error| [&asked[..], &["--quantity", "H", "--error", error]].concat();
    // What is printed, and the same as JSON.
    let told = |error| {
        let folder = TempDir::new().unwrap();
        let json = folder.path().join("answer.json");
        let into_file = ["--json", text(&json)];
        let said =
            succeed(&[&["recommend", file.path()], &of_mean(error)[..], &into_file].concat());
        let found: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
        (said, found)
    };
    let (said, found) = told("2%");
    assert!(found["choice"].is_null(), "{found}");
    let [noise, all] = ["noise_error", "reference_error"].map(|key| number(&found, key));
    assert!(noise > 0.9 * all && noise > 0.02, "{found}");
    // H of the noise goes as 1/h², as the number of vertices does; eighths of a doubling are tried.
    let needed = number(&found, "vertices_needed");
    let expected = 2562.0 * 0.02 / noise;
    let step = 2.0_f64.powf(-0.125);
    assert!(
        (step * expected..=expected.ceil()).contains(&needed),
        "{found}"
    );
    assert!(said.contains("needs a coarser mesh"), "{said}");
    assert!(said.contains("Noise of positions 7."), "{said}");
    // So coarse a mesh would not resolve the shape.
    let (said, _) = told("0.01%");
    assert!(
        said.contains("no number of vertices with the same noise"),
        "{said}"
    );
    // Exact positions have none, and their answer says so.
    let exact = Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()));
    let found = answer(
        &exact,
        &["--method", "j6", "--scalar", "f64", "--quantity", "H"],
    );
    assert_eq!(
        found["noise"],
        serde_json::json!({"length": 0.0, "edges": 0.0})
    );
    assert_eq!(number(&found, "noise_error"), 0.0);
}
