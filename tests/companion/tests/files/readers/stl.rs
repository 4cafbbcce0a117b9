//! Contents of STL files, and messages about broken ones.

use super::solid::tetrahedron;
use helfrich_std::io::{Format, MeshFile, ParseError, parse};

fn stl(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Stl)
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
            stl(&format!(
                "solid\n{}endsolid\n",
                facet.replace("0 1 0", "1 -0 0")
            )),
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

/// Bytes after the last face are skipped, unless they are faces that the header does not count.
#[test]
fn bytes_after_the_faces_are_skipped() {
    let good = tetrahedron().binary_stl();
    let expected = parse(&good, Format::Stl).unwrap();
    for after in [&b"\r\n"[..], &[7; 49], &[7; 51], &[0; 50], &[0; 500]] {
        let longer = [&good[..], after].concat();
        assert_eq!(parse(&longer, Format::Stl).unwrap(), expected);
    }
    for count in [0, 3, 5] {
        let mut miscounted = good.clone();
        miscounted[80] = count;
        let error = parse(&miscounted, Format::Stl).unwrap_err().to_string();
        assert!(error.contains("there are 284: it is truncated or damaged"));
    }
}
