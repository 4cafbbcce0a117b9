//! Comparison of f32 with f64.

use super::accuracy::time_chart;
use super::curves::{columns, series};
use super::svg;
use super::text::{Table, count, csv_line, digits, time_of};
use super::{QUANTITIES, Section, called, each, label};
use crate::report::SCATTERED;
use crate::scalar::Scalar;
use crate::study::{Quantity, Row};
use std::io::{self, Write};

/// Largest ratio of the errors of f32 and f64 at which they count as equal.
const AS_GOOD: f64 = 1.5;

/// Errors of f32 over those of f64, and times of f64 over those of f32.
pub(super) fn write(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let families = each(rows.iter().map(|row| row.family));
    let scalars = each(rows.iter().map(|row| row.scalar));
    let single = scalars.iter().filter(|&&scalar| scalar != Scalar::F64);
    let single = Vec::from_iter(single.copied());
    writeln!(out, "<section id=\"precision\"><h2>Is f32 enough?</h2>")?;
    if single.is_empty() || !scalars.contains(&Scalar::F64) {
        return writeln!(
            out,
            "<p class=\"note\">Only one number type was studied.</p></section>"
        );
    }
    writeln!(
        out,
        "<p>The largest error in f32 over that in f64, and how much longer f64 takes. Up to ×{AS_GOOD} f32 is enough: the method is further off than its rounding. \
         Where it is not, it is the storage of positions that hurts; <code>f32-pair</code> keeps them in pairs of f32 and computes in f32.</p>"
    )?;
    for &family in &families {
        for quantity in QUANTITIES {
            let [hidden, symbol] = [
                if family == families[0] && quantity == QUANTITIES[0] {
                    ""
                } else {
                    " hidden"
                },
                quantity.symbol(),
            ];
            writeln!(
                out,
                "<div data-when=\"quantity={symbol} family={family}\"{hidden}>"
            )?;
            table(rows, family, quantity, &single)
                .write(&format!("precision-{symbol}-{family}"), out)?;
            writeln!(out, "</div>")?;
        }
    }
    writeln!(out, "</section>")
}

/// The part of a page that shows what each digit costs in every number type: errors against times, decimal digits
/// and times on the finest mesh of `family`, and errors of f32 over those of f64. Captions end with `about`.
///
/// # Errors
/// Never: writing to memory does not fail.
pub fn precision_section(rows: &[Row], family: &str, about: &str) -> io::Result<Section> {
    let mut section = Section::default();
    let out = &mut section.html;
    writeln!(out, "<div class=\"pair\">")?;
    for quantity in QUANTITIES {
        let symbol = quantity.symbol();
        let id = format!("digits-{symbol}");
        let chart = time_chart(rows, quantity, family);
        writeln!(
            out,
            "<figure><figcaption>Largest error of {symbol} against the time of an evaluation <span>full lines f64, broken lines f32; {about}</span></figcaption>"
        )?;
        svg::write(&chart, &id, false, out)?;
        writeln!(out, "</figure>")?;
        section.charts.push((id, chart));
    }
    writeln!(out, "</div>")?;
    for quantity in QUANTITIES {
        let symbol = quantity.symbol();
        digits_table(rows, family, quantity).write(&format!("digits-{symbol}-table"), out)?;
    }
    let scalars = each(rows.iter().map(|row| row.scalar)).into_iter();
    let single = Vec::from_iter(scalars.filter(|&scalar| scalar != Scalar::F64));
    for quantity in QUANTITIES {
        let id = format!("precision-{}", quantity.symbol());
        table(rows, family, quantity, &single).write_folded(&id, out)?;
    }
    Ok(section)
}

