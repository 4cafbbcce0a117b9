//! Runs of hard scenes as users write them: each completes properly, or reports the problem.

mod cases;
mod laws;
mod momentum;
mod scenes;

use super::{Bound, Group, Outcome, Row, StabilityError};
use cases::{CASES, Case, Trials};
use helfrich_std::method::BendingMethod;
use helfrich_std::run::{End, Progress, run};
use helfrich_std::scalar::Scalar;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::{Simulation, build};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::error::Error;
use std::path::Path;

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Course {
    /// Kind of end of the run.
    pub end: End,
    /// A description of the end.
    pub message: String,
    /// Warnings about the scene and during the run.
    pub warnings: Vec<String>,
    /// Whether energies, areas, volumes, deformations and centres are finite in every row.
    pub finite: bool,
    /// Largest change of a surface's volume, relative, over all rows.
    pub volume_change: f64,
    /// Taylor deformation at the end, in flows.
    pub deformation: Option<f64>,
    /// Largest difference of the deformation in the second half of the run from that at the end, relative.
    pub unsteadiness: Option<f64>,
    /// Difference of the deformation from that of the run with which it is compared, relative.
    pub error: Option<f64>,
}

impl Course {
    /// Whether the run completed.
    pub fn is_complete(&self) -> bool {
        matches!(self.end, End::Completed | End::Converged)
    }

    /// Whether a warning or the last message contains this text.
    pub fn says(&self, part: &str) -> bool {
        let mut all = self.warnings.iter().chain([&self.message]);
        all.any(|message| message.contains(part))
    }
}

/// Number of runs, for the progress.
pub(super) fn count() -> usize {
    CASES.iter().map(|case| case.trials.count()).sum::<usize>() + laws::count()
}

/// Performs all runs; `tell` is called before each.
pub(super) fn rows(tell: &mut dyn FnMut(&str)) -> Result<Vec<Row>, StabilityError> {
    let mut rows = Vec::new();
    let mut courses = Courses::default();
    for case in CASES {
        let mut add =
            |subject: &'static str, changes: &[&str], against: Option<&[&str]>, bound: Bound| {
                tell(&format!("{}: {subject}", case.name));
                let outcome = case.outcome(&mut courses, changes, against);
                let outcome = outcome.map_err(|source| StabilityError {
                    case: case.name,
                    source,
                })?;
                rows.push(Row::new(
                    Group::Dynamics,
                    (case.name, case.meaning),
                    (subject, Scalar::F64),
                    outcome,
                    bound,
                ));
                Ok(())
            };
        match case.trials {
            Trials::These(trials) => {
                for trial in trials {
                    add(trial.subject, trial.changes, None, trial.bound)?;
                }
            }
            Trials::EveryMethod {
                changes,
                against,
                bound,
            } => {
                for method in BendingMethod::ALL {
                    let Some(bound) = bound(method) else {
                        continue;
                    };
                    let chosen = format!("surface.0.bending.method={method}");
                    let changes = [changes, &[&*chosen]].concat();
                    add(method.name(), &changes, Some(against), bound)?;
                }
            }
        }
    }
    laws::rows(tell, &mut rows)?;
    Ok(rows)
}

