//! Presentation of data: tables and CSV. Nothing is computed here.

mod csv;
mod noisy;
pub mod page;
mod recommendation;

pub use crate::findings::first_of_each_kind;
pub use csv::{curvature_csv, study_csv};
pub use noisy::{noise_section, noise_table};
pub use recommendation::recommendation;

use crate::info::MeshInfo;
use crate::plots::unit_of;
use crate::run::{End, EnergyEstimate, Summary, stability};
use crate::scene::Dimension;
use crate::series::{ITERATION, TIME};
use crate::six::Six;
use crate::study::{MOST_SCATTER, Quantity, Row};
use crate::sweep::{Case, Crossing, Outcome, Swept};
use crate::verdict::ConvergenceVerdict;
use helfrich::{Noise, Surface};
use std::io::{self, Write};
use std::path::Path;

/// Writes a study as a table: a block for each shape, family and number type, a line for each
/// method and mesh, and the orders of the last refinement under each method.
///
/// # Errors
/// If `out` cannot be written to.
pub fn study_table(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let same_block =
        |a: &Row, b: &Row| (a.shape, a.family, a.scalar) == (b.shape, b.family, b.scalar);
    writeln!(
        out,
        "Relative errors, largest (max) and area-weighted mean over the vertices."
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

/// Mark of a time that is the median of scattered times.
const SCATTERED: &str = "~";

/// The explanation of this mark.
fn about_scatter(is_used: bool, out: &mut dyn Write) -> io::Result<()> {
    if !is_used {
        return Ok(());
    }
    writeln!(
        out,
        "\n{SCATTERED}: times of single runs scatter (quartiles more than {:.0} % of their median apart): the machine had other work; measure again when it is idle.",
        100.0 * MOST_SCATTER
    )
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

/// Writes the properties of a mesh, one per line.
///
/// # Errors
/// If `out` cannot be written to.
pub fn mesh_info(info: &MeshInfo, noise: &Noise<f64>, out: &mut dyn Write) -> io::Result<()> {
    let mut line = |name: &str, value: String| writeln!(out, "{name:22} {value}");
    let isolated = match info.isolated_vertices {
        0 => String::new(),
        count => format!(" ({count} in no triangle)"),
    };
    line("vertices", format!("{}{isolated}", info.vertices))?;
    line("edges", info.edges.to_string())?;
    line("triangles", info.triangles.to_string())?;
    let closed = match info.boundary_edges {
        0 => "yes".to_owned(),
        count => format!("no ({count} boundary edges)"),
    };
    line("closed", closed)?;
    line("components", info.components.to_string())?;
    line(
        "Euler characteristic",
        info.euler_characteristic.to_string(),
    )?;
    line("area", format!("{}", info.area))?;
    let volume = match info.volume {
        Some(volume) if volume < 0.0 => format!("{volume} (negative: the mesh is inside out)"),
        Some(volume) => volume.to_string(),
        None => "not defined: the mesh has a boundary".to_owned(),
    };
    line("volume", volume)?;
    line(
        "edge lengths",
        format!("{} … {}", info.edge_lengths[0], info.edge_lengths[1]),
    )?;
    line(
        "angles",
        format!("{:.4}° … {:.4}°", info.angles[0], info.angles[1]),
    )?;
    line(
        "valences",
        format!("{} … {}", info.valences[0], info.valences[1]),
    )?;
    let degenerate = match info.degenerate_triangles.as_slice() {
        [] => "0".to_owned(),
        [first, ..] => format!("{} (the first is {first})", info.degenerate_triangles.len()),
    };
    line("degenerate triangles", degenerate)?;
    let seen = match noise.is_seen() {
        true => noise_of_positions(noise),
        false => "none is seen".to_owned(),
    };
    line("noise of positions", seen)
}

/// The standard deviation of noise, as a length and in edges.
pub fn noise_of_positions(noise: &Noise<f64>) -> String {
    format!("{:.1e} ({:.1e} mean edges)", noise.length, noise.edges)
}

/// A standard deviation of the positions of a surface, as a length and in mean edges.
pub fn deviation_of_positions(deviation: f64, surface: Surface<'_, f64>) -> String {
    let edges = surface.mesh().edges();
    let lengths = edges.iter().map(|&[from, to]| {
        let [x, y, z] = surface.difference(from, to);
        x.hypot(y).hypot(z)
    });
    let edge = lengths.sum::<f64>() / edges.len() as f64;
    noise_of_positions(&Noise {
        length: deviation,
        edges: deviation / edge,
    })
}

/// A number of a series, or a dash where it is not known.
fn known(value: f64) -> String {
    match value.is_finite() {
        true => Six(value).to_string(),
        false => "–".to_owned(),
    }
}

/// Shares of a sum in whole per cent, of which the sum is 100: those with the largest remainders are
/// rounded up.
fn percentages(parts: &[f64]) -> Vec<u32> {
    let whole: f64 = parts.iter().sum();
    let exact = Vec::from_iter(parts.iter().map(|part| 100.0 * part / whole));
    let mut shares = Vec::from_iter(exact.iter().map(|share| share.floor() as u32));
    let mut order = Vec::from_iter(0..parts.len());
    order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()));
    let missing = 100_u32.saturating_sub(shares.iter().sum());
    for place in order.into_iter().take(missing as usize) {
        shares[place] += 1;
    }
    shares
}

/// Writes the end of a run: its last numbers with their units, and the cost of each of its parts.
///
/// # Errors
/// If `out` cannot be written to.
pub fn run_table(summary: &Summary, folder: &Path, out: &mut dyn Write) -> io::Result<()> {
    let Summary {
        title,
        message,
        iterations,
        right_hand_sides,
        seconds,
        last,
        effects,
        parts,
        energy_estimates,
        modes,
        scene,
        ..
    } = summary;
    if !title.is_empty() {
        writeln!(out, "{title}")?;
    }
    let work = match right_hand_sides {
        Some(count) => format!("{iterations} steps, {count} evaluations of the velocities"),
        None => format!("{iterations} iterations"),
    };
    writeln!(out, "{message}: {work} in {seconds:.1} s\n")?;
    let width = last.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in last
        .iter()
        .filter(|(name, _)| ![TIME, ITERATION].contains(&name.as_str()))
    {
        let unit = match value.is_finite() {
            true => unit_of(name, scene),
            false => String::new(),
        };
        let line = format!("{name:width$}  {:>14} {unit}", known(*value));
        writeln!(out, "{}", line.trim_end())?;
    }
    if !energy_estimates.is_empty() {
        writeln!(out)?;
    }
    for EnergyEstimate { surface, error, .. } in energy_estimates {
        let known = match error.is_nan() {
            true => "is not checked: too few vertices".to_owned(),
            false => format!("is known to {:.2} %", 100.0 * error),
        };
        writeln!(out, "the energy of \"{surface}\" {known}")?;
    }
    if !modes.is_empty() {
        // An energy over the fourth power of a length.
        let unit = match Dimension::REPULSION.unit(scene.units).as_str() {
            "" => String::new(),
            unit => format!("; stiffness in {unit}"),
        };
        writeln!(out, "\nthe shape is {}{unit}", stability(modes))?;
        writeln!(
            out,
            "{:>4}  {:>14}  {:>9}  {:>5}",
            "mode", "stiffness", "residual", "rigid"
        )?;
        for (mode, number) in modes.iter().zip(1..) {
            let stiffness = Six(mode.stiffness).to_string();
            let (residual, rigid) = (mode.residual, 100.0 * mode.rigid);
            writeln!(
                out,
                "{number:>4}  {stiffness:>14}  {residual:>9.0e}  {rigid:>3.0} %"
            )?;
        }
    }
    let costs = Vec::from_iter(effects.iter().chain(parts));
    let width = costs.iter().map(|cost| cost.effect.len()).max();
    let width = width.unwrap_or(0);
    writeln!(
        out,
        "\n{:width$}  {:>11}  {:>9}  {:>6}",
        "part", "times", "seconds", "share"
    )?;
    let shares = percentages(&Vec::from_iter(costs.iter().map(|cost| cost.seconds)));
    for (cost, share) in costs.iter().zip(shares) {
        writeln!(
            out,
            "{:width$}  {:>11}  {:>9.3}  {share:>4} %",
            cost.effect, cost.evaluations, cost.seconds
        )?;
    }
    writeln!(out, "\nwritten to {}", folder.display())
}

/// Writes the results of the runs of a sweep: one line per run with its values, the last numbers of
/// the chosen columns, the number of evaluations of velocities (or iterations), the time in
/// seconds, the time of an evaluation of bending in microseconds, and the end of the run. Below are
/// the reasons why runs failed.
///
/// # Errors
/// If `out` cannot be written to.
pub fn sweep_table(swept: &Swept, folder: &Path, out: &mut dyn Write) -> io::Result<()> {
    let costs = ["evaluations", "seconds", "bending [µs]", "end"];
    let columns = swept.columns.iter().zip(&swept.units);
    let columns = columns.map(|(column, unit)| match unit.as_str() {
        "" => column.clone(),
        unit => format!("{column} [{unit}]"),
    });
    let keys = swept.keys.iter().cloned().chain(columns);
    let mut rows = vec![Vec::from_iter(keys.chain(costs.map(str::to_owned)))];
    for (case, outcome) in &swept.cases {
        let mut row = case.values.clone();
        match outcome {
            Outcome::Ended(ended) => {
                row.extend(swept.columns.iter().map(|column| known(ended.last(column))));
                let evaluations = ended.right_hand_sides.unwrap_or(ended.iterations);
                let bending = ended.bending.map(|seconds| format!("{:.1}", 1e6 * seconds));
                row.extend([
                    evaluations.to_string(),
                    format!("{:.1}", ended.seconds),
                    bending.unwrap_or_else(|| "–".to_owned()),
                    ended.end.name().to_owned(),
                ]);
            }
            Outcome::Refused(_) | Outcome::Waiting => {
                let end = match outcome {
                    Outcome::Waiting => "waiting",
                    _ => "refused",
                };
                row.extend(vec!["–".to_owned(); swept.columns.len() + 3]);
                row.push(end.to_owned());
            }
        }
        rows.push(row);
    }
    let columns = rows[0].len();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths = Vec::from_iter((0..columns).map(|column| width(column).unwrap_or(0)));
    for (number, row) in rows.iter().enumerate() {
        let cells = row.iter().zip(&widths).enumerate();
        // Texts are aligned to the left, numbers to the right.
        let cells = cells.map(|(column, (cell, &width))| {
            if column < swept.keys.len() || column + 1 == columns {
                format!("{cell:width$}")
            } else {
                format!("{cell:>width$}")
            }
        });
        writeln!(out, "{}", Vec::from_iter(cells).join("  ").trim_end())?;
        if number == 0 {
            let line = widths.iter().sum::<usize>() + 2 * (columns - 1);
            writeln!(out, "{}", "─".repeat(line))?;
        }
    }
    let mut reasons = swept.cases.iter().filter_map(reason).peekable();
    if reasons.peek().is_some() {
        writeln!(out)?;
    }
    for (name, reason) in reasons {
        writeln!(out, "{name}: {reason}")?;
    }
    for column in &swept.columns {
        for dependence in swept.dependences(column) {
            for Crossing { names, at } in dependence.crossings() {
                let [first, second] = names;
                let (key, at) = (&dependence.key, at.map(Six));
                let [x, y] = at;
                writeln!(
                    out,
                    "{column} = {y} of both {first} and {second} at {key} = {x}"
                )?;
            }
        }
    }
    for column in &swept.unknown {
        let known = swept.known.join(", ");
        writeln!(out, "\nno run has the column `{column}`: there are {known}")?;
    }
    writeln!(out, "\nwritten to {}", folder.display())
}

/// The reason why a run did not reach its end.
fn reason((case, outcome): &(Case, Outcome)) -> Option<(&str, &str)> {
    let reason = match outcome {
        Outcome::Ended(ended) if matches!(ended.end, End::Converged | End::Completed) => None,
        Outcome::Ended(ended) => Some(ended.message.as_str()),
        Outcome::Refused(reason) => Some(reason.as_str()),
        Outcome::Waiting => None,
    };
    Some((case.name.as_str(), reason?))
}
