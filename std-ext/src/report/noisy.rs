//! Errors on noisy shapes, as a table of text and as a part of a page.

use crate::report::page::Section;
use crate::report::page::text::escaped;
use crate::study::{BEST_FIXED, NoiseRow};
use std::io::{self, Write};

/// The quantities of [`NoiseRow::errors`].
const SYMBOLS: [&str; 3] = ["H", "K", "f"];

/// The rows of one mesh, and the noises in their order.
fn meshes(rows: &[NoiseRow]) -> impl Iterator<Item = (&[NoiseRow], Vec<f64>)> {
    let is_same = |a: &NoiseRow, b: &NoiseRow| (a.family, a.vertices) == (b.family, b.vertices);
    rows.chunk_by(is_same).map(|rows| {
        let mut deviations = Vec::from_iter(rows.iter().map(|row| row.deviation));
        deviations.dedup();
        (rows, deviations)
    })
}

/// The methods in their order, the best fixed fit last.
fn methods(rows: &[NoiseRow]) -> Vec<&'static str> {
    let first = rows.first().map_or(0.0, |row| row.deviation);
    let of_first = rows.iter().filter(|row| row.deviation == first);
    of_first.map(|row| row.method).collect()
}

fn find<'a>(rows: &'a [NoiseRow], method: &str, deviation: f64) -> Option<&'a NoiseRow> {
    let mut rows = rows.iter();
    rows.find(|row| row.method == method && row.deviation == deviation)
}

/// An error with two digits, a dash if it is not defined.
fn error(row: Option<&NoiseRow>, quantity: usize) -> String {
    let error = row.and_then(|row| row.errors[quantity]);
    error.map_or_else(|| "–".to_owned(), |error| format!("{error:.1e}"))
}

/// What the bars of a row are worth: the part of the vertices within them, and the median of bar over error.
fn bars(row: Option<&NoiseRow>, quantity: usize) -> String {
    let bars = row.and_then(|row| row.bars).map(|bars| bars[quantity]);
    bars.map_or_else(String::new, |bars| {
        format!("{:.1} % ×{:.1}", 100.0 * bars.within, bars.median)
    })
}

/// Writes a block for each mesh and quantity: a line for each method, a column for each noise.
///
/// # Errors
/// If `out` cannot be written to.
pub fn noise_table(rows: &[NoiseRow], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "Root mean square errors over that of the exact field, by the noise of every coordinate in mean\n\
         edges. Bars of jet: part of the vertices whose error is within the bar, and the median of the bar\n\
         over the error. – : the method does not define it."
    )?;
    for (rows, deviations) in meshes(rows) {
        let NoiseRow {
            family, vertices, ..
        } = rows[0];
        for (quantity, symbol) in SYMBOLS.iter().enumerate() {
            writeln!(out, "\n{family} · {vertices} vertices · {symbol}")?;
            write!(out, "{:15}", "noise")?;
            for deviation in &deviations {
                write!(out, " {:>13}", format!("{deviation:e}"))?;
            }
            writeln!(out)?;
            for method in methods(rows) {
                write!(out, "{method:15}")?;
                for &deviation in &deviations {
                    let row = find(rows, method, deviation);
                    write!(out, " {:>13}", error(row, quantity))?;
                }
                writeln!(out)?;
            }
            write!(out, "{:15}", "bars of jet")?;
            for &deviation in &deviations {
                write!(out, " {:>13}", bars(find(rows, "jet", deviation), quantity))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The part of a page that says which method bears which noise.
///
/// # Errors
/// None: a buffer in memory can always be written to.
pub fn noise_section(rows: &[NoiseRow]) -> io::Result<Section> {
    let mut html = Vec::new();
    writeln!(
        html,
        "<section id=\"noise\"><h2>Which method at which noise</h2><p>Root mean square errors over that of the \
         exact field, by the standard deviation of every coordinate in mean lengths of an edge. The least \
         error of a method is printed bold; “{BEST_FIXED}” is the least of any fit with the same degree and \
         number of neighbours at every vertex, which a user cannot know. Below <code>jet</code>: the part of \
         the vertices whose error is within its error bar, and the median of the bar over the error.</p>"
    )?;
    for (rows, deviations) in meshes(rows) {
        let NoiseRow {
            family, vertices, ..
        } = rows[0];
        for (quantity, symbol) in SYMBOLS.iter().enumerate() {
            write!(
                html,
                "<h3>{symbol} · {} · {vertices} vertices</h3><table><thead><tr><th>method</th>",
                escaped(family)
            )?;
            for deviation in &deviations {
                write!(html, "<th>{deviation:e}</th>")?;
            }
            write!(html, "</tr></thead><tbody>")?;
            let methods = methods(rows);
            let least = |deviation: f64| {
                let own = methods.iter().filter(|&&method| method != BEST_FIXED);
                let errors =
                    own.filter_map(|method| find(rows, method, deviation)?.errors[quantity]);
                errors.fold(f64::INFINITY, f64::min)
            };
            for method in &methods {
                write!(html, "<tr><th>{}</th>", escaped(method))?;
                for &deviation in &deviations {
                    let row = find(rows, method, deviation);
                    let is_least =
                        row.and_then(|row| row.errors[quantity]) == Some(least(deviation));
                    let text = error(row, quantity);
                    match is_least && *method != BEST_FIXED {
                        true => write!(html, "<td><strong>{text}</strong></td>")?,
                        false => write!(html, "<td>{text}</td>")?,
                    }
                }
                write!(html, "</tr>")?;
            }
            write!(html, "<tr><th>bars of jet</th>")?;
            for &deviation in &deviations {
                write!(
                    html,
                    "<td>{}</td>",
                    bars(find(rows, "jet", deviation), quantity)
                )?;
            }
            writeln!(html, "</tr></tbody></table>")?;
        }
    }
    writeln!(html, "</section>")?;
    Ok(Section {
        html,
        charts: Vec::new(),
    })
}
