//! Parts of a scene that a run and its continuation have in common.

use super::RunError;
use crate::checkpoint::Fingerprint;
use crate::scene::{Driver, MeshFileSource, MeshSource, ReferenceSource, Relax, Scene};
use crate::simulation::Simulation;
use helfrich::TriangleMesh;
use std::fmt::Write as _;
use std::path::PathBuf;

/// The fingerprint of everything on which the numbers of a run depend to the last bit: the scene
/// and the content of its mesh files, not the names of these files.
///
/// Title, outputs and the end of the run are not included.
///
/// # Errors
/// If the file of a reference cannot be read.
pub(crate) fn fingerprint(
    scene: &Scene,
    simulation: &Simulation,
    positions: &[[f64; 3]],
) -> Result<Fingerprint, RunError> {
    let mut surfaces = scene.surfaces.clone();
    let mut obstacles = scene.obstacles.clone();
    let mut references = Vec::new();
    for surface in &mut surfaces {
        forget(&mut surface.source);
        for reference in surface.effects.references_mut() {
            if let ReferenceSource::File(file) = &mut reference.source {
                references.push(std::mem::take(file));
            }
        }
    }
    for obstacle in &mut obstacles {
        forget(&mut obstacle.source);
    }
    let driver = endless(scene.driver, simulation.load_count());
    let parts = (
        scene.units,
        &surfaces,
        &scene.interactions,
        &obstacles,
        driver,
        &scene.course,
    );
    let mut text = serde_json::to_string(&parts).unwrap_or_default();
    for (body, surface) in simulation.bodies().iter().zip(&scene.surfaces) {
        add_triangles(body.mesh(), &mut text);
        for column in surface.effects.columns() {
            add_numbers(&column.values, &mut text);
        }
    }
    add_positions(positions, &mut text);
    for obstacle in simulation.obstacles() {
        add_triangles(&obstacle.mesh, &mut text);
        add_positions(&obstacle.positions, &mut text);
    }
    for file in references {
        let reference = file.read()?;
        add_triangles(&reference.mesh, &mut text);
        add_positions(&reference.positions, &mut text);
    }
    Ok(Fingerprint::of(&text))
}

/// The files that a scene reads, as it names them: meshes, references and published curves.
pub(super) fn input_files(scene: &Scene) -> Vec<PathBuf> {
    let surfaces = scene.surfaces.iter();
    let references = surfaces
        .clone()
        .flat_map(|surface| surface.effects.references());
    let references = references.filter_map(|reference| match &reference.source {
        ReferenceSource::File(file) => Some(&file.path),
        _ => None,
    });
    let obstacles = scene.obstacles.iter().map(|obstacle| &obstacle.source);
    let meshes = surfaces.map(|surface| &surface.source).chain(obstacles);
    let meshes = meshes.filter_map(|source| match source {
        MeshSource::File(file) => Some(&file.path),
        MeshSource::Shape { .. } => None,
    });
    let published = scene
        .output
        .plots
        .iter()
        .filter_map(|plot| plot.published.as_ref());
    meshes.chain(references).chain(published).cloned().collect()
}

/// A driver without the settings that decide its end. In a sequence of loads these are included,
/// because each load begins where the previous one ended.
fn endless(driver: Driver, loads: usize) -> Driver {
    match driver {
        Driver::Relax(relax) => {
            // Criteria for an equilibrium, and its modes, do not change the path to it.
            let judged = Relax {
                energy_error: 0.0,
                modes: 0,
                ..relax
            };
            Driver::Relax(match loads {
                1 => Relax {
                    residual: 0.0,
                    iterations: 0,
                    ..judged
                },
                _ => judged,
            })
        }
        Driver::BoundaryIntegral(mut driver) => {
            driver.duration = 0.0;
            Driver::BoundaryIntegral(driver)
        }
        Driver::LatticeBoltzmann(mut driver) => {
            driver.duration = 0.0;
            Driver::LatticeBoltzmann(driver)
        }
    }
}

fn forget(source: &mut MeshSource) {
    if let MeshSource::File(file) = source {
        *file = MeshFileSource::default();
    }
}

fn add_triangles(mesh: &TriangleMesh, text: &mut String) {
    // Writing to a string cannot fail.
    let _ = write!(text, "{:?}", mesh.triangles());
}

fn add_positions(positions: &[[f64; 3]], text: &mut String) {
    add_numbers(positions.as_flattened(), text);
}

fn add_numbers(numbers: &[f64], text: &mut String) {
    for number in numbers {
        let _ = write!(text, "{:x},", number.to_bits());
    }
}
