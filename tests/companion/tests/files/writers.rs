//! Mesh files that are written and read again, and refined meshes.

use helfrich_std::generate::{Family, generate};
use helfrich_std::io::{
    Format, MeshFile, WriteError, parse, read, read_with_columns, write, write_to,
    write_with_colours,
};
use helfrich_std::subdivide::{SubdivideError, Target, subdivide};
use std::path::{Path, PathBuf};

fn discocyte(vertices: usize) -> MeshFile {
    let shape = "discocyte:4e-6".parse().unwrap();
    let made = generate(&shape, Family::Smooth, vertices, 0).unwrap();
    MeshFile::new(made.positions, made.mesh)
}

fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("writers");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn what_is_written_is_read_again_with_all_digits() {
    let file = discocyte(162);
    for format in [Format::Obj, Format::Off, Format::Ply, Format::Vtp] {
        let mut bytes = Vec::new();
        write_to(&mut bytes, format, &file.positions, &file.mesh).unwrap();
        assert_eq!(parse(&bytes, format).unwrap(), file, "{format:?}");
    }
}

/// Colours are read again as columns where the format has columns, and positions are the same with and without.
#[test]
fn colours_are_written() {
    let file = discocyte(42);
    let colours = Vec::from_iter((0..42).map(|k| [k, 255 - k, 7]));
    for (name, names) in [
        ("c.ply", &["red", "green", "blue"][..]),
        ("c.vtp", &[]),
        ("c.obj", &[]),
        ("c.off", &[]),
        ("c.glb", &[]),
    ] {
        let path = folder().join(name);
        write_with_colours(&path, &file.positions, &file.mesh, &colours).unwrap();
        let (found, columns) = read_with_columns(&path).unwrap();
        assert_eq!(found.mesh, file.mesh, "{name}");
        let rounded = file
            .positions
            .iter()
            .map(|p| p.map(|x| f64::from(x as f32)));
        match name {
            "c.glb" => assert_eq!(found.positions, Vec::from_iter(rounded)),
            _ => assert_eq!(found.positions, file.positions),
        }
        for (part, name) in names.iter().enumerate() {
            let expected = Vec::from_iter(colours.iter().map(|colour| f64::from(colour[part])));
            let column = columns.iter().find(|column| column.name == *name);
            assert_eq!(column.unwrap().values, expected);
        }
    }
    let text = std::fs::read_to_string(folder().join("c.off")).unwrap();
    assert!(text.starts_with("COFF\n42 80 0\n") && text.contains(" 1 254 7 255\n"));
    let text = std::fs::read_to_string(folder().join("c.obj")).unwrap();
    assert!(text.contains(" 0.0 1.0 0.02745098\n"));
    for (name, count) in [("c.stl", 42), ("c.ply", 41)] {
        let error = write_with_colours(
            &folder().join(name),
            &file.positions,
            &file.mesh,
            &colours[..count],
        );
        let message = error.unwrap_err().to_string();
        assert!(
            message.contains(&format!("{count} colours of 42 vertices")),
            "{message}"
        );
    }
    let mut bytes = Vec::new();
    let error = write_to(&mut bytes, Format::Msh, &file.positions, &file.mesh).unwrap_err();
    assert_eq!(error.kind(), std::io::ErrorKind::Unsupported);
}

/// STL has no list of vertices, so that vertices are numbered by their first appearance in triangles.
#[test]
fn stl_keeps_the_triangles_and_seven_digits() {
    let file = discocyte(162);
    let mut bytes = Vec::new();
    write_to(&mut bytes, Format::Stl, &file.positions, &file.mesh).unwrap();
    assert_eq!(bytes.len(), 84 + 50 * file.mesh.triangles().len());
    let again = parse(&bytes, Format::Stl).unwrap();
    assert_eq!(again.mesh.vertex_count(), file.mesh.vertex_count());
    let pairs = again.mesh.triangles().iter().zip(file.mesh.triangles());
    for (found, expected) in pairs {
        for (found, expected) in found.iter().zip(expected) {
            let rounded = file.positions[*expected as usize].map(|x| f64::from(x as f32));
            assert_eq!(again.positions[*found as usize], rounded);
        }
    }
    // Each face starts with its outward normal.
    let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let normal = [84, 88, 92].map(float);
    let length: f32 = normal.iter().map(|x| x * x).sum();
    assert!((length - 1.0).abs() < 1e-6);
    let corner = [96, 100, 104].map(float);
    assert!(normal.iter().zip(corner).map(|(n, x)| n * x).sum::<f32>() > 0.0);
}

#[test]
fn files_are_named_by_their_ending() {
    let file = discocyte(42);
    for name in ["mesh.obj", "mesh.OFF", "mesh.ply"] {
        let path = folder().join(name);
        write(&path, &file.positions, &file.mesh).unwrap();
        assert_eq!(read(&path).unwrap(), file, "{name}");
    }
    let message = |name: &str| {
        let error = write(Path::new(name), &file.positions, &file.mesh);
        error.unwrap_err().to_string()
    };
    assert_eq!(
        message("mesh.obj.gz"),
        "mesh.obj.gz: unknown format: .obj, .off, .stl, .ply, .vtp and .glb files can be written"
    );
    assert!(message("no/such/folder/mesh.obj").starts_with("no/such/folder/mesh.obj: "));
}

#[test]
fn coordinates_beyond_stl_are_refused() {
    let mut file = discocyte(42);
    file.positions[7][1] = -1e39;
    let path = folder().join("large.stl");
    let error = write(&path, &file.positions, &file.mesh).unwrap_err();
    assert!(
        matches!(
            error,
            WriteError::OutOfRange {
                vertex: 7,
                axis: 1,
                ..
            }
        ),
        "{error}"
    );
    assert!(!path.exists());
}

#[test]
fn refined_files() {
    let file = discocyte(42);
    let fine = subdivide(file.clone(), 2, Target::Controls).unwrap();
    let limit = subdivide(file.clone(), 2, Target::Limit).unwrap();
    assert_eq!(fine.mesh.vertex_count(), 642);
    assert_eq!(fine.mesh, limit.mesh);
    assert_ne!(fine.positions, limit.positions);
    assert_eq!(subdivide(file.clone(), 0, Target::Controls).unwrap(), file);
    assert_ne!(subdivide(file.clone(), 0, Target::Limit).unwrap(), file);
}

#[test]
fn refinement_that_cannot_be_is_refused() {
    let message = |levels| subdivide(discocyte(42), levels, Target::Limit).unwrap_err();
    assert_eq!(
        message(12).to_string(),
        "12 levels of refinement are too many: 1342177280 triangles are too many: the limit is 715827882"
    );
    assert!(matches!(message(u32::MAX), SubdivideError::TooLarge { .. }));
}
