//! A run of a scene in a folder: what is driven, written, stored, and taken up again.
//!
//! A folder holds
//! * `series.csv`: a row of numbers every so many iterations, and one at the end of each load;
//! * `surfaces/NAME-TIME.vtp` with `surfaces.pvd`, their index;
//! * `pictures/TIME.png`;
//! * `checkpoint`: all that is needed to go on, bit for bit;
//! * `summary.json`: how it ended, the last row, what each effect has cost, the scene as run.
//!
//! Every file but the series is written as a whole or not at all, and a run that is taken up
//! again cuts the series back to the checkpoint. Whenever a run is killed, nothing is lost but
//! what came after its last checkpoint.

mod measure;

use crate::checkpoint::{self, CheckpointError, Fingerprint};
use crate::dynamics::{Outcome, Relaxation, Settings, SetupError, State};
use crate::io::{
    Collection, CollectionEntry, PointField, PointValues, UNFINISHED, VtpError, replace_file,
    write_vtp,
};
use crate::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use crate::scene::{Driver, Every, Relax, Scene, Units};
use crate::series::{Series, SeriesError, SeriesTable};
use crate::simulation::{Acting, Cost, Simulation};
use measure::Measures;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The checkpoint's name in its folder.
pub const CHECKPOINT: &str = "checkpoint";

/// Width and height of the pictures, in pixels.
const PICTURE_SIZE: [u32; 2] = [900, 700];

/// Why a run cannot begin or go on. The message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The surfaces resist nothing.
    #[error("{0}: give a surface `bending`, `elasticity`, `tension` or a penalty on its `area`")]
    Setup(#[from] SetupError),
    /// A driver that cannot be run.
    #[error("scenes of the driver \"{name}\" can be read, and not run yet")]
    Driver {
        /// The driver.
        name: &'static str,
    },
    /// There is a run in the folder already.
    #[error(
        "{}: there is a run here already: `--resume` goes on with it, `--out` names another folder",
        folder.display()
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
    },
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
    /// The last load did not: the limit of iterations was reached.
    IterationLimit,
    /// The last load did not: nothing improves any more.
    Stagnated,
    /// It went wrong; what is kept is the last good state.
    Failed,
    /// It was asked to stop, and can be taken up again.
    Interrupted,
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
    /// Iterations in all.
    pub iterations: u64,
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
    /// The load of a sequence, from 0, and how many there are.
    pub load: [usize; 2],
    /// Iterations of this load.
    pub iteration: u64,
    /// The residual, that at which the load began, and that at which it is in equilibrium.
    pub residual: [f64; 3],
    /// The energy.
    pub energy: f64,
}

impl Progress {
    /// From 0 to 1, by the digits that the residual has lost of those it has to lose.
    pub fn fraction(&self) -> f64 {
        let [load, loads] = self.load.map(|count| count as f64);
        let [residual, first, last] = self.residual;
        let done = (first / residual).ln() / (first / last).ln();
        // Not a number before the first step, and where there is nothing to do.
        let done = if done.is_finite() {
            done.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (load + done) / loads
    }
}

impl fmt::Display for Progress {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [residual, ..] = self.residual;
        let [load, loads] = self.load;
        if loads > 1 {
            write!(formatter, "load {} of {loads}, ", load + 1)?;
        }
        let Self {
            iteration, energy, ..
        } = self;
        write!(
            formatter,
            "iteration {iteration}, energy {energy:.6e}, residual {residual:.1e}"
        )
    }
}

/// All that a checkpoint holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Stored {
    load: usize,
    /// Iterations of the loads before.
    before: u64,
    relaxation: State,
    rows: u64,
    files: Collection,
    /// The time at which files were written last.
    written: Option<u64>,
    /// The residual with which the load began.
    first_residual: Option<f64>,
    costs: Vec<(u64, f64)>,
    seconds: f64,
    /// How the first load ended that did not come to its equilibrium, and all of these in words.
    unfinished: Option<End>,
    notes: Vec<String>,
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
    let measures = Measures::new(scene, &simulation, &positions);
    let (Driver::Relax(relax), Every::Iterations(every)) = (scene.driver, scene.output.every)
    else {
        let name = scene.driver.name();
        return Err(RunError::Driver { name });
    };
    let settings = settings(relax);
    let columns = measures.columns();
    let [path, series_path] = [CHECKPOINT, "series.csv"].map(|name| folder.join(name));
    let (relaxation, series, stored, last) = if resume {
        let stored: Stored = checkpoint::read(&path, fingerprint).map_err(RunError::Checkpoint)?;
        remove_unfinished(folder);
        simulation.set_load(stored.load);
        let state = stored.relaxation.clone();
        let relaxation = Relaxation::resume(simulation.membranes(), state, settings)?;
        let series = Series::resume(&series_path, &columns, stored.rows);
        let series = series.map_err(RunError::Series)?;
        let table = SeriesTable::read(&series_path).map_err(RunError::Series)?;
        let last = table.rows.last().cloned();
        (relaxation, series, stored, last.unwrap_or_default())
    } else {
        if path.exists() || series_path.exists() {
            let folder = folder.to_owned();
            return Err(RunError::Occupied { folder });
        }
        let relaxation = Relaxation::new(simulation.membranes(), positions, settings)?;
        make_folder(folder)?;
        let series = Series::create(&series_path, &columns)
            .map_err(|error| RunError::Output(Box::new(error)))?;
        let stored = Stored {
            load: 0,
            before: 0,
            relaxation: relaxation.state().clone(),
            rows: 0,
            files: Collection::default(),
            written: None,
            first_residual: None,
            costs: Vec::new(),
            seconds: 0.0,
            unfinished: None,
            notes: Vec::new(),
        };
        (relaxation, series, stored, Vec::new())
    };
    let mut run = Run {
        scene,
        folder,
        fingerprint,
        simulation,
        measures,
        settings,
        relaxation,
        series,
        stored,
        start,
        time: 0,
        last,
    };
    let (end, message) = run.drive(relax, every, interrupted, progress)?;
    run.finish(end, message)
}

