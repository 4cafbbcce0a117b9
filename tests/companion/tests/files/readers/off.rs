//! Contents of OFF files, and messages about broken ones.

use helfrich_std::io::{Format, MeshFile, ParseError, parse};

fn off(text: &str) -> Result<MeshFile, ParseError> {
    parse(text.as_bytes(), Format::Off)
}

#[test]
fn off_variants() {
    let file =
        off("STCNOFF 4 1 0\n# square\n0 0 0 0 0 1 9 9\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n");
    assert_eq!(file.unwrap().mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
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
