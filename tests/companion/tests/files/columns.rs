//! Numbers at the vertices and faces of mesh files.

use helfrich::TriangleMesh;
use helfrich_std::io::{
    Column, ColumnPlace, Format, MeshFile, PointField, PointValues, parse, parse_with_columns,
    read_with_columns, write_vtp_with_cells,
};
use helfrich_tests::meshes::icosphere;
use std::fmt::Write;
use tempfile::TempDir;

fn column(name: &str, values: &[f64]) -> Column {
    Column {
        name: name.to_owned(),
        place: ColumnPlace::Vertices,
        values: values.to_vec(),
    }
}

fn at_triangles(name: &str, values: &[f64]) -> Column {
    Column {
        place: ColumnPlace::Triangles,
        ..column(name, values)
    }
}

/// Columns are read bit for bit as they were written; arrays of vectors are not read as columns.
#[test]
fn columns_of_vtp_files_keep_all_digits() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("sphere.vtp");
    let mesh = icosphere(1);
    let numbers = Vec::from_iter((0..42).map(|k| f64::from(k).exp() - 1e9 / 3.0));
    let labels = Vec::from_iter((0..42).map(|k| f64::from(k % 3)));
    let field = |name, values| PointField { name, values };
    let fields = [
        field("kappa", PointValues::Scalars(&numbers)),
        field("force", PointValues::Vectors(&mesh.positions)),
        field("label", PointValues::Scalars(&labels)),
    ];
    let faces = Vec::from_iter((0..80).map(|k| f64::from(k).sqrt()));
    let cells = [field("kappa", PointValues::Scalars(&faces))];
    let (connectivity, positions) = (&mesh.connectivity, &mesh.positions);
    write_vtp_with_cells(&path, connectivity, positions, None, &fields, &cells).unwrap();
    let (file, columns) = read_with_columns(&path).unwrap();
    assert_eq!(file.positions, mesh.positions);
    let expected = [
        column("kappa", &numbers),
        column("label", &labels),
        at_triangles("kappa", &faces),
    ];
    assert_eq!(columns, expected);
}

const PIECE: &str = r#"<Piece NumberOfPoints="3" NumberOfPolys="1"><PointData>
<DataArray Name="a" type="Float32" format="ascii">1 nan 3</DataArray>
<DataArray Name="b" type="Int8" NumberOfComponents="1" format="ascii">-4 5 6</DataArray>
<DataArray Name="names" type="String" format="ascii">112 0 113 0 114 0</DataArray>
<DataArray Name="two" type="Float32" NumberOfComponents="2" format="ascii">1 2 3 4 5 6</DataArray>
</PointData><CellData><DataArray Name="c" type="Int8" format="ascii">7</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray>
</Points><Polys><DataArray Name="connectivity" type="Int32" format="ascii">0 1 2</DataArray>
<DataArray Name="offsets" type="Int32" format="ascii">3</DataArray></Polys></Piece>"#;

fn vtp(pieces: &[&str]) -> String {
    let pieces = pieces.concat();
    format!("<VTKFile type=\"PolyData\"><PolyData>{pieces}</PolyData></VTKFile>")
}

fn columns(text: &str, format: Format) -> Vec<Column> {
    let (file, columns) = parse_with_columns(text.as_bytes(), format).unwrap();
    assert_eq!(parse(text.as_bytes(), format), Ok::<MeshFile, _>(file));
    columns
}

/// Columns of several pieces are joined; a column that one piece lacks is omitted.
#[test]
fn columns_of_pieces_are_joined() {
    let one = columns(&vtp(&[PIECE]), Format::Vtp);
    let names = Vec::from_iter(one.iter().map(|column| column.name.as_str()));
    assert_eq!(names, ["a", "b", "c"]);
    assert!(one[0].values[1].is_nan());
    let other = PIECE.replace("\"a\"", "\"z\"").replace("-4", "9");
    let two = columns(&vtp(&[PIECE, &other]), Format::Vtp);
    let expected = [
        column("b", &[-4.0, 5.0, 6.0, 9.0, 5.0, 6.0]),
        at_triangles("c", &[7.0, 7.0]),
    ];
    assert_eq!(two, expected);
}

/// All triangles of a polygon get its number. The numbers of lines, which precede those of polygons, are
/// skipped.
#[test]
fn faces_with_more_corners_have_one_number() {
    let text = vtp(&[
        r#"<Piece NumberOfPoints="5" NumberOfLines="1" NumberOfPolys="2"><CellData>
<DataArray Name="c" type="Int8" format="ascii">7 8 9</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 1 1 0 0 1 0 2 2 0</DataArray></Points>
<Lines><DataArray Name="connectivity" type="Int32" format="ascii">0 2</DataArray>
<DataArray Name="offsets" type="Int32" format="ascii">2</DataArray></Lines>
<Polys><DataArray Name="connectivity" type="Int32" format="ascii">0 1 2 3 1 4 2</DataArray>
<DataArray Name="offsets" type="Int32" format="ascii">4 7</DataArray></Polys></Piece>"#,
    ]);
    let expected = [at_triangles("c", &[8.0, 8.0, 9.0])];
    assert_eq!(columns(&text, Format::Vtp), expected);
    let text = text.replace("7 8 9", "8 9");
    let error = parse_with_columns(text.as_bytes(), Format::Vtp).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 2: an array of CellData has 2 numbers, and its piece 3 cells"
    );
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
                property float z\nelement face 2\nproperty uchar domain\n\
                property list uchar int vertex_indices\nproperty float kappa\nend_header\n\
                0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 0\n1 4 0 1 2 3 0.5\n2 3 1 4 2 3.5\n";
    let expected = [
        at_triangles("domain", &[1.0, 1.0, 2.0]),
        at_triangles("kappa", &[0.5, 0.5, 3.5]),
    ];
    assert_eq!(columns(text, Format::Ply), expected);
}

