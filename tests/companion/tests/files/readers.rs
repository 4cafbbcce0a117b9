//! Mesh files: their contents, and messages about files that contain no mesh.

mod gzip;
mod obj;
mod off;
mod others;
mod ply;
mod solid;
mod solid_cells;
mod stl;
mod vtp;

use helfrich_std::io::{Format, parse, read};
use solid::{Solid, icosahedron, in_order_of_appearance, tetrahedron};
use std::fs;
use std::path::{Path, PathBuf};

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

/// Every truncated file is an error or still a mesh, never a panic.
#[test]
fn truncation_anywhere_is_an_error() {
    let solid = tetrahedron();
    for (bytes, format) in [
        (solid.binary_ply(true), Format::Ply),
        (solid.binary_stl(), Format::Stl),
        (solid.ply().trim_end().into(), Format::Ply),
    ] {
        for length in 0..bytes.len() {
            // A last number that lost some digits is still a number.
            let lost = bytes.len() - length;
            assert!(
                parse(&bytes[..length], format).is_err() || lost < 3,
                "{format:?} {length}"
            );
        }
    }
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
            &format!(
                "unknown format: {} files can be read, also compressed as .gz",
                Format::readable()
            ),
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
