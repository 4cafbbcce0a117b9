//! The program as its users meet it: arguments and files in, output, messages and exit codes out.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use helfrich::shapes::Shape;
use helfrich::{GompperKroll, KantorNelson, Prepared, Real, Surface};
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_std::io::read;
use helfrich_std::method::{BendingMethod, Evaluator, Fields};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::{Debug, Write as _};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::str::FromStr;
use tempfile::TempDir;

/// What a run left.
#[derive(Debug)]
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_helfrich"));
    command.args(arguments).stdin(Stdio::null());
    command
}

fn run(arguments: &[&str]) -> Run {
    let output = command(arguments).output().unwrap();
    Run {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// The standard output of a run that ends well and says nothing beside it.
#[track_caller]
fn succeed(arguments: &[&str]) -> String {
    let run = run(arguments);
    assert_eq!(run.code, Some(0), "{arguments:?}: {}", run.stderr);
    assert_eq!(run.stderr, "", "{arguments:?}");
    run.stdout
}

/// The message of a run that ends with this code, and prints nothing.
#[track_caller]
fn fail(code: i32, arguments: &[&str]) -> String {
    let run = run(arguments);
    assert_eq!(run.code, Some(code), "{arguments:?}: {}", run.stderr);
    assert_eq!(run.stdout, "", "{arguments:?}");
    assert!(run.stderr.starts_with("error: "), "{}", run.stderr);
    assert_eq!(run.stderr.matches("error:").count(), 1, "{}", run.stderr);
    run.stderr
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn is_empty(folder: &TempDir) -> bool {
    fs::read_dir(folder.path()).unwrap().next().is_none()
}

// ── study ────────────────────────────────────────────────────────────────────────────────────────

/// The rows that `study --json -` prints with these arguments.
#[track_caller]
fn rows(arguments: &[&str]) -> Vec<Value> {
    let all = [&["study", "--json", "-"], arguments].concat();
    serde_json::from_str(&succeed(&all)).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

const METHODS: [&str; 9] = [
    "kantor-nelson",
    "gompper-kroll",
    "meyer",
    "belkin",
    "farutin",
    "loop",
    "juelicher",
    "j4",
    "j6",
];

/// The quantities that the study compares.
fn defined(method: &str) -> &'static [&'static str] {
    match method {
        "kantor-nelson" => &["f"],
        "gompper-kroll" | "juelicher" => &["H", "f"],
        "loop" => &["H", "K", "f"],
        _ => &["H", "K", "LapH", "f"],
    }
}

#[test]
fn json_has_every_combination_and_nothing_else() {
    for (shape, numbers) in [
        ("sphere", "162,642"),
        ("ellipsoid", "162,642"),
        ("discocyte", "162,642"),
        ("torus", "200,800"),
    ] {
        let both = "f32,f64";
        let arguments = [
            "--shape",
            shape,
            "--vertices",
            numbers,
            "--family",
            "all",
            "--method",
            "all",
            "--scalar",
            both,
        ];
        let rows = rows(&arguments);
        let mut rows = rows.iter();
        for family in ["regular", "smooth", "relaxed", "irregular", "hard"] {
            for scalar in ["f32", "f64"] {
                for method in METHODS {
                    let mut coarse = Vec::new();
                    for quantity in defined(method) {
                        let row = rows.next().unwrap();
                        check_row(row, [shape, family, scalar, method, quantity]);
                        assert!(row["order_max"].is_null() && row["order_mean"].is_null());
                        coarse.push(row);
                    }
                    for (quantity, coarse) in defined(method).iter().zip(coarse) {
                        let row = rows.next().unwrap();
                        check_row(row, [shape, family, scalar, method, quantity]);
                        check_order(coarse, row);
                    }
                }
            }
        }
        assert_eq!(rows.next(), None);
    }
}

fn check_row(row: &Value, names: [&str; 5]) {
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
    ];
    let found: BTreeSet<&str> = row
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    assert_eq!(found, BTreeSet::from(keys));
    let labels = ["shape", "family", "scalar", "method", "quantity"];
    assert_eq!(labels.map(|key| row[key].as_str().unwrap()), names);
    let [max, mean] = ["max", "mean"].map(|key| number(row, key));
    assert!(0.0 < mean && mean <= max && max.is_finite(), "{row}");
    assert!(number(row, "ns_per_vertex") > 0.0);
    assert!(row["vertices"].is_u64());
}

fn check_order(coarse: &Value, fine: &Value) {
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
    let table = succeed(&["study", "--method", "A,B,C", "--vertices", "42,162"]);
    for name in [
        "kantor-nelson",
        "gompper-kroll",
        "meyer",
        "regular",
        "irregular",
        "order",
    ] {
        assert!(table.contains(name), "{name}: {table}");
    }
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
        (&["--shape", "torus:1,2"], "tube radius"),
        (&["--shape", "torus:1"], "torus:2,1"),
        (&["--shape", "sphere:nan"], "radius"),
        (&["--shape", "sphere:1e-120"], "out of range"),
        (&["--scalar", "f16"], "f32, f32-pair and f64"),
        (&["--vertices", ""], "empty"),
        (&["--vertices", "0"], "between 12 and"),
        (&["--vertices", "-642"], "-6"),
        (&["--vertices", "643"], "642 and 2562"),
        (
            &["--vertices", "642,643", "--family", "hard"],
            "642 and 2562",
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
        (&["--modulus", "1e300", "--scalar", "f64,f32"], "f32"),
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
    let late = [
        "--family",
        "irregular,regular",
        "--vertices",
        "163842,200000",
    ];
    assert!(fail(2, &[&["study"], &late[..]].concat()).contains("200000"));
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

// ── curvature ────────────────────────────────────────────────────────────────────────────────────

const HEADER: &str = "vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz";

fn irregular_discocyte() -> GeneratedMesh {
    let shape: AnyShape = "discocyte".parse().unwrap();
    generate(&shape, Family::Irregular, 300, 7).unwrap()
}

fn obj(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = String::new();
    for [x, y, z] in positions {
        writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn off(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = format!("OFF\n{} {} 0\n", positions.len(), triangles.len());
    for [x, y, z] in positions {
        writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

fn ply(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    );
    let body = off(positions, triangles);
    header + body.splitn(3, '\n').nth(2).unwrap()
}

fn stl(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = "solid\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for &vertex in triangle {
            let [x, y, z] = positions[vertex as usize];
            writeln!(text, "vertex {x:?} {y:?} {z:?}").unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid\n"
}

/// A folder with a file in it.
struct Fixture {
    folder: TempDir,
    path: PathBuf,
}

impl Fixture {
    fn new(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        Self { folder, path }
    }

    fn path(&self) -> &str {
        text(&self.path)
    }

    fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The names in the folder.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let mut names = Vec::from_iter(entries.map(|e| name(e).into_string().unwrap()));
        names.sort();
        names
    }
}

/// A table of numbers, with what is empty as `None`.
fn table<T: FromStr<Err: Debug>>(csv: &str) -> Vec<[Option<T>; 13]> {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some(HEADER));
    assert!(csv.ends_with('\n') && !csv.contains('\r'));
    let line = |(vertex, line): (usize, &str)| {
        let mut fields = line.split(',');
        assert_eq!(fields.next(), Some(vertex.to_string().as_str()));
        let value = |field: &str| (!field.is_empty()).then(|| field.parse().unwrap());
        Vec::from_iter(fields.map(value)).try_into().ok().unwrap()
    };
    lines.enumerate().map(line).collect()
}

fn vector<T: Copy>(line: &[Option<T>; 13], at: usize) -> Option<[T; 3]> {
    Some([line[at]?, line[at + 1]?, line[at + 2]?])
}

#[track_caller]
fn check_table<T: Real>(lines: &[[Option<T>; 13]], positions: &[[T; 3]], fields: &Fields<T>) {
    assert_eq!(lines.len(), positions.len());
    for (vertex, line) in lines.iter().enumerate() {
        assert_eq!(vector(line, 0), Some(positions[vertex]));
        assert_eq!(line[3], Some(fields.area[vertex]));
        assert_eq!(vector(line, 4), Some(fields.normal[vertex]));
        assert_eq!(line[7], fields.mean[vertex]);
        assert_eq!(line[8], fields.gaussian[vertex]);
        assert_eq!(line[9], fields.laplacian_of_mean[vertex]);
        assert_eq!(vector(line, 10), fields.force_density[vertex]);
    }
}

#[test]
fn every_format_gives_what_the_library_computes() {
    let GeneratedMesh {
        mesh, positions, ..
    } = irregular_discocyte();
    let triangles = mesh.triangles();
    let files = [
        Fixture::new("mesh.obj", obj(&positions, triangles)),
        Fixture::new("mesh.off", off(&positions, triangles)),
        Fixture::new("mesh.ply", ply(&positions, triangles)),
        Fixture::new("mesh.STL", stl(&positions, triangles)),
    ];
    for file in &files {
        let mesh_file = read(&file.path).unwrap();
        if !file.path().ends_with("STL") {
            assert_eq!(mesh_file.positions, positions);
        }
        let (mesh, exact) = (&mesh_file.mesh, &mesh_file.positions);
        let single = Vec::from_iter(exact.iter().map(|point| point.map(|x| x as f32)));
        for method in BendingMethod::ALL {
            let arguments = ["curvature", file.path(), "--method", method.name()];
            let surface = Surface::new(mesh, exact).unwrap();
            let fields = Evaluator::new(method, 1.0, mesh).fields(surface);
            // Warnings of negative areas may stand beside the table.
            check_table(&table(&run(&arguments).stdout), exact, &fields);

            let surface = Surface::new(mesh, &single).unwrap();
            let fields = Evaluator::new(method, 1.0, mesh).fields(surface);
            let csv = run(&[&arguments[..], &["--scalar", "f32"]].concat()).stdout;
            check_table(&table(&csv), &single, &fields);
        }
    }
}

#[test]
fn what_a_method_does_not_define_is_empty() {
    let GeneratedMesh {
        mesh, positions, ..
    } = irregular_discocyte();
    let file = Fixture::new("mesh.obj", obj(&positions, mesh.triangles()));
    for (method, defined) in [
        ("A", [false, false, false]),
        ("B", [true, false, false]),
        ("C", [true, true, true]),
        ("D", [true, true, true]),
        ("E", [true, true, true]),
        ("S", [true, true, false]),
        ("juelicher", [true, false, false]),
        ("j4", [true, true, true]),
        ("j6", [true, true, true]),
        ("J", [true, true, true]),
    ] {
        let csv = run(&["curvature", file.path(), "--method", method]).stdout;
        for line in table::<f64>(&csv) {
            assert_eq!([7, 8, 9].map(|column| line[column].is_some()), defined);
            assert!(vector(&line, 4).is_some() && vector(&line, 10).is_some());
        }
    }
    // The default is the method that defines all.
    let [plain, meyer] = [&[][..], &["--method", "meyer"]]
        .map(|method| run(&[&["curvature", file.path()], method].concat()).stdout);
    assert_eq!(plain, meyer);
}

#[test]
fn the_force_density_is_the_nodal_force_over_the_mixed_area() {
    let GeneratedMesh {
        mesh, positions, ..
    } = irregular_discocyte();
    let file = Fixture::new("mesh.obj", obj(&positions, mesh.triangles()));
    let surface = Surface::new(&mesh, &positions).unwrap();
    for method in ["A", "B"] {
        let mut force = vec![[0.0; 3]; positions.len()];
        match method {
            "A" => Prepared::new(KantorNelson::new(2.5), &mesh).add_force(surface, &mut force),
            _ => Prepared::new(GompperKroll::new(2.5), &mesh).add_force(surface, &mut force),
        }
        let csv = run(&[
            "curvature",
            file.path(),
            "--method",
            method,
            "--modulus",
            "2.5",
        ])
        .stdout;
        let lines = table::<f64>(&csv);
        let total: f64 = lines.iter().filter_map(|line| line[3]).sum();
        assert!((total / surface.area() - 1.0).abs() < 1e-13);
        let largest = force.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        for (line, force) in lines.iter().zip(force) {
            let (area, density) = (line[3].unwrap(), vector(line, 10).unwrap());
            for axis in 0..3 {
                assert!((density[axis] * area - force[axis]).abs() <= 1e-13 * largest);
            }
        }
    }
}

#[test]
fn the_force_is_proportional_to_the_modulus() {
    let GeneratedMesh {
        mesh, positions, ..
    } = irregular_discocyte();
    let file = Fixture::new("mesh.off", off(&positions, mesh.triangles()));
    for method in ["A", "B", "C"] {
        let lines = |modulus| {
            let arguments = [
                "curvature",
                file.path(),
                "--method",
                method,
                "--modulus",
                modulus,
            ];
            table::<f64>(&run(&arguments).stdout)
        };
        for (one, four) in lines("1").iter().zip(lines("4")) {
            assert_eq!(one[..10], four[..10]);
            // A power of two rounds nothing.
            assert_eq!(
                vector(one, 10).unwrap().map(|x| 4.0 * x),
                vector(&four, 10).unwrap()
            );
        }
    }
}

#[test]
fn a_cell_in_metres_keeps_its_digits() {
    let shape: AnyShape = "discocyte:3.91e-6".parse().unwrap();
    let made = generate(&shape, Family::Regular, 642, 1).unwrap();
    let file = Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()));
    let csv = succeed(&["curvature", file.path(), "--modulus", "2e-19"]);
    for (line, &preimage) in table::<f64>(&csv).iter().zip(&made.preimages) {
        let exact = shape.at(preimage);
        assert_eq!(vector(line, 0), Some(exact.position));
        assert!((line[7].unwrap() - exact.mean).abs() * 3.91e-6 < 0.5);
    }
    assert!(csv.len() < 642 * 13 * 25, "digits, not zeros");
}

/// A sheet of 5 × 5 vertices with a bump, and a vertex that no triangle uses.
fn sheet() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..5u32 {
        for column in 0..5u32 {
            let [x, y] = [column, row].map(f64::from);
            positions.push([x, y, 0.1 * x * x + 0.05 * x * y]);
            if row < 4 && column < 4 {
                let corner = 5 * row + column;
                triangles.push([corner, corner + 1, corner + 6]);
                triangles.push([corner, corner + 6, corner + 5]);
            }
        }
    }
    positions.push([9.0; 3]);
    (positions, triangles)
}

#[test]
fn boundaries_and_unused_vertices_have_empty_fields() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for method in ["A", "B", "C"] {
        let lines = table::<f64>(&succeed(&["curvature", file.path(), "--method", method]));
        assert_eq!(lines.len(), 26);
        let unused = &lines[25];
        assert_eq!(unused[..4], [Some(9.0), Some(9.0), Some(9.0), Some(0.0)]);
        assert!(unused[4..].iter().all(Option::is_none), "{unused:?}");
        for (vertex, line) in lines[..25].iter().enumerate() {
            let [row, column] = [vertex / 5, vertex % 5];
            let within =
                |ring: usize| (ring..5 - ring).contains(&row) && (ring..5 - ring).contains(&column);
            assert!(vector(line, 4).is_some() && line[3] > Some(0.0));
            assert_eq!(
                line[7].is_some(),
                method != "A" && within(1),
                "H at {vertex}"
            );
            assert_eq!(
                line[8].is_some(),
                method == "C" && within(1),
                "K at {vertex}"
            );
            assert_eq!(
                line[9].is_some(),
                method == "C" && within(2),
                "ΔH at {vertex}"
            );
            // Nodal forces exist everywhere, the strong form needs a full second ring.
            assert_eq!(
                vector(line, 10).is_some(),
                method != "C" || within(2),
                "f at {vertex}"
            );
        }
    }
}

#[test]
fn degenerate_triangles_warn_and_leave_no_false_numbers() {
    // An octahedron of which one corner is opened into two coincident vertices.
    let positions = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let triangles = [
        [0, 1, 4],
        [1, 5, 4],
        [1, 2, 5],
        [2, 3, 5],
        [3, 4, 5],
        [3, 0, 4],
        [1, 0, 6],
        [2, 1, 6],
        [3, 2, 6],
        [0, 3, 6],
    ];
    let file = Fixture::new("opened.obj", obj(&positions, &triangles));
    for method in ["A", "B", "C"] {
        let run = run(&["curvature", file.path(), "--method", method]);
        assert_eq!(run.code, Some(0));
        assert!(
            run.stderr.starts_with(&format!("warning: {}", file.path())),
            "{}",
            run.stderr
        );
        for line in table::<f64>(&run.stdout) {
            assert!(
                line.iter().flatten().all(|number| number.is_finite()),
                "{line:?}"
            );
        }
    }
    let info = succeed(&["info", file.path()]);
    assert!(info.contains("2 (the first is 1)"), "{info}");

    // All in one point: nothing has an area.
    let file = Fixture::new("point.obj", obj(&[[1.0; 3]; 7], &triangles));
    for method in ["A", "B", "C"] {
        let run = run(&["curvature", file.path(), "--method", method]);
        assert_eq!(run.code, Some(0));
        for line in table::<f64>(&run.stdout) {
            assert_eq!(line[3], Some(0.0));
            assert!(line[4..].iter().all(Option::is_none), "{method} {line:?}");
        }
    }
}

#[test]
fn csv_is_written_as_a_whole_or_not_at_all() {
    let GeneratedMesh {
        mesh, positions, ..
    } = irregular_discocyte();
    let file = Fixture::new("mesh.obj", obj(&positions, mesh.triangles()));
    let csv = file.beside("out.csv");
    let printed = succeed(&["curvature", file.path()]);
    assert_eq!(succeed(&["curvature", file.path(), "--csv", "-"]), printed);
    for _ in 0..2 {
        assert_eq!(
            succeed(&["curvature", file.path(), "--csv", text(&csv)]),
            ""
        );
        assert_eq!(fs::read_to_string(&csv).unwrap(), printed);
    }
    assert_eq!(file.names(), ["mesh.obj", "out.csv"]);

    // What was there stays as it was if there is nothing to write.
    let bad = Fixture::new("bad.obj", "v 0 0 nan\n");
    fail(2, &["curvature", bad.path(), "--csv", text(&csv)]);
    assert_eq!(fs::read_to_string(&csv).unwrap(), printed);

    for target in ["none/out.csv", "mesh.obj/out.csv", "."] {
        let target = file.beside(target);
        let message = fail(3, &["curvature", file.path(), "--csv", text(&target)]);
        assert!(message.contains(text(&target)), "{message}");
        assert_eq!(message.lines().count(), 1);
    }
    assert_eq!(file.names(), ["mesh.obj", "out.csv"]);

    let mesh = fs::read(file.path()).unwrap();
    let message = fail(2, &["curvature", file.path(), "--csv", file.path()]);
    assert!(message.contains("would replace the mesh"), "{message}");
    assert_eq!(fs::read(file.path()).unwrap(), mesh);
}

#[cfg(unix)]
#[test]
fn links_and_permissions_survive() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let [csv, link] = ["out.csv", "link.csv"].map(|name| file.beside(name));
    fs::write(&csv, "old").unwrap();
    fs::set_permissions(&csv, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("out.csv", &link).unwrap();
    succeed(&["curvature", file.path(), "--csv", text(&link)]);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(fs::read_to_string(&csv).unwrap().starts_with(HEADER));
    assert_eq!(
        fs::metadata(&csv).unwrap().permissions().mode() & 0o777,
        0o640
    );
}

#[test]
fn wrong_curvature_arguments() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for (arguments, hint) in [
        (&["--method", "nope"][..], "kantor-nelson (A)"),
        (&["--method", "all"], "kantor-nelson (A)"),
        (&["--method", "A,B"], "kantor-nelson (A)"),
        (&["--scalar", "f16"], "f32, f32-pair and f64"),
        (&["--modulus", "0"], "above 0"),
        (&["--modulus", "-2"], "above 0"),
        (&["--modulus", "x"], "above 0"),
        (&["--modulus", "1e39", "--scalar", "f32"], "f32"),
        (&["--nope"], "--nope"),
    ] {
        let message = fail(2, &[&["curvature", file.path()], arguments].concat());
        assert!(message.contains(hint), "{arguments:?}: {message}");
    }
    fail(2, &["curvature"]);
    fail(2, &["info"]);
    fail(2, &["info", file.path(), file.path()]);
    fail(2, &["nope"]);
}

