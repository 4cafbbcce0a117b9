//! VTP files: polygons of VTK's PolyData.

use super::solid::{Solid, icosahedron, tetrahedron};
use helfrich_std::io::{Format, parse};
use helfrich_tests::invariants::check_reader;
use std::fmt::Write;

fn message(text: &str) -> String {
    parse(text.as_bytes(), Format::Vtp).unwrap_err().to_string()
}

/// A file of one piece with these arrays, followed by `after` behind the data.
fn document(attributes: &str, counts: [usize; 2], arrays: [&str; 3], after: &str) -> String {
    let [points, polygons] = counts;
    let [coordinates, connectivity, offsets] = arrays;
    format!(
        "<?xml version=\"1.0\"?>\n<!-- of \"PolyData\" > -->\n\
         <VTKFile type='PolyData' version=\"0.1\" {attributes}>\n  <PolyData>\n\
         <Piece NumberOfPoints=\"{points}\" NumberOfStrips=\"0\" NumberOfPolys=\"{polygons}\">\n\
         <PointData><DataArray Name=\"a > b\" type=\"Float32\" format=\"ascii\">1</DataArray>\
         </PointData>\n<Points><DataArray NumberOfComponents=\"3\" Name=\"Points\" {coordinates}\
         </DataArray></Points>\n<Verts/><Polys>\n<DataArray Name=\"connectivity\" {connectivity}\
         </DataArray>\n<DataArray Name = \"offsets\" {offsets}</DataArray>\n</Polys></Piece>\n\
         </PolyData>\n{after}</VTKFile>\n"
    )
}

/// ASCII arrays with all digits, coordinates and corners on lines of their own.
fn ascii(solid: &Solid) -> String {
    let mut points = "type=\"Float64\" format=\"ascii\">\n".to_owned();
    for [x, y, z] in &solid.positions {
        writeln!(points, "{x:?} {y:?} {z:?}").unwrap();
    }
    let mut corners = "type=\"Int32\" format=\"ascii\">\n".to_owned();
    for [a, b, c] in &solid.triangles {
        writeln!(corners, "{a} {b} {c}").unwrap();
    }
    let mut ends = "type=\"Int32\" format=\"ascii\">".to_owned();
    for end in 1..=solid.triangles.len() {
        write!(ends, " {}", 3 * end).unwrap();
    }
    let counts = [solid.positions.len(), solid.triangles.len()];
    document("", counts, [&points, &corners, &ends], "")
}

/// Raw numbers of 32 and 64 bits, appended at the end of the file.
fn appended_raw(solid: &Solid) -> Vec<u8> {
    let bytes = |data: Vec<u8>| [&(data.len() as u32).to_le_bytes()[..], &data].concat();
    let points = solid.positions.as_flattened().iter();
    let points = bytes(points.flat_map(|x| x.to_le_bytes()).collect());
    let corners = solid.triangles.as_flattened().iter();
    let corners = bytes(corners.flat_map(|&x| i64::from(x).to_le_bytes()).collect());
    let ends = 1..=solid.triangles.len() as u32;
    let ends = bytes(ends.flat_map(|end| (3 * end).to_le_bytes()).collect());
    let array = |kind: &str, offset: usize| {
        format!("type=\"{kind}\" format=\"appended\" offset=\"{offset}\">")
    };
    let text = document(
        "byte_order=\"LittleEndian\" header_type=\"UInt32\"",
        [solid.positions.len(), solid.triangles.len()],
        [
            &array("Float64", 0),
            &array("Int64", points.len()),
            &array("UInt32", points.len() + corners.len()),
        ],
        "<AppendedData encoding=\"raw\">\n _",
    );
    let end = text.len() - "</VTKFile>\n".len();
    let after = b"</AppendedData></VTKFile>".to_vec();
    [
        text.as_bytes()[..end].to_vec(),
        points,
        corners,
        ends,
        after,
    ]
    .concat()
}

