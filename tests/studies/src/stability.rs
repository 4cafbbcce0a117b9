//! Methods and formulas on hard cases. This file has the data; [`crate::report`] presents them.
//!
//! Each row has a result and the bound that it must satisfy. Every row is a test: the tests call
//! [`Stability::run`] and check whether each row has passed.

mod cancellation;
mod double_double;
mod dynamics;
mod geometry;
mod input;
mod kernels;
mod specimen;
mod threads;

pub use double_double::DoubleDouble;
pub use dynamics::Course;

use helfrich_std::scalar::Scalar;
use helfrich_std::study::StudyProgress;
use serde::Serialize;
use std::error::Error;
use std::fmt;
use std::str::FromStr;

/// The subject of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// A bending method on a hard surface.
    Geometry,
    /// A mesh or surface that has to be refused.
    Input,
    /// The rounding error of a formula on its worst cases.
    Cancellation,
    /// A run of a hard scene.
    Dynamics,
    /// A comparison of results on one thread and on two.
    Threads,
}

impl Group {
    /// All groups, in the order of the table.
    pub const ALL: [Self; 5] = [
        Self::Geometry,
        Self::Cancellation,
        Self::Dynamics,
        Self::Threads,
        Self::Input,
    ];

    /// The name, and a sentence about the measured quantity and its bound.
    pub fn describe(self) -> (&'static str, &'static str) {
        match self {
            Self::Geometry => (
                "geometry",
                "Largest error of the force density f over the vertices, relative to the largest \
                 exact |f|, and the slope of the line through 0 that fits f to the exact one, \
                 weighted by area: 1 if both agree on average, -1 if the sign is wrong. A method \
                 must be stable or flag the vertices where it is not; then the others count. \
                 Errors, slopes and the flagged part of the vertices have bounds.",
            ),
            Self::Input => (
                "input",
                "Invalid input is refused with a message that names the reason.",
            ),
            Self::Cancellation => (
                "cancellation",
                "Largest error of a formula, compared with the same code in twice the \
                 precision at the same positions. The unit is the change that one unit in \
                 the last place causes, of the longest edge in each coordinate and of the \
                 result. A formula with avoidable cancellation has errors of thousands.",
            ),
            Self::Dynamics => (
                "dynamics",
                "Whole runs of scenes, in f64 except for lattices in f32. Each run must \
                 reach its end with finite numbers and a constant volume, or report the \
                 problem: before it starts, by a warning, or by stopping with the reason.",
            ),
            Self::Threads => (
                "threads",
                "The number of values of a result that differ between one thread and two \
                 threads in any bit.",
            ),
        }
    }
}

/// Error for a name that is not a group.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no group `{name}`: the groups are {}", Group::ALL.map(|group| group.describe().0).join(", "))]
pub struct UnknownGroup {
    name: String,
}

impl FromStr for Group {
    type Err = UnknownGroup;

    fn from_str(name: &str) -> Result<Self, UnknownGroup> {
        let found = Self::ALL
            .into_iter()
            .find(|group| group.describe().0 == name);
        found.ok_or_else(|| UnknownGroup {
            name: name.to_owned(),
        })
    }
}

/// One case for one method or formula in one number type.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The subject of the row.
    pub group: Group,
    /// The case's name.
    pub case: &'static str,
    /// The meaning of the case, in a sentence.
    pub meaning: &'static str,
    /// The method or formula.
    pub subject: &'static str,
    /// The number type.
    pub scalar: Scalar,
    /// The result.
    pub outcome: Outcome,
    /// The bound on the result.
    pub bound: Bound,
    /// Whether the result satisfies the bound.
    pub passed: bool,
}

/// The result of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Numbers for every vertex.
    Evaluated(Evaluation),
    /// An error, with this message.
    Refused(String),
    /// One number; the row's group or case defines its meaning.
    Measured(f64),
    /// A run, complete or not.
    Ran(Course),
}

/// The result of a method on a hard surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Whether energy, forces, curvatures, normals and areas all are finite.
    pub finite: bool,
    /// Largest error of f over the vertices, relative to the largest exact |f|; `None` where f is not
    /// known exactly.
    pub error: Option<f64>,
    /// This error over the vertices that the quality report does not flag; `None` if it flags all.
    pub unflagged_error: Option<f64>,
    /// Σ A f_found f/Σ A f² over the vertices that are not flagged, over all if all are; A areas of vertices.
    pub slope: Option<f64>,
    /// Largest change of f under an exact translation, relative to the largest |f|.
    pub moved: Option<f64>,
    /// Largest change of f under an exact scaling, relative to the largest |f|.
    pub scaled: Option<f64>,
    /// Number of findings.
    pub findings: usize,
    /// Number of flagged vertices.
    pub flagged: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Checksum of all bits of f, which shows whether builds or numbers of threads change a bit.
    pub checksum: u64,
}