// ── info ─────────────────────────────────────────────────────────────────────────────────────────

/// The value after a name.
#[track_caller]
fn value<'a>(info: &'a str, name: &str) -> &'a str {
    let line = info.lines().find_map(|line| line.strip_prefix(name));
    line.unwrap_or_else(|| panic!("no {name} in {info}")).trim()
}

#[test]
fn info_of_a_closed_mesh() {
    // An octahedron.
    let positions = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut triangles = vec![];
    for corner in 0..4u32 {
        let next = (corner + 1) % 4;
        triangles.extend([[corner, next, 4], [next, corner, 5]]);
    }
    let file = Fixture::new("octahedron.ply", ply(&positions, &triangles));
    let info = succeed(&["info", file.path()]);
    for (name, expected) in [
        ("vertices", "6"),
        ("edges", "12"),
        ("triangles", "8"),
        ("closed", "yes"),
        ("components", "1"),
        ("Euler characteristic", "2"),
        ("angles", "60.0000° … 60.0000°"),
        ("valences", "4 … 4"),
        ("degenerate triangles", "0"),
    ] {
        assert_eq!(value(&info, name), expected, "{name}");
    }
    let [area, volume] = ["area", "volume"].map(|name| value(&info, name).parse::<f64>().unwrap());
    assert!((area - 4.0 * 3f64.sqrt()).abs() < 1e-14 && (volume - 4.0 / 3.0).abs() < 1e-15);

    for triangle in &mut triangles {
        triangle.swap(0, 1);
    }
    let file = Fixture::new("inside-out.ply", ply(&positions, &triangles));
    let info = succeed(&["info", file.path()]);
    assert!(value(&info, "volume").contains("inside out"), "{info}");
}

