//! Numbers at the vertices of mesh files.

use helfrich_std::io::{
    Column, Format, MeshFile, PointField, PointValues, parse, parse_with_columns,
    read_with_columns, write_vtp,
};
use helfrich_tests::meshes::icosphere;
use std::fmt::Write;
use tempfile::TempDir;

fn column(name: &str, values: &[f64]) -> Column {
    Column {
        name: name.to_owned(),
        values: values.to_vec(),
    }
}

/// Columns are read as they were written, bit for bit; vectors are not numbers.
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
    write_vtp(&path, &mesh.connectivity, &mesh.positions, None, &fields).unwrap();
    let (file, columns) = read_with_columns(&path).unwrap();
    assert_eq!(file.positions, mesh.positions);
    let expected = [column("kappa", &numbers), column("label", &labels)];
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

/// Pieces one after the other; a column that one of them lacks is none.
#[test]
fn columns_of_pieces_are_joined() {
    let one = columns(&vtp(&[PIECE]), Format::Vtp);
    let names = Vec::from_iter(one.iter().map(|column| column.name.as_str()));
    assert_eq!(names, ["a", "b"]);
    assert!(one[0].values[1].is_nan());
    let other = PIECE.replace("\"a\"", "\"z\"").replace("-4", "9");
    let two = columns(&vtp(&[PIECE, &other]), Format::Vtp);
    assert_eq!(two, [column("b", &[-4.0, 5.0, 6.0, 9.0, 5.0, 6.0])]);
}

/// Only where columns are asked for.
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

/// Before, between and behind the coordinates; lists and what belongs to faces are no columns.
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
