//! Problems of a scene, and their messages.

use super::UnitSystem;
use super::units::Dimension;
use super::value::Origin;
use crate::generate::{GenerateError, ParseShapeError};
use std::fmt;
use std::path::PathBuf;

/// An error in a scene, or a warning about it, with its place.
///
/// Displayed as `file:line:column: problem: remedy`, with the line of the file below.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// The scene file.
    pub path: PathBuf,
    /// The place in the file, or the override.
    pub place: Place,
    /// The problem.
    pub problem: Problem,
}

/// The place of a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A place in its text.
    Text {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// The line, without its end.
        text: String,
        /// Number of characters of the line that are concerned, 1 or more.
        width: usize,
    },
    /// An override, as it was given.
    Override(String),
}

/// All errors of a scene, in the order of its text; at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneErrors(Vec<SceneError>);

impl SceneErrors {
    /// The errors.
    pub fn errors(&self) -> &[SceneError] {
        &self.0
    }

    pub(crate) fn new(errors: Vec<SceneError>) -> Option<Self> {
        (!errors.is_empty()).then_some(Self(errors))
    }
}

impl From<SceneError> for SceneErrors {
    fn from(error: SceneError) -> Self {
        Self(vec![error])
    }
}

impl std::error::Error for SceneErrors {}

impl fmt::Display for SceneErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            write!(f, "{}{error}", if index == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            path,
            place,
            problem,
        } = self;
        match place {
            Place::File => write!(f, "{}: {problem}", path.display()),
            Place::Override(text) => write!(f, "--set {text}: {problem}"),
            Place::Text {
                line,
                column,
                text,
                width,
            } => {
                writeln!(f, "{}:{line}:{column}: {problem}", path.display())?;
                // Long lines are cut, control characters would move the marks.
                let before = (column - 1).saturating_sub(60);
                let shown = text.chars().skip(before).take(100);
                let shown = shown.map(|c| if c.is_control() { ' ' } else { c });
                let shown = String::from_iter(shown);
                let marks = "^".repeat((*width).min(100 - (column - 1 - before)));
                write!(
                    f,
                    "    {}\n    {}{marks}",
                    shown.trim_end(),
                    " ".repeat(column - 1 - before)
                )
            }
        }
    }
}

