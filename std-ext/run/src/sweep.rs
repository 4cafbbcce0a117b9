//! Runs of one scene with every combination of some values, compared.
//!
//! A folder holds
//! * a folder for each run, named by its values, such as `method=meyer,vertices=642`: see
//!   [`run`](crate::run);
//! * `sweep.csv`: a line for each run with its values, last numbers, cost and end;
//! * `COLUMN.png` for each chosen column: the series of all runs together, with published curves; with
//!   the feature `pictures` only;
//! * `COLUMN-over-KEY.png` for each chosen column and each key that varies over numbers: the last numbers of all
//!   runs that reached their end, and the points where curves cross; hollow marks are numbers of runs that
//!   ended unresolved, stagnated, or at the limit of iterations.
//!
//! A failed run is recorded, and the next one starts.
//!
//! A [`Part`] of a sweep has a table of its own, `sweep-K-of-N.csv`, and no plots. Other processes may run other parts in the
//! same folder. Afterwards a whole sweep that resumes compares all runs.

mod board;
mod dependence;
mod part;
mod table;
mod vary;

pub use dependence::{Crossing, Dependence};
pub use part::{Part, PartSyntaxError};
pub use vary::{Vary, VarySyntaxError};

use crate::lock::{Lock, LockError};
use crate::plots::{PlotError, read_curves};
use crate::png;
use crate::run::{CHECKPOINT, End, Progress, RunError, SUMMARY, fingerprint, run};
use crate::scene::{OverrideSyntaxError, Overrides, Scene, SceneErrors, SceneFile};
use crate::series::SeriesTable;
use crate::simulation::EffectCost;
use crate::simulation::build;
use board::Board;
use serde::Deserialize;
use std::fs;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// The table's name in its folder.
pub const TABLE: &str = "sweep.csv";

/// The largest number of runs of a sweep.
const MOST_CASES: usize = 10_000;

/// A scene and values, every combination of which is run.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The scene file.
    pub scene: PathBuf,
    /// Overrides that all runs share, see [`Overrides`].
    pub set: Vec<String>,
    /// The keys that vary; the last varies fastest.
    pub vary: Vec<Vary>,
    /// Columns of the series to show, `NAME` for all `NAME_SURFACE`. If empty, those of the scene's
    /// plots or, without plots, the first few.
    pub columns: Vec<String>,
    /// The number of simultaneous runs; each has its share of the available threads.
    pub jobs: NonZeroUsize,
    /// The part of the combinations that is run; all if there is none.
    pub part: Option<Part>,
}

/// One combination.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    /// The name of its folder.
    pub name: String,
    /// Its values, one per key.
    pub values: Vec<String>,
}

/// The reason why a sweep cannot start or continue. The message is one line, or that of the errors
/// of a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A shared override has no path.
    #[error(transparent)]
    Override(#[from] OverrideSyntaxError),
    /// No combination is a valid scene.
    #[error(transparent)]
    Scene(SceneErrors),
    /// Two keys are the same.
    #[error("`{key}` varies twice: give all its values at once, as in `{key}=1,2,3`")]
    RepeatedKey {
        /// The key.
        key: String,
    },
    /// There are too many combinations.
    #[error("{cases} combinations: at most {MOST_CASES} can be run")]
    TooMany {
        /// Number of combinations.
        cases: usize,
    },
    /// The folder already contains runs.
    #[error(
        "{}: there are runs here already: continue them with `--resume`, or name another folder with `--out`",
        folder.display()
    )]
    Occupied {
        /// The folder of one.
        folder: PathBuf,
    },
    /// The folder contains something that the sweep would replace.
    #[error(
        "{}: the sweep would replace this, which is there without runs: move it away, or name another \
         folder with `--out`",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Another process writes to the folder.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// A run's output cannot be written.
    #[error(transparent)]
    Run(RunError),
    /// A plot cannot be drawn.
    #[error("{}: {error}", path.display())]
    Plot {
        /// The picture.
        path: PathBuf,
        /// The reason.
        error: PlotError,
    },
    /// Something cannot be written.
    #[error("{}: {source}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
}

