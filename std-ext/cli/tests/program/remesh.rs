//! `helfrich remesh`.

use crate::fixture::{Fixture, disturbed, obj, sheet};
use crate::{fail, run, succeed, text};
use helfrich::Surface;
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_std::io::{ColumnPlace, PointField, PointValues, read, read_with_columns, write_vtp};

fn ellipsoid(vertices: usize) -> GeneratedMesh {
    let shape = "ellipsoid:1,0.8,0.5".parse().unwrap();
    generate(&shape, Family::Irregular, vertices, 1).unwrap()
}

/// A smooth field is carried by polynomials: linear interpolation between these vertices is off by 1e-2. Labels, which are
/// integers, stay labels.
#[test]
fn numbers_at_vertices_are_carried_to_the_new_mesh() {
    let made = ellipsoid(2562);
    let file = Fixture::new("cell.vtp", "");
    let field = |[x, y, z]: [f64; 3]| (2.0 * x).sin() + y * z;
    let smooth = Vec::from_iter(made.positions.iter().map(|&at| field(at)));
    let labels = made
        .positions
        .iter()
        .map(|[x, ..]| if *x > 0.0 { 7.0 } else { 3.0 });
    let labels = Vec::from_iter(labels);
    let fields = [("smooth", &smooth), ("label", &labels)].map(|(name, values)| PointField {
        name,
        values: PointValues::Scalars(values),
    });
    write_vtp(
        file.path().as_ref(),
        &made.mesh,
        &made.positions,
        None,
        &fields,
    )
    .unwrap();
    let out = file.beside("even.vtp");
    let said = succeed(&[
        "remesh",
        file.path(),
        "--vertices",
        "2000",
        "-o",
        text(&out),
    ]);
    assert!(
        said.contains("2000 vertices, 3996 triangles (before: 2562, 5120)"),
        "{said}"
    );
    let (new, columns) = read_with_columns(&out).unwrap();
    assert_eq!(new.positions.len(), 2000);
    for column in columns {
        assert_eq!(column.place, ColumnPlace::Vertices);
        for (value, &at) in column.values.iter().zip(&new.positions) {
            match column.name.as_str() {
                "smooth" => assert!((value - field(at)).abs() < 2e-5, "{value} {}", field(at)),
                _ => assert!([3.0, 7.0].contains(value), "{value}"),
            }
        }
    }
}

/// Ends and sides of a box are flat, and their creases straight.
#[test]
fn creases_are_kept_and_said() {
    let cube = [0, 1, 2, 3, 4, 5, 6, 7].map(|k| [k & 1, (k >> 1) & 1, k >> 2].map(f64::from));
    let squares = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = squares
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let file = Fixture::new("cube.obj", obj(&cube, &Vec::from_iter(triangles)));
    let out = file.beside("even.obj");
    let arguments = ["remesh", file.path(), "--edge", "0.2", "-o", text(&out)];
    let said = run(&arguments);
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    assert!(
        said.stderr.contains("12 edges are kept as creases"),
        "{}",
        said.stderr
    );
    let new = read(&out).unwrap();
    let surface = Surface::new(&new.mesh, &new.positions).unwrap();
    assert!(
        (surface.area() - 6.0).abs() < 1e-12 && (surface.volume().unwrap() - 1.0).abs() < 1e-12
    );
    assert!(new.positions.len() > 100);
}

#[test]
fn lengths_are_chosen_by_curvature_and_error() {
    let made = ellipsoid(642);
    let file = Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()));
    let out = file.beside("new.obj");
    let mut counts = Vec::new();
    for lengths in [
        ["--curvature", "10"],
        ["--curvature", "20"],
        ["--error", "1%"],
        ["--error", "0.0001"],
    ] {
        let [option, value] = lengths;
        succeed(&["remesh", file.path(), option, value, "-o", text(&out)]);
        counts.push(read(&out).unwrap().positions.len());
    }
    // Edges that are twice as long need a quarter of the vertices, as far as lengths are within their range.
    assert!(counts[0] > 3 * counts[1], "{counts:?}");
    assert!(counts[2] < 642 && counts[3] > counts[2], "{counts:?}");
}

/// The new mesh would have noise as bumps.
#[test]
fn noise_is_refused_with_the_option_that_removes_it() {
    let made = ellipsoid(642);
    let noisy = disturbed(&made.positions, 3e-3);
    let file = Fixture::new("noisy.obj", obj(&noisy, made.mesh.triangles()));
    let out = file.beside("new.obj");
    let message = fail(2, &["remesh", file.path(), "-o", text(&out)]);
    assert!(
        message.contains("--smooth removes it first") && !out.exists(),
        "{message}"
    );
    let said = run(&["remesh", file.path(), "--smooth", "-o", text(&out)]);
    assert!(
        said.code == Some(0) && said.stderr.contains("the noise is removed"),
        "{}",
        said.stderr
    );
}

#[test]
fn wrong_columns_are_named() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let out = file.beside("new.obj");
    let message = fail(
        2,
        &["remesh", file.path(), "--field", "size", "-o", text(&out)],
    );
    assert!(
        message.contains("there is no column `size`: the file has no numbers"),
        "{message}"
    );
    let message = fail(2, &["remesh", file.path(), "-o", file.path()]);
    assert!(message.contains("would replace the mesh"), "{message}");
}