/// The bound of a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bound {
    /// Everything is finite and invariant, and f is near the exact one over the vertices that are not flagged,
    /// over all if all are.
    Near {
        /// Largest error, relative to the largest exact |f|.
        error: f64,
        /// Largest deviation of the slope from 1.
        slope: f64,
        /// Largest part of the vertices that is flagged.
        flagged: f64,
    },
    /// Everything is finite and invariant; f is not known exactly.
    Finite {
        /// Largest part of the vertices that is flagged.
        flagged: f64,
    },
    /// Everything is finite and invariant, and there is a finding.
    Reported,
    /// The case is refused, with a message that contains this text.
    Refused(&'static str),
    /// The case is refused, with a message that contains both texts.
    RefusedForBoth(&'static str, &'static str),
    /// The number is at most this.
    AtMost(f64),
    /// A run completes with finite numbers, and changes no volume by more than this fraction.
    Runs {
        /// The fraction.
        volume: f64,
    },
    /// A run completes as for [`Self::Runs`], without warnings.
    RunsInSilence {
        /// The fraction.
        volume: f64,
    },
    /// A run completes with finite numbers, and the deformation in the second half differs by at most this
    /// fraction from that at the end.
    Steady {
        /// The fraction.
        most: f64,
    },
    /// A run completes with finite numbers, and its deformation differs by at most this fraction from
    /// that of the run with which it is compared.
    RunsNear {
        /// The fraction.
        most: f64,
    },
    /// A run completes as for [`Self::RunsNear`]; or all its numbers are finite, and a warning or its last
    /// message contains the reason for the difference.
    RunsNearOrSays {
        /// The fraction.
        most: f64,
        /// A part of the message.
        why: &'static str,
    },
    /// All numbers of a run are finite, and a warning or its last message contains this text.
    Says(&'static str),
    /// All numbers of a run are finite, and it stopped with a message that contains this text.
    Stops(&'static str),
}

impl Bound {
    /// Whether an outcome satisfies the bound.
    pub fn allows(self, outcome: &Outcome) -> bool {
        // The conditions are written such that NaN never passes.
        match (self, outcome) {
            (bound, Outcome::Evaluated(found)) => found.is_sound() && found.is_within(bound),
            (Self::Refused(part), Outcome::Refused(message)) => message.contains(part),
            (Self::RefusedForBoth(one, other), Outcome::Refused(message)) => {
                message.contains(one) && message.contains(other)
            }
            (Self::AtMost(most), Outcome::Measured(value)) => *value <= most,
            (bound, Outcome::Ran(course)) => dynamics::allows(bound, course).unwrap_or(false),
            _ => false,
        }
    }
}

impl Evaluation {
    /// Whether all is finite, and unchanged by an exact translation and an exact scaling.
    fn is_sound(&self) -> bool {
        let unchanged = |defect: Option<f64>| defect.is_none_or(|defect| defect == 0.0);
        self.finite && unchanged(self.moved) && unchanged(self.scaled)
    }

    fn is_within(&self, bound: Bound) -> bool {
        let part = self.flagged as f64 / self.vertices as f64;
        match bound {
            Bound::Near {
                error,
                slope,
                flagged,
            } => {
                let least = self.unflagged_error.or(self.error);
                part <= flagged
                    && least.is_some_and(|found| found <= error)
                    && self.slope.is_some_and(|found| (found - 1.0).abs() <= slope)
            }
            Bound::Finite { flagged } => part <= flagged,
            Bound::Reported => self.findings > 0,
            _ => false,
        }
    }
}

impl Row {
    /// Makes a row, which passes if the bound allows the outcome.
    pub fn new(
        group: Group,
        (case, meaning): (&'static str, &'static str),
        (subject, scalar): (&'static str, Scalar),
        outcome: Outcome,
        bound: Bound,
    ) -> Self {
        let passed = bound.allows(&outcome);
        Self {
            group,
            case,
            meaning,
            subject,
            scalar,
            outcome,
            bound,
            passed,
        }
    }
}

impl fmt::Display for Row {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            case,
            subject,
            scalar,
            outcome,
            bound,
            ..
        } = self;
        write!(
            formatter,
            "{case}: {subject} in {scalar}: {outcome:?}, bound {bound:?}"
        )
    }
}

/// Approximate cost of a run, in evaluations of a method on a hard surface.
const RUN: usize = 20;

/// Extent of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stability {
    /// Whether the mesh of a million vertices is among the cases; it takes minutes.
    pub large: bool,
    /// The only group of rows to make; `None` for all.
    pub group: Option<Group>,
}

/// The reason why the table cannot be made.
#[derive(Debug, thiserror::Error)]
#[error("the case `{case}` cannot be made: {source}")]
pub struct StabilityError {
    /// The case.
    case: &'static str,
    /// The reason.
    source: Box<dyn Error + Send + Sync>,
}

impl Stability {
    /// Makes the table, row by row; `progress` is called at every step.
    ///
    /// # Errors
    /// If a mesh cannot be made, or there is no space for a run.
    pub fn run(
        self,
        progress: &mut dyn FnMut(StudyProgress<'_>),
    ) -> Result<Vec<Row>, StabilityError> {
        let wanted = |group| self.group.is_none_or(|only| only == group);
        let evaluations = match wanted(Group::Geometry) {
            true => geometry::count(self.large),
            false => 0,
        };
        let runs = match wanted(Group::Dynamics) {
            true => dynamics::count(),
            false => 0,
        };
        let total = (evaluations + RUN * runs + 1) as u64;
        let mut rows = Vec::new();
        if wanted(Group::Geometry) {
            rows = geometry::rows(self.large, &mut |done, at| {
                let done = done as u64;
                progress(StudyProgress { done, total, at });
            })?;
        }
        let mut dynamics = Vec::new();
        if wanted(Group::Dynamics) {
            let mut run = 0;
            dynamics = dynamics::rows(&mut |at| {
                let done = (evaluations + RUN * run) as u64;
                progress(StudyProgress { done, total, at });
                run += 1;
            })?;
        }
        progress(StudyProgress {
            done: total - 1,
            total,
            at: "formulas in twice the precision, threads, input",
        });
        if wanted(Group::Cancellation) {
            rows.extend(cancellation::rows());
            rows.extend(kernels::rows());
        }
        rows.extend(dynamics);
        if wanted(Group::Threads) {
            rows.extend(threads::rows()?);
        }
        if wanted(Group::Input) {
            rows.extend(input::rows());
        }
        Ok(rows)
    }
}