/// A problem of a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be read.
    #[error("{message}")]
    Unreadable {
        /// The reason.
        message: String,
    },
    /// The text is not valid TOML.
    #[error("this is not valid TOML: {message}")]
    Syntax {
        /// The message of the parser.
        message: String,
    },
    /// An unknown key.
    #[error("there is no key `{key}` {}: {}", within(table), suggestion(nearest.as_ref(), "keys", known))]
    UnknownKey {
        /// The table's path; empty for the scene.
        table: String,
        /// The key.
        key: String,
        /// The most similar key.
        nearest: Option<String>,
        /// All keys of the table.
        known: String,
    },
    /// A key that only tables of another kind have.
    #[error(
        "`{key}` belongs to the kind {kinds}, and {} is of the kind \"{kind}\": leave it out, or \
         choose another kind",
        name_of(table)
    )]
    OtherKind {
        /// The table's path.
        table: String,
        /// The key.
        key: String,
        /// The table's kind.
        kind: &'static str,
        /// The kinds that have the key.
        kinds: String,
    },
    /// A key is missing.
    #[error("{} lacks `{key}`: {expected} is needed. {summary}", name_of(table))]
    Missing {
        /// The table's path; empty for the scene.
        table: String,
        /// The key.
        key: &'static str,
        /// The expected value.
        expected: String,
        /// The meaning of the key.
        summary: &'static str,
    },
    /// None of several keys is present.
    #[error("{} has neither {keys}: one of them is needed", name_of(table))]
    NoneOf {
        /// The table's path.
        table: String,
        /// The keys, with `nor` between them.
        keys: String,
    },
    /// Several keys that exclude each other.
    #[error("{} has both {keys}: only one of them can be meant", name_of(table))]
    SeveralOf {
        /// The table's path.
        table: String,
        /// The keys, with `and` between them.
        keys: String,
    },
    /// A key that has a meaning only together with another one.
    #[error("`{key}` also needs `{other}`: {summary}")]
    Needs {
        /// The key.
        key: &'static str,
        /// The key it needs.
        other: &'static str,
        /// The meaning of the required key.
        summary: &'static str,
    },
    /// A value of the wrong type.
    #[error("`{key}` is {found}: {expected} is needed")]
    WrongKind {
        /// The key.
        key: String,
        /// The value found.
        found: String,
        /// The expected value.
        expected: String,
    },
    /// An unknown name.
    #[error("`{key}` cannot be \"{name}\": {}", suggestion(nearest.as_ref(), "choices", known))]
    UnknownName {
        /// The key.
        key: String,
        /// The name.
        name: String,
        /// The most similar name.
        nearest: Option<String>,
        /// All names.
        known: String,
    },
    /// A number out of its range.
    #[error("`{key}` is {value}: a number {range} is needed")]
    OutOfRange {
        /// The key.
        key: String,
        /// The number, in the scene's units.
        value: String,
        /// The allowed range, in words.
        range: String,
    },
    /// A unit of the wrong dimension.
    #[error(
        "`{key}` is {found}, \"{text}\": {expected} is needed{}",
        or_example(example)
    )]
    WrongDimension {
        /// The key.
        key: String,
        /// The number with its unit.
        text: String,
        /// Its dimension, in words.
        found: String,
        /// The expected dimension, in words.
        expected: String,
        /// An example of a valid number.
        example: &'static str,
    },
    /// A text that is not a number with a unit.
    #[error(
        "`{key}` is \"{text}\", {reason}: {expected} is needed{}",
        or_example(example)
    )]
    NoQuantity {
        /// The key.
        key: String,
        /// The text.
        text: String,
        /// The reason.
        reason: String,
        /// The expected value, in words.
        expected: String,
        /// An example of a valid number.
        example: &'static str,
    },
    /// A number with a unit in a scene without units.
    #[error(
        "`{key}` has a unit, \"{text}\", but the scene's units are \"none\": a plain number is needed, \
         or units = \"micro\""
    )]
    UnitWithoutUnits {
        /// The key.
        key: String,
        /// The number with its unit.
        text: String,
    },
    /// A text that does not name a shape.
    #[error("`{key}`: {source}")]
    Shape {
        /// The key.
        key: String,
        /// The reason.
        source: ParseShapeError,
    },
    /// A mesh that cannot be generated.
    #[error(transparent)]
    Generate(GenerateError),
    /// Two surfaces, obstacles or outputs with the same name.
    #[error("{what} {second} has the name \"{name}\" of {what} {first}: names have to differ")]
    RepeatedName {
        /// Their kind.
        what: &'static str,
        /// The name.
        name: String,
        /// The first, counted from 0.
        first: usize,
        /// The second.
        second: usize,
    },
    /// An override's path names no element of a list.
    #[error("there is no {kind} `{element}`: {}", if known.is_empty() { format!("the scene has no {kind}") } else { format!("there are {}", known.join(", ")) })]
    UnknownElement {
        /// The list.
        kind: String,
        /// The name or number of the element in the path.
        element: String,
        /// The existing elements.
        known: Vec<String>,
    },
    /// An override's path ends at an element of a list.
    #[error(
        "`{path}.{element}` is a whole table: name one of its keys, as in {path}.{element}.KEY=VALUE"
    )]
    WholeElement {
        /// The list's path.
        path: String,
        /// The element.
        element: String,
    },
    /// An override's path continues below a value.
    #[error("`{path}` is a value, not a table: there is no `{below}` in it")]
    NoTable {
        /// The path of the value.
        path: String,
        /// The next word of the path.
        below: String,
    },
    /// Settings that are valid separately but not together.
    #[error("{message}")]
    Contradiction {
        /// The contradiction and a remedy.
        message: String,
    },
    /// A warning.
    #[error("{message}")]
    Doubtful {
        /// The doubt and its reason.
        message: String,
    },
}

fn name_of(table: &str) -> String {
    match table {
        "" => "the scene".to_owned(),
        table => format!("`{table}`"),
    }
}

fn within(table: &str) -> String {
    format!("in {}", name_of(table))
}

fn suggestion(nearest: Option<&String>, what: &str, known: &str) -> String {
    match nearest {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => format!("the {what} are {known}"),
    }
}

fn or_example(example: &str) -> String {
    match example {
        "" => String::new(),
        example => format!(", such as {example}"),
    }
}

/// The expected number, in words: its dimension and its unit in the scene.
pub(super) fn expected_number(dimension: Dimension, units: UnitSystem) -> String {
    match dimension.unit(units).as_str() {
        "" if units == UnitSystem::None => "a number".to_owned(),
        "" => dimension.name(),
        unit => format!("{} in {unit}", dimension.name()),
    }
}

/// Problems with the origins of the values concerned.
#[derive(Debug, Default)]
pub(super) struct Problems(pub(super) Vec<(Origin, Problem)>);

impl Problems {
    pub(super) fn add(&mut self, origin: &Origin, problem: Problem) {
        self.0.push((origin.clone(), problem));
    }
}
