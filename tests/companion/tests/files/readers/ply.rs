//! Contents of PLY files, and messages about broken ones.

use super::solid::tetrahedron;
use helfrich_std::io::{Format, MeshFile, ParseError, parse};

fn ply(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Ply)
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

const VERTEX: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const FACE: &str = "element face 1\nproperty list uchar int vertex_indices\n";
const POINTS: &str = "0 0 0\n1 0 0\n0 1 0\n";

fn declared(declarations: &str, body: &str) -> Result<MeshFile, ParseError> {
    ply(&format!(
        "ply\nformat ascii 1.0\n{declarations}end_header\n{body}"
    ))
}

#[test]
fn bad_ply_headers() {
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
            declared("property float x\n", ""),
            "line 3: expected `element` first, found `property`",
        ),
        (
            declared("element vertex -1\n", ""),
            "line 3: expected the number of elements, found `-1`",
        ),
        (
            declared("element vertex 1\nproperty quad x\n", ""),
            "line 4: expected a type such as float, double, uchar or int, found `quad`",
        ),
        (
            declared(
                "element face 1\nproperty list uchar float vertex_index\n",
                "",
            ),
            "line 4: expected an integer type such as uchar or int, found `float`",
        ),
        (
            declared(FACE, ""),
            "line 5: the header declares no element `vertex`",
        ),
        (
            declared(VERTEX, POINTS),
            "line 7: the header declares no element `face`",
        ),
        (
            declared(&format!("{VERTEX}element face 1\n"), POINTS),
            "line 8: the header declares no property `list … vertex_indices` of element `face`",
        ),
        (
            declared(
                &format!("{FACE}element vertex 1\nproperty int x\nproperty int z\n"),
                "",
            ),
            "line 8: the header declares no property `y` of element `vertex`",
        ),
    ] {
        assert_eq!(result.unwrap_err().to_string(), message);
    }
}

