//! Mesh files: what is read, and what is said about files that are no mesh.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use helfrich_std::io::{Format, MeshFile, ParseError, Problem, parse, read};

/// A closed mesh as plain lists.
struct Solid {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// With coordinates that need all digits of an `f64`.
fn tetrahedron() -> Solid {
    Solid {
        positions: vec![
            [0.1, 0.2, 0.3],
            [1.0 + f64::EPSILON, 0.0, -1e-300],
            [0.0, 1.0 / 3.0, 0.0],
            [0.0, 0.0, 12_345.678_901_234_5],
        ],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

fn icosahedron() -> Solid {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for [a, b] in [
        [1.0, golden],
        [1.0, -golden],
        [-1.0, golden],
        [-1.0, -golden],
    ] {
        positions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    // The faces are the triples with all edges of length 2, turned outwards.
    let mut triangles = Vec::new();
    let distance = |i: usize, j: usize| {
        let squares = (0..3).map(|k| (positions[i][k] - positions[j][k]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let lengths = [distance(i, j), distance(j, k), distance(k, i)];
                if lengths.iter().all(|length| (length - 2.0).abs() < 1e-9) {
                    let [a, b, c] = [positions[i], positions[j], positions[k]];
                    let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
                        + a[1] * (b[2] * c[0] - b[0] * c[2])
                        + a[2] * (b[0] * c[1] - b[1] * c[0]);
                    let [i, j, k] = [i as u32, j as u32, k as u32];
                    triangles.push(if determinant > 0.0 {
                        [i, j, k]
                    } else {
                        [i, k, j]
                    });
                }
            }
        }
    }
    Solid {
        positions,
        triangles,
    }
}

impl Solid {
    fn obj(&self) -> String {
        let mut text = "# a comment\no solid\n".to_owned();
        for [x, y, z] in &self.positions {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        text
    }

    fn off(&self) -> String {
        let mut text = format!("OFF\n{} {} 0\n", self.positions.len(), self.triangles.len());
        for [x, y, z] in &self.positions {
            writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c}").unwrap();
        }
        text
    }

    fn stl(&self) -> String {
        let mut text = "solid a name\n".to_owned();
        for triangle in &self.triangles {
            text += "facet normal 0 0 0\n  outer loop\n";
            for &vertex in triangle {
                let [x, y, z] = self.positions[vertex as usize];
                writeln!(text, "    vertex {x:?} {y:?} {z:?}").unwrap();
            }
            text += "  endloop\nendfacet\n";
        }
        text + "endsolid a name\n"
    }

    fn binary_stl(&self) -> Vec<u8> {
        let mut bytes = b"solid, although binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for triangle in &self.triangles {
            bytes.extend([0; 12]);
            for &vertex in triangle {
                for coordinate in self.positions[vertex as usize] {
                    bytes.extend((coordinate as f32).to_le_bytes());
                }
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn ply_header(&self, encoding: &str) -> String {
        format!(
            "ply\nformat {encoding} 1.0\ncomment C:\\dir\\\n\
             element vertex {}\nproperty uchar red\nproperty double z\nproperty double x\n\
             property list uchar short weights\nproperty double y\n\
             element material 1\nproperty int shininess\n\
             element face {}\nproperty list uchar int vertex_indices\nproperty float quality\n\
             end_header\n",
            self.positions.len(),
            self.triangles.len()
        )
    }

    fn ply(&self) -> String {
        let mut text = self.ply_header("ascii");
        for [x, y, z] in &self.positions {
            writeln!(text, "255 {z:?} {x:?} 2 7 8 {y:?}").unwrap();
        }
        text += "90\n";
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c} 0.5").unwrap();
        }
        text
    }

    fn binary_ply(&self, big: bool) -> Vec<u8> {
        let encoding = if big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let mut bytes = self.ply_header(encoding).into_bytes();
        let mut put = |number: &[u8]| {
            if big {
                bytes.extend(number.iter().rev());
            } else {
                bytes.extend(number);
            }
        };
        for [x, y, z] in &self.positions {
            put(&[255]);
            put(&z.to_le_bytes());
            put(&x.to_le_bytes());
            put(&[2]);
            put(&7i16.to_le_bytes());
            put(&8i16.to_le_bytes());
            put(&y.to_le_bytes());
        }
        put(&90i32.to_le_bytes());
        for triangle in &self.triangles {
            put(&[3]);
            for vertex in triangle {
                put(&vertex.to_le_bytes());
            }
            put(&0.5f32.to_le_bytes());
        }
        bytes
    }
}

/// What `solid` becomes when corners are numbered as they first appear, as STL readers do.
fn in_order_of_appearance(solid: &Solid, round: impl Fn(f64) -> f64) -> Solid {
    let mut order = Vec::new();
    for vertex in solid.triangles.iter().flatten() {
        if !order.contains(vertex) {
            order.push(*vertex);
        }
    }
    let number = |vertex| order.iter().position(|&v| v == vertex).unwrap() as u32;
    Solid {
        positions: order
            .iter()
            .map(|&vertex| solid.positions[vertex as usize].map(&round))
            .collect(),
        triangles: solid.triangles.iter().map(|t| t.map(number)).collect(),
    }
}

#[track_caller]
fn assert_reads(bytes: &[u8], format: Format, expected: &Solid) {
    let file = parse(bytes, format).unwrap();
    assert_eq!(file.positions, expected.positions);
    assert_eq!(file.mesh.triangles(), expected.triangles);
    assert!(file.mesh.is_closed());
    assert_eq!(file.mesh.euler_characteristic(), 2);
}

#[test]
fn every_format_gives_the_same_mesh_with_all_digits() {
    for solid in [tetrahedron(), icosahedron()] {
        assert_reads(solid.obj().as_bytes(), Format::Obj, &solid);
        assert_reads(solid.off().as_bytes(), Format::Off, &solid);
        assert_reads(solid.ply().as_bytes(), Format::Ply, &solid);
        assert_reads(&solid.binary_ply(false), Format::Ply, &solid);
        assert_reads(&solid.binary_ply(true), Format::Ply, &solid);
        let welded = in_order_of_appearance(&solid, |x| x);
        assert_reads(solid.stl().as_bytes(), Format::Stl, &welded);
        let rounded = in_order_of_appearance(&solid, |x| f64::from(x as f32));
        assert_reads(&solid.binary_stl(), Format::Stl, &rounded);
    }
}

#[test]
fn line_ends_of_windows_change_nothing() {
    let solid = tetrahedron();
    for (text, format) in [
        (solid.obj(), Format::Obj),
        (solid.off(), Format::Off),
        (solid.stl(), Format::Stl),
        (solid.ply(), Format::Ply),
    ] {
        let windows = text.replace('\n', "\r\n");
        let without_last = text.trim_end();
        let expected = parse(text.as_bytes(), format);
        assert!(expected.is_ok());
        assert_eq!(parse(windows.as_bytes(), format), expected);
        assert_eq!(parse(without_last.as_bytes(), format), expected);
    }
    let mut bytes = solid
        .ply_header("binary_little_endian")
        .replace('\n', "\r\n")
        .into_bytes();
    let header = solid.ply_header("binary_little_endian").len();
    bytes.extend(&solid.binary_ply(false)[header..]);
    assert_reads(&bytes, Format::Ply, &solid);
}

fn obj(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Obj)
}

fn off(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Off)
}

fn stl(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Stl)
}

fn ply(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Ply)
}

