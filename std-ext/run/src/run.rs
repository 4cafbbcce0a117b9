//! A run of a scene in a folder: driver, outputs, checkpoints and resumption.
//!
//! A folder holds
//! * `series.csv`: rows of numbers at regular iterations or times, and at the end of each load;
//! * `surfaces/NAME-TIME.vtp` with `surfaces.pvd`, their index;
//! * `last.vtp`, or `last-NAME.vtp` of several surfaces: the final surfaces, which can be the
//!   `mesh` of another scene;
//! * `pictures/TIME.png`;
//! * `slices/NAME-TIME.vti` and `.png` with `slices.pvd`: the fluid on the scene's slices;
//! * `volumes/NAME-TIME.vti` with `volumes.pvd`: all fluid of a box;
//! * `series-NAME.csv`: rows for each surface of a population, on request;
//! * `plots/COLUMN.png`: columns of the series, drawn when the run ends;
//! * `modes.csv`: the normal modes of an equilibrium, if the driver asks for them;
//! * `rheology.csv`, `profiles.csv`: means over the time of the run, if the scene measures a suspension;
//! * `checkpoint`: the state from which the run continues bit for bit;
//! * `summary.json`: the end of the run, the last row, the cost of each effect, and the scene as
//!   run.
//!
//! Every file except the series is complete or absent, and a resumed run truncates the series to
//! the checkpoint. A run that is killed at any time loses only the work since its last checkpoint;
//! the first checkpoint is written before the first row.
//!
//! Only one process at a time runs in a folder: it holds a [`Lock`] there until the run ends. A new run does
//! not replace files that it finds in its folder, nor any run a file that its scene reads.

mod acts;
mod census;
mod clock;
mod costs;
mod curved;
mod deformed;
mod drive;
mod error;
mod estimate;
mod files;
mod flowing;
mod folder;
mod identity;
mod immersing;
mod measure;
mod modes;
mod quality;
mod relaxing;
mod remedy;
mod remeshing;
mod rheology;
mod start;
mod state;
mod summary;

pub(crate) use identity::fingerprint;

use crate::checkpoint::{self, Fingerprint};
use crate::io::replace_file;
use crate::lock::Lock;
use crate::scene::{Driver, Scene};
use crate::series::{Series, SeriesError, SeriesTable};
use crate::simulation::{Acting, Body, EffectCost, Simulation, messages_once};
use census::Census;
use drive::{Drive, Mark};
pub use error::RunError;
pub use estimate::EnergyEstimate;
use files::PlannedPlot;
use measure::Measures;
pub use modes::stability;
pub use quality::Flagged;
pub use remeshing::Remeshing;
use remeshing::{Remesher, RemeshingState};
pub use rheology::Average;
use rheology::Rheometer;
pub use start::assist;
use start::drive;
use state::{DriveState, Outputs, Stored};
use std::collections::HashSet;
use std::path::Path;
use std::time::Instant;
pub use summary::{End, Summary};

/// The checkpoint's name in its folder.
pub const CHECKPOINT: &str = "checkpoint";

/// The series' name in its folder.
const SERIES: &str = "series.csv";

/// The summary's name in its folder.
pub(crate) const SUMMARY: &str = "summary.json";

/// The progress of a run.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// From 0 to 1.
    pub fraction: f64,
    /// Description of the progress.
    pub message: &'a str,
    /// The positions of all surfaces, one after the other.
    pub positions: &'a [[f64; 3]],
    /// The surfaces; after a new mesh or a change of topology they have others than at the start.
    pub bodies: &'a [Body],
}

