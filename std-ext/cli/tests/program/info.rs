//! `helfrich info`.

use crate::fixture::{Fixture, disturbed, obj, off, ply, sheet};
use crate::{run, succeed};
use helfrich_std::generate::{Family, generate};
use std::f64::consts::PI;

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
        ("noise of positions", "none is seen"),
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

/// Two cubes and an isolated vertex between them; the second cube has edges of 2 and no lid. Edges of a cube have
/// angles of π/2, so that ∫ H dS is 3π of its edge, and without a lid, at whose four edges nothing is known, 2π.
#[test]
fn info_of_components() {
    let cube = |edge: f64, at: f64| {
        let corners = (0..8).map(move |k| [k & 1, k >> 1 & 1, k >> 2].map(f64::from));
        corners.map(move |x| x.map(|x| at + edge * x))
    };
    let sides: [[u32; 4]; 6] = [
        [0, 2, 3, 1],
        [0, 1, 5, 4],
        [1, 3, 7, 5],
        [3, 2, 6, 7],
        [2, 0, 4, 6],
        [4, 5, 7, 6],
    ];
    let of = |first: u32, sides: &[[u32; 4]]| {
        let halves = sides
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Vec::from_iter(halves.map(|corners| corners.map(|corner| first + corner)))
    };
    let positions = Vec::from_iter(cube(1.0, 0.0).chain([[9.0; 3]]).chain(cube(2.0, 4.0)));
    let triangles = [of(0, &sides), of(9, &sides[..5])].concat();
    let file = Fixture::new("cubes.ply", ply(&positions, &triangles));
    let info = succeed(&["info", file.path()]);
    assert_eq!(value(&info, "components"), "2");
    let total = value(&info, "total mean curvature").parse::<f64>();
    assert!((total.unwrap() - 7.0 * PI).abs() < 1e-13);
    for (name, words, curvature) in [
        (
            "component 1",
            "8 vertices from 0 on, genus 0, volume 1, area 6",
            3.0 * PI,
        ),
        (
            "component 2",
            "8 vertices from 9 on, 4 boundary edges, area 20",
            4.0 * PI,
        ),
    ] {
        let (found, total) = value(&info, name)
            .split_once(", total mean curvature ")
            .unwrap();
        assert_eq!(found, words);
        assert!(
            (total.parse::<f64>().unwrap() - curvature).abs() < 1e-13,
            "{total}"
        );
    }
    let many = (0..25).flat_map(|k| cube(1.0, 2.0 * f64::from(k)));
    let triangles = Vec::from_iter((0..25).flat_map(|k| of(8 * k, &sides)));
    let file = Fixture::new("many.ply", ply(&Vec::from_iter(many), &triangles));
    let info = succeed(&["info", file.path()]);
    assert!(
        info.contains("component 20 ") && !info.contains("component 21 "),
        "{info}"
    );
    assert!(info.contains("and 5 more components"), "{info}");
}

/// `info` says how large it is, `curvature` also what it takes away and what helps.
#[test]
fn noise_of_positions_is_told() {
    let made = generate(&"sphere".parse().unwrap(), Family::Regular, 642, 1).unwrap();
    let told = |positions: &[[f64; 3]]| {
        let file = Fixture::new("cell.obj", obj(positions, made.mesh.triangles()));
        let info = succeed(&["info", file.path()]);
        let warned = run(&["curvature", file.path(), "--method", "j6"]);
        assert_eq!(warned.code, Some(0));
        let info = value(&info, "noise of positions").to_owned();
        (info, warned.stderr)
    };
    let (info, warned) = told(&made.positions);
    assert_eq!(info, "none is seen");
    assert_eq!(warned, "");
    let (info, warned) = told(&disturbed(&made.positions, 1e-3));
    let length = info.split(' ').next().unwrap().parse::<f64>().unwrap();
    assert!((0.9e-3..1.1e-3).contains(&length), "{info}");
    assert!(info.ends_with("mean edges)"), "{info}");
    assert!(
        warned.contains(&format!("noise of positions {info}")),
        "{warned}"
    );
    assert!(warned.contains("take a coarser mesh"), "{warned}");
    assert!(
        warned.contains("642 × a vertex where a fourth derivative is lost in noise"),
        "{warned}"
    );
    // Coordinates in f32 are worth a word, and at this distance no warning.
    let single = made
        .positions
        .iter()
        .map(|x| x.map(|x| f64::from(x as f32)));
    let (_, warned) = told(&Vec::from_iter(single));
    assert!(
        warned.contains("note: ") && !warned.contains("warning: "),
        "{warned}"
    );
}