#[test]
fn obj_statements() {
    let text = "mtllib a.mtl\nv 0 0 0 1.0\n  v 1 0 0 0.5 0.5 0.5\nv \\\n 1 1 0 # corner\nvn 0 0 1\n\
                v 0 1 0\nvt 0 0\ng one two\ns off\nf 1/1/1 2//1 \\\r\n3/1 -1\nl 1 2 3\np 1\n";
    let file = obj(text).unwrap();
    assert_eq!(file.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    // Faces may come before their vertices, and negative numbers count back from where they stand.
    let file = obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 4\nv 1 1 0\n").unwrap();
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [2, 1, 3]]);
}

#[test]
fn off_variants() {
    let file =
        off("STCNOFF 4 1 0\n# square\n0 0 0 0 0 1 9 9\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n");
    assert_eq!(file.unwrap().mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn negative_zero_is_welded_with_zero() {
    let facet = |a: &str, b: &str, c: &str| {
        format!(
            "FACET normal 0 0 1\nOUTER LOOP\nVERTEX {a}\nVERTEX {b}\nvertex {c}\nENDLOOP\nENDFACET\n"
        )
    };
    let text = format!(
        "solid\n{}endsolid\nsolid second\n{}endsolid second\n",
        facet("-0 0 0", "1 0 0", "1 1 0"),
        facet("0 -0.0 0", "1 1 0", "0 1 0")
    );
    let file = stl(&text).unwrap();
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert!(
        file.positions
            .iter()
            .flatten()
            .all(|x| x.is_sign_positive())
    );
}

#[test]
fn ply_with_integer_coordinates_and_quads() {
    let text = "ply\nformat ascii 1.0\nobj_info none\nelement nothing 99999999999\n\
                element face 1\nproperty list uchar uint vertex_index\nelement vertex 4\n\
                property int x\nproperty int y\nproperty int z\nend_header\n\
                4 0 1 2 3\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n";
    let file = ply(text).unwrap();
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(file.positions[1], [2.0, 0.0, 0.0]);
}

/// Four vertices and, on lines 5 and following, faces.
fn obj_faces(faces: &str) -> Result<MeshFile, ParseError> {
    obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{faces}"))
}

#[test]
fn bad_obj_files() {
    for (result, message) in [
        (obj(""), "the file is empty"),
        (
            obj("\n# nothing\n"),
            "the mesh is empty: it has no triangle",
        ),
        (obj("v 0 0 0\n"), "the mesh is empty: it has no triangle"),
        (
            obj("\n\u{1}\u{2} 7\n"),
            r"line 2: expected an OBJ keyword such as v or f, found `\u{1}\u{2}`",
        ),
        (
            obj("v 0 0 0\nv 1 nan 0\n"),
            "line 2 (vertex 2): coordinate y is `nan`: a finite number is needed",
        ),
        (
            obj("v 0 0 -inf\n"),
            "line 1 (vertex 1): coordinate z is `-inf`: a finite number is needed",
        ),
        (
            obj("v 1e999 0 0\n"),
            "line 1 (vertex 1): coordinate x is `1e999`: a finite number is needed",
        ),
        (
            obj("v 0 0\nv 1 0 0\n"),
            "line 1 (vertex 1): expected coordinate z, found the end of the line",
        ),
        (
            obj("v 0 0 0x\n"),
            "line 1 (vertex 1): expected coordinate z, found `0x`",
        ),
        (
            obj_faces("f 1 2 5\n"),
            "line 5 (face 1): the face names vertex 5, but there are 4 vertices, numbered from 1",
        ),
        (
            obj_faces("f 1 3 2\nf 1 2 -5\n"),
            "line 6 (face 2): the face names vertex -5, but there are 4 vertices, numbered from 1",
        ),
        (
            obj_faces("f 1 2 0\n"),
            "line 5 (face 1): the face names vertex 0, but there are 4 vertices, numbered from 1",
        ),
        (
            obj_faces("f 1 2 4294967297\n"),
            "line 5 (face 1): expected a vertex number from 1 to 4294967296, or from -1 downwards, found `4294967297`",
        ),
        (
            obj_faces("f 1 /2 3\n"),
            "line 5 (face 1): expected a vertex number from 1 to 4294967296, or from -1 downwards, found `/2`",
        ),
        (
            obj_faces("f 1 2\n"),
            "line 5 (face 1): a face of 2 corners: three or more are needed",
        ),
        (
            obj_faces("f 1 2 1\n"),
            "line 5 (face 1): corners 1 and 3 of the face are a repeated vertex: all have to differ",
        ),
        (
            obj_faces("f 1 2 3 4 2\n"),
            "line 5 (face 1): corners 2 and 5 of the face are a repeated vertex: all have to differ",
        ),
        (
            obj_faces("f 1 3 2\n\nf 1 3 4\n"),
            "line 5 (face 1) and line 7 (face 2): triangles 0 and 1 both run from vertex 0 to vertex 2: their orientations contradict each other (triangles and vertices counted from 0)",
        ),
        (
            obj_faces("f 1 2 3\nf 3 2 1\n"),
            "line 5 (face 1) and line 6 (face 2): triangles 0 and 1 have the same three vertices (triangles and vertices counted from 0)",
        ),
        (
            obj_faces("v 1 1 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"),
            "line 8 (face 3): 3 triangles meet in the edge between vertices 0 and 1, triangle 2 among them: a surface has at most two (triangles and vertices counted from 0)",
        ),
        (
            obj_faces("v 1 1 1\nf 1 2 3\nf 1 4 5\n"),
            "line 6 (face 1) and line 7 (face 2): the triangles at vertex 0 form 2 separate fans (a bow-tie), triangles 0 and 1 in different ones: a surface has one (triangles and vertices counted from 0)",
        ),
    ] {
        assert_eq!(result.unwrap_err().to_string(), message);
    }
}

#[test]
fn bad_off_files() {
    for (result, message) in [
        (
            off("4OFF\n"),
            "line 1: expected the header OFF, COFF, NOFF or STOFF, found `4OFF`",
        ),
        (
            off("# only\n"),
            "line 1: expected the header OFF, COFF, NOFF or STOFF, found the end of the file",
        ),
        (
            off("OFF\nmany 1 0\n"),
            "line 2: expected the number of vertices, found `many`",
        ),
        (
            off("OFF 3\n"),
            "line 1: expected the number of faces, found the end of the line",
        ),
        (
            off("OFF\n3 1 0\n0 0 0\n1 0 0\n"),
            "line 4: the file is truncated: it ends after 2 of 3 vertices",
        ),
        (
            off("OFF 18446744073709551615 1 0\n0 0 0"),
            "line 2: the file is truncated: it ends after 1 of 18446744073709551615 vertices",
        ),
        (
            off("OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "line 5: the file is truncated: it ends after 1 of 2 faces",
        ),
        (
            off("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 NaN\n3 0 1 2\n"),
            "line 4 (vertex 2): coordinate z is `NaN`: a finite number is needed",
        ),
        (
            off("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "line 5 (face 0): the face names vertex 3, but there are 3 vertices, numbered from 0",
        ),
        (
            off("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n99999 0 1 2\n"),
            "line 5 (face 0): expected a vertex number from 0 to 4294967295, found the end of the line",
        ),
        (
            off("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\nx 0 1 2\n"),
            "line 5 (face 0): expected the number of a face's corners, found `x`",
        ),
        (
            off("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n"),
            "line 6: expected the end of the file, found `3`",
        ),
        (off("OFF 0 0 0\n"), "the mesh is empty: it has no triangle"),
    ] {
        assert_eq!(result.unwrap_err().to_string(), message);
    }
}

#[test]
fn bad_stl_files() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    for (result, message) in [
        (
            stl("salad\n"),
            "line 1: expected `solid` (or a binary STL file), found `salad`",
        ),
        (
            stl("solid\nendsolid\n"),
            "the mesh is empty: it has no triangle",
        ),
        (
            stl(&format!("solid\n{facet}")),
            "line 8: expected `facet` or `endsolid`, found the end of the file",
        ),
        (
            stl("solid\nfacet\nouter loop\nvertex 0 0 0\n"),
            "line 4: expected `vertex`, found the end of the file",
        ),
        (
            stl("solid\nfacet\nouter loop\nvertex 0 0 1e400\n"),
            "line 4 (face 0): coordinate z is `1e400`: a finite number is needed",
        ),
        (
            stl("solid\nfacet\nouter loop\nvertex 0 0 0\nendloop\n"),
            "line 5: expected `vertex`, found `endloop`",
        ),
        (
            stl(&format!("solid\n{}", facet.replace("0 1 0", "1 -0 0"))),
            "line 2 (face 0): corners 2 and 3 of the face are a repeated vertex: all have to differ",
        ),
        (
            stl(&format!("solid\n{facet}{facet}endsolid\n")),
            "line 2 (face 0) and line 9 (face 1): triangles 0 and 1 have the same three vertices (triangles and vertices counted from 0)",
        ),
        (
            stl(&format!("solid\n{facet}endsolid\nx\n")),
            "line 10: expected `solid` or the end of the file, found `x`",
        ),
    ] {
        assert_eq!(result.unwrap_err().to_string(), message);
    }
    let good = tetrahedron().binary_stl();
    let mut nan = good.clone();
    nan[84 + 50 + 16..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut degenerate = good.clone();
    degenerate.copy_within(84 + 12..84 + 24, 84 + 36);
    for (bytes, message) in [
        (
            &good[..200],
            "a binary STL file of 4 faces has 284 bytes, but there are 200: it is truncated or damaged",
        ),
        (
            &nan,
            "byte 134 (face 1): coordinate y is NaN: a finite number is needed",
        ),
        (
            &degenerate,
            "byte 84 (face 0): corners 1 and 3 of the face are a repeated vertex: all have to differ",
        ),
    ] {
        let error = parse(bytes, Format::Stl).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}

#[test]
fn bad_ply_files() {
    let vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    let with = |declarations: &str, body: &str| {
        ply(&format!(
            "ply\nformat ascii 1.0\n{declarations}end_header\n{body}"
        ))
    };
    let mesh = |body: &str| with(&format!("{vertex}{face}"), body);
    for (result, message) in [
        (
            ply("plx\n"),
            "line 1: expected the header `ply`, found `plx`",
        ),
        (
            ply("ply\nelement\n"),
            "line 2: expected `format`, found `element`",
        ),
        (
            ply("ply\nformat binary 1.0\n"),
            "line 2: expected ascii, binary_little_endian or binary_big_endian, found `binary`",
        ),
        (
            ply("ply\nformat ascii 1.0\nelement vertex 3\n"),
            "line 3: expected `element`, `property`, `comment` or `end_header`, found the end of the file",
        ),
        (
            with("property float x\n", ""),
            "line 3: expected `element` first, found `property`",
        ),
        (
            with("element vertex -1\n", ""),
            "line 3: expected the number of elements, found `-1`",
        ),
        (
            with("element vertex 1\nproperty quad x\n", ""),
            "line 4: expected a type such as float, double, uchar or int, found `quad`",
        ),
        (
            with(
                "element face 1\nproperty list uchar float vertex_index\n",
                "",
            ),
            "line 4: expected an integer type such as uchar or int, found `float`",
        ),
        (
            with(face, ""),
            "line 5: the header declares no element `vertex`",
        ),
        (
            with(vertex, points),
            "line 7: the header declares no element `face`",
        ),
        (
            with(&format!("{vertex}element face 1\n"), points),
            "line 8: the header declares no property `list … vertex_indices` of element `face`",
        ),
        (
            with(
                &format!("{face}element vertex 1\nproperty int x\nproperty int z\n"),
                "",
            ),
            "line 8: the header declares no property `y` of element `vertex`",
        ),
        (
            mesh("0 0 0\n1 0\n"),
            "line 11 (vertex 1): expected coordinate z, found the end of the line",
        ),
        (
            mesh("0 0 0\n1 0 0 0\n"),
            "line 11 (vertex 1): expected the end of the line, found `0`",
        ),
        (
            mesh("0 0 0\n"),
            "line 10: the file is truncated: it ends after 1 of 3 vertices",
        ),
        (
            mesh(points),
            "line 12: the file is truncated: it ends after 0 of 1 faces",
        ),
        (
            mesh(&format!("{points}3 0 1\n")),
            "line 13 (face 0): expected a vertex number from 0 to 4294967295, found the end of the line",
        ),
        (
            mesh(&format!("{points}3 0 1 -2\n")),
            "line 13 (face 0): expected a vertex number from 0 to 4294967295, found `-2`",
        ),
        (
            mesh(&format!("{points}3 0 1 3\n")),
            "line 13 (face 0): the face names vertex 3, but there are 3 vertices, numbered from 0",
        ),
        (
            mesh(&format!("{points}-3 0 1 2\n")),
            "line 13 (face 0): expected a list's length, found `-3`",
        ),
        (
            mesh(&format!("{points}3 0 1 2\n3 2 1 0\n")),
            "line 14: expected the end of the file, found `3`",
        ),
    ] {
        assert_eq!(result.unwrap_err().to_string(), message);
    }
}

#[test]
fn bad_binary_ply_files() {
    let solid = tetrahedron();
    let good = solid.binary_ply(false);
    let header = solid.ply_header("binary_little_endian").len();
    // A vertex takes 30 bytes, the material 4, a face 17.
    let faces = header + 4 * 30 + 4;
    let mut infinite = good.clone();
    infinite[header + 30 + 9..][..8].copy_from_slice(&f64::INFINITY.to_le_bytes());
    let mut out_of_range = good.clone();
    out_of_range[faces + 17 + 5] = 9;
    let mut negative = good.clone();
    negative[faces + 17 + 4] = 255;
    let mut longer = good.clone();
    longer.extend([1, 2, 3]);
    for (bytes, message) in [
        (
            &good[..header + 40],
            format!(
                "byte {}: the file is truncated: it ends after 1 of 4 vertices",
                header + 39
            ),
        ),
        (
            &good[..good.len() - 20],
            format!(
                "byte {}: the file is truncated: it ends after 2 of 4 faces",
                faces + 2 * 17 + 13
            ),
        ),
        (
            &infinite,
            format!(
                "byte {} (vertex 1): coordinate x is inf: a finite number is needed",
                header + 39
            ),
        ),
        (
            &out_of_range,
            format!(
                "byte {} (face 1): the face names vertex 9, but there are 4 vertices, numbered from 0",
                faces + 17
            ),
        ),
        (
            &negative,
            format!(
                "byte {} (face 1): expected a vertex number from 0 to 4294967295, found -16777216",
                faces + 17 + 5
            ),
        ),
        (
            &longer,
            format!(
                "byte {}: expected the end of the file, found 3 bytes more",
                good.len()
            ),
        ),
    ] {
        let error = parse(bytes, Format::Ply).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}

/// Every prefix of a good file is a mesh or an error, never a panic.
#[test]
fn truncation_anywhere_is_an_error() {
    let solid = tetrahedron();
    for (bytes, format) in [
        (solid.binary_ply(true), Format::Ply),
        (solid.binary_stl(), Format::Stl),
        (solid.ply().trim_end().into(), Format::Ply),
    ] {
        for length in 0..bytes.len() {
            // A last number that lost digits is still a number.
            let lost = bytes.len() - length;
            assert!(
                parse(&bytes[..length], format).is_err() || lost < 3,
                "{format:?} {length}"
            );
        }
    }
}

#[test]
fn a_polygon_of_many_corners_takes_linear_time() {
    let corners = 200_000;
    let mut text = String::new();
    for _ in 0..corners {
        text += "v 0 0 0\n";
    }
    text += "f";
    for corner in 1..=corners {
        write!(text, " {corner}").unwrap();
    }
    let file = obj(&text).unwrap();
    assert_eq!(file.mesh.triangles().len(), corners - 2);
}

fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn the_extension_or_the_first_word_tells_the_format() {
    let solid = tetrahedron();
    for (name, bytes) in [
        ("upper.OBJ", solid.obj().into_bytes()),
        ("cell.off", solid.off().into_bytes()),
        ("binary.Stl", solid.binary_stl()),
        ("binary.ply", solid.binary_ply(true)),
        ("sniffed", solid.off().into_bytes()),
        ("sniffed.ply.tmp", solid.ply().into_bytes()),
        ("sniffed.mesh", solid.stl().into_bytes()),
    ] {
        let mesh = read(&file(name, &bytes)).unwrap().mesh;
        assert_eq!(mesh.triangles().len(), 4, "{name}");
    }
}

#[test]
fn messages_are_one_line_that_starts_with_the_file() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let missing = folder.join("missing.obj");
    let unknown = file("cell.xyz", b"0 0 0\n");
    let broken = file("broken.off", b"OFF 1 1 0\n0 0 z\n");
    for (path, message) in [
        (missing.as_path(), "there is no such file"),
        (folder, "is a directory: a mesh file is needed"),
        (
            &unknown,
            "unknown format: .obj, .off, .stl and .ply files can be read",
        ),
        (
            &broken,
            "line 2 (vertex 0): expected coordinate z, found `z`",
        ),
    ] {
        let error = read(path).unwrap_err().to_string();
        assert_eq!(error, format!("{}: {message}", path.display()));
    }
}

#[test]
fn problems_can_be_matched() {
    let error = obj_faces("f 1 2 5\n").unwrap_err();
    assert!(matches!(
        error.problem,
        Problem::VertexOutOfRange {
            vertex: 5,
            vertices: 4,
            first: 1
        }
    ));
}