/// Runs a scene that was prepared by [`build`](crate::simulation::build) in a folder, which is
/// created if necessary. With `resume`, continues the run in the folder from its last checkpoint,
/// or from the start if it was stopped before its first checkpoint. A resumed scene may have
/// another title, other outputs and a later end.
///
/// After every step `progress` receives the progress, and `interrupted` decides whether to stop.
///
/// # Errors
/// If no effect resists deformation, the folder holds another run, another process writes there, or
/// something cannot be written. A scene that does not reach its equilibrium is not an error: see
/// [`End`].
pub fn run(
    scene: &Scene,
    (mut simulation, positions): (Simulation, Vec<[f64; 3]>),
    folder: &Path,
    resume: bool,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Result<Summary, RunError> {
    let start = Instant::now();
    folder::refuse_inputs(scene, &simulation, folder)?;
    let lock = folder::lock_if_there(folder)?;
    let fingerprint = fingerprint(scene, &simulation, &positions)?;
    let [path, series_path] = [CHECKPOINT, SERIES].map(|name| folder.join(name));
    let stored: Option<Stored> = if !resume {
        folder::refuse_occupied(folder)?;
        None
    } else if folder::has_checkpoint(folder, lock.as_ref())? {
        Some(checkpoint::read(&path, fingerprint).map_err(RunError::Checkpoint)?)
    } else {
        None
    };
    if stored.is_none() {
        folder::refuse_foreign(scene, &simulation, folder)?;
    }
    let (state, outputs) = stored
        .map(|stored| ((stored.drive, stored.remeshing), stored.outputs))
        .unzip();
    let PlannedRun {
        measures,
        remesher,
        drive,
        rheometer,
        mut census,
        plots,
    } = plan(scene, &mut simulation, positions, state)?;
    let lock = match resume {
        true => lock,
        false => Some(folder::make(folder, lock)?),
    };
    folder::tidy(folder);
    census.open(folder, outputs.as_ref().map(|outputs| outputs.rows))?;
    let columns = Vec::from_iter(census.columns().iter().map(String::as_str));
    let (series, outputs, last) = match outputs {
        Some(outputs) => {
            let series = Series::resume(&series_path, &columns, outputs.rows);
            let series = series.map_err(RunError::Series)?;
            let table = SeriesTable::read(&series_path).map_err(RunError::Series)?;
            let last = table.rows.last().cloned();
            (series, Some(outputs), last.unwrap_or_default())
        }
        None => {
            let series = Series::create(&series_path, &columns)
                .map_err(|error| RunError::Output(Box::new(error)))?;
            (series, None, Vec::new())
        }
    };
    // The work of resuming is not counted.
    let uncounted = outputs.as_ref().map(|_| simulation.costs());
    let uncounted = uncounted.into_iter().flatten();
    let begins = outputs.is_none();
    let mut run = Run {
        scene,
        folder,
        fingerprint,
        uncounted: uncounted.map(|cost| cost.evaluations).collect(),
        simulation,
        measures,
        remesher,
        drive,
        rheometer,
        census,
        plots,
        series,
        outputs: outputs.unwrap_or_default(),
        start,
        last,
        lock,
    };
    if begins {
        run.checkpoint()?;
    }
    let (end, message) = run.drive(interrupted, progress)?;
    run.finish(end, message)
}

/// State of a run before anything is written.
struct PlannedRun<'a> {
    measures: Measures,
    remesher: Remesher,
    drive: Box<dyn Drive + 'a>,
    rheometer: Option<Rheometer>,
    census: Census,
    plots: Vec<PlannedPlot<'a>>,
}

/// Makes all checks of [`run`] that precede its first output, and writes nothing.
///
/// # Errors
/// As [`run`], except errors of the folder.
pub fn check(
    scene: &Scene,
    (mut simulation, positions): (Simulation, Vec<[f64; 3]>),
) -> Result<(), RunError> {
    plan(scene, &mut simulation, positions, None).map(drop)
}

fn plan<'a>(
    scene: &'a Scene,
    simulation: &mut Simulation,
    mut positions: Vec<[f64; 3]>,
    state: Option<(DriveState, RemeshingState)>,
) -> Result<PlannedRun<'a>, RunError> {
    files::refuse_pictures(&scene.output)?;
    start::refuse_ranks(scene, simulation)?;
    let begins = state.is_none();
    let mut measures = Measures::new(scene, simulation, &positions);
    let mut remesher = Remesher::new(scene, simulation, &positions);
    let state = match state {
        Some((state, remeshing)) => {
            remesher.resume(scene, simulation, remeshing)?;
            positions = remesher.references();
            Some(state)
        }
        None => None,
    };
    let rheometer = Rheometer::new(scene, simulation, &positions);
    // Held areas and volumes may be those of smooth surfaces now.
    measures.meshes_changed(scene, simulation);
    let drive = drive(scene, simulation, positions, state)?;
    if begins {
        acts::refuse_idle(scene, simulation, drive.positions())?;
    }
    let mut columns = measures.columns(&*drive, simulation);
    columns.extend(Run::probe_columns(scene));
    columns.extend(rheometer.iter().flat_map(Rheometer::columns));
    let census = Census::new(scene, &columns);
    let mut columns = census.columns().to_vec();
    let mut seen = HashSet::new();
    let repeated = columns.iter().position(|column| !seen.insert(column));
    if let Some(at) = repeated {
        let column = columns.swap_remove(at);
        return Err(RunError::RepeatedColumn { column });
    }
    let plots = scene.output.plots.iter();
    let plots = plots.map(|plot| PlannedPlot::new(plot, &columns, simulation));
    let plots = plots.collect::<Result<_, _>>()?;
    Ok(PlannedRun {
        measures,
        remesher,
        drive,
        rheometer,
        census,
        plots,
    })
}

