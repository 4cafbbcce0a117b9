//! The tables of a study, and the conclusion from them.

use super::page::text::{percent, target, time_of};
use super::{SCATTERED, about_scatter};
use crate::answer::{Norm, Question, Recommended, cheapest, each, most_accurate, seconds};
use crate::study::{Quantity, Row};
use crate::verdict::ConvergenceVerdict;
use std::io::{self, Write};

/// The accuracy of the conclusion.
const TARGET: f64 = 0.01;

/// Writes a study as a table: a block for each shape, family and number type, a line for each
/// method and mesh, and the orders of the last refinement under each method. Quantities and methods are explained
/// above the first block.
///
/// # Errors
/// If `out` cannot be written to.
pub fn study_table(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let same_block =
        |a: &Row, b: &Row| (a.shape, a.family, a.scalar) == (b.shape, b.family, b.scalar);
    for quantity in Quantity::ALL {
        writeln!(out, "{:3}{}", heading(quantity), quantity.in_words())?;
    }
    writeln!(out, "N  number of vertices\n")?;
    for method in each(rows.iter().map(|row| row.method)) {
        writeln!(
            out,
            "{:3}{method:14} {}: {}",
            method.label(),
            method.title(),
            method.idea()
        )?;
    }
    writeln!(
        out,
        "\nErrors relative to the largest exact value: the largest (max) and the area-weighted mean over the vertices."
    )?;
    writeln!(
        out,
        "Order: of the last refinement; error ~ h^order. – : the method does not define it."
    )?;
    for block in rows.chunk_by(same_block) {
        let Row {
            shape,
            family,
            scalar,
            ..
        } = &block[0];
        writeln!(out, "\n{shape} · {family} · {scalar}")?;
        for method in block.chunk_by(|a, b| a.method == b.method) {
            let Row {
                method, options, ..
            } = &method[0];
            if !options.is_default() {
                writeln!(out, "{method}: {options}")?;
            }
        }
        write!(out, "{:13} {:>7}", "method", "N")?;
        for quantity in Quantity::ALL {
            let symbol = heading(quantity);
            write!(out, "  {:>8} {:>8}", format!("{symbol} max"), "mean")?;
        }
        writeln!(out, "  {:>9}", "ns/vertex")?;
        writeln!(out, "{}", "─".repeat(13 + 8 + 4 * 19 + 11))?;
        for method in block.chunk_by(|a, b| a.method == b.method) {
            for (index, mesh) in method.chunk_by(|a, b| a.vertices == b.vertices).enumerate() {
                let name = if index == 0 {
                    mesh[0].method.name()
                } else {
                    ""
                };
                write!(out, "{name:13} {:>7}", mesh[0].vertices)?;
                cells(
                    mesh,
                    out,
                    |row| [Some(row.max), Some(row.mean)],
                    |value| format!("{value:.1e}"),
                )?;
                let mark = if mesh[0].is_scattered() {
                    SCATTERED
                } else {
                    ""
                };
                let time = format!("{mark}{:.1}", mesh[0].ns_per_vertex);
                writeln!(out, "  {time:>9}")?;
            }
            let finest = method.last().map_or(0, |row| row.vertices);
            let start = method.partition_point(|row| row.vertices < finest);
            write!(out, "{:13} {:>7}", "", "order")?;
            let orders = |row: &Row| [row.order_max, row.order_mean];
            cells(&method[start..], out, orders, |order| {
                format!("{order:+.1}")
            })?;
            writeln!(out)?;
        }
    }
    about_scatter(rows.iter().any(Row::is_scattered), out)
}