/// Faces with corners of their own are 1280 components only if nobody asks.
#[test]
fn split_vertices_are_said_and_welded() {
    let sphere = generate(&"sphere".parse().unwrap(), Family::Regular, 642, 1).unwrap();
    let triangles = sphere.mesh.triangles();
    let corners = triangles.iter().flatten();
    let positions = Vec::from_iter(corners.map(|&corner| sphere.positions[corner as usize]));
    let apart = (0..positions.len() as u32).step_by(3);
    let apart = Vec::from_iter(apart.map(|first| [first, first + 1, first + 2]));
    let file = Fixture::new("split.obj", obj(&positions, &apart));
    for arguments in [
        &["info", file.path()][..],
        &["curvature", file.path()],
        &["subdivide", file.path(), "-o", "/dev/null"],
    ] {
        let message = run(arguments).stderr;
        assert!(
            message.contains("3198 vertices"),
            "{arguments:?}: {message}"
        );
        assert!(message.contains("--weld"), "{arguments:?}: {message}");
    }
    let info = run(&["info", file.path()]).stdout;
    assert_eq!(value(&info, "components"), "1280");
    let info = succeed(&["info", "--weld", file.path()]);
    assert_eq!(value(&info, "components"), "1");
    assert_eq!(value(&info, "vertices"), "642");
    let table = succeed(&["curvature", "--weld", file.path()]);
    assert_eq!(table.lines().count(), 643);
    let whole = run(&["info", "--weld", file.path()]);
    assert!(whole.stderr.is_empty());
}

/// Faces with corners of their own that differ in the last digits of a text are one surface with `--weld=DISTANCE`, which
/// the message says.
#[test]
fn gaps_are_said_and_welded() {
    let sphere = generate(&"sphere".parse().unwrap(), Family::Regular, 162, 1).unwrap();
    let corners = sphere.mesh.triangles().iter().flatten();
    let positions = corners.enumerate().map(|(place, &corner)| {
        let off = 1e-6 * (place % 7) as f64;
        sphere.positions[corner as usize].map(|x| x + off)
    });
    let positions = Vec::from_iter(positions);
    let apart = (0..positions.len() as u32).step_by(3);
    let apart = Vec::from_iter(apart.map(|first| [first, first + 1, first + 2]));
    let file = Fixture::new("gaps.obj", obj(&positions, &apart));
    let told = run(&["info", file.path()]).stderr;
    let (_, rest) = told.split_once("others; ").expect("advice");
    let (advice, _) = rest.split_once(' ').expect("an argument");
    assert!(advice.starts_with("--weld="), "{told}");
    let info = succeed(&["info", advice, file.path()]);
    assert_eq!(value(&info, "vertices"), "162");
    assert_eq!(value(&info, "components"), "1");
    // A boundary alone is no gap.
    let open = Fixture::new(
        "open.obj",
        obj(&sphere.positions, &sphere.mesh.triangles()[1..]),
    );
    assert_eq!(run(&["info", open.path()]).stderr, "");
    let refused = run(&["info", "--weld=-1", file.path()]);
    assert!(refused.stderr.contains("0 or more"), "{}", refused.stderr);
}

/// The noise that `info` prints is that which error bars contain.
#[test]
fn info_and_curvature_agree_about_noise() {
    for (shape, family, vertices, part) in [
        ("torus", Family::Regular, 1280, 0.0),
        ("torus:1,0.4", Family::Irregular, 1280, 2e-5),
        ("discocyte", Family::Irregular, 1280, 0.0),
        ("ellipsoid:1,0.8,0.6", Family::Irregular, 642, 1e-3),
    ] {
        let made = generate(&shape.parse().unwrap(), family, vertices, 1).unwrap();
        let exact = disturbed(&made.positions, part);
        let single = exact.iter().map(|x| x.map(|x| f64::from(x as f32)));
        let single = Vec::from_iter(single);
        for positions in [exact, single] {
            let file = Fixture::new("mesh.obj", obj(&positions, made.mesh.triangles()));
            let info = succeed(&["info", file.path()]);
            let seen = value(&info, "noise of positions");
            let told = run(&["curvature", file.path(), "--method", "jet"]).stderr;
            match seen {
                "none is seen" => assert!(!told.contains("noise of positions"), "{told}"),
                _ => assert!(
                    told.contains(&format!("noise of positions {seen}")),
                    "{seen} {told}"
                ),
            }
        }
    }
}
