//! Choice of the driver of a run.

use super::RunError;
use super::drive::Drive;
use super::flowing::Flowing;
use super::immersing::{Immersing, Stored};
use super::relaxing::Relaxing;
use super::state::DriveState;
use crate::scalar::Scalar;
use crate::scene::{Driver, Every, Scene};
use crate::simulation::Simulation;

/// The scene's driver, at the start of a run or in its stored state.
pub(super) fn drive<'a>(
    scene: &'a Scene,
    simulation: &mut Simulation,
    positions: Vec<[f64; 3]>,
    stored: Option<DriveState>,
) -> Result<Box<dyn Drive + 'a>, RunError> {
    let checkpoint_every = scene.output.checkpoint_every;
    Ok(match (scene.driver, scene.output.every, stored) {
        (Driver::Relax(relax), Every::Iterations(every), None) => {
            let every = [every, checkpoint_every];
            Box::new(Relaxing::new(scene, relax, every, simulation, positions)?)
        }
        (Driver::Relax(relax), Every::Iterations(every), Some(DriveState::Relaxing(state))) => {
            let every = [every, checkpoint_every];
            Box::new(Relaxing::resume(scene, relax, every, simulation, state)?)
        }
        (Driver::BoundaryIntegral(driver), Every::Time(_), None) => {
            Box::new(Flowing::new(scene, driver, simulation, positions)?)
        }
        (Driver::BoundaryIntegral(driver), Every::Time(_), Some(DriveState::Flowing(state))) => {
            Box::new(Flowing::resume(
                scene, driver, simulation, positions, state,
            )?)
        }
        (Driver::LatticeBoltzmann(driver), Every::Time(_), stored) => match driver.precision {
            Scalar::F32 | Scalar::F32Pair => {
                let stored = f32::taken(stored)?;
                Box::new(Immersing::new(
                    scene, driver, simulation, positions, stored,
                )?)
            }
            Scalar::F64 => {
                let stored = f64::taken(stored)?;
                Box::new(Immersing::new(
                    scene, driver, simulation, positions, stored,
                )?)
            }
        },
        // The reader of the scene excludes the first case, the fingerprint of the checkpoint the
        // second.
        _ => return Err(RunError::Mismatch),
    })
}

/// Refuses what only one rank can do.
pub(super) fn refuse_ranks(scene: &Scene, simulation: &Simulation) -> Result<(), RunError> {
    let ranks = simulation.division().team().count();
    let replaced = scene
        .surfaces
        .iter()
        .find(|surface| surface.remesh.is_some());
    match (ranks, scene.driver, replaced) {
        (1, ..) | (_, Driver::LatticeBoltzmann(_), None) => Ok(()),
        (_, Driver::LatticeBoltzmann(_), Some(surface)) => Err(RunError::RemeshingOnRanks {
            ranks,
            surface: surface.name.clone(),
        }),
        (_, driver, _) => Err(RunError::DriverOnRanks {
            ranks,
            driver: driver.name(),
        }),
    }
}

/// As a rank that is not the first of those that [share](Simulation::share) a simulation: does what the first one needs in
/// [`run`](super::run()), until that one [dismisses](helfrich_execute::team::Team::dismiss) this. Writes nothing.
///
/// # Errors
/// As [`run`](super::run()), before anything is done; the first rank has the same ones.
pub fn assist(
    scene: &Scene,
    (mut simulation, positions): (Simulation, Vec<[f64; 3]>),
) -> Result<(), RunError> {
    refuse_ranks(scene, &simulation)?;
    let simulation = &mut simulation;
    let Driver::LatticeBoltzmann(driver) = scene.driver else {
        return Ok(());
    };
    match driver.precision {
        Scalar::F32 | Scalar::F32Pair => {
            Immersing::<f32>::assist(scene, driver, simulation, positions)
        }
        Scalar::F64 => Immersing::<f64>::assist(scene, driver, simulation, positions),
    }
}
