//! `helfrich smooth`.

use crate::fixture::{Fixture, disturbed, obj, sheet};
use crate::{fail, run, succeed, text};
use helfrich::Surface;
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_std::io::{PointField, PointValues, read, read_with_columns, write_vtp};

fn ellipsoid(vertices: usize) -> GeneratedMesh {
    let shape = "ellipsoid:1,0.8,0.5".parse().unwrap();
    generate(&shape, Family::Irregular, vertices, 1).unwrap()
}

fn volume(made: &GeneratedMesh, positions: &[[f64; 3]]) -> f64 {
    let surface = Surface::new(&made.mesh, positions).unwrap();
    surface.volume().unwrap()
}

/// Root mean square of the left sides of the equation of the ellipsoid.
fn off(positions: &[[f64; 3]]) -> f64 {
    let left = |[x, y, z]: &[f64; 3]| x * x + (y / 0.8).powi(2) + (z / 0.5).powi(2) - 1.0;
    let squares = positions.iter().map(|at| left(at).powi(2));
    (squares.sum::<f64>() / positions.len() as f64).sqrt()
}

/// The value of a property that the program prints.
fn value<'a>(printed: &'a str, name: &str) -> &'a str {
    let line = printed.lines().find_map(|line| line.strip_prefix(name));
    line.unwrap_or_else(|| panic!("{name}: {printed}")).trim()
}

/// Fits of degree 4 have 15 coefficients: over 90 neighbours with weights that fall to e⁻⁴, which count as a quarter of
/// them, they leave less than 0.8 of independent noise, and those of four moves less than half.
#[test]
fn noise_is_removed_and_numbers_and_volume_are_kept() {
    let made = ellipsoid(2562);
    let noisy = disturbed(&made.positions, 1e-3);
    let file = Fixture::new("cell.vtp", "");
    let heights = Vec::from_iter(noisy.iter().map(|at| at[2]));
    let fields = [PointField {
        name: "height",
        values: PointValues::Scalars(&heights),
    }];
    write_vtp(file.path().as_ref(), &made.mesh, &noisy, None, &fields).unwrap();
    let out = file.beside("smooth.vtp");
    let said = succeed(&["smooth", file.path(), "-o", text(&out)]);
    let noise = value(&said, "noise of positions")
        .split(' ')
        .next()
        .unwrap();
    assert!((0.9e-3..1.1e-3).contains(&noise.parse().unwrap()), "{said}");
    assert!(
        value(&said, "fits").ends_with("neighbours, 4 times"),
        "{said}"
    );
    // Vertices move by their noise along the normal, or up to a third more; the largest of 2562 normal errors is four
    // standard deviations.
    let moved = value(&said, "displacements").split(' ');
    let moved = Vec::from_iter(moved.filter_map(|word| word.parse::<f64>().ok()));
    assert!((0.9e-3..1.3e-3).contains(&moved[0]), "{said}");
    assert!((3e-3..6e-3).contains(&moved[1]), "{said}");

    let (new, columns) = read_with_columns(&out).unwrap();
    assert_eq!(new.mesh.triangles(), made.mesh.triangles());
    assert_eq!(columns[0].name, "height");
    assert_eq!(columns[0].values, heights);
    assert!(off(&new.positions) < 0.5 * off(&noisy));
    let [before, after] = [&noisy, &new.positions].map(|positions| volume(&made, positions));
    assert!((after / before - 1.0).abs() < 1e-12, "{before} {after}");
    let printed = value(&said, "volume").split(' ').next().unwrap();
    assert!((printed.parse::<f64>().unwrap() / before - 1.0).abs() < 1e-12);
}

#[test]
fn a_mesh_without_noise_keeps_every_bit() {
    let made = ellipsoid(642);
    let file = Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()));
    let out = file.beside("smooth.obj");
    let said = run(&["smooth", file.path(), "-o", text(&out)]);
    assert_eq!(said.code, Some(0));
    assert!(
        said.stderr.contains(
            "no noise that can be told from the shape: no vertex is moved; --scale or --flow"
        ),
        "{}",
        said.stderr
    );
    assert_eq!(value(&said.stdout, "displacements"), "0");
    assert_eq!(read(&out).unwrap().positions, made.positions);
}

/// A tube that is six edges around, with noise of a fifth of an edge.
#[test]
fn noise_that_no_fit_reduces_is_told() {
    let shape = "torus:1,0.2".parse().unwrap();
    let made = generate(&shape, Family::Irregular, 642, 1).unwrap();
    let noisy = disturbed(&made.positions, 0.0263);
    let file = Fixture::new("tube.obj", obj(&noisy, made.mesh.triangles()));
    let out = file.beside("smooth.obj");
    let said = run(&["smooth", file.path(), "-o", text(&out)]);
    assert_eq!(said.code, Some(0));
    for part in [
        "warning: ",
        "which no fits reduce around half",
        "no vertex is moved: --scale or --flow",
    ] {
        assert!(said.stderr.contains(part), "{}", said.stderr);
    }
    assert_eq!(read(&out).unwrap().positions, noisy);
}

/// A strength beyond that of the noise moves vertices, more with more neighbours and with a longer time.
#[test]
fn strengths_are_chosen() {
    let made = ellipsoid(2562);
    let file = Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()));
    let out = file.beside("smooth.obj");
    let mut moved = Vec::new();
    for strength in [
        ["--scale", "32"],
        ["--scale", "128"],
        ["--flow", "1e-4"],
        ["--flow", "1e-2"],
    ] {
        let [option, number] = strength;
        let said = succeed(&["smooth", file.path(), option, number, "-o", text(&out)]);
        let mean = value(&said, "displacements").split(' ').next().unwrap();
        moved.push(mean.parse::<f64>().unwrap());
        let new = read(&out).unwrap().positions;
        let kept = volume(&made, &new) / volume(&made, &made.positions) - 1.0;
        assert!(kept.abs() < 1e-12, "{strength:?}: {kept}");
    }
    assert!(
        moved[1] > 4.0 * moved[0] && moved[3] > 4.0 * moved[2],
        "{moved:?}"
    );
}

#[test]
fn wrong_arguments_are_refused_and_leave_no_file() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let out = file.beside("smooth.obj");
    for (more, expected) in [
        (&["--scale", "27"][..], "27 is not in 28..=4096"),
        (&["--flow", "0"], "a finite number above 0 is needed"),
        (&["--flow", "1", "--scale", "28"], "cannot be used with"),
    ] {
        let message = fail(
            2,
            &[&["smooth", file.path(), "-o", text(&out)], more].concat(),
        );
        assert!(message.contains(expected), "{message}");
    }
    let message = fail(2, &["smooth", file.path(), "-o", file.path()]);
    assert!(
        message.contains("the smooth mesh would replace the mesh"),
        "{message}"
    );
    assert_eq!(file.names(), ["sheet.obj"]);
    let said = succeed(&["smooth", file.path(), "--flow", "1", "-o", text(&out)]);
    assert_eq!(
        value(&said, "volume"),
        "not defined: the mesh has a boundary"
    );
    // Nothing is left of a closed surface.
    let made = ellipsoid(162);
    let file = Fixture::new("cell.obj", obj(&made.positions, made.mesh.triangles()));
    let out = file.beside("smooth.obj");
    let message = fail(
        2,
        &["smooth", file.path(), "--flow", "1e300", "-o", text(&out)],
    );
    let remedies = ["choose a time far below this area", "smooth less"];
    assert!(
        remedies.iter().any(|remedy| message.contains(remedy)),
        "{message}"
    );
    assert_eq!(file.names(), ["cell.obj"]);
}