/// Writes the verdicts: a block for each family and number type, a line for each method.
///
/// # Errors
/// If `out` cannot be written to.
pub fn verdict_table(verdicts: &[ConvergenceVerdict], out: &mut dyn Write) -> io::Result<()> {
    if verdicts.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\nDoes it converge? By the orders p of the largest and the mean error over the three finest meshes:"
    )?;
    writeln!(
        out,
        "largest p ≥ ½: converges (at all vertices); else mean p ≥ ½: in the mean; else largest p < −½: diverges; else stalls."
    )?;
    for block in verdicts.chunk_by(|a, b| (a.family, a.scalar) == (b.family, b.scalar)) {
        let title = format!("{} · {}", block[0].family, block[0].scalar);
        write!(out, "\n{title:21}")?;
        for quantity in Quantity::ALL {
            write!(out, "  {:11}", heading(quantity))?;
        }
        writeln!(out, "\n{}", "─".repeat(21 + 4 * 13))?;
        for method in block.chunk_by(|a, b| a.method == b.method) {
            write!(out, "{:21}", method[0].method)?;
            for quantity in Quantity::ALL {
                let verdict = method.iter().find(|verdict| verdict.quantity == quantity);
                let text =
                    verdict.map_or("–".to_owned(), |verdict| verdict.convergence.to_string());
                write!(out, "  {text:11}")?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// Writes the conclusion: the cheapest method for 1 % of each quantity on each mesh family, and the one method to
/// take for H and f.
///
/// # Errors
/// If `out` cannot be written to.
pub fn conclusion(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let families = each(rows.iter().map(|row| row.family));
    let scalars = each(rows.iter().map(|row| row.scalar));
    let goal = target(TARGET);
    writeln!(
        out,
        "\nWhat to take: the shortest evaluation with errors of at most {goal}, which finer meshes keep.\n"
    )?;
    let [strict, mean] = Norm::ALL.map(Norm::in_words);
    writeln!(out, "{:15}  {strict:38}  {mean}", format!("{goal} of"))?;
    writeln!(out, "{}", "─".repeat(15 + 2 * 40))?;
    for quantity in Quantity::ALL {
        for family in &families {
            let [strict, mean] = Norm::ALL.map(|norm| {
                let question = Question {
                    family,
                    quantity,
                    norm,
                    target: TARGET,
                    method: None,
                };
                cheapest_in_words(rows, &question, scalars.len() > 1)
            });
            let name = format!("{}, {family}", heading(quantity));
            writeln!(out, "{name:15}  {strict:38}  {mean}")?;
        }
    }
    let busy = match rows.iter().any(Row::is_scattered) {
        true => format!("{SCATTERED} "),
        false => String::new(),
    };
    let kinds = families.join(" and ");
    let asked = [Quantity::Mean, Quantity::ForceDensity];
    let found = Recommended::of(rows, &asked, TARGET);
    match found.and_then(|found| Some((found.largest()?, found))) {
        Some((largest, Recommended { method, norm, .. })) => writeln!(
            out,
            "\n{busy}Take {method}, {}: H and f within {goal} {} on {kinds} meshes, from N = {} on, {} an evaluation there.",
            method.idea(),
            norm.in_words(),
            largest.vertices,
            time_of(largest, seconds(largest)),
        )?,
        None => writeln!(
            out,
            "\n{busy}No method that was studied has both H and f within {goal}, even on average, on {kinds} meshes of these sizes."
        )?,
    }
    writeln!(out, "For a mesh of your own: helfrich recommend MESH")
}

/// The answer to a question in one cell.
fn cheapest_in_words(rows: &[Row], question: &Question<'_>, name_scalar: bool) -> String {
    let name = |row: &Row| match name_scalar {
        true => format!("{} in {}", row.method, row.scalar),
        false => row.method.to_string(),
    };
    match (cheapest(rows, question), most_accurate(rows, question)) {
        (Some(row), _) => format!(
            "{}, N = {}, {}",
            name(row),
            row.vertices,
            time_of(row, seconds(row))
        ),
        (None, Some(row)) => format!(
            "none; {} has {} at N = {}",
            name(row),
            percent(question.norm.of(row)),
            row.vertices
        ),
        (None, None) => "–".to_owned(),
    }
}

/// The symbol of a quantity, for a column.
fn heading(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::LaplacianOfMean => "ΔH",
        other => other.symbol(),
    }
}

/// A pair of cells for each quantity.
fn cells(
    rows: &[Row],
    out: &mut dyn Write,
    values: impl Fn(&Row) -> [Option<f64>; 2],
    text: impl Fn(f64) -> String,
) -> io::Result<()> {
    for quantity in Quantity::ALL {
        let row = rows.iter().find(|row| row.quantity == quantity);
        let [max, mean] = row
            .map_or([None, None], &values)
            .map(|value| value.map_or_else(|| "–".to_owned(), &text));
        write!(out, "  {max:>8} {mean:>8}")?;
    }
    Ok(())
}
