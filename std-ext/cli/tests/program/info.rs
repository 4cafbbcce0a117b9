//! `helfrich info`.

use crate::fixture::{Fixture, off, ply, sheet};
use crate::succeed;

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
