//! The stability table as Markdown: a cell only where it differs from what a reader knows already.

use super::{capitalised, first_line, short};
use crate::stability::{Bound, Course, Evaluation, Group, Outcome, Row};
use helfrich_std::scalar::Scalar;
use std::io::{self, Write};

/// Values that differ by this factor or less share a cell.
const SAME: f64 = 1.1;

/// Number of words of a message that are shown.
const WORDS: usize = 8;

/// Least change of a volume that is shown.
const VOLUME: f64 = 1e-14;

/// Number types beside [`Scalar::F64`].
const OTHER: [Scalar; 2] = [Scalar::F32, Scalar::F32Pair];

/// Writes the rows as Markdown.
///
/// # Errors
/// If `out` cannot be written to.
pub fn stability_markdown(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let failed = Vec::from_iter(rows.iter().filter(|row| !row.passed));
    writeln!(
        out,
        "# Numerical stability\n\n\
         Written by `cargo run --release --package helfrich-studies -- stability --markdown docs/STABILITY.md`; \
         `--large` adds a mesh of a million vertices. The command without `--markdown` prints every number. \
         {} of {} rows pass; each is a test in `tests/studies/tests/studies/stability.rs`.\n",
        rows.len() - failed.len(),
        rows.len()
    )?;
    for row in failed {
        writeln!(out, "* FAILED: {row}")?;
    }
    for group in rows.chunk_by(|a, b| a.group == b.group) {
        let (name, meaning) = group[0].group.describe();
        writeln!(out, "## {}\n\n{meaning}\n", capitalised(name))?;
        let cases = Vec::from_iter(group.chunk_by(|a, b| a.case == b.case));
        match group[0].group {
            Group::Geometry => geometry(&cases, out)?,
            Group::Dynamics => dynamics(&cases, out)?,
            Group::Cancellation | Group::Threads => measured(&cases, out)?,
            Group::Input => input(&cases, out)?,
        }
    }
    write!(out, "{BUILDS}")
}

/// Text about the comparison of builds, which is not part of the table.
const BUILDS: &str = "## Builds

`.ci/builds` compares this table, with checksums of every force, of a build without optimisation, a release build, and \
one for the machine's own instructions (`-C target-cpu=native`), and runs of whole scenes between the latter two. No bit \
may differ.
";

/// A number of an evaluation that has a table of its own.
struct Quantity {
    title: &'static str,
    meaning: &'static str,
    /// The number that needs no cell.
    usual: Option<f64>,
    value: fn(&Evaluation) -> Option<Shown>,
}

/// A cell and the number in it, by which it is compared.
struct Shown {
    text: String,
    number: f64,
}

impl Shown {
    fn is_like(&self, other: &Self) -> bool {
        let bracketed = |shown: &Self| shown.text.starts_with('(');
        let ratio = (self.number / other.number).abs();
        let near = (1.0 / SAME..=SAME).contains(&ratio) && self.number * other.number > 0.0;
        bracketed(self) == bracketed(other) && (near || self.number == other.number)
    }
}

const QUANTITIES: [Quantity; 4] = [
    Quantity {
        title: "Error",
        usual: None,
        meaning: "Largest error of f over the vertices that are not flagged; in brackets over all, where all are \
                  flagged.",
        value: |found| {
            let number = found.unflagged_error.or(found.error)?;
            let text = match found.unflagged_error {
                Some(error) => short(error),
                None => format!("({})", short(number)),
            };
            Some(Shown { text, number })
        },
    },
    Quantity {
        title: "Error with flagged vertices",
        usual: Some(0.0),
        meaning: "Largest error of f over all vertices, where it is more than ten times the above.",
        value: |found| {
            let (all, unflagged) = (found.error?, found.unflagged_error?);
            let (text, number) = match all > 10.0 * unflagged {
                true => (short(all), all),
                false => ("–".to_owned(), 0.0),
            };
            Some(Shown { text, number })
        },
    },
    Quantity {
        title: "Flagged vertices",
        usual: Some(0.0),
        meaning: "In per cent of all, where there are any.",
        value: |found| {
            let number = (100.0 * found.flagged as f64 / found.vertices as f64).ceil();
            let text = number.to_string();
            Some(Shown { text, number })
        },
    },
    Quantity {
        title: "Slope",
        usual: None,
        meaning: "Over the vertices that are not flagged, or over all if all are.",
        value: |found| {
            let number = found.slope?;
            let text = short(number);
            Some(Shown { text, number })
        },
    },
];

