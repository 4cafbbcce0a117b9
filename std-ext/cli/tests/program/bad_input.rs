//! Files that are no meshes, or bad ones.

use crate::fixture::{Fixture, obj, sheet};
use crate::{fail, is_empty, text};
use tempfile::TempDir;

/// The messages about a file are one line that names it, and have these parts.
#[track_caller]
fn is_refused(name: &str, content: Vec<u8>, hints: &[&str]) {
    let file = Fixture::new(name, content);
    let csv = file.beside("out.csv");
    for arguments in [
        &["info", file.path()][..],
        &["curvature", file.path(), "--csv", text(&csv)],
    ] {
        let message = fail(2, arguments);
        assert!(
            message.starts_with(&format!("error: {}", file.path())),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.ends_with('\n'));
        for hint in hints {
            assert!(message.contains(hint), "{name}: no {hint:?} in {message}");
        }
    }
    assert_eq!(file.names(), [name]);
}

#[test]
fn bad_files_get_one_line_that_names_the_place() {
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\n";
    let faces = |faces: &str| format!("{points}{faces}").into_bytes();
    let mut binary_stl = vec![0; 84];
    binary_stl[80] = 9;
    for (name, content, hints) in [
        (
            "garbage.obj",
            b"\x7fELF\x00\xff\xfe\n\x01".to_vec(),
            &[][..],
        ),
        ("garbage.off", b"\x7fELF\x00\xff\xfe".to_vec(), &["line 1"]),
        ("garbage.stl", b"garbage".to_vec(), &["line 1", "solid"]),
        ("garbage.ply", b"garbage".to_vec(), &["line 1", "ply"]),
        ("truncated.stl", binary_stl, &["9 faces", "84"]),
        (
            "truncated.off",
            b"OFF\n4 4 0\n0 0 0\n".to_vec(),
            &["truncated", "line 3"],
        ),
        ("empty.obj", vec![], &["empty"]),
        ("empty.stl", vec![], &["empty"]),
        ("no-faces.obj", points.as_bytes().to_vec(), &["triangle"]),
        ("no-faces.off", b"OFF\n0 0 0\n".to_vec(), &["triangle"]),
        (
            "mesh.mesh",
            b"MeshVersionFormatted 2\n".to_vec(),
            &["unknown format"],
        ),
        ("unnamed", b"".to_vec(), &["unknown format"]),
        (
            "nan.obj",
            b"v 0 0 nan\n".to_vec(),
            &["line 1", "vertex 1", "coordinate z", "nan"],
        ),
        (
            "huge.obj",
            b"v 0 1e999 0\n".to_vec(),
            &["line 1", "coordinate y"],
        ),
        (
            "word.obj",
            b"v 0 0 x\n".to_vec(),
            &["line 1", "vertex 1", "`x`"],
        ),
        (
            "far.obj",
            faces("f 1 2 9\n"),
            &["line 6", "face 1", "vertex 9", "5 vertices"],
        ),
        (
            "zero.obj",
            faces("f 1 2 0\n"),
            &["line 6", "face 1", "vertex 0"],
        ),
        (
            "repeated.obj",
            faces("f 1 2 3\nf 1 4 4\n"),
            &["line 7", "face 2", "repeated"],
        ),
        (
            "twice.obj",
            faces("f 1 2 3\nf 2 3 1\n"),
            &["line 6", "line 7"],
        ),
        (
            "inconsistent.obj",
            faces("f 1 2 3\nf 1 2 4\n"),
            &["line 6", "line 7", "orient"],
        ),
        (
            "three-sided.obj",
            faces("f 1 2 3\nf 2 1 4\nf 1 2 5\n"),
            &["line 8", "3 triangles meet"],
        ),
        (
            "bow-tie.obj",
            format!("{points}v 2 2 2\nf 1 2 3\nf 1 5 6\n").into_bytes(),
            &["line 7", "line 8", "vertex 0"],
        ),
        (
            "huge.off",
            b"OFF\n4000000000 4000000000 0\n".to_vec(),
            &["truncated"],
        ),
    ] {
        is_refused(name, content, hints);
    }
}

#[test]
fn missing_files_and_folders_are_bad_input() {
    let folder = TempDir::new().unwrap();
    let missing = folder.path().join("missing.obj");
    assert!(fail(2, &["info", text(&missing)]).contains("no such file"));
    assert!(fail(2, &["info", text(folder.path())]).contains("directory"));
    assert!(is_empty(&folder));
}

#[test]
fn what_does_not_fit_into_f32_is_bad_input() {
    let (mut positions, triangles) = sheet();
    positions[3][1] = 1e300;
    let file = Fixture::new("far.obj", obj(&positions, &triangles));
    let message = fail(2, &["curvature", file.path(), "--scalar", "f32"]);
    for hint in [file.path(), "coordinate y", "vertex 3", "f32"] {
        assert!(message.contains(hint), "{message}");
    }
}