/// The tetrahedron, encoded by Python's base64, struct and zlib: in big-endian order with separately padded
/// headers; compressed; compressed and appended.
fn encoded() -> [String; 3] {
    let binary =
        |kind: &str, data: &str| format!("type=\"{kind}\" format=\"binary\">\n   {data}\n");
    let appended = |kind: &str, offset: usize| {
        format!("type=\"{kind}\" format=\"appended\" offset=\"{offset}\">")
    };
    let big = document(
        "byte_order=\"BigEndian\"",
        [4, 4],
        [
            &binary(
                "Float64",
                "AAAAYA==P7mZmZmZmZo/yZmZmZmZmj/TMzMzMzMzP/AAAAAAAAEAAAAAAAAAAIGlbh/C+PNZAAAAAAAAAAA/\
                 1VVVVVVVVQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAEDIHNbmPFOy",
            ),
            &binary(
                "Int32",
                "AAAAMA==AAAAAAAAAAIAAAABAAAAAAAAAAEAAAADAAAAAQAAAAIAAAADAAAAAgAAAAAAAAAD",
            ),
            &binary("Int32", "AAAAEA==AAAAAwAAAAYAAAAJAAAADA=="),
        ],
        "",
    );
    let compressed = document(
        "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"",
        [4, 4],
        [
            &binary(
                "Float64",
                "AgAAAAAAAABAAAAAAAAAACAAAAAAAAAALgAAAAAAAAAUAAAAAAAAAA==eJybNRMEdtrPAtMn7Y3B4LI9IwMI\
                 fLBngILIzz8OyectbYTxQ8Hgqj0AAs4UbnicY2DADjYF2zy7JnPCAQATVwQi",
            ),
            &binary(
                "Int8",
                "AQAAAAAAAABAAAAAAAAAAAwAAAAAAAAAFAAAAAAAAAA=eJxjYGJkYGRmZGJmYmAGAABuABM=",
            ),
            &binary(
                "UInt8",
                "AQAAAAAAAABAAAAAAAAAAAQAAAAAAAAADAAAAAAAAAA=eJxjZuPkAQAAQAAf",
            ),
        ],
        "",
    );
    let at_the_end = document(
        "compressor=\"vtkZLibDataCompressor\"",
        [4, 4],
        [
            &appended("Float64", 0),
            &appended("Int32", 136),
            &appended("Int32", 220),
        ],
        "<AppendedData encoding=\"base64\">\n   \
         _AwAAACgAAAAQAAAAHwAAABoAAAAUAAAAeJybNRMEdtrPAtMn7Y3B4LI9IwMIfLBngAIAZGIMo3ici/z845B83tJGBig\
         IBYOr9gxoAADr3gfMeJxjYICATcE2z67JnHAAABNHBCI=AgAAACgAAAAIAAAAGgAAAA4AAAA=eJxjYGBgYAJiRgYIAN\
         HMUJoJygbRAAEsABB4nGNgYGBgBmIAABQABA==AQAAACgAAAAQAAAAEwAAAA==eJxjZmBgYANiTiDmAWIAAQAAHw==\
         \n</AppendedData>\n",
    );
    [big, compressed, at_the_end]
}

#[track_caller]
fn assert_reads(bytes: &[u8], expected: &Solid) {
    let file = parse(bytes, Format::Vtp).unwrap();
    assert_eq!(file.positions, expected.positions);
    assert_eq!(file.mesh.triangles(), expected.triangles);
}

#[test]
fn every_way_of_storing_numbers_gives_the_same_mesh() {
    for solid in [tetrahedron(), icosahedron()] {
        assert_reads(ascii(&solid).as_bytes(), &solid);
        assert_reads(ascii(&solid).replace('\n', "\r\n").as_bytes(), &solid);
        assert_reads(&appended_raw(&solid), &solid);
    }
    for text in encoded() {
        assert_reads(text.as_bytes(), &tetrahedron());
    }
}

/// Pieces are concatenated, and polygons are split into triangles as in other formats.
#[test]
fn pieces_and_polygons_become_one_mesh() {
    let piece = |z: f64| {
        format!(
            "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"1\"><Points>\
             <DataArray type=\"Float32\" format=\"ascii\">0 0 {z} 1 0 {z} 1 1 {z} 0 1 {z}</DataArray>\
             </Points><Polys><DataArray type=\"Int8\" Name=\"connectivity\" format=\"ascii\">0 1 2 3\
             </DataArray><DataArray type=\"Int8\" Name=\"offsets\" format=\"ascii\">4</DataArray>\
             </Polys></Piece>"
        )
    };
    let text = format!(
        "<VTKFile type=\"PolyData\"><PolyData>{}{}</PolyData></VTKFile>",
        piece(0.0),
        piece(2.5)
    );
    let file = parse(text.as_bytes(), Format::Vtp).unwrap();
    assert_eq!(
        file.mesh.triangles(),
        [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]
    );
    assert_eq!(file.positions[6], [1.0, 1.0, 2.5]);
}