/// The cases and a table of each quantity, with a column for each method.
fn geometry(cases: &[&[Row]], out: &mut dyn Write) -> io::Result<()> {
    for case in cases {
        writeln!(out, "* {}", described(case))?;
    }
    let inexact = cases
        .iter()
        .filter(|case| evaluations(case, Scalar::F64).all(|(_, found)| found.error.is_none()));
    let inexact = Vec::from_iter(inexact.map(|case| case[0].case)).join(", ");
    writeln!(
        out,
        "\nEvery result is finite, and no translation or scaling without rounding changes a bit. No exact f is known \
         for: {inexact}.\n\n\
         Methods are in columns. Numbers are those of f64; a cell is empty where it is within 10 % of the clean mesh. \
         Rows of f32 and f32-pair have the cells that differ by more than 10 % from f64. Rows without cells are left \
         out."
    )?;
    for quantity in QUANTITIES {
        table_of(&quantity, cases, out)?;
    }
    writeln!(out)
}

/// Cells of a row under its cases; empty where nothing is new.
struct Line {
    names: Vec<String>,
    cells: Vec<String>,
}

fn table_of(quantity: &Quantity, cases: &[&[Row]], out: &mut dyn Write) -> io::Result<()> {
    let of = |case: &[Row], scalar| {
        let found = evaluations(case, scalar).map(|(_, found)| (quantity.value)(found));
        Vec::from_iter(found)
    };
    let mut lines: Vec<Line> = Vec::new();
    let mut add = |name: String, values: &[Option<Shown>], known: &[Option<Shown>]| {
        let cell = |(place, value): (usize, &Option<Shown>)| {
            let known = known.get(place).and_then(Option::as_ref);
            let new = value
                .as_ref()
                .filter(|value| !known.is_some_and(|known| value.is_like(known)));
            new.map_or_else(String::new, |value| value.text.clone())
        };
        let cells = Vec::from_iter(values.iter().enumerate().map(cell));
        match lines.iter_mut().find(|line| line.cells == cells) {
            Some(line) => line.names.push(name),
            None if cells.iter().all(String::is_empty) => (),
            None => lines.push(Line {
                names: vec![name],
                cells,
            }),
        }
    };
    let first = of(cases[0], Scalar::F64);
    let usual = |_: &Option<Shown>| {
        let text = String::new();
        quantity.usual.map(|number| Shown { text, number })
    };
    let usual = Vec::from_iter(first.iter().map(usual));
    for (place, case) in cases.iter().enumerate() {
        let name = case[0].case;
        let double = of(case, Scalar::F64);
        let known = if place == 0 { &usual } else { &first };
        add(name.to_owned(), &double, known);
        for scalar in OTHER {
            add(format!("{name} in {scalar}"), &of(case, scalar), &double);
        }
    }
    // A row with the same in every cell is a sentence.
    let is_even = |line: &Line| line.cells.iter().all(|cell| *cell == line.cells[0]);
    let (even, lines): (Vec<_>, Vec<_>) = lines.into_iter().partition(is_even);
    writeln!(out, "\n### {}\n\n{}", quantity.title, quantity.meaning)?;
    for line in even {
        let names = line.names.join(", ");
        writeln!(out, "{} with every method: {names}.", line.cells[0])?;
    }
    // Methods with the same cells share a column.
    let methods = evaluations(cases[0], Scalar::F64).map(|(name, _)| name);
    let column = |place: usize| Vec::from_iter(lines.iter().map(|line| &line.cells[place]));
    let mut columns: Vec<(usize, String)> = Vec::new();
    for (place, method) in methods.enumerate() {
        match columns
            .iter_mut()
            .find(|(other, _)| column(*other) == column(place))
        {
            Some((_, title)) => *title += &format!(", {method}"),
            None => columns.push((place, method.to_owned())),
        }
    }
    let titles = Vec::from_iter(columns.iter().map(|(_, title)| title.as_str()));
    let marks = "---:|".repeat(titles.len());
    writeln!(out, "\n| | {} |\n|---|{marks}", titles.join(" | "))?;
    for line in &lines {
        let cells = columns.iter().map(|(place, _)| line.cells[*place].as_str());
        let cells = Vec::from_iter(cells).join(" | ");
        writeln!(out, "| {} | {cells} |", line.names.join(", "))?;
    }
    Ok(())
}

/// The evaluations of a case in a number type, with their methods.
fn evaluations(case: &[Row], scalar: Scalar) -> impl Iterator<Item = (&str, &Evaluation)> {
    case.iter().filter_map(move |row| match &row.outcome {
        Outcome::Evaluated(found) if row.scalar == scalar => Some((row.subject, found)),
        _ => None,
    })
}

