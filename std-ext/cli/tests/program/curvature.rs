//! `helfrich curvature`.

use crate::fixture::{Fixture, obj, off, ply, sheet, stl};
use crate::{fail, run, succeed, text};
use helfrich::shapes::Shape;
use helfrich::{GompperKroll, KantorNelson, Prepared, Real, Surface};
use helfrich_std::execute::with_threads;
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_std::io::read;
use helfrich_std::method::{BendingMethod, Evaluator, Fields};
use helfrich_std::report::curvature_csv;
use std::fmt::Debug;
use std::fs;
use std::num::NonZeroUsize;
use std::str::FromStr;

const HEADER: &str = "vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz";

fn irregular_discocyte() -> GeneratedMesh {
    let shape: AnyShape = "discocyte".parse().unwrap();
    generate(&shape, Family::Irregular, 300, 7).unwrap()
}

/// Every method but `jet`, which chooses its fits and has more columns.
fn of_one_fit() -> impl Iterator<Item = BendingMethod> {
    let all = BendingMethod::NAMED.into_iter();
    all.filter(|&method| method != BendingMethod::Jet)
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
        let mesh_file = read(file.path().as_ref()).unwrap();
        if !file.path().ends_with("STL") {
            assert_eq!(mesh_file.positions, positions);
        }
        let (mesh, exact) = (&mesh_file.mesh, &mesh_file.positions);
        let single = Vec::from_iter(exact.iter().map(|point| point.map(|x| x as f32)));
        // Methods do not know formats: one with fits and one without stand for all in all but one.
        let is_first = file.path() == files[0].path();
        let is_asked = |&method: &BendingMethod| {
            is_first || matches!(method, BendingMethod::GompperKroll | BendingMethod::J6)
        };
        for method in of_one_fit().filter(is_asked) {
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
    for method in of_one_fit() {
        let defined = method.description().defines;
        let csv = run(&["curvature", file.path(), "--method", method.name()]).stdout;
        for line in table::<f64>(&csv) {
            assert_eq!([7, 8, 9].map(|column| line[column].is_some()), defined);
            assert!(vector(&line, 4).is_some());
            assert_eq!(vector(&line, 10).is_some(), method.has_force());
        }
    }
    // The default is the method that knows its errors.
    let [plain, jet] = [&[][..], &["--method", "jet"]]
        .map(|method| run(&[&["curvature", file.path()], method].concat()).stdout);
    assert_eq!(plain, jet);
}

/// The force density of a method that does not determine it is not printed without a word: on irregular meshes
/// it is off by hundreds of times the largest exact value.
#[test]
fn a_force_that_does_not_converge_is_warned_of() {
    let shape: AnyShape = "discocyte".parse().unwrap();
    let made = generate(&shape, Family::Irregular, 2562, 1).unwrap();
    let file = Fixture::new("cell.off", off(&made.positions, made.mesh.triangles()));
    let exact = made.preimages.iter().map(|&at| shape.at(at));
    let exact = Vec::from_iter(exact.map(|at| at.normal.map(|x| x * at.force_density(1.0))));
    let size = |f: &[f64; 3]| f.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = exact.iter().map(size).fold(0.0, f64::max);
    for method in of_one_fit().filter(|method| method.has_force()) {
        let told = run(&["curvature", file.path(), "--method", method.name()]);
        let lines = table::<f64>(&told.stdout);
        let off = lines.iter().zip(&exact).map(|(line, exact)| {
            let found = vector(line, 10).unwrap();
            size(&[0, 1, 2].map(|axis| found[axis] - exact[axis]))
        });
        let off = off.fold(0.0, f64::max) / largest;
        let is_warned = told
            .stderr
            .contains(&format!("{method} does not determine f"));
        assert!(
            is_warned || off < 1.0,
            "{method}: f is off by {off}: {}",
            told.stderr
        );
        let is_determined = ["j4", "j6", "j8", "galerkin"].contains(&method.name());
        assert_eq!(is_warned, !is_determined, "{method}: {}", told.stderr);
    }
}

/// A sphere that is inside out, alone or beside others, has a negative H, and the component is named.
#[test]
fn what_is_inside_out_is_named() {
    let made = generate(&"sphere".parse().unwrap(), Family::Regular, 642, 1).unwrap();
    let reversed = Vec::from_iter(made.mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]));
    let beside = made.positions.iter().map(|&[x, y, z]| [x + 9.0, y, z]);
    let both = Vec::from_iter(made.positions.iter().copied().chain(beside));
    let second = reversed
        .iter()
        .map(|triangle| triangle.map(|vertex| vertex + 642));
    let all = Vec::from_iter(made.mesh.triangles().iter().copied().chain(second));
    for (file, named) in [
        (
            Fixture::new("one.off", off(&made.positions, &reversed)),
            "component 1 of 1",
        ),
        (
            Fixture::new("two.off", off(&both, &all)),
            "component 2 of 2 (642 vertices from vertex 642 on)",
        ),
    ] {
        for method in ["jet", "j6", "corrected"] {
            let told = run(&["curvature", file.path(), "--method", method]);
            assert_eq!(told.code, Some(0));
            for hint in [file.path(), named, "is inside out", "reverse the corners"] {
                assert!(
                    told.stderr.contains(hint),
                    "{method}: no {hint} in {}",
                    told.stderr
                );
            }
            let line = told.stdout.lines().last().unwrap();
            assert!(line.split(',').nth(8).unwrap().starts_with('-'), "{line}");
        }
        let info = succeed(&["info", file.path()]);
        assert!(info.contains(named), "{info}");
    }
    let file = Fixture::new("right.off", off(&made.positions, made.mesh.triangles()));
    succeed(&["curvature", file.path()]);
    assert!(!succeed(&["info", file.path()]).contains("inside out"));
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
    let csv = run(&[
        "curvature",
        file.path(),
        "--method",
        "j6",
        "--modulus",
        "2e-19",
    ])
    .stdout;
    for (line, &preimage) in table::<f64>(&csv).iter().zip(&made.preimages) {
        let exact = shape.at(preimage);
        assert_eq!(vector(line, 0), Some(exact.position));
        assert!((line[7].unwrap() - exact.mean).abs() * 3.91e-6 < 0.5);
    }
    assert!(csv.len() < 642 * 13 * 25, "digits, not zeros");
}

