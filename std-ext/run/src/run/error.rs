//! Errors that prevent a run from starting or continuing.

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

/// The reason why a run cannot start or continue. The message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// No effect of a surface resists deformation.
    #[error(
        "surface \"{surface}\" has the moduli {bending:e} (bending) and {in_plane:e} (in plane): neither \
         may be negative, nor both 0: give it `bending`, `elasticity`, `tension` or a penalty on its `area`"
    )]
    Modulus {
        /// The surface's name.
        surface: String,
        /// Its bending modulus.
        bending: f64,
        /// Its in-plane modulus.
        in_plane: f64,
    },
    /// The relaxation cannot start.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The time integration cannot start.
    #[error(transparent)]
    Integration(#[from] integrate::SetupError),
    /// The outputs of the scene, or the stored state, belong to another driver.
    #[error("the outputs or the checkpoint do not belong to the scene's driver")]
    Mismatch,
    /// The fixed step of the scene is longer than the stable step at the start of the run.
    #[error(
        "driver: a step of {step:e} is {:.2} times {limit:.4e}, the longest that is stable with \
         rk4 here, where the stiffest mode decays at a rate of {rate:.3e}: choose a `step` of {:.2e} \
         or less, or leave `integrator` out",
        step / limit, 0.9 * limit
    )]
    UnstableStep {
        /// The step.
        step: f64,
        /// The longest stable step.
        limit: f64,
        /// The spectral radius that limits it, per time.
        rate: f64,
    },
    /// Two columns of the series have the same name.
    #[error(
        "output: two columns of the series are called `{column}`: give the probe, or the surface, \
         another name"
    )]
    RepeatedColumn {
        /// The name.
        column: String,
    },
    /// The scene asks for PNG files, and the library was built without the feature that writes them.
    #[error(
        "output: `{key}` is written as PNG files, and helfrich-std was built without its feature \
         `pictures`: enable it, or {}",
        if *key == "pictures" { "set `pictures = false`" } else { "omit the key" }
    )]
    NoPictures {
        /// The key of the output.
        key: &'static str,
    },
    /// The box of fluid is invalid.
    #[error("driver: {0}")]
    Lattice(#[from] LatticeError),
    /// A driver that works on one rank only.
    #[error(
        "driver: {ranks} ranks were started, and `{driver}` runs on one: start it without `mpiexec`, or take \
         `lattice-boltzmann`"
    )]
    DriverOnRanks {
        /// Number of ranks.
        ranks: usize,
        /// The driver.
        driver: &'static str,
    },
    /// Meshes that change, on several ranks.
    #[error(
        "surface \"{surface}\": {ranks} ranks were started, and `remesh` works on one: leave it out, or start the run \
         without `mpiexec`"
    )]
    RemeshingOnRanks {
        /// Number of ranks.
        ranks: usize,
        /// The surface's name.
        surface: String,
    },
    /// The folder already contains a run.
    #[error(
        "{}: there is a run here already: continue it with `--resume`, or name another folder with `--out`",
        folder.display()
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder contains something that the run would replace, and that is not of a run.
    #[error(
        "{}: the run would replace this, which is not of a run here: move it away, or name another folder \
         with `--out`",
        path.display()
    )]
    Foreign {
        /// The file, or the subfolder with files in it.
        path: PathBuf,
    },
    /// The run would replace a file that the scene reads.
    #[error(
        "{}: the run would replace {}, which the scene reads: name another folder with `--out`",
        path.display(), input.display()
    )]
    Input {
        /// The output.
        path: PathBuf,
        /// The file of the scene.
        input: PathBuf,
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
        /// Number of vertices.
        vertices: usize,
    },
    /// The folder contains no run to resume.
    #[error(
        "{}: there is no run here to continue: omit `--resume` to start one",
        folder.display()
    )]
    NoRun {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder contains a run without its checkpoint.
    #[error(
        "{}: the run here has lost its `{CHECKPOINT}` and cannot continue: restore the file, or \
         name another folder with `--out`",
        folder.display()
    )]
    NoCheckpoint {
        /// The folder.
        folder: PathBuf,
    },
    /// The run is already past the end of the scene.
    #[error(
        "driver: the run in this folder has already reached t = {}, and the scene ends at \
         {}: choose a longer `duration` or `strain`, or another folder with `--out`",
        Six(*time), Six(*duration)
    )]
    Past {
        /// The time that the run has reached.
        time: f64,
        /// The scene's duration.
        duration: f64,
    },
    /// Another process writes to the folder.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The mesh file of a reference can no longer be read.
    #[error(transparent)]
    Read(#[from] MeshSourceError),
    /// A plot names a column that the series does not have.
    #[error("plots: there is no column `{column}` in this run: there are {}", known.join(", "))]
    NoColumn {
        /// The column.
        column: String,
        /// Names that exist.
        known: Vec<String>,
    },
    /// Published curves cannot be drawn.
    #[error(transparent)]
    Curves(#[from] CurvesError),
    /// The checkpoint cannot be used for this scene.
    #[error(transparent)]
    Checkpoint(CheckpointError),
    /// The series cannot be continued.
    #[error(transparent)]
    Series(SeriesError),
    /// Something cannot be written. Earlier outputs are complete.
    #[error("{}: {source}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Something cannot be written. Earlier outputs are complete.
    #[error(transparent)]
    Output(Box<dyn std::error::Error + Send + Sync>),
}

impl RunError {
    /// Whether the error is that of an output, and not of the scene or an input.
    pub fn is_output(&self) -> bool {
        matches!(
            self,
            Self::Unwritable { .. } | Self::Output(_) | Self::Lock(LockError::Inaccessible { .. })
        )
    }
}