impl SweepError {
    /// Whether the error is that of an output, and not of the arguments or an input.
    pub fn is_output(&self) -> bool {
        matches!(
            self,
            Self::Run(_)
                | Self::Plot { .. }
                | Self::Unwritable { .. }
                | Self::Lock(LockError::Inaccessible { .. })
        )
    }
}

/// The progress of a sweep.
#[derive(Clone, Debug)]
pub struct SweepProgress<'a> {
    /// The run that has made a step, from 0, and how many there are.
    pub case: [usize; 2],
    /// Its name.
    pub name: &'a str,
    /// The progress of the run.
    pub run: &'a Progress<'a>,
    /// The fraction of the whole sweep from 0 to 1, with equal weights for all runs.
    pub fraction: f64,
}

/// The outcome of all combinations.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    /// The names of the keys, shortened as far as they stay distinct.
    pub keys: Vec<String>,
    /// The chosen columns that some run has.
    pub columns: Vec<String>,
    /// The unit of each of these; empty for a number without one.
    pub units: Vec<String>,
    /// Columns that no run has, and all columns that exist; empty until a run has ended.
    pub unknown: Vec<String>,
    /// All columns of all runs.
    pub known: Vec<String>,
    /// Combinations of the part, in the order of [`Sweep::cases`].
    pub cases: Vec<(Case, Outcome)>,
    /// Further warnings, for example about published curves that cannot be read.
    pub warnings: Vec<String>,
}

/// The outcome of a combination.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The run was made, now or earlier.
    Ended(Ended),
    /// The run failed, with the reason.
    Refused(String),
    /// The sweep was interrupted before this run.
    Waiting,
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// The way in which it ended.
    pub end: End,
    /// A description of the end.
    pub message: String,
    /// Iterations, or steps in time.
    pub iterations: u64,
    /// Evaluations of the velocities, of drivers in time.
    pub right_hand_sides: Option<u64>,
    /// Total time in seconds.
    pub seconds: f64,
    /// Seconds per evaluation of bending, on all surfaces together; `None` without bending.
    pub bending: Option<f64>,
    /// The series.
    pub series: SeriesTable,
    /// Further warnings.
    pub warnings: Vec<String>,
}

impl Ended {
    /// The last number of a column, NaN if there is none.
    pub fn last(&self, column: &str) -> f64 {
        let column = self.series.columns.iter().position(|name| name == column);
        let row = self.series.rows.last();
        column
            .zip(row)
            .map_or(f64::NAN, |(column, row)| row[column])
    }
}

/// The part of a `summary.json` that is read.
#[derive(Deserialize)]
struct Summary {
    end: End,
    message: String,
    iterations: u64,
    right_hand_sides: Option<u64>,
    seconds: f64,
    effects: Vec<EffectCost>,
    warnings: Vec<String>,
    fingerprint: String,
    scene: serde_json::Value,
}

impl Sweep {
    /// All combinations, of all parts.
    ///
    /// # Errors
    /// If a key varies twice, or there are too many.
    pub fn cases(&self) -> Result<Vec<Case>, SweepError> {
        for (at, vary) in self.vary.iter().enumerate() {
            if self.vary[..at].iter().any(|other| other.key == vary.key) {
                let key = vary.key.clone();
                return Err(SweepError::RepeatedKey { key });
            }
        }
        let counts = self.vary.iter().map(|vary| vary.values.len());
        let count = counts.fold(1, usize::saturating_mul);
        if count > MOST_CASES {
            return Err(SweepError::TooMany { cases: count });
        }
        let mut combinations = vec![Vec::new()];
        for Vary { values, .. } in &self.vary {
            let with = |before: &Vec<String>, value: &String| {
                let mut longer = before.clone();
                longer.push(value.clone());
                longer
            };
            let longer = combinations
                .iter()
                .flat_map(|before| values.iter().map(move |value| with(before, value)));
            combinations = longer.collect();
        }
        let keys = vary::short_keys(&self.vary);
        let mut cases: Vec<Case> = Vec::with_capacity(combinations.len());
        for values in combinations {
            let mut name = vary::file_name(&keys, &values);
            if cases.iter().any(|case| case.name == name) {
                name.push_str(&format!("-{}", cases.len() + 1));
            }
            cases.push(Case { name, values });
        }
        Ok(cases)
    }