#[test]
fn info_of_a_mesh_with_boundary() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.off", off(&positions, &triangles));
    let info = succeed(&["info", file.path()]);
    for (name, expected) in [
        ("vertices", "26 (1 in no triangle)"),
        ("triangles", "32"),
        ("closed", "no (16 boundary edges)"),
        ("components", "1"),
        ("Euler characteristic", "1"),
        ("volume", "not defined: the mesh has a boundary"),
        ("valences", "2 … 6"),
    ] {
        assert_eq!(value(&info, name), expected, "{name}");
    }
}

// ── bad input ────────────────────────────────────────────────────────────────────────────────────

#[test]
fn bad_files_get_one_line_that_names_the_place() {
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\n";
    let faces = |faces: &str| format!("{points}{faces}").into_bytes();
    let mut binary_stl = vec![0; 84];
    binary_stl[80] = 9;
    for (name, content, hints) in [
        (
            "garbage.obj",
            b"\x7fELF\x00\xff\xfe\n\x01".to_vec(),
            &[][..],
        ),
        ("garbage.off", b"\x7fELF\x00\xff\xfe".to_vec(), &["line 1"]),
        ("garbage.stl", b"garbage".to_vec(), &["line 1", "solid"]),
        ("garbage.ply", b"garbage".to_vec(), &["line 1", "ply"]),
        ("truncated.stl", binary_stl, &["9 faces", "84"]),
        (
            "truncated.off",
            b"OFF\n4 4 0\n0 0 0\n".to_vec(),
            &["truncated", "line 3"],
        ),
        ("empty.obj", vec![], &["empty"]),
        ("empty.stl", vec![], &["empty"]),
        ("no-faces.obj", points.as_bytes().to_vec(), &["triangle"]),
        ("no-faces.off", b"OFF\n0 0 0\n".to_vec(), &["triangle"]),
        ("mesh.msh", b"$MeshFormat\n".to_vec(), &["unknown format"]),
        ("unnamed", b"".to_vec(), &["unknown format"]),
        (
            "nan.obj",
            b"v 0 0 nan\n".to_vec(),
            &["line 1", "vertex 1", "coordinate z", "nan"],
        ),
        (
            "huge.obj",
            b"v 0 1e999 0\n".to_vec(),
            &["line 1", "coordinate y"],
        ),
        (
            "word.obj",
            b"v 0 0 x\n".to_vec(),
            &["line 1", "vertex 1", "`x`"],
        ),
        (
            "far.obj",
            faces("f 1 2 9\n"),
            &["line 6", "face 1", "vertex 9", "5 vertices"],
        ),
        (
            "zero.obj",
            faces("f 1 2 0\n"),
            &["line 6", "face 1", "vertex 0"],
        ),
        (
            "repeated.obj",
            faces("f 1 2 3\nf 1 4 4\n"),
            &["line 7", "face 2", "repeated"],
        ),
        (
            "twice.obj",
            faces("f 1 2 3\nf 2 3 1\n"),
            &["line 6", "line 7"],
        ),
        (
            "inconsistent.obj",
            faces("f 1 2 3\nf 1 2 4\n"),
            &["line 6", "line 7", "orient"],
        ),
        (
            "three-sided.obj",
            faces("f 1 2 3\nf 2 1 4\nf 1 2 5\n"),
            &["line 8", "3 triangles meet"],
        ),
        (
            "bow-tie.obj",
            format!("{points}v 2 2 2\nf 1 2 3\nf 1 5 6\n").into_bytes(),
            &["line 7", "line 8", "vertex 0"],
        ),
        (
            "huge.off",
            b"OFF\n4000000000 4000000000 0\n".to_vec(),
            &["truncated"],
        ),
    ] {
        let file = Fixture::new(name, content);
        let csv = file.beside("out.csv");
        for arguments in [
            &["info", file.path()][..],
            &["curvature", file.path(), "--csv", text(&csv)],
        ] {
            let message = fail(2, arguments);
            assert!(
                message.starts_with(&format!("error: {}", file.path())),
                "{message}"
            );
            assert_eq!(message.lines().count(), 1, "{message}");
            assert!(message.ends_with('\n'));
            for hint in hints {
                assert!(message.contains(hint), "{name}: no {hint:?} in {message}");
            }
        }
        assert_eq!(file.names(), [name]);
    }
    let folder = TempDir::new().unwrap();
    let missing = folder.path().join("missing.obj");
    assert!(fail(2, &["info", text(&missing)]).contains("no such file"));
    assert!(fail(2, &["info", text(folder.path())]).contains("directory"));
    assert!(is_empty(&folder));
}

#[test]
fn what_does_not_fit_into_f32_is_bad_input() {
    let (mut positions, triangles) = sheet();
    positions[3][1] = 1e300;
    let file = Fixture::new("far.obj", obj(&positions, &triangles));
    let message = fail(2, &["curvature", file.path(), "--scalar", "f32"]);
    for hint in [file.path(), "coordinate y", "vertex 3", "f32"] {
        assert!(message.contains(hint), "{message}");
    }
}

// ── streams ──────────────────────────────────────────────────────────────────────────────────────

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for arguments in [
        &["study", "--vertices", "12", "--family", "regular"][..],
        &[
            "study",
            "--vertices",
            "12",
            "--family",
            "regular",
            "--json",
            "-",
        ],
        &["curvature", file.path()],
        &["info", file.path()],
    ] {
        let mut child = command(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    }
}

#[test]
fn the_exit_code_tells_even_if_nobody_reads_the_message() {
    let mut child = command(&["info", "missing.obj"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_output_error() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for arguments in [
        &["study", "--vertices", "12", "--family", "regular"][..],
        &["curvature", file.path()],
        &["info", file.path()],
    ] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = command(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: standard output"));
    }
    fail(3, &["curvature", file.path(), "--csv", "/dev/full"]);
}
