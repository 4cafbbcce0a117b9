//! Comparison of f32 with f64.

use super::curves::{columns, series};
use super::text::{Table, csv_line, digits};
use super::{QUANTITIES, called, each, label};
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
