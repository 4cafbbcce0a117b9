//! A run of a scene in a folder: what is driven, written, stored, and taken up again.
//!
//! A folder holds
//! * `series.csv`: a row of numbers every so many iterations or so much time, and one at the end of each
//!   load;
//! * `surfaces/NAME-TIME.vtp` with `surfaces.pvd`, their index;
//! * `pictures/TIME.png`;
//! * `slices/NAME-TIME.vti` and `.png` with `slices.pvd`: the fluid on the scene's slices;
//! * `volumes/NAME-TIME.vti` with `volumes.pvd`: all fluid of a box;
//! * `plots/COLUMN.png`: columns of the series, drawn when the run ends;
//! * `checkpoint`: all that is needed to go on, bit for bit;
//! * `summary.json`: how it ended, the last row, what each effect has cost, the scene as run.
//!
//! Every file but the series is written as a whole or not at all, and a run that is taken up
//! again cuts the series back to the checkpoint. Whenever a run is killed, nothing is lost but
//! what came after its last checkpoint.

mod clock;
mod deformed;
mod drive;
mod files;
mod flowing;
mod immersing;
mod measure;
mod relaxing;

use crate::checkpoint::{self, CheckpointError, Fingerprint};
use crate::dynamics::{SetupError, integrate};
use crate::flow::lattice_boltzmann::LatticeError;
use crate::io::{Collection, UNFINISHED, replace_file};
use crate::plots::CurvesError;
use crate::scene::Scene;
use crate::series::{Series, SeriesError, SeriesTable};
use crate::simulation::{Acting, Cost, Simulation};
use drive::{Drive, DriveState, Mark, drive};
use files::PlannedPlot;
use measure::Measures;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The checkpoint's name in its folder.
pub const CHECKPOINT: &str = "checkpoint";

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
        matches!(self, Self::Unwritable { .. } | Self::Output(_))
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// Every load came to its equilibrium.
    Converged,
    /// It went on to the end of its duration.
    Completed,
    /// The last load did not: the limit of iterations was reached.
    IterationLimit,
    /// The last load did not: nothing improves any more.
    Stagnated,
    /// It went wrong; what is kept is the last good state.
    Failed,
    /// It was asked to stop, and can be taken up again.
    Interrupted,
}

impl End {
    /// What it is called in tables and in `summary.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Completed => "completed",
            Self::IterationLimit => "iteration-limit",
            Self::Stagnated => "stagnated",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// What a run leaves in `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The scene's title.
    pub title: String,
    /// How it ended.
    pub end: End,
    /// The same in words.
    pub message: String,
    /// Iterations, or steps in time, in all.
    pub iterations: u64,
    /// Evaluations of the velocities in all, those for the spectral radius included; of drivers in
    /// time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right_hand_sides: Option<u64>,
    /// Seconds in all, resumed runs included.
    pub seconds: f64,
    /// The names of the last row's numbers, and these; a number that is not finite is null.
    pub last: Vec<(String, f64)>,
    /// What each effect has cost.
    pub effects: Vec<Cost>,
    /// What is worth knowing besides.
    pub warnings: Vec<String>,
    /// The version of the program.
    pub version: &'static str,
    /// The scene as run.
    pub scene: Scene,
}

/// How far a run is.
#[derive(Clone, Debug)]
pub struct Progress {
    /// From 0 to 1.
    pub fraction: f64,
    /// The same in words.
    pub message: String,
}

/// All that a checkpoint holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Stored {
    drive: DriveState,
    outputs: Outputs,
}

/// Where outputs stand.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Outputs {
    rows: u64,
    files: Collection,
    slices: Collection,
    volumes: Collection,
    /// The number of the last row, as files have it.
    written: Option<u64>,
    /// How many rows there were.
    sets: u64,
    costs: Vec<(u64, f64)>,
    seconds: f64,
}