/// A column of the wrong length is an error only if columns are requested.
#[test]
fn columns_of_another_length_are_refused() {
    for (numbers, found) in [("-4 5", 2), ("-4 5 6 7", 4)] {
        let text = vtp(&[&PIECE.replace("-4 5 6", numbers)]);
        parse(text.as_bytes(), Format::Vtp).unwrap();
        let error = parse_with_columns(text.as_bytes(), Format::Vtp).unwrap_err();
        let message = error.to_string();
        assert_eq!(
            message,
            format!("line 3: an array of PointData has {found} numbers, and its piece 3 points")
        );
    }
}

/// Columns are read before, between and after the coordinates; list properties are not columns.
#[test]
fn columns_of_ply_files() {
    let header = |encoding: &str| {
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex 3\nproperty short label\nproperty float x\n\
             property float y\nproperty list uchar uchar near\nproperty double kappa\n\
             property float z\nelement face 1\nproperty uchar red\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let rows = [
        (-3_i16, [0.0_f32, 0.0], 0.1),
        (7, [1.0, 0.0], f64::INFINITY),
        (2, [0.0, 1.0], 1e300),
    ];
    let expected = [
        column("label", &[-3.0, 7.0, 2.0]),
        column("kappa", &[0.1, f64::INFINITY, 1e300]),
        at_triangles("red", &[255.0]),
    ];
    let mut text = header("ascii");
    let mut bytes = header("binary_little_endian").into_bytes();
    for (label, [x, y], kappa) in rows {
        writeln!(text, "{label} {x} {y} 2 8 9 {kappa} 0").unwrap();
        bytes.extend(label.to_le_bytes());
        bytes.extend([x, y].iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([2, 8, 9]);
        bytes.extend(kappa.to_le_bytes());
        bytes.extend(0.0_f32.to_le_bytes());
    }
    text += "255 3 0 1 2\n";
    bytes.extend([255, 3]);
    bytes.extend([0_i32, 1, 2].iter().flat_map(|x| x.to_le_bytes()));
    assert_eq!(columns(&text, Format::Ply), expected);
    let (_, found) = parse_with_columns(&bytes, Format::Ply).unwrap();
    assert_eq!(found, expected);
    let wrong = text.replace("0.1", "much");
    parse(wrong.as_bytes(), Format::Ply).unwrap();
    let error = parse_with_columns(wrong.as_bytes(), Format::Ply).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 14 (vertex 0): expected a number, found `much`"
    );
}

#[test]
fn other_formats_have_no_columns() {
    let text = "v 0 0 0 255 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(columns(text, Format::Obj), []);
}

/// A vertex of no face may have any coordinates: it is left out with its numbers. That of a face may not.
#[test]
fn unknown_vertices_of_no_face_are_left_out() {
    let ply = |face: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
             property float a\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 10\nnan 0 0 11\n1 0 0 12\n0 inf 0 13\n0 1 0 14\n3 {face}\n"
        )
    };
    let (file, columns) = parse_with_columns(ply("0 2 4").as_bytes(), Format::Ply).unwrap();
    assert_eq!(file.left_out, 2);
    assert_eq!(file.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(file.mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(columns, [column("a", &[10.0, 12.0, 14.0])]);
    let refused = parse(ply("0 2 3").as_bytes(), Format::Ply).unwrap_err();
    let told = refused.to_string();
    assert!(
        told.contains("line 12 (vertex 1): coordinate x is `nan`"),
        "{told}"
    );

    for (text, format) in [
        (
            "v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 4\n",
            Format::Obj,
        ),
        (
            "OFF\n4 1 0\n0 0 0\nnan 0 0\n1 0 0\n0 1 0\n3 0 2 3\n",
            Format::Off,
        ),
    ] {
        let file = parse(text.as_bytes(), format).unwrap();
        assert_eq!((file.left_out, file.positions.len()), (1, 3), "{format:?}");
        assert_eq!(file.mesh.triangles(), [[0, 1, 2]], "{format:?}");
    }

    let folder = TempDir::new().unwrap();
    let path = folder.path().join("unknown.vtp");
    let mesh = icosphere(0);
    let mut positions = mesh.positions.clone();
    positions.insert(3, [f64::NAN; 3]);
    let renumbered = mesh.connectivity.triangles().iter();
    let renumbered = renumbered.map(|triangle| triangle.map(|v| v + u32::from(v >= 3)));
    let wide = TriangleMesh::new(positions.len(), renumbered.collect()).unwrap();
    let numbers = Vec::from_iter((0..positions.len()).map(|k| k as f64));
    let field = PointField {
        name: "a",
        values: PointValues::Scalars(&numbers),
    };
    write_vtp_with_cells(&path, &wide, &positions, None, &[field], &[]).unwrap();
    let (file, columns) = read_with_columns(&path).unwrap();
    assert_eq!(file.left_out, 1);
    assert_eq!(file.positions, mesh.positions);
    assert_eq!(file.mesh.triangles(), mesh.connectivity.triangles());
    assert!(!columns[0].values.contains(&3.0) && columns[0].values.len() == positions.len() - 1);
}