/// Text of a file, its wrong replacement, and part of the error message.
const WRONG: [[&str; 3]; 19] = [
    [
        "'PolyData'",
        "\"ImageData\"",
        "line 3: expected data of the type PolyData or UnstructuredGrid, found `ImageData`",
    ],
    [
        "version=\"0.1\"",
        "header_type=\"UInt16\"",
        "line 3: expected headers of the type",
    ],
    [
        "version=\"0.1\"",
        "byte_order=\"Middle\"",
        "line 3: expected the byte order",
    ],
    [
        "version=\"0.1\"",
        "compressor=\"vtkOtherDataCompressor\"",
        "a compressor of zlib, LZ4 or LZMA, or none",
    ],
    [
        "NumberOfPoints=\"4\"",
        "NumberOfPoints=\"5\"",
        "ends after 4 of 5 vertices",
    ],
    [
        "NumberOfPoints=\"4\"",
        "",
        "line 5: expected a number of points",
    ],
    [
        "0.1 0.2 0.3",
        "0.1 0.2 z",
        "line 8: expected a number, found `z`",
    ],
    [
        "0.1 0.2 0.3",
        "0.1 inf 0.3",
        "line 8 (vertex 0): coordinate y is inf",
    ],
    [
        "0 2 1\n",
        "0 2 9\n",
        "line 15 (face 0): the face names vertex 9",
    ],
    [
        "0 2 1\n",
        "0 2 -1\n",
        "line 15 (face 0): the face names vertex -1",
    ],
    [
        "0 2 1\n",
        "0 2 2\n",
        "corners 2 and 3 of the face are a repeated vertex",
    ],
    [
        "0 2 1\n",
        "0 2 1.5\n",
        "line 15: expected a whole number, found `1.5`",
    ],
    [
        " 3 6 9 12",
        " 3 6 9 13",
        "(face 3): expected ends of polygons",
    ],
    [
        " 3 6 9 12",
        " 3 6 5 12",
        "(face 2): expected ends of polygons",
    ],
    [
        "type=\"Int32\"",
        "type=\"Float32\"",
        "expected a type of whole numbers",
    ],
    [
        "type=\"Int32\"",
        "type=\"String\"",
        "expected a type of numbers",
    ],
    [
        "format=\"ascii\">\n",
        "format=\"hex\">\n",
        "expected the format ascii, binary or appended, found `hex`",
    ],
    [
        "format=\"ascii\">\n",
        "format=\"appended\" offset=\"0\">\n",
        "expected appended data",
    ],
    [
        "format=\"ascii\">\n",
        "format=\"binary\">\n",
        "expected data as long as their header says",
    ],
];

#[test]
fn wrong_files_say_where_and_what() {
    let text = ascii(&tetrahedron());
    let with = |old: &str, new: &str| {
        assert!(text.contains(old), "{old}");
        message(&text.replacen(old, new, 1))
    };
    for [old, new, hint] in WRONG {
        let found = with(old, new);
        assert!(found.contains(hint), "{new}: {found}");
    }
    assert!(message("<html></html>").contains("expected the tag VTKFile, found `html`"));
    assert!(message("<VTKFile type=\"PolyData\"").contains("expected the end of a tag"));
    assert!(message("<VTKFile type=\"PolyData\"></VTKFile>").contains("it has no triangle"));
}

/// A file that is truncated anywhere, or of which any byte is changed, is a mesh or an error.
#[test]
fn damaged_files_are_errors_or_meshes() {
    let tetrahedron = tetrahedron();
    let [big, compressed, at_the_end] = encoded().map(String::into_bytes);
    let plain = ascii(&tetrahedron).into_bytes();
    for whole in [
        plain,
        appended_raw(&tetrahedron),
        big,
        compressed,
        at_the_end,
    ] {
        for at in 0..whole.len() {
            check_reader(&whole[..at], Format::Vtp);
            for mask in [1, 0x20, 0x80] {
                let mut damaged = whole.clone();
                damaged[at] ^= mask;
                check_reader(&damaged, Format::Vtp);
            }
        }
    }
}

/// Files written by VTK itself, in each of its number formats, are read. They are the seeds of the fuzz
/// target.
#[test]
fn files_of_vtk_are_read() {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fuzz/corpus-seeds/read_vtp"
    );
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        check_reader(&bytes, Format::Vtp);
        let file = parse(&bytes, Format::Vtp).unwrap();
        let corner = |axis: usize, sign: f64| {
            let mut corner = [0.0; 3];
            corner[axis] = sign;
            corner
        };
        let octahedron = (0..3).flat_map(|axis| [1.0, -1.0].map(|sign| corner(axis, sign)));
        assert_eq!(file.positions, Vec::from_iter(octahedron), "{path:?}");
        assert_eq!(file.mesh.triangles().len(), 8, "{path:?}");
        assert!(file.mesh.is_closed(), "{path:?}");
        names.push(path.file_stem().unwrap().to_string_lossy().into_owned());
    }
    names.sort();
    let expected = [
        "appended",
        "appended-lzma",
        "appended-raw",
        "appended-raw-zlib",
        "binary",
        "binary-lz4",
        "binary-zlib",
        "strips",
        "text",
        "text-lz4",
    ];
    assert_eq!(names, expected);
}