/// Runs a scene that was made ready by [`build`](crate::simulation::build) in a folder, which is made
/// if it is not there; with `resume`, goes on with the run that is there.
///
/// After every step `progress` is told how far it is, and `interrupted` asked whether to stop.
///
/// # Errors
/// If the surfaces resist nothing, the folder holds another run, or something cannot be
/// written. That a scene does not come to its equilibrium is no error: see [`End`].
pub fn run(
    scene: &Scene,
    (mut simulation, positions): (Simulation, Vec<[f64; 3]>),
    folder: &Path,
    resume: bool,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<Summary, RunError> {
    let start = Instant::now();
    let fingerprint = fingerprint(scene, &simulation, &positions);
    let [path, series_path] = [CHECKPOINT, "series.csv"].map(|name| folder.join(name));
    let stored = if resume {
        let stored = checkpoint::read(&path, fingerprint).map_err(RunError::Checkpoint)?;
        remove_unfinished(folder);
        Some(stored)
    } else if path.exists() || series_path.exists() {
        let folder = folder.to_owned();
        return Err(RunError::Occupied { folder });
    } else {
        None
    };
    let (state, outputs) = stored
        .map(|Stored { drive, outputs }| (drive, outputs))
        .unzip();
    let measures = Measures::new(scene, &simulation, &positions);
    let drive = drive(scene, &mut simulation, positions, state)?;
    let mut columns = measures.columns(&*drive, &simulation);
    columns.extend(Run::probe_columns(scene));
    let repeated = (1..columns.len()).find(|&at| columns[..at].contains(&columns[at]));
    if let Some(at) = repeated {
        let column = columns.swap_remove(at);
        return Err(RunError::RepeatedColumn { column });
    }
    let plots = scene.output.plots.iter();
    let plots = plots.map(|plot| PlannedPlot::new(plot, &columns, &simulation));
    let plots = plots.collect::<Result<_, _>>()?;
    let columns = Vec::from_iter(columns.iter().map(String::as_str));
    let (series, outputs, last) = match outputs {
        Some(outputs) => {
            let series = Series::resume(&series_path, &columns, outputs.rows);
            let series = series.map_err(RunError::Series)?;
            let table = SeriesTable::read(&series_path).map_err(RunError::Series)?;
            let last = table.rows.last().cloned();
            (series, outputs, last.unwrap_or_default())
        }
        None => {
            make_folder(folder)?;
            let series = Series::create(&series_path, &columns)
                .map_err(|error| RunError::Output(Box::new(error)))?;
            (series, Outputs::default(), Vec::new())
        }
    };
    let mut run = Run {
        scene,
        folder,
        fingerprint,
        simulation,
        measures,
        drive,
        plots,
        series,
        outputs,
        start,
        last,
    };
    let (end, message) = run.drive(interrupted, progress)?;
    run.finish(end, message)
}

/// Of the scene as read and of the meshes that it names, to the last bit.
fn fingerprint(scene: &Scene, simulation: &Simulation, positions: &[[f64; 3]]) -> Fingerprint {
    let mut text = serde_json::to_string(scene).unwrap_or_default();
    for body in simulation.bodies() {
        text.push_str(&format!("{:?}", body.mesh().triangles()));
    }
    for coordinate in positions.as_flattened() {
        text.push_str(&format!("{:x}", coordinate.to_bits()));
    }
    Fingerprint::of(&text)
}

fn make_folder(path: &Path) -> Result<(), RunError> {
    std::fs::create_dir_all(path).map_err(|source| RunError::Unwritable {
        path: path.to_owned(),
        source,
    })
}

/// Takes away the files that a run was writing when it was killed. That one stays is no harm.
fn remove_unfinished(folder: &Path) {
    let folders = ["", "surfaces", "pictures", "slices", "volumes", "plots"];
    for folder in folders.map(|name| folder.join(name)) {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

/// A run under way.
struct Run<'a> {
    scene: &'a Scene,
    folder: &'a Path,
    fingerprint: Fingerprint,
    simulation: Simulation,
    measures: Measures,
    drive: Box<dyn Drive + 'a>,
    plots: Vec<PlannedPlot<'a>>,
    series: Series,
    /// Costs and seconds are those of the runs that this one goes on with.
    outputs: Outputs,
    start: Instant,
    /// The last row.
    last: Vec<f64>,
}

impl Run<'_> {
    /// Step after step.
    fn drive(
        &mut self,
        interrupted: &dyn Fn() -> bool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<(End, String), RunError> {
        if self.outputs.written.is_none() {
            self.write(false)?;
            self.checkpoint()?;
        }
        loop {
            let step = self.drive.step(&mut self.simulation)?;
            progress(&self.drive.progress());
            if step.output {
                self.write(step.end.is_some())?;
            }
            if step.checkpoint {
                self.checkpoint()?;
            }
            if let Some(end) = step.end {
                return Ok(end);
            }
            if interrupted() {
                self.checkpoint()?;
                let message = format!(
                    "interrupted at {}: `--resume` goes on",
                    self.drive.caption()
                );
                return Ok((End::Interrupted, message));
            }
        }
    }

    /// A row of the series and, if it is due or the last, a set of files, unless that was done here
    /// already.
    fn write(&mut self, last: bool) -> Result<(), RunError> {
        let mark = self.drive.mark();
        if self.outputs.written == Some(mark.number) {
            return Ok(());
        }
        let acting = self.simulation.resolve(self.drive.positions());
        let mut row = self.measures.row(&*self.drive, &self.simulation, &acting);
        row.extend(self.probe());
        let output = |error: SeriesError| RunError::Output(Box::new(error));
        self.series.append(&row).map_err(output)?;
        self.last = row;
        let due = self
            .outputs
            .sets
            .is_multiple_of(self.scene.output.files_every);
        self.outputs.sets += 1;
        if due || last {
            self.write_files(mark, &acting)?;
        }
        self.outputs.written = Some(mark.number);
        Ok(())
    }

    /// A set of files.
    fn write_files(&mut self, mark: Mark, acting: &[Acting]) -> Result<(), RunError> {
        if self.scene.output.surfaces {
            self.write_surfaces(mark, acting)?;
        }
        if self.scene.output.pictures {
            self.draw(mark, acting)?;
        }
        self.write_slices(mark)?;
        self.write_volumes(mark)
    }

    fn checkpoint(&mut self) -> Result<(), RunError> {
        let rows = self.series.mark();
        self.outputs.rows = rows.map_err(|error| RunError::Output(Box::new(error)))?;
        let costs = self.costs();
        let stored = Stored {
            drive: self.drive.state(),
            outputs: Outputs {
                costs: costs.iter().map(|c| (c.evaluations, c.seconds)).collect(),
                seconds: self.seconds(),
                ..self.outputs.clone()
            },
        };
        checkpoint::write(&self.folder.join(CHECKPOINT), self.fingerprint, &stored)
            .map_err(|error| RunError::Output(Box::new(error)))
    }

    fn seconds(&self) -> f64 {
        self.outputs.seconds + self.start.elapsed().as_secs_f64()
    }

    /// Of this run and those that it goes on with.
    fn costs(&self) -> Vec<Cost> {
        let mut costs = self.simulation.costs();
        costs.extend(self.drive.costs());
        for (cost, &(evaluations, seconds)) in costs.iter_mut().zip(&self.outputs.costs) {
            cost.evaluations += evaluations;
            cost.seconds += seconds;
        }
        costs
    }

    fn finish(&mut self, end: End, message: String) -> Result<Summary, RunError> {
        self.draw_plots()?;
        let mut columns = self.measures.columns(&*self.drive, &self.simulation);
        columns.extend(Self::probe_columns(self.scene));
        let last = columns.into_iter().zip(self.last.clone());
        let work = self.drive.work();
        let warnings = self.simulation.warnings().iter();
        let mut warnings = Vec::from_iter(warnings.map(ToString::to_string));
        warnings.extend(self.drive.notes().iter().cloned());
        let summary = Summary {
            title: self.scene.title.clone(),
            end,
            message,
            iterations: work.iterations,
            right_hand_sides: work.right_hand_sides,
            seconds: self.seconds(),
            last: last.collect(),
            effects: self.costs(),
            warnings,
            version: env!("CARGO_PKG_VERSION"),
            scene: self.scene.clone(),
        };
        let path = self.folder.join("summary.json");
        replace_file(&path, |out| {
            serde_json::to_writer_pretty(&mut *out, &summary)?;
            writeln!(out)
        })
        .map_err(|source| RunError::Unwritable { path, source })?;
        Ok(summary)
    }
}