/// Decimal digits of the largest error on the finest mesh, and what one of them costs.
fn digits_table(rows: &[Row], family: &str, quantity: Quantity) -> Table {
    let all = series(rows, family, quantity);
    let scalars = each(all.iter().map(|series| series.1));
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"scalar",
            &"family",
            &"quantity",
            &"vertices",
            &"digits",
            &"ns_per_vertex",
            &"scatter",
        ],
    );
    let mut lines = Vec::new();
    for method in each(all.iter().map(|series| series.0)) {
        let mut line = vec![label(method)];
        for &scalar in &scalars {
            let own = all
                .iter()
                .find(|series| (series.0, series.1) == (method, scalar));
            let finest = own.and_then(|series| series.2.last());
            line.push(finest.map_or("–".to_owned(), |row| {
                let right = -row.max.log10();
                csv_line(
                    &mut csv,
                    &[
                        &method,
                        &scalar,
                        &family,
                        &quantity.symbol(),
                        &row.vertices,
                        &right,
                        &row.ns_per_vertex,
                        &row.ns_scatter,
                    ],
                );
                let whole = time_of(row, 1e-9 * row.ns_per_vertex);
                let cost = match right {
                    right if right > 0.0 => time_of(row, 1e-9 * row.ns_per_vertex / right),
                    _ => "no digit".to_owned(),
                };
                let right = format!("{right:.1}").replace('-', "−");
                format!("{right} <span>{whole} a vertex; a digit: {cost}</span>")
            }));
        }
        lines.push(line);
    }
    let finest = all.iter().filter_map(|series| series.2.last());
    let finest = finest.map(|row| row.vertices).max().unwrap_or(0);
    let names = scalars.iter().map(|scalar| format!("{scalar}, digits"));
    Table {
        caption: format!(
            "{}, {family} mesh, N = {}: correct decimal digits at the worst vertex, −log₁₀ of the largest relative error, \
             the time of an evaluation, and this time over the digits",
            called(quantity),
            count(finest)
        ),
        head: std::iter::once("method".to_owned()).chain(names).collect(),
        rows: lines,
        csv,
    }
}

fn table(rows: &[Row], family: &str, quantity: Quantity, single: &[Scalar]) -> Table {
    let all = series(rows, family, quantity);
    let (numbers, head) = columns(&all);
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"scalar",
            &"family",
            &"quantity",
            &"vertices",
            &"error_over_f64",
            &"time_of_f64_over",
        ],
    );
    let mut lines = Vec::new();
    for method in each(all.iter().map(|(method, ..)| *method)) {
        let of = |scalar: Scalar| {
            let own = all
                .iter()
                .find(|series| (series.0, series.1) == (method, scalar));
            own.map_or(&[][..], |series| &series.2)
        };
        for &scalar in single {
            let mut line = vec![format!("{} {scalar}", label(method))];
            for &number in &numbers {
                let at = |scalar| of(scalar).iter().find(|row| row.vertices == number);
                let pair = at(scalar).zip(at(Scalar::F64));
                line.push(pair.map_or("–".to_owned(), |(single, double)| {
                    let error = single.max / double.max;
                    let scattered = single.is_scattered() || double.is_scattered();
                    let mark = if scattered { SCATTERED } else { "" };
                    let faster = double.ns_per_vertex / single.ns_per_vertex;
                    csv_line(
                        &mut csv,
                        &[
                            &method,
                            &scalar,
                            &family,
                            &quantity.symbol(),
                            &number,
                            &error,
                            &faster,
                        ],
                    );
                    let (class, word) = if error <= AS_GOOD {
                        ("yes", "✓")
                    } else {
                        ("no", "✗")
                    };
                    format!(
                        "<b class=\"{class}\">{word} ×{}</b> <span>f64 takes {mark}×{faster:.1}</span>",
                        digits(error)
                    )
                }));
            }
            lines.push(line);
        }
    }
    Table {
        caption: format!(
            "{}, {family} meshes: error over that of f64 (✓ up to ×{AS_GOOD}), and time of f64 over its own",
            called(quantity)
        ),
        head,
        rows: lines,
        csv,
    }
}
