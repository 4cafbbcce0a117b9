//! Why a run cannot begin or go on.

use super::CHECKPOINT;
use crate::checkpoint::CheckpointError;
use crate::dynamics::{SetupError, integrate};
use crate::flow::lattice_boltzmann::LatticeError;
use crate::lock::LockError;
use crate::plots::CurvesError;
use crate::scene::MeshSourceError;
use crate::series::SeriesError;
use crate::six::Six;
use std::io;
use std::path::PathBuf;

/// Why a run cannot begin or go on. The message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The surfaces resist nothing.
    #[error("{0}: give a surface `bending`, `elasticity`, `tension` or a penalty on its `area`")]
    Setup(#[from] SetupError),
    /// The integration in time cannot begin.
    #[error(transparent)]
    Integration(#[from] integrate::SetupError),
    /// The scene's outputs, or what was stored, are those of another driver.
    #[error("the outputs, or the checkpoint, are not those of the scene's driver")]
    Mismatch,
    /// The step that the scene asks for is longer than what is stable where the run begins.
    #[error(
        "driver: a step of {step:e} is {:.2} times {limit:.4e}, the longest that is stable with \
         rk4 here, where the stiffest mode decays at a rate of {rate:.3e}: choose a `step` of {:.2e} \
         or less, or leave `integrator` out",
        step / limit, 0.9 * limit
    )]
    UnstableStep {
        /// The step.
        step: f64,
        /// The longest that is stable.
        limit: f64,
        /// The spectral radius that limits it, per time.
        rate: f64,
    },
    /// Two columns of the series have one name.
    #[error(
        "output: two columns of the series are called `{column}`: give the probe, or the surface, \
         another name"
    )]
    RepeatedColumn {
        /// The name.
        column: String,
    },
    /// There is no such box of fluid.
    #[error("driver: {0}")]
    Lattice(#[from] LatticeError),
    /// There is a run in the folder already.
    #[error(
        "{}: there is a run here already: `--resume` goes on with it, `--out` names another folder",
        folder.display()
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
    },
    /// No force acts on any vertex.
    #[error(
        "nothing acts on {surfaces}: where the run begins, every force of every effect is 0, and there \
         is nothing to relax: begin with another shape, or give targets or a reference that differ \
         from it"
    )]
    NothingActs {
        /// The surfaces' names.
        surfaces: String,
    },
    /// A bending method has left out every vertex.
    #[error(
        "surface \"{surface}\": {method} measures no curvature on this mesh: all of its {vertices} \
         vertices that are not on a boundary are left out, for want of area or of neighbours: give it \
         more vertices, or choose another `bending.method`"
    )]
    NotMeasured {
        /// The surface's name.
        surface: String,
        /// The method's name.
        method: &'static str,
        /// How many there are.
        vertices: usize,
    },
    /// There is no run in the folder to go on with.
    #[error(
        "{}: there is no run here to go on with: leave `--resume` out to begin one",
        folder.display()
    )]
    NoRun {
        /// The folder.
        folder: PathBuf,
    },
    /// There is a run in the folder whose state was taken away.
    #[error(
        "{}: there is a run here without its `{CHECKPOINT}`, and nothing to go on from: put it back, or \
         name another folder with `--out`",
        folder.display()
    )]
    NoCheckpoint {
        /// The folder.
        folder: PathBuf,
    },
    /// The run is past the end that the scene has now.
    #[error(
        "driver: the run that is there has come to t = {} already, and the scene's end is at \
         {}: choose a longer `duration` or `strain`, or another folder with `--out`",
        Six(*time), Six(*duration)
    )]
    Past {
        /// How far it is.
        time: f64,
        /// The scene's duration.
        duration: f64,
    },
    /// Another process writes to the folder.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The mesh of a reference cannot be read any more.
    #[error(transparent)]
    Read(#[from] MeshSourceError),
    /// A plot shows what the series does not have.
    #[error("plots: there is no column `{column}` in this run: there are {}", known.join(", "))]
    NoColumn {
        /// The column.
        column: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// What was published cannot be drawn.
    #[error(transparent)]
    Curves(#[from] CurvesError),
    /// There is no run to go on with, or not of this scene.
    #[error(transparent)]
    Checkpoint(CheckpointError),
    /// The series cannot be gone on with.
    #[error(transparent)]
    Series(SeriesError),
    /// Something cannot be written. What was written before is whole.
    #[error("{}: {source}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// Something cannot be written. What was written before is whole.
    #[error(transparent)]
    Output(Box<dyn std::error::Error + Send + Sync>),
}

impl RunError {
    /// Whether an output is at fault, and not the scene or an input.
    pub fn is_output(&self) -> bool {
        matches!(
            self,
            Self::Unwritable { .. } | Self::Output(_) | Self::Lock(LockError::Inaccessible { .. })
        )
    }
}