fn settings(relax: Relax) -> Settings {
    Settings {
        tolerance: relax.residual,
        iteration_limit: usize::try_from(relax.iterations).unwrap_or(usize::MAX),
        redistribution: relax.redistribution,
        ..Settings::default()
    }
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
    for folder in [folder, &folder.join("surfaces"), &folder.join("pictures")] {
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
    settings: Settings,
    relaxation: Relaxation,
    series: Series,
    /// As it was at the last checkpoint, but for what says where outputs stand.
    stored: Stored,
    start: Instant,
    /// Iterations so far.
    time: u64,
    /// The last row.
    last: Vec<f64>,
}

impl Run<'_> {
    /// Load after load, step after step.
    fn drive(
        &mut self,
        relax: Relax,
        every: u64,
        interrupted: &dyn Fn() -> bool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<(End, String), RunError> {
        let checkpoint_every = self.scene.output.checkpoint_every;
        let loads = self.simulation.load_count();
        if self.stored.written.is_none() {
            self.write(0, f64::NAN)?;
            self.checkpoint()?;
        }
        loop {
            let report = self.relaxation.step(&mut self.simulation);
            let iteration = report.iteration as u64;
            let first = *self.stored.first_residual.get_or_insert(report.residual);
            progress(&Progress {
                load: [self.stored.load, loads],
                iteration,
                residual: [report.residual, first, relax.residual],
                energy: report.energy,
            });
            let time = self.stored.before + iteration;
            self.time = time;
            if report.outcome.is_some() || iteration.is_multiple_of(every) {
                self.write(time, report.residual)?;
            }
            if let Some(outcome) = report.outcome {
                let mut message = self.message(outcome, report.residual);
                let load = self.stored.load + 1;
                if loads > 1 && outcome != Outcome::Converged {
                    message = format!("load {load} of {loads}: {message}");
                    self.stored.notes.push(message.clone());
                    self.stored.unfinished.get_or_insert(end(outcome));
                }
                let failed = matches!(outcome, Outcome::Failed(_));
                if load == loads || failed {
                    self.checkpoint()?;
                    let first = self.stored.unfinished.filter(|_| !failed);
                    if !self.stored.notes.is_empty() {
                        message = self.stored.notes.join("; ");
                    }
                    return Ok((first.unwrap_or(end(outcome)), message));
                }
                self.stored.load = load;
                self.stored.before = time;
                self.stored.first_residual = None;
                self.simulation.set_load(self.stored.load);
                let positions = self.relaxation.positions().to_vec();
                self.relaxation =
                    Relaxation::new(self.simulation.membranes(), positions, self.settings)?;
                self.checkpoint()?;
            } else if interrupted() {
                self.checkpoint()?;
                let message = format!("interrupted after {time} iterations: `--resume` goes on");
                return Ok((End::Interrupted, message));
            } else if iteration.is_multiple_of(checkpoint_every) {
                self.checkpoint()?;
            }
        }
    }

    /// An outcome in words, with what is worth knowing of it.
    fn message(&self, outcome: Outcome, residual: f64) -> String {
        let mut message = outcome.to_string();
        if let Outcome::Failed(failure) = outcome
            && let Some(membrane) = failure.membrane()
        {
            let name = self.simulation.bodies()[membrane].name();
            message.push_str(&format!("; membrane {membrane} is the surface \"{name}\""));
        }
        if outcome != Outcome::Converged && residual.is_finite() {
            message.push_str(&format!("; the residual is {residual:.1e}"));
        }
        message
    }

    /// A row of the series and a set of files, unless that was done at this time already.
    fn write(&mut self, time: u64, residual: f64) -> Result<(), RunError> {
        if self.stored.written == Some(time) {
            return Ok(());
        }
        let positions = self.relaxation.positions();
        let acting = self.simulation.resolve(positions);
        let row = self
            .measures
            .row(&self.simulation, positions, &acting, time, residual);
        let output = |error: SeriesError| RunError::Output(Box::new(error));
        self.series.append(&row).map_err(output)?;
        self.last = row;
        if self.scene.output.surfaces {
            self.write_surfaces(time, &acting)?;
        }
        if self.scene.output.pictures {
            self.draw(time, &acting)?;
        }
        self.stored.written = Some(time);
        Ok(())
    }

    fn write_surfaces(&mut self, time: u64, acting: &[Acting]) -> Result<(), RunError> {
        make_folder(&self.folder.join("surfaces"))?;
        let positions = self.relaxation.positions();
        for (part, body) in self.simulation.bodies().iter().enumerate() {
            let fields = measure::fields(&self.simulation, body, positions, acting);
            let fields = Vec::from_iter(fields.iter().map(|(name, values)| PointField {
                name,
                values: match values {
                    measure::Values::Scalars(values) => PointValues::Scalars(values),
                    measure::Values::Vectors(values) => PointValues::Vectors(values),
                },
            }));
            let name = format!("surfaces/{}-{time:08}.vtp", body.name());
            write_vtp(
                &self.folder.join(&name),
                body.mesh(),
                &positions[body.vertices()],
                Some(time as f64),
                &fields,
            )
            .map_err(|error: VtpError| RunError::Output(Box::new(error)))?;
            self.stored.files.entries.push(CollectionEntry {
                time: time as f64,
                part,
                file: name,
            });
        }
        let path = self.folder.join("surfaces.pvd");
        let written = self.stored.files.write(&path);
        written.map_err(|source| RunError::Unwritable { path, source })
    }

    /// All surfaces in one picture, coloured by the scene's field.
    fn draw(&mut self, time: u64, acting: &[Acting]) -> Result<(), RunError> {
        let folder = self.folder.join("pictures");
        make_folder(&folder)?;
        let positions = self.relaxation.positions();
        let scene = self.scene;
        let field = scene.output.picture_field;
        let bodies = self.simulation.bodies();
        let fields =
            Vec::from_iter(bodies.iter().map(|body| {
                measure::picture_field(&self.simulation, body, positions, acting, field)
            }));
        let surfaces = bodies.iter().zip(&fields).filter_map(|(body, field)| {
            Some(PaintedSurface {
                surface: body.surface(positions)?,
                field: field.as_deref(),
                shading: Shading::Smooth,
                edges: false,
            })
        });
        let surfaces = Vec::from_iter(surfaces);
        let signed = fields.iter().flatten().flatten().any(|&value| value < 0.0);
        let label = measure::picture_label(field, scene.units);
        let title = match scene.title.as_str() {
            "" => format!("iteration {time}"),
            title => format!("{title}, iteration {time}"),
        };
        let picture = Picture {
            size: PICTURE_SIZE,
            title: &title,
            surfaces: &surfaces,
            colours: Colouring {
                label: &label,
                range: None,
                map: if signed {
                    ColourMap::Diverging
                } else {
                    ColourMap::Sequential
                },
            },
            view: View {
                frame: Some(self.measures.frame(positions)),
                ..View::default()
            },
            length_unit: match scene.units {
                Units::Micro => Some("µm"),
                Units::None => None,
            },
        };
        let path = folder.join(format!("{time:08}.png"));
        let canvas = picture
            .draw()
            .map_err(|error| RunError::Output(Box::new(error)))?;
        let written = canvas.write_png(&path);
        written.map_err(|source| RunError::Unwritable { path, source })
    }

    fn checkpoint(&mut self) -> Result<(), RunError> {
        let rows = self.series.mark();
        self.stored.rows = rows.map_err(|error| RunError::Output(Box::new(error)))?;
        let mut stored = self.stored.clone();
        stored.relaxation = self.relaxation.state().clone();
        let costs = self.costs();
        stored.costs = costs.iter().map(|c| (c.evaluations, c.seconds)).collect();
        stored.seconds = self.seconds();
        checkpoint::write(&self.folder.join(CHECKPOINT), self.fingerprint, &stored)
            .map_err(|error| RunError::Output(Box::new(error)))
    }

    fn seconds(&self) -> f64 {
        self.stored.seconds + self.start.elapsed().as_secs_f64()
    }

    /// Of this run and those that it goes on with.
    fn costs(&self) -> Vec<Cost> {
        let mut costs = self.simulation.costs();
        for (cost, &(evaluations, seconds)) in costs.iter_mut().zip(&self.stored.costs) {
            cost.evaluations += evaluations;
            cost.seconds += seconds;
        }
        costs
    }

    fn finish(&mut self, end: End, message: String) -> Result<Summary, RunError> {
        let columns = self.measures.columns();
        let last = columns
            .into_iter()
            .map(str::to_owned)
            .zip(self.last.clone());
        let warnings = self.simulation.warnings().iter();
        let mut warnings = Vec::from_iter(warnings.map(ToString::to_string));
        warnings.extend(self.stored.notes.iter().cloned());
        let summary = Summary {
            title: self.scene.title.clone(),
            end,
            message,
            iterations: self.time,
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

fn end(outcome: Outcome) -> End {
    match outcome {
        Outcome::Converged => End::Converged,
        Outcome::IterationLimit => End::IterationLimit,
        Outcome::Stagnated => End::Stagnated,
        _ => End::Failed,
    }
}
