//! Any text as a scene: errors with a place, or a scene that can be made ready and explained.
#![no_main]

use helfrich_std::info::MeshInfo;
use helfrich_std::scene::{MeshSource, Overrides, ReferenceSource, Scene, SceneFile, SurfaceScene};
use helfrich_std::simulation::build;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

/// Vertices of all surfaces together, beyond which a scene is only read.
const VERTICES: usize = 400;

/// Whether the meshes are small, and none of them is a file.
fn is_small(scene: &Scene) -> bool {
    let references_file = |surface: &SurfaceScene| {
        let elasticity = surface
            .effects
            .elasticity
            .as_ref()
            .map(|law| &law.reference);
        let local_area = surface
            .effects
            .local_area
            .as_ref()
            .map(|law| &law.reference);
        let mut references = elasticity.into_iter().chain(local_area);
        references.any(|reference| matches!(reference.source, ReferenceSource::File(_)))
    };
    let vertices = |surface: &SurfaceScene| match surface.source {
        MeshSource::Shape { vertices, .. } if !references_file(surface) => vertices,
        _ => VERTICES + 1,
    };
    let all = scene.surfaces.iter().map(vertices);
    all.fold(0, usize::saturating_add) <= VERTICES
}

// What stands before a NUL, if there is one, are overrides as of `--set`, one a line.
fuzz_target!(|text: &str| {
    let (set, text) = text.split_once('\0').unwrap_or(("", text));
    let overrides = match Overrides::new(set.lines()) {
        Ok(overrides) => overrides,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let file = match SceneFile::parse(text, Path::new("scene.toml"), &overrides) {
        Ok(file) => file,
        Err(errors) => {
            assert!(!errors.to_string().is_empty());
            return;
        }
    };
    for warning in &file.warnings {
        assert!(!warning.to_string().is_empty());
    }
    serde_json::to_string(&file.scene).expect("a scene is plain data");
    if !is_small(&file.scene) {
        return;
    }
    let (simulation, positions) = match build(&file) {
        Ok(built) => built,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let surface = |body: &helfrich_std::simulation::Body| {
        let surface = body.surface(&positions);
        MeshInfo::new(surface.expect("what was built has finite positions"))
    };
    let meshes = Vec::from_iter(simulation.bodies().iter().map(surface));
    for warning in simulation.warnings() {
        assert!(!warning.to_string().is_empty());
    }
    let explanation = file.scene.explain(&meshes).to_string();
    assert!(!explanation.is_empty());
});