/// The largest number of each case, over subjects and number types.
fn measured(cases: &[&[Row]], out: &mut dyn Write) -> io::Result<()> {
    let mut subjects: Vec<&str> = Vec::new();
    writeln!(out, "| | largest | at most |\n|---|---:|---:|")?;
    for case in cases {
        let mut largest = (0.0_f64, "");
        let mut bounds = Vec::new();
        for row in *case {
            if let (Outcome::Measured(value), Bound::AtMost(most)) = (&row.outcome, row.bound) {
                let is_less = *value <= largest.0;
                if !is_less {
                    // A value that is no number is the largest.
                    largest = (*value, row.subject);
                }
                bounds.push(format!("{most:.0}"));
            }
            if !subjects.contains(&row.subject) {
                subjects.push(row.subject);
            }
        }
        bounds.dedup();
        let shown = match largest {
            (0.0, _) => "0".to_owned(),
            (value, subject) if case.iter().all(|row| row.subject == subject) => {
                format!("{value:.2}")
            }
            (value, subject) => format!("{value:.2}, {subject}"),
        };
        let bounds = bounds.join(", ");
        writeln!(out, "| {} | {shown} | {bounds} |", described(case))?;
    }
    // Methods need no list.
    if cases[0][0].group == Group::Cancellation {
        writeln!(out, "\nMeasured: {}.", subjects.join(", "))?;
    }
    writeln!(out)
}

/// Runs as a list for each case; numbers as tables.
fn dynamics(cases: &[&[Row]], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "D is the Taylor deformation at the end of complete runs, `(7 % off)` its difference from the run with which it \
         is compared. Volumes change by less than 1e-14, unless a change is given. `says: …` is the beginning of the \
         first warning.\n"
    )?;
    let is_number = |case: &[Row]| matches!(case[0].outcome, Outcome::Measured(_));
    for cases in cases.chunk_by(|a, b| is_number(a) == is_number(b)) {
        if is_number(cases[0]) {
            measured(cases, out)?;
            continue;
        }
        for case in cases {
            writeln!(out, "* {}", described(case))?;
            // Runs that end in the same way share a line.
            let mut lines: Vec<(Vec<&str>, String)> = Vec::new();
            for row in *case {
                let text = match &row.outcome {
                    Outcome::Ran(course) => course_of(course),
                    Outcome::Refused(message) => format!("refused: {}", shortened(message)),
                    other => format!("{other:?}"),
                };
                match lines.last_mut().filter(|(_, other)| *other == text) {
                    Some((subjects, _)) => subjects.push(row.subject),
                    None => lines.push((vec![row.subject], text)),
                }
            }
            for (subjects, text) in lines {
                writeln!(out, "  * {}: {text}", subjects.join(", "))?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Messages of refusals, in f64.
fn input(cases: &[&[Row]], out: &mut dyn Write) -> io::Result<()> {
    for case in cases {
        let row = case.iter().find(|row| row.scalar == Scalar::F64);
        let message = row.map_or("–".to_owned(), |row| match &row.outcome {
            Outcome::Refused(message) => first_line(message),
            other => format!("{other:?}"),
        });
        writeln!(out, "* **{}**: {message}", capitalised(case[0].case))?;
    }
    writeln!(out)
}

/// Name and meaning of a case.
fn described(case: &[Row]) -> String {
    format!("**{}**: {}", capitalised(case[0].case), case[0].meaning)
}

/// A run in one line.
fn course_of(course: &Course) -> String {
    let mut parts = Vec::new();
    if !course.is_complete() {
        parts.push(format!(
            "{}: {}",
            course.end.name(),
            shortened(&course.message)
        ));
    } else if let Some(deformation) = course.deformation {
        let off = course
            .error
            .map(|error| format!(" ({:.0} % off)", 100.0 * error));
        parts.push(format!("D = {deformation:.3}{}", off.unwrap_or_default()));
    } else {
        parts.push(course.end.name().to_owned());
    }
    if !course.finite {
        parts.push("not finite".to_owned());
    }
    // A change that is no number is not small.
    let is_small = course.volume_change < VOLUME;
    if !is_small {
        parts.push(format!("volume {:.0e}", course.volume_change));
    }
    let says = course.warnings.first();
    parts.extend(says.map(|warning| format!("says: {}", shortened(warning))));
    parts.join("; ")
}

/// The first words of a message.
fn shortened(message: &str) -> String {
    let line = first_line(message);
    let timed = line
        .strip_prefix("from γ̇t = ")
        .and_then(|rest| rest.split_once(": "));
    let line = timed.map_or(line.as_str(), |(_, rest)| rest).to_owned();
    let words = Vec::from_iter(line.split_whitespace());
    match words.len() {
        0..=WORDS => line,
        _ => {
            words[..WORDS]
                .join(" ")
                .trim_end_matches([',', ':', ';'])
                .to_owned()
                + " …"
        }
    }
}
