//! Contents of OBJ files, and messages about broken ones.

use helfrich_std::io::{Format, MeshFile, ParseError, Problem, parse};
use std::fmt::Write;

fn obj(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Obj)
}

/// Four vertices, and faces from line 5 on.
fn obj_faces(faces: &str) -> Result<MeshFile, ParseError> {
    obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{faces}"))
}

#[test]
fn obj_statements() {
    let text = "mtllib a.mtl\nv 0 0 0 1.0\n  v 1 0 0 0.5 0.5 0.5\nv \\\n 1 1 0 # corner\nvn 0 0 1\n\
                v 0 1 0\nvt 0 0\ng one two\ns off\nf 1/1/1 2//1 \\\r\n3/1 -1\nl 1 2 3\np 1\n";
    let file = obj(text).unwrap();
    assert_eq!(file.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    // Faces may precede their vertices, and negative numbers count back from the last vertex before the face.
    let file = obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 4\nv 1 1 0\n").unwrap();
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [2, 1, 3]]);
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
            obj(
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nf 1 2 3\nf 1 3 4\nf 1 4 5\n#\nf 4 5 6\n",
            ),
            "line 9 (face 3) and line 11 (face 4): triangles 2 and 3 both run from vertex 3 to vertex 4: their orientations contradict each other (triangles and vertices counted from 0)",
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
