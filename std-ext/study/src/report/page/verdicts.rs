//! Convergence of the methods.

use super::text::{Table, csv_line, escaped, signed};
use super::{each, label};
use crate::scalar::Scalar;
use crate::study::Quantity;
use crate::verdict::ConvergenceVerdict;
use std::io::{self, Write};

/// Writes the convergence of every method in f64: a table for each family of meshes.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write(verdicts: &[ConvergenceVerdict], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "<section id=\"verdicts\"><h2>Does it converge?</h2>")?;
    if verdicts.is_empty() {
        return writeln!(
            out,
            "<p class=\"note\">It takes two meshes or more to say.</p></section>"
        );
    }
    writeln!(
        out,
        "<p>What a finer mesh does to the error, with the orders p of the largest and of the mean error over the three finest meshes. \
         Largest p ≥ ½: <b>converges</b>, at all vertices; else mean p ≥ ½: <b>in the mean</b>; else largest p &lt; −½: <b>diverges</b>; else <b>stalls</b>.</p>"
    )?;
    for family in each(verdicts.iter().map(|verdict| verdict.family)) {
        let own = verdicts.iter().filter(|verdict| verdict.family == family);
        let own = Vec::from_iter(own.filter(|verdict| verdict.scalar == Scalar::F64));
        if own.is_empty() {
            continue;
        }
        let mut csv = String::new();
        csv_line(
            &mut csv,
            &[
                &"family",
                &"method",
                &"quantity",
                &"verdict",
                &"order_max",
                &"order_mean",
            ],
        );
        let mut lines = Vec::new();
        for method in each(own.iter().map(|verdict| verdict.method)) {
            let mut line = vec![format!(
                "{} <span>{}</span>",
                label(method),
                escaped(method.title())
            )];
            for quantity in Quantity::ALL {
                let verdict = own
                    .iter()
                    .find(|verdict| (verdict.method, verdict.quantity) == (method, quantity));
                line.push(verdict.map_or("–".to_owned(), |verdict| {
                    csv_line(
                        &mut csv,
                        &[
                            &family,
                            &method,
                            &quantity.symbol(),
                            &verdict.convergence,
                            &verdict.order_max,
                            &verdict.order_mean,
                        ],
                    );
                    let word = verdict.convergence.to_string();
                    format!(
                        "<b class=\"v-{}\">{word}</b> <span>{}, {}</span>",
                        word.replace(' ', "-"),
                        signed(verdict.order_max),
                        signed(verdict.order_mean)
                    )
                }));
            }
            lines.push(line);
        }
        Table {
            caption: format!(
                "{family} meshes, f64: verdict, and p of the largest and the mean error"
            ),
            head: ["method", "H", "K", "Δ<sub>S</sub>H", "f"]
                .map(str::to_owned)
                .to_vec(),
            rows: lines,
            csv,
        }
        .write(&format!("verdicts-{family}"), out)?;
    }
    writeln!(out, "</section>")
}