fn make_folder(path: &Path) -> Result<(), RunError> {
    std::fs::create_dir_all(path).map_err(|source| RunError::Unwritable {
        path: path.to_owned(),
        source,
    })
}

/// A run under way.
struct Run<'a> {
    scene: &'a Scene,
    folder: &'a Path,
    fingerprint: Fingerprint,
    simulation: Simulation,
    measures: Measures,
    remesher: Remesher,
    drive: Box<dyn Drive + 'a>,
    rheometer: Option<Rheometer>,
    census: Census,
    plots: Vec<PlannedPlot<'a>>,
    series: Series,
    /// Costs and seconds include those of the resumed runs.
    outputs: Outputs,
    start: Instant,
    /// The last row.
    last: Vec<f64>,
    /// Evaluations of each effect that an uninterrupted run would not make.
    uncounted: Vec<u64>,
    /// Held as long as the run writes.
    lock: Option<Lock>,
}

impl Run<'_> {
    /// Runs step by step until the end.
    fn drive(
        &mut self,
        interrupted: &dyn Fn() -> bool,
        progress: &mut dyn FnMut(&Progress<'_>),
    ) -> Result<(End, String), RunError> {
        if self.outputs.written.is_none() {
            if !self.replace_worn(interrupted)? {
                return self.interrupted();
            }
            // A relaxation may begin with a surface that is not resolved.
            self.write(false)?;
            self.checkpoint()?;
        }
        loop {
            // Before a step, so that a continued run repeats it.
            if !self.replace_worn(interrupted)? {
                return self.interrupted();
            }
            if let Some(message) = self.remesher.worn_out(&*self.drive) {
                // The last checkpoint is of a state that could go on.
                self.write(true)?;
                return Ok((End::Failed, message));
            }
            if self.remesher.measures(&*self.drive) {
                self.measure()?;
            }
            let mut step = self.drive.step(&mut self.simulation)?;
            if let Some(worn) = step.worn {
                if self.remesher.can_replace(worn, &*self.drive) {
                    if !self.replace(&[worn], interrupted)? {
                        return self.interrupted();
                    }
                } else {
                    step = self.drive.worn_out(&mut self.simulation);
                    step.end = step.end.map(|(end, why)| {
                        let why = match self.remesher.renews(worn) {
                            true => {
                                let body = &self.simulation.bodies()[worn];
                                self.remesher.folded(body, &*self.drive)
                            }
                            false => format!("mesh worn out: {why}"),
                        };
                        (end, why)
                    });
                }
            }
            if matches!(step.end, Some((End::Converged, _))) && self.measure()? {
                continue;
            }
            let (fraction, message) = self.drive.progress();
            progress(&Progress {
                fraction,
                message: &message,
                positions: self.drive.positions(),
                bodies: self.simulation.bodies(),
            });
            if step.output
                && let Some(message) = self.write(step.end.is_some())?
            {
                // No checkpoint: the last one, of a state that could go on, is kept.
                return Ok((End::Failed, message));
            }
            if step.checkpoint {
                self.checkpoint()?;
            }
            if let Some(end) = step.end {
                return Ok(end);
            }
            if interrupted() {
                return self.interrupted();
            }
        }
    }

    fn interrupted(&mut self) -> Result<(End, String), RunError> {
        self.checkpoint()?;
        let message = format!(
            "interrupted at {}: `--resume` continues",
            self.drive.caption()
        );
        Ok((End::Interrupted, message))
    }

    /// Measures held areas and volumes anew; false if they stay as they are.
    fn measure(&mut self) -> Result<bool, RunError> {
        let (scene, simulation) = (self.scene, &mut self.simulation);
        let changed = self.remesher.measure(scene, simulation, &mut *self.drive)?;
        if changed {
            self.measures.meshes_changed(scene, &self.simulation);
        }
        Ok(changed)
    }

    /// Replaces the meshes that are due; false if this was interrupted.
    fn replace_worn(&mut self, interrupted: &dyn Fn() -> bool) -> Result<bool, RunError> {
        let (scene, simulation) = (self.scene, &mut self.simulation);
        if self.remesher.part(scene, simulation, &mut *self.drive)? {
            self.measures.meshes_changed(scene, &self.simulation);
        }
        let positions = self.drive.positions();
        let due = self.remesher.due(&self.simulation, positions);
        self.replace(&due, interrupted)
    }

    /// Replaces the meshes of some surfaces; false if this was interrupted.
    fn replace(
        &mut self,
        surfaces: &[usize],
        interrupted: &dyn Fn() -> bool,
    ) -> Result<bool, RunError> {
        if surfaces.is_empty() {
            return Ok(true);
        }
        let start = Instant::now();
        let (scene, simulation) = (self.scene, &mut self.simulation);
        let (remesher, drive) = (&mut self.remesher, &mut *self.drive);
        let done = remesher.replace(surfaces, scene, simulation, drive, interrupted)?;
        self.measures.meshes_changed(scene, &self.simulation);
        self.outputs.output_costs.remeshing.add(start);
        Ok(done)
    }

    /// Writes a row of the series and, if due or at the end, a set of files, unless this has been
    /// done at this point already. Returns the reason why the run cannot go on, if there is one.
    fn write(&mut self, last: bool) -> Result<Option<String>, RunError> {
        let mark = self.drive.mark();
        if self.outputs.written == Some(mark.number) {
            return Ok(None);
        }
        let start = Instant::now();
        let acting = self.simulation.resolve(self.drive.positions());
        let flagged = quality::flagged(&self.simulation, self.drive.positions());
        let mut row = self.measures.row(
            &*self.drive,
            &self.simulation,
            &self.remesher,
            &acting,
            &flagged,
        );
        self.doubt(flagged.iter().flatten());
        self.outputs.output_costs.quality.add(start);
        row.extend(self.probe());
        if let Some(rheometer) = &self.rheometer {
            row.extend(rheometer.numbers(&mut *self.drive, &mut self.simulation, &acting));
        }
        let start = Instant::now();
        let output = |error: SeriesError| RunError::Output(Box::new(error));
        self.census.append(&row).map_err(output)?;
        let row = self.census.row(&row);
        self.series.append(&row).map_err(output)?;
        self.outputs.output_costs.files.add(start);
        self.last = row;
        self.note_profile();
        let impossible = quality::impossible(&self.simulation, &acting, &flagged);
        let files_every = self.scene.output.files_every;
        let due = self.outputs.sets.is_multiple_of(files_every);
        self.outputs.sets += 1;
        let last = last || impossible.is_some();
        if due || last {
            self.write_files(mark, &acting, last)?;
        }
        self.outputs.written = Some(mark.number);
        Ok(impossible)
    }

    /// Writes a set of files, which may be the last.
    fn write_files(&mut self, mark: Mark, acting: &[Acting], last: bool) -> Result<(), RunError> {
        if self.scene.output.surfaces {
            let start = Instant::now();
            self.write_surfaces(mark, acting)?;
            self.outputs.output_costs.files.add(start);
        }
        let counts = [self.outputs.pictures, self.drive.positions().len() as u64];
        let work = self.drive.work();
        let seconds = costs::estimated_seconds(self.scene, &self.simulation, work);
        if costs::is_drawn(&self.scene.output, counts, seconds, last) {
            let start = Instant::now();
            self.draw(mark, acting)?;
            self.outputs.pictures += 1;
            self.outputs.output_costs.pictures.add(start);
        }
        self.write_slices(mark)?;
        self.write_volumes(mark)
    }

    fn checkpoint(&mut self) -> Result<(), RunError> {
        let start = Instant::now();
        let rows = self.census.mark().and_then(|()| self.series.mark());
        self.outputs.rows = rows.map_err(|error| RunError::Output(Box::new(error)))?;
        let costs = self.costs();
        let stored = Stored {
            drive: self.drive.state(),
            remeshing: self.remesher.state().clone(),
            outputs: Outputs {
                costs: costs.iter().map(|c| (c.evaluations, c.seconds)).collect(),
                seconds: self.seconds(),
                ..self.outputs.clone()
            },
        };
        checkpoint::write(&self.folder.join(CHECKPOINT), self.fingerprint, &stored)
            .map_err(|error| RunError::Output(Box::new(error)))?;
        self.outputs.output_costs.files.add(start);
        Ok(())
    }

    fn seconds(&self) -> f64 {
        self.outputs.seconds + self.start.elapsed().as_secs_f64()
    }

    /// Costs of effects in this run and in the runs that it continues.
    fn costs(&self) -> Vec<EffectCost> {
        let mut costs = self.simulation.costs();
        for (cost, uncounted) in costs.iter_mut().zip(&self.uncounted) {
            cost.evaluations -= uncounted;
        }
        costs.extend(self.drive.costs());
        for (cost, &(evaluations, seconds)) in costs.iter_mut().zip(&self.outputs.costs) {
            cost.evaluations += evaluations;
            cost.seconds += seconds;
        }
        costs
    }

    fn finish(&mut self, end: End, message: String) -> Result<Summary, RunError> {
        let start = Instant::now();
        self.draw_plots()?;
        if !self.plots.is_empty() {
            self.outputs.output_costs.pictures.add(start);
        }
        let start = Instant::now();
        self.write_last()?;
        self.outputs.output_costs.files.add(start);
        let columns = self.census.columns().iter().cloned();
        let last = columns.zip(self.last.clone());
        let work = self.drive.work();
        // The last row may be from the resumed run.
        let start = Instant::now();
        let positions = self.drive.positions();
        let acting = self.simulation.resolve(positions);
        let flagged = quality::flagged(&self.simulation, positions);
        let flagged = Vec::from_iter(flagged.into_iter().flatten());
        let (mut energy_estimates, mut modes) = (Vec::new(), (Vec::new(), None));
        let (mut end, mut message) = (end, message);
        if let (Driver::Relax(relax), true) = (self.scene.driver, end.is_reached()) {
            energy_estimates =
                estimate::estimates(self.scene, &self.simulation, &acting, positions);
            self.outputs.output_costs.quality.add(start);
            let reached = (end, message);
            (end, message) =
                summary::judge(reached, self.scene, relax, &flagged, &energy_estimates);
            modes = modes::found(relax, end, &mut self.simulation, positions);
        }
        let warnings = self.simulation.warnings().iter();
        let mut warnings = Vec::from_iter(warnings.map(ToString::to_string));
        let (modes, warning) = modes;
        warnings.extend(warning);
        modes::write(&modes, self.folder)?;
        let (rheology, warning) = self.average()?;
        warnings.extend(warning);
        let notes = self.drive.notes().iter();
        let notes = notes.chain(self.remesher.notes());
        let notes = notes.chain(self.outputs.doubts.iter().map(|(_, note)| note));
        let names = Vec::from_iter(self.simulation.bodies().iter().map(Body::name));
        warnings.extend(messages_once(notes.cloned().collect(), &names));
        let lock = self.lock.iter().filter_map(Lock::warning);
        warnings.extend(lock.map(str::to_owned));
        let (effects, seconds) = (self.costs(), self.seconds());
        let in_effects = effects.iter().map(|cost| cost.seconds).sum();
        let outputs = self.outputs.output_costs;
        let summary = Summary {
            title: self.scene.title.clone(),
            end,
            message,
            iterations: work.iterations,
            right_hand_sides: work.right_hand_sides,
            seconds,
            last: last.collect(),
            parts: outputs.parts(work.iterations, in_effects, seconds),
            effects: Census::costs(self.scene, effects),
            flagged,
            energy_estimates,
            remeshings: self.remesher.events().to_vec(),
            modes,
            rheology,
            warnings,
            version: env!("CARGO_PKG_VERSION"),
            fingerprint: self.fingerprint.to_hex(),
            scene: self.scene.clone(),
        };
        let path = self.folder.join(SUMMARY);
        replace_file(&path, |out| {
            serde_json::to_writer_pretty(&mut *out, &summary)?;
            writeln!(out)
        })
        .map_err(|source| RunError::Unwritable { path, source })?;
        Ok(summary)
    }
}
