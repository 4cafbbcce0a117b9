//! Costs of methods, for the terminal.

use crate::costs::Costs;
use helfrich_std::report::page::text::{digits, percent};
use std::io::{self, Write};

/// Writes the costs as text, a line for each method.
///
/// # Errors
/// If `out` cannot be written to.
pub fn cost_table(costs: &Costs, out: &mut dyn Write) -> io::Result<()> {
    let Costs {
        commit,
        date,
        build,
        machine,
        scatter,
        ..
    } = costs;
    writeln!(out, "commit {commit}, {date}, {build}, {machine}")?;
    writeln!(out, "ratios scatter by up to {}\n", percent(*scatter))?;
    writeln!(
        out,
        "{:14} {:>11} {:>10} {:>13} {:>22}",
        "method", "time, B = 1", "ns/vertex", "bytes/vertex", "of boundary integrals"
    )?;
    for cost in &costs.methods {
        writeln!(
            out,
            "{:14} {:>11} {:>10} {:>13} {:>22}",
            cost.method,
            digits(cost.relative),
            digits(cost.nanoseconds),
            digits(cost.bytes),
            cost.flow.map_or("–".to_owned(), percent),
        )?;
    }
    writeln!(out, "\nMethod G, force densities of J6:")?;
    for cost in &costs.galerkin {
        let [energy, density] = [cost.energy, cost.density].map(digits);
        writeln!(
            out,
            "{:14} energy and gradient {energy}, f {density}",
            cost.family
        )?;
    }
    Ok(())
}
