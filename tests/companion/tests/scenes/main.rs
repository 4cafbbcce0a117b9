//! Scene files: valid scenes are read, and errors are reported.

mod columns;
mod edges;
mod errors;
mod explanations;
mod flow;
mod hostile;
mod lattice;
mod meshes;
mod noise;
mod obstacles;
mod order;
mod overrides;
mod populations;
mod private;
mod reading;
mod rheology;
mod schema;
mod shipped;

use helfrich::Surface;
// Private modules that are compiled here refer to these as items of their own crate.
use helfrich_std::clock;
use helfrich_std::generate::{self, generate};
use helfrich_std::info::MeshInfo;
use helfrich_std::method;
use helfrich_std::provenance;
use helfrich_std::scene::{
    self, MeshFileSource, MeshSource, Overrides, Place, SceneErrors, SceneFile,
};
use std::path::{Path, PathBuf};

/// Folder of the shipped scenes.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../std-ext/scene/scenes")
}

/// Names and texts of the shipped scenes.
fn shipped() -> Vec<(String, String)> {
    let files = std::fs::read_dir(folder()).unwrap();
    let paths = files.map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let name = |path: &PathBuf| path.file_stem().unwrap().to_string_lossy().into_owned();
    let mut all =
        Vec::from_iter(scenes.map(|path| (name(&path), std::fs::read_to_string(path).unwrap())));
    all.sort();
    all
}

fn parse(text: &str) -> Result<SceneFile, SceneErrors> {
    parse_with::<&str>(text, &[])
}

fn parse_with<S: Into<String> + Clone>(
    text: &str,
    overrides: &[S],
) -> Result<SceneFile, SceneErrors> {
    let overrides = Overrides::new(overrides.iter().cloned()).unwrap();
    SceneFile::parse(text, Path::new("folder/cell.toml"), &overrides)
}

#[track_caller]
fn valid(text: &str) -> SceneFile {
    parse(text).unwrap_or_else(|errors| panic!("{errors}\n\n{text}"))
}

/// Scene of the capsule of Guckenberger et al. 2016 on a coarse mesh, with replaced lines: effects from line
/// 8 on, the driver from line 11 on, which ends with `more`.
#[track_caller]
fn capsule_in(driver: &str, more: &str, replacements: &[(&str, &str)]) -> String {
    let mut text = format!(
        r#"units = "none"
[[surface]]
name = "capsule"
shape = "sphere:1"
family = "regular"
vertices = 642
match_volume = true
bending = {{ method = "B", modulus = 0.1125 }}
elasticity = {{ law = "neo-hookean", shear_modulus = 1 }}
[driver]
kind = "{driver}"
viscosity = 1
flow = {{ kind = "shear", rate = 0.15 }}
strain = 4
{more}"#
    );
    for (old, new) in replacements {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    text
}

/// A mesh file without further keys.
fn mesh_file(path: &str) -> MeshFileSource {
    MeshFileSource {
        path: path.into(),
        weld: None,
    }
}

/// A scene with `effects` on its one surface, from line 8 on.
fn with(effects: &str) -> String {
    format!(
        "units = \"micro\"\n[driver]\nkind = \"relax\"\n[[surface]]\nname = \"cell\"\nshape = \
         \"sphere:3\"\nvertices = 642\n{effects}"
    )
}

/// The only error of a text.
#[track_caller]
fn the_error(text: &str) -> (Place, String) {
    let errors = parse(text).expect_err(text);
    assert_eq!(errors.errors().len(), 1, "{errors}");
    (errors.errors()[0].place.clone(), errors.to_string())
}

/// Checks that a text has one error, at `line` and `column`, whose message contains `parts`.
#[track_caller]
fn refused(text: &str, at: [usize; 2], parts: &[&str]) {
    let (place, message) = the_error(text);
    let Place::Text {
        line,
        column,
        text: shown,
        ..
    } = place
    else {
        panic!("no place: {message}");
    };
    assert_eq!([line, column], at, "{message}");
    assert_eq!(
        Some(shown.as_str()),
        text.lines().nth(line - 1),
        "{message}"
    );
    let start = format!("folder/cell.toml:{line}:{column}: ");
    assert!(message.starts_with(&start), "{message}");
    assert!(message.contains(shown.trim_end()), "{message}");
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

/// Checks the error of an effect that is added to the scene of [`with`].
#[track_caller]
fn refused_effect(effects: &str, at: [usize; 2], parts: &[&str]) {
    refused(&with(effects), at, parts);
}

/// Facts about the mesh of a surface, generated or from a file, after scaling.
fn generated(file: &SceneFile, surface: usize) -> MeshInfo {
    let surface = &file.scene.surfaces[surface];
    let (mesh, positions, matched) = match &surface.source {
        MeshSource::Shape {
            shape,
            family,
            vertices,
            seed,
            match_volume,
        } => {
            let made = generate(shape, *family, *vertices, *seed).unwrap();
            let enclosed = Surface::new(&made.mesh, &made.positions).unwrap().volume();
            let matched = match match_volume {
                true => (shape.volume() / enclosed.unwrap()).cbrt(),
                false => 1.0,
            };
            (made.mesh, made.positions, matched)
        }
        MeshSource::File(source) => {
            let read = source.read().unwrap();
            (read.mesh, read.positions, 1.0)
        }
    };
    let scaled = |point: &[f64; 3]| point.map(|x| x * surface.scale * matched);
    let positions = Vec::from_iter(positions.iter().map(scaled));
    MeshInfo::new(Surface::new(&mesh, &positions).unwrap())
}