type Made<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Completed runs, by scene and changes, because several rows check the same run.
#[derive(Default)]
struct Courses(HashMap<(&'static str, Vec<String>), Result<Course, String>>);

impl Courses {
    /// Returns the result of [`course`], which is computed once for equivalent changes: the last of two
    /// changes of one key counts, and the order of keys does not.
    fn of(&mut self, scene: &'static str, changes: &[&str]) -> Made<Result<Course, String>> {
        let key_of = |change: &&str| change.split('=').next().unwrap_or_default().to_owned();
        let last = changes
            .iter()
            .map(|change| (key_of(change), change.to_string()));
        let key = (scene, BTreeMap::from_iter(last).into_values().collect());
        if let Some(made) = self.0.get(&key) {
            return Ok(made.clone());
        }
        let made = course(scene, changes)?;
        Ok(self.0.entry(key).or_insert(made).clone())
    }
}

impl Case {
    fn outcome(
        &self,
        courses: &mut Courses,
        changes: &[&str],
        against: Option<&[&str]>,
    ) -> Made<Outcome> {
        let mut course = match courses.of(self.scene, changes)? {
            Ok(course) => course,
            Err(refusal) => return Ok(Outcome::Refused(refusal)),
        };
        if let Some(others) = against {
            let all = [changes, others].concat();
            if let Ok(other) = courses.of(self.scene, &all)? {
                let pair = course.deformation.zip(other.deformation);
                course.error = pair.map(|(found, expected)| (found / expected - 1.0).abs());
            }
        }
        Ok(Outcome::Ran(course))
    }
}

/// A scene, its simulation and initial positions.
type Ready = (SceneFile, Simulation, Vec<[f64; 3]>);

/// Makes a scene with changes ready to run; returns the message if it is refused.
fn ready(scene: &str, changes: &[&str]) -> Made<Result<Ready, String>> {
    let overrides = Overrides::new(changes.iter().copied())?;
    let file = match SceneFile::parse(scene, Path::new("scene.toml"), &overrides) {
        Ok(file) => file,
        Err(errors) => return Ok(Err(errors.to_string())),
    };
    Ok(match build(&file) {
        Ok((simulation, positions)) => Ok((file, simulation, positions)),
        Err(error) => Err(error.to_string()),
    })
}

/// Runs a scene with changes; returns the message if it is refused.
fn course(scene: &str, changes: &[&str]) -> Made<Result<Course, String>> {
    let folder = tempfile::tempdir()?;
    let folder = folder.path().join("run");
    let (file, simulation, positions) = match ready(scene, changes)? {
        Ok(ready) => ready,
        Err(refusal) => return Ok(Err(refusal)),
    };
    let ready = (simulation, positions);
    let summary = match run(&file.scene, ready, &folder, false, &|| false, &mut quiet) {
        Ok(summary) => summary,
        Err(error) if error.is_output() => return Err(error.into()),
        Err(error) => return Ok(Err(error.to_string())),
    };
    let series = SeriesTable::read(&folder.join("series.csv"))?;
    let deformation = series.column("deformation");
    let last = deformation
        .as_ref()
        .and_then(|column| column.last().copied());
    let second_half = deformation
        .as_ref()
        .map(|column| &column[column.len() / 2..]);
    let unsteadiness = second_half.zip(last).map(|(values, last)| {
        let differences = values.iter().map(|value| (value / last - 1.0).abs());
        differences.fold(0.0, f64::max)
    });
    Ok(Ok(Course {
        end: summary.end,
        message: summary.message,
        warnings: summary.warnings,
        finite: is_finite(&series),
        volume_change: volume_change(&series),
        deformation: last,
        unsteadiness,
        error: None,
    }))
}

fn quiet(_: &Progress) {}

/// Columns that are defined for every surface in these scenes, because all surfaces are closed.
const DEFINED: [&str; 7] = [
    "energy",
    "area",
    "volume",
    "deformation",
    "wrinkles",
    "centroid",
    "smallest_angle",
];

fn is_finite(series: &SeriesTable) -> bool {
    let names = series.columns.iter().enumerate();
    let defined = names.filter(|(_, name)| DEFINED.iter().any(|known| name.starts_with(known)));
    let defined = Vec::from_iter(defined.map(|(at, _)| at));
    let mut numbers = series
        .rows
        .iter()
        .flat_map(|row| defined.iter().map(|&at| row[at]));
    numbers.all(f64::is_finite)
}

fn volume_change(series: &SeriesTable) -> f64 {
    let names = series.columns.iter().enumerate();
    let volumes = names.filter(|(_, name)| name.starts_with("volume"));
    let changes = volumes.flat_map(|(at, _)| {
        let mut column = series.rows.iter().map(move |row| row[at]);
        let first = column.next().unwrap_or(f64::NAN);
        column.map(move |volume| (volume / first - 1.0).abs())
    });
    changes.fold(0.0, |most, change| {
        // NaN does not count as a small change.
        if change.is_nan() {
            f64::INFINITY
        } else {
            most.max(change)
        }
    })
}

/// Whether a run satisfies a bound.
pub(super) fn allows(bound: Bound, course: &Course) -> Option<bool> {
    let whole = course.finite && course.is_complete();
    Some(match bound {
        Bound::Runs { volume } => whole && course.volume_change <= volume,
        Bound::RunsInSilence { volume } => {
            whole && course.volume_change <= volume && course.warnings.is_empty()
        }
        Bound::Steady { most } => {
            whole && course.unsteadiness.is_some_and(|unsteady| unsteady <= most)
        }
        Bound::RunsNear { most } => whole && course.error.is_some_and(|error| error <= most),
        Bound::RunsNearOrSays { most, why } => {
            let near = whole && course.error.is_some_and(|error| error <= most);
            near || (course.finite && course.says(why))
        }
        Bound::Says(part) => course.finite && course.says(part),
        Bound::Stops(part) => {
            course.finite && !course.is_complete() && course.message.contains(part)
        }
        _ => return None,
    })
}
