//! The stability table, for the terminal and as Markdown.

mod markdown;

pub use markdown::stability_markdown;

use crate::stability::{Bound, Course, Evaluation, Group, Outcome, Row};
use helfrich_std::scalar::Scalar;
use std::io::{self, Write};

/// Writes the rows as text: a block for each case, a line for each method or formula, a column for
/// each number type.
///
/// # Errors
/// If `out` cannot be written to.
pub fn stability_table(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    for group in rows.chunk_by(|a, b| a.group == b.group) {
        let (name, meaning) = group[0].group.describe();
        writeln!(out, "\n{}: {meaning}", name.to_uppercase())?;
        legend(group[0].group, |line| writeln!(out, "  {line}"))?;
        for case in group.chunk_by(|a, b| a.case == b.case) {
            writeln!(out, "\n{} · {}", case[0].case, case[0].meaning)?;
            for subject in lines(case) {
                write!(out, "  {:28}", subject[0].subject)?;
                for scalar in columns(case) {
                    write!(out, "  {:30}", cell(&subject, scalar))?;
                }
                writeln!(out)?;
            }
        }
    }
    let failed = rows.iter().filter(|row| !row.passed).count();
    writeln!(
        out,
        "\n{} of {} rows passed",
        rows.len() - failed,
        rows.len()
    )
}

/// Writes the legend of the cells of a group.
fn legend(group: Group, mut line: impl FnMut(&str) -> io::Result<()>) -> io::Result<()> {
    match group {
        Group::Geometry => {
            line(
                "`2.1e-2, slope 0.99`: the largest error of f is 2.1e-2 of the largest exact |f|, and f is \
                 on average 0.99 of the exact one.",
            )?;
            line(
                "`3e4, else 1.5 (14 % flagged), slope 0.98`: the quality report flags 14 % of the \
                 vertices; error and slope over the others are 1.5 and 0.98.",
            )?;
            line(
                "`finite`: all results are finite; there is no exact result to compare \
                  with.",
            )
        }
        Group::Input => line("The message of the refusal."),
        Group::Cancellation | Group::Threads => {
            line("`0.12 ≤ 4`: the error found, and the largest allowed.")
        }
        Group::Dynamics => {
            line(
                "`completed, D = 0.148, volume 2e-16`: the Taylor deformation at the end, and the largest change of a volume.",
            )?;
            line("`(7 % off)`: D differs by 7 % from the run with which it is compared.")?;
            line("`says: …`: the first warning. `failed: …`, `stagnated: …`: the reason.")?;
            line("`3.2 ≤ 64`: the value found, and the largest allowed.")
        }
    }
}

/// Number types of a case; runs have only those that occur.
fn columns(case: &[Row]) -> Vec<Scalar> {
    let mut scalars = Scalar::ALL.to_vec();
    if case.iter().all(|row| row.group == Group::Dynamics) {
        scalars.retain(|&scalar| case.iter().any(|row| row.scalar == scalar));
    }
    scalars
}

/// Rows of each method or formula, in the order of their first row.
fn lines(case: &[Row]) -> Vec<Vec<&Row>> {
    let mut lines: Vec<Vec<&Row>> = Vec::new();
    for row in case {
        match lines.iter_mut().find(|line| line[0].subject == row.subject) {
            Some(line) => line.push(row),
            None => lines.push(vec![row]),
        }
    }
    lines
}

fn cell(subject: &[&Row], scalar: Scalar) -> String {
    let Some(row) = subject.iter().find(|row| row.scalar == scalar) else {
        return "–".to_owned();
    };
    let found = match &row.outcome {
        Outcome::Evaluated(found) => evaluation(found),
        Outcome::Refused(message) => first_line(message),
        Outcome::Ran(course) => course_of(course),
        Outcome::Measured(value) => match row.bound {
            Bound::AtMost(most) => format!("{value:.2} ≤ {most}"),
            _ => format!("{value:.1e}"),
        },
    };
    if row.passed {
        found
    } else {
        format!("FAILED: {found}")
    }
}

/// A run in one line.
fn course_of(course: &Course) -> String {
    let mut text = course.end.name().to_owned();
    if !course.is_complete() {
        text += &format!(": {}", course.message);
    }
    if !course.finite {
        text += ", not finite";
    }
    if let Some(deformation) = course.deformation {
        text += &format!(", D = {deformation:.3}");
    }
    if let Some(error) = course.error {
        text += &format!(" ({:.0} % off)", 100.0 * error);
    }
    text += &format!(", volume {:.0e}", course.volume_change);
    if let Some(warning) = course.warnings.first() {
        text += &format!("; says: {}", first_line(warning));
    }
    text
}

/// First line of a message without its position in a scene, which readers of the table do not see.
fn first_line(message: &str) -> String {
    let line = message.lines().next().unwrap_or_default();
    let place = |start: &str| line.starts_with(start).then(|| line.split_once(": "));
    let placed = ["scene.toml", "--set"].into_iter().find_map(place);
    match placed.flatten() {
        Some((_, rest)) => rest.to_owned(),
        None => line.to_owned(),
    }
}

fn evaluation(found: &Evaluation) -> String {
    if !found.finite {
        return "not finite".to_owned();
    }
    let mut text = found.error.map_or("finite".to_owned(), short);
    if let Some(unflagged) = found.unflagged_error
        && found.error != Some(unflagged)
    {
        text += &format!(", else {}", short(unflagged));
    }
    if found.flagged == found.vertices {
        text += " (all flagged)";
    } else if found.flagged > 0 {
        let part = 100.0 * found.flagged as f64 / found.vertices as f64;
        text += &format!(" ({} % flagged)", part.ceil());
    }
    if let Some(slope) = found.slope {
        text += &format!(", slope {}", short(slope));
    }
    for (defect, what) in [(found.moved, "moved"), (found.scaled, "scaled")] {
        if let Some(defect) = defect.filter(|defect| *defect != 0.0) {
            text += &format!(", {what}: {defect:.0e}");
        }
    }
    text
}

/// A number with two digits.
fn short(value: f64) -> String {
    match value.abs() {
        0.095..9.95 => format!(
            "{value:.prec$}",
            prec = if value.abs() < 0.95 { 2 } else { 1 }
        ),
        9.95..99.5 => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}

fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters
        .next()
        .map(|letter| letter.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}