    /// The scene of a combination.
    fn read(&self, case: &Case) -> Result<Result<SceneFile, SceneErrors>, OverrideSyntaxError> {
        let varied = self.vary.iter().zip(&case.values);
        let varied = varied.map(|(vary, value)| format!("{}={value}", vary.key));
        let overrides = Overrides::new(self.set.iter().cloned().chain(varied))?;
        Ok(SceneFile::read(&self.scene, &overrides))
    }

    /// Runs the combinations of the part in a folder, [`jobs`](Self::jobs) at once. With `resume`, continues existing
    /// runs and skips those that have ended. The table and the plots are written after every run, in
    /// the order of [`cases`](Self::cases).
    ///
    /// After every step `progress` receives the progress, and `interrupted` decides whether to
    /// stop.
    ///
    /// # Errors
    /// If no combination is a valid scene, there are runs in the folder without `resume`, or something
    /// cannot be written. Other failures of a run are its [`Outcome`].
    pub fn run(
        &self,
        folder: &Path,
        resume: bool,
        interrupted: &(dyn Fn() -> bool + Sync),
        progress: &mut (dyn FnMut(&SweepProgress<'_>) + Send),
    ) -> Result<Swept, SweepError> {
        let mut cases = self.cases()?;
        if let Some(part) = self.part {
            let mut numbers = 0..;
            cases.retain(|_| numbers.next().is_some_and(|number| part.contains(number)));
        }
        let plots = png::IS_ENABLED && self.part.is_none();
        let table = self.part.map_or_else(|| TABLE.to_owned(), Part::table);
        let table = folder.join(table);
        let mut scene = None;
        let mut refused = None;
        for case in &cases {
            match self.read(case)? {
                Ok(file) => scene = scene.or(Some(file.scene)),
                Err(errors) => refused = refused.or(Some(errors)),
            }
            let own = folder.join(&case.name);
            if !resume
                && [CHECKPOINT, "series.csv"]
                    .iter()
                    .any(|file| own.join(file).exists())
            {
                return Err(SweepError::Occupied { folder: own });
            }
        }
        // A mistyped key is reported once, not for every run.
        let scene = match (scene, refused) {
            (Some(scene), _) => scene,
            (None, Some(errors)) => return Err(SweepError::Scene(errors)),
            (None, None) => return Ok(Swept::new(self, Vec::new())),
        };
        if !resume {
            let columns = scene.output.plots.iter().map(|plot| &plot.column);
            let pictures = self.columns.iter().chain(columns).filter(|_| plots);
            let pictures = pictures.map(|column| folder.join(format!("{column}.png")));
            let mut files = pictures.chain([table.clone()]);
            if let Some(path) = files.find(|path| path.symlink_metadata().is_ok()) {
                return Err(SweepError::Foreign { path });
            }
        }
        fs::create_dir_all(folder).map_err(|source| SweepError::Unwritable {
            path: folder.to_owned(),
            source,
        })?;
        let lock = match self.part {
            None => Lock::of_folder(folder)?,
            // The folders of runs have locks of their own.
            Some(_) => Lock::of_file(&table)?,
        };
        let waiting = cases.into_iter().map(|case| (case, Outcome::Waiting));
        let mut swept = Swept::new(self, waiting.collect());
        swept.warnings.extend(lock.warning().map(str::to_owned));
        if !png::IS_ENABLED {
            let message =
                "columns are not plotted: helfrich-std was built without its feature `pictures`";
            swept.warnings.push(message.to_owned());
        }
        let mut published = Vec::new();
        for plot in &scene.output.plots {
            let curves = plot.published.as_deref().map(read_curves).transpose();
            let curves = curves.unwrap_or_else(|error| {
                swept.warnings.push(error.to_string());
                None
            });
            published.push(curves.unwrap_or_default());
        }
        let board = Board::new(swept, progress);
        board.share(self.jobs, &|at, case| {
            let interrupted = || board.is_stopped() || interrupted();
            if interrupted() {
                return Ok(());
            }
            let mut tell = |run: &Progress<'_>| board.tell(at, case, run);
            let own = folder.join(&case.name);
            let outcome = match self.run_case(case, &own, resume, &interrupted, &mut tell) {
                Ok(ended) => Outcome::Ended(ended),
                Err(Trouble::Case(reason)) => Outcome::Refused(reason),
                Err(Trouble::Sweep(error)) => return Err(error),
            };
            board.enter(at, outcome, |swept| {
                swept.choose(&self.columns, &scene);
                swept.write_table(&table)?;
                match plots {
                    true => swept.plot(folder, &scene, &published),
                    false => Ok(()),
                }
            })
        })?;
        Ok(board.into_swept())
    }

    /// Runs a combination, unless it has ended.
    fn run_case(
        &self,
        case: &Case,
        folder: &Path,
        resume: bool,
        interrupted: &dyn Fn() -> bool,
        progress: &mut dyn FnMut(&Progress<'_>),
    ) -> Result<Ended, Trouble> {
        let of_case = |error: &dyn ToString| Trouble::Case(error.to_string());
        let file = self.read(case).map_err(|error| of_case(&error))?;
        let file = file.map_err(|error| of_case(&error))?;
        let ready = build(&file).map_err(|error| of_case(&error))?;
        if resume && folder.join(SUMMARY).exists() {
            let (ended, summary) = read_ended(folder).map_err(Trouble::Case)?;
            let (simulation, positions) = &ready;
            let own = fingerprint(&file.scene, simulation, positions);
            let own = own.map_err(|error| of_case(&error))?;
            if summary.fingerprint != own.to_hex() {
                let message = "the run that is there is of another scene";
                return Err(Trouble::Case(message.to_owned()));
            }
            if ended.end != End::Interrupted && summary.scene == as_read_back(&file.scene) {
                return Ok(ended);
            }
        }
        let goes_on = resume && folder.is_dir();
        match run(&file.scene, ready, folder, goes_on, interrupted, progress) {
            Ok(_) => Ok(read_ended(folder).map_err(Trouble::Case)?.0),
            Err(error) if error.is_output() => Err(Trouble::Sweep(SweepError::Run(error))),
            Err(error) => Err(of_case(&error)),
        }
    }
}

/// A failure of a run, or of the whole sweep.
enum Trouble {
    Case(String),
    Sweep(SweepError),
}

/// The result of an earlier run, and its scene.
fn read_ended(folder: &Path) -> Result<(Ended, RunScene), String> {
    let path = folder.join(SUMMARY);
    let unreadable = |error: &dyn ToString| format!("{}: {}", path.display(), error.to_string());
    let text = fs::read_to_string(&path).map_err(|error| unreadable(&error))?;
    let summary: Summary = serde_json::from_str(&text).map_err(|error| unreadable(&error))?;
    let series = SeriesTable::read(&folder.join("series.csv")).map_err(|e| e.to_string())?;
    let bending = summary.effects.iter().filter(|cost| {
        // With several surfaces, each has its own bending, `bending_NAME`.
        let rest = cost.effect.strip_prefix("bending");
        cost.evaluations > 0 && rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    });
    let each = bending.map(|cost| cost.seconds / cost.evaluations as f64);
    let ended = Ended {
        end: summary.end,
        message: summary.message,
        iterations: summary.iterations,
        right_hand_sides: summary.right_hand_sides,
        seconds: summary.seconds,
        bending: each.reduce(|a, b| a + b),
        series,
        warnings: summary.warnings,
    };
    let scene = RunScene {
        fingerprint: summary.fingerprint,
        scene: summary.scene,
    };
    Ok((ended, scene))
}

/// The scene of a run.
struct RunScene {
    /// The fingerprint that continuations share.
    fingerprint: String,
    /// The scene as it is stored in a summary.
    scene: serde_json::Value,
}

/// A scene as read from a summary, with numbers through the same parser.
fn as_read_back(scene: &Scene) -> serde_json::Value {
    let text = serde_json::to_string(scene).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}