#[test]
fn boundaries_and_unused_vertices_have_empty_fields() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    for method in ["A", "B", "C"] {
        let lines = table::<f64>(&run(&["curvature", file.path(), "--method", method]).stdout);
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
    // On which nothing is to be warned of.
    let shape: AnyShape = "sphere".parse().unwrap();
    let GeneratedMesh {
        mesh, positions, ..
    } = generate(&shape, Family::Regular, 642, 1).unwrap();
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
    assert_eq!(
        run(&["curvature", file.path(), "--csv", text(&link)]).code,
        Some(0)
    );
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
        (
            &["--areas", "voronoi", "--method", "J"],
            "method jet has no option `areas`",
        ),
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

/// Numbers read back to the same bits from texts as short as those of `{:?}`, and rows are in order,
/// whatever the number of threads.
#[test]
fn rows_have_the_digits_and_the_order_of_their_vertices() {
    const COUNT: usize = 40_000;
    // A sequence that visits all exponents, with digits of all lengths in between.
    let mut state = 1_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        state ^ (state >> 29)
    };
    let mut positions = Vec::new();
    for vertex in 0..COUNT {
        let anything = Some(f64::from_bits(next())).filter(|x| x.is_finite());
        let scale = 10.0_f64.powi((next() % 44) as i32 - 22);
        let short = (next() % 2000) as f64 - 1000.0;
        positions.push([
            anything.unwrap_or(-0.0),
            short * scale,
            vertex as f64 * 1e-7,
        ]);
    }
    positions[0] = [5e-324, f64::MAX, 1e16];
    positions[1] = [1e-5, -1e-4, 9.999999999999999e-6];
    check_digits(&positions);
    let single = positions.iter().map(|row| row.map(|x| x as f32));
    check_digits(&Vec::from_iter(single));
}

fn check_digits<T: Real + FromStr<Err: Debug>>(positions: &[[T; 3]]) {
    let undefined = vec![None; positions.len()];
    let fields = Fields {
        area: positions.iter().map(|row| row[0]).collect(),
        normal: vec![[T::zero(); 3]; positions.len()],
        mean: positions.iter().map(|row| Some(row[1])).collect(),
        gaussian: undefined.clone(),
        laplacian_of_mean: undefined,
        force_density: vec![None; positions.len()],
    };
    for threads in [1, 2, 5] {
        let threads = NonZeroUsize::new(threads).unwrap();
        let mut csv = Vec::new();
        with_threads(threads, || {
            curvature_csv(positions, &fields, &[], &mut csv).unwrap();
        });
        let csv = String::from_utf8(csv).unwrap();
        let mut lines = csv.lines().skip(1);
        for (vertex, row) in positions.iter().enumerate() {
            let words = Vec::from_iter(lines.next().unwrap().split(','));
            assert_eq!(words.len(), 14);
            assert_eq!(words[0].parse(), Ok(vertex));
            let [x, y, z] = *row;
            for (at, expected) in [(1, x), (2, y), (3, z), (4, x), (8, y)] {
                let read: T = words[at].parse().unwrap();
                assert_eq!(read, expected);
                assert_eq!(read.is_sign_negative(), expected.is_sign_negative());
                assert_eq!(words[at].len(), format!("{expected:?}").len());
            }
            assert!(
                [5, 6, 7, 9, 10, 11, 12, 13]
                    .iter()
                    .all(|&at| words[at].is_empty())
            );
        }
        assert_eq!(lines.next(), None);
    }
}

/// Where neighbours determine no fit, methods in strong form have no force either; one with an energy has one.
#[test]
fn unknown_curvatures_leave_no_force() {
    let corners = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let faces = [[0, 2], [2, 1], [1, 3], [3, 0]].map(|[a, b]| [[a, b, 4], [b, a, 5]]);
    let file = Fixture::new("octahedron.obj", obj(&corners, faces.as_flattened()));
    for (method, is_known) in [("j6", false), ("farutin", false), ("gompper-kroll", true)] {
        let output = run(&["curvature", file.path(), "--method", method]);
        assert_eq!(output.code, Some(0), "{}", output.stderr);
        for line in table::<f64>(&output.stdout) {
            assert_eq!(line[7].is_some(), is_known, "{method}: H");
            assert_eq!(line[10].is_some(), is_known, "{method}: f");
        }
    }
}
