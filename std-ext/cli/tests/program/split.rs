//! `helfrich split`.

use crate::fixture::Fixture;
use crate::{fail, succeed, text};
use helfrich::TriangleMesh;
use helfrich_std::generate::{Family, generate};
use helfrich_std::io::{
    ColumnPlace, PointField, PointValues, read_with_columns, write_vtp_with_cells,
};
use std::path::Path;

/// Two spheres whose vertices and triangles alternate, an unused vertex between, and numbers at all of them.
#[test]
fn components_are_written_with_their_numbers() {
    let made = generate(&"sphere".parse().unwrap(), Family::Regular, 42, 1).unwrap();
    let mut positions = Vec::new();
    for &[x, y, z] in &made.positions {
        positions.extend([[x, y, z], [x + 3.0, y, 2.0 * z]]);
    }
    positions.insert(0, [9.0; 3]);
    let mut triangles = Vec::new();
    for triangle in made.mesh.triangles() {
        triangles.extend([0, 1].map(|side| triangle.map(|vertex| 2 * vertex + side + 1)));
    }
    let mesh = TriangleMesh::new(positions.len(), triangles).unwrap();
    let numbers = Vec::from_iter((0..positions.len()).map(|number| number as f64));
    let marks = Vec::from_iter((0..mesh.triangles().len()).map(|number| number as f64));
    let field = |name, values| PointField {
        name,
        values: PointValues::Scalars(values),
    };
    let (vertices, cells) = ([field("number", &numbers)], [field("mark", &marks)]);
    let file = Fixture::new("both.vtp", "");
    write_vtp_with_cells(
        Path::new(file.path()),
        &mesh,
        &positions,
        None,
        &vertices,
        &cells,
    )
    .unwrap();
    let out = file.beside("parts");
    let printed = succeed(&["split", file.path(), "--out", text(&out)]);
    for line in [
        "component-1.vtp: 42 vertices, 80 triangles",
        "component-2.vtp: 42 vertices",
    ] {
        assert!(printed.contains(line), "{printed}");
    }
    for (side, name) in ["component-1.vtp", "component-2.vtp"].iter().enumerate() {
        let (part, columns) = read_with_columns(&out.join(name)).unwrap();
        assert_eq!(part.mesh.triangles(), made.mesh.triangles());
        let own = Vec::from_iter(positions[1 + side..].iter().step_by(2).copied());
        assert_eq!(part.positions, own);
        let of = |place| columns.iter().find(|column| column.place == place).unwrap();
        let numbers = &of(ColumnPlace::Vertices).values;
        assert!(
            numbers
                .iter()
                .zip(0..)
                .all(|(&found, k)| found == f64::from(2 * k + side as u32 + 1))
        );
        let marks = &of(ColumnPlace::Triangles).values;
        assert!(
            marks
                .iter()
                .zip(0..)
                .all(|(&found, k)| found == f64::from(2 * k + side as u32))
        );
    }
    // Files that are there are kept.
    let again = fail(2, &["split", file.path(), "--out", text(&out)]);
    assert!(
        again.contains("there is such a file: choose another folder"),
        "{again}"
    );
}

#[test]
fn specks_are_left_out_and_formats_refused() {
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    let file = Fixture::new("speck.obj", tetrahedron);
    let folder = file.beside("parts");
    let (out, path) = (text(&folder), file.path());
    let none = fail(2, &["split", path, "--least", "5", "--out", out]);
    assert!(
        none.contains("no component has 5 vertices or more"),
        "{none}"
    );
    let format = fail(2, &["split", path, "--format", "st", "--out", out]);
    assert!(format.contains("is needed"), "{format}");
    let printed = succeed(&["split", path, "--format", "stl", "--out", out]);
    assert!(
        printed.contains("component-1.stl: 4 vertices, 4 triangles"),
        "{printed}"
    );
}