#[test]
fn bad_ply_bodies() {
    let mesh = |body: &str| declared(&format!("{VERTEX}{FACE}"), body);
    for (result, message) in [
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
            mesh(POINTS),
            "line 12: the file is truncated: it ends after 0 of 1 faces",
        ),
        (
            mesh(&format!("{POINTS}3 0 1\n")),
            "line 13 (face 0): expected a vertex number from 0 to 4294967295, found the end of the line",
        ),
        (
            mesh(&format!("{POINTS}3 0 1 -2\n")),
            "line 13 (face 0): expected a vertex number from 0 to 4294967295, found `-2`",
        ),
        (
            mesh(&format!("{POINTS}3 0 1 3\n")),
            "line 13 (face 0): the face names vertex 3, but there are 3 vertices, numbered from 0",
        ),
        (
            mesh(&format!("{POINTS}-3 0 1 2\n")),
            "line 13 (face 0): expected a list's length, found `-3`",
        ),
        (
            mesh(&format!("{POINTS}3 0 1 2\n3 2 1 0\n")),
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
    // A vertex takes 30 bytes, the element between vertices and faces 4, a face 17.
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

/// Plain records, as in nearly all files, which are read many at a time.
struct Plain {
    big: bool,
    double: bool,
    points: Vec<[f64; 3]>,
    faces: Vec<Vec<i32>>,
}

impl Plain {
    fn octahedron(big: bool, double: bool) -> Self {
        let point = |k: usize| {
            let mut point = [0.0; 3];
            point[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            point
        };
        let faces = [
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        Self {
            big,
            double,
            points: (0..6).map(point).collect(),
            faces: faces.iter().map(|face| face.to_vec()).collect(),
        }
    }

    fn header(&self) -> String {
        let order = if self.big { "big" } else { "little" };
        let kind = if self.double { "double" } else { "float" };
        format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex {}\nproperty {kind} x\nproperty {kind} \
             y\nproperty uchar red\nproperty {kind} z\nelement face {}\nproperty list uchar int \
             vertex_indices\nend_header\n",
            self.points.len(),
            self.faces.len()
        )
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.header().into_bytes();
        let mut push = |number: &[u8]| {
            if self.big {
                bytes.extend(number.iter().rev());
            } else {
                bytes.extend(number);
            }
        };
        for &[x, y, z] in &self.points {
            for (axis, x) in [x, y, z].into_iter().enumerate() {
                if axis == 2 {
                    push(&[7]);
                }
                if self.double {
                    push(&x.to_le_bytes());
                } else {
                    push(&(x as f32).to_le_bytes());
                }
            }
        }
        for face in &self.faces {
            push(&[face.len() as u8]);
            face.iter().for_each(|vertex| push(&vertex.to_le_bytes()));
        }
        bytes
    }

    /// Byte offset of a vertex, or of the first face if `vertex` is the number of vertices.
    fn vertex(&self, vertex: usize) -> usize {
        let coordinate = if self.double { 8 } else { 4 };
        self.header().len() + vertex * (3 * coordinate + 1)
    }

    fn face(&self, face: usize) -> usize {
        let before = self.faces[..face].iter().map(|face| 1 + 4 * face.len());
        self.vertex(self.points.len()) + before.sum::<usize>()
    }
}

/// Plain records give the same mesh as records after one that is not plain, and errors name their byte
/// offsets.
#[test]
fn plain_records_are_read_as_others() {
    for (big, double) in [(false, false), (false, true), (true, false), (true, true)] {
        let solid = Plain::octahedron(big, double);
        let expected = parse(&solid.bytes(), Format::Ply).unwrap();
        assert_eq!(expected.positions, solid.points);
        let faces = expected.mesh.triangles().iter();
        let faces = faces.map(|triangle| triangle.map(|vertex| vertex as i32).to_vec());
        assert_eq!(Vec::from_iter(faces), solid.faces);

        // The triangles (2, 1, 4) and (1, 3, 4) together are the quadrilateral (2, 1, 3, 4), which the reader
        // cuts along the other diagonal.
        let mut with_quad = Plain::octahedron(big, double);
        with_quad.faces.splice(1..3, [vec![4, 2, 1, 3]]);
        let found = parse(&with_quad.bytes(), Format::Ply).unwrap();
        let mut triangles = expected.mesh.triangles().to_vec();
        triangles.splice(1..3, [[4, 2, 1], [4, 1, 3]]);
        assert_eq!(found.mesh.triangles(), triangles);

        type Change = fn(&mut Plain);
        let changes: [(Change, usize, &str); 6] = [
            (
                |solid| solid.points[3][1] = f64::INFINITY,
                solid.vertex(3) + if double { 8 } else { 4 },
                "(vertex 3): coordinate y is inf: a finite number is needed",
            ),
            (
                |solid| solid.faces[5] = vec![1, 2, 2],
                solid.face(5),
                "(face 5): corners 2 and 3 of the face are a repeated vertex: all have to differ",
            ),
            (
                |solid| solid.faces[5][1] = -1,
                solid.face(5) + 9,
                "(face 5): expected a vertex number from 0 to 4294967295, found -1",
            ),
            (
                |solid| solid.faces[5][2] = 6,
                solid.face(5),
                "(face 5): the face names vertex 6, but there are 6 vertices, numbered from 0",
            ),
            (
                |solid| solid.faces[6].truncate(2),
                solid.face(6),
                "(face 6): a face of 2 corners: three or more are needed",
            ),
            (
                |solid| solid.faces[7].swap(0, 1),
                solid.face(4),
                "(face 4) and byte",
            ),
        ];
        for (change, byte, message) in changes {
            let mut solid = Plain::octahedron(big, double);
            change(&mut solid);
            let error = parse(&solid.bytes(), Format::Ply).unwrap_err().to_string();
            let expected = format!("byte {byte} {message}");
            assert!(error.starts_with(&expected), "{error}\n{expected}");
        }
        let bytes = solid.bytes();
        let error = parse(&bytes[..solid.face(6) + 4], Format::Ply).unwrap_err();
        let message = format!(
            "byte {}: the file is truncated: it ends after 6 of 8 faces",
            solid.face(6) + 1
        );
        assert_eq!(error.to_string(), message);
    }
}
