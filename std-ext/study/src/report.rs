//! Presentation of data: tables and CSV. Nothing is computed here.

mod csv;
mod noisy;
pub mod page;
mod recommendation;
mod smoothing;
mod study;

pub use crate::findings::first_of_each_kind;
pub use csv::{curvature_csv, study_csv};
pub use noisy::{noise_section, noise_table};
pub use recommendation::recommendation;
pub use smoothing::smoothing;
pub use study::{conclusion, study_table, verdict_table};

use crate::info::{ComponentInfo, MeshInfo};
use crate::plots::unit_of;
use crate::run::{End, EnergyEstimate, Summary, stability};
use crate::series::{ITERATION, TIME};
use crate::six::Six;
use crate::study::MOST_SCATTER;
use crate::sweep::{Case, Crossing, Outcome, Swept};
use helfrich::Noise;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

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

/// The largest number of components whose measures are written.
const MOST_COMPONENTS: usize = 20;

/// Writes the properties of a mesh and of its components, one per line.
///
/// # Errors
/// If `out` cannot be written to.
pub fn mesh_info(
    info: &MeshInfo,
    components: &[ComponentInfo],
    noise: &Noise<f64>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut line = |name: &str, value: String| property(out, name, value);
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
        None => NO_VOLUME.to_owned(),
    };
    line("volume", volume)?;
    let total = components.iter().map(|part| part.total_mean_curvature);
    line("total mean curvature", total.sum::<f64>().to_string())?;
    if components.len() > 1 {
        for (number, part) in (1..).zip(components.iter().take(MOST_COMPONENTS)) {
            line(&format!("component {number}"), measures(part))?;
        }
        if let more @ 1.. = components.len().saturating_sub(MOST_COMPONENTS) {
            line("", format!("and {more} more components"))?;
        }
    }
    for component in &info.inside_out {
        line("inside out", component.to_string())?;
    }
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
    let (name, seen) = noise_property(noise);
    line(name, seen)
}

/// The volume of a mesh with a boundary.
const NO_VOLUME: &str = "not defined: the mesh has a boundary";

/// Writes a property of a mesh.
fn property(out: &mut dyn Write, name: &str, value: impl Display) -> io::Result<()> {
    writeln!(out, "{name:22} {value}")
}

/// The noise as a property of a mesh.
fn noise_property(noise: &Noise<f64>) -> (&'static str, String) {
    let seen = match noise.is_seen() {
        true => noise_of_positions(noise),
        false => "none is seen".to_owned(),
    };
    ("noise of positions", seen)
}

/// The measures of a component in words.
fn measures(part: &ComponentInfo) -> String {
    let &ComponentInfo {
        first,
        vertices,
        boundary_edges,
        genus,
        area,
        volume,
        total_mean_curvature,
        ..
    } = part;
    let closed = match (genus, volume) {
        (Some(genus), Some(volume)) => format!("genus {genus}, volume {volume}"),
        _ => format!("{boundary_edges} boundary edges"),
    };
    format!(
        "{vertices} vertices from {first} on, {closed}, area {area}, total mean curvature {total_mean_curvature}"
    )
}

/// The standard deviation of noise, as a length and in edges.
pub fn noise_of_positions(noise: &Noise<f64>) -> String {
    format!("{:.1e} ({:.1e} mean edges)", noise.length, noise.edges)
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
        rheology,
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
    if !rheology.is_empty() {
        writeln!(out, "\n{:width$}  {:>14} {:>14}", "mean", "", "error")?;
    }
    for average in rheology {
        let [mean, error] = [average.mean, average.standard_error].map(known);
        let (name, unit) = (&average.quantity, unit_of(&average.quantity, scene));
        let line = format!("{name:width$}  {mean:>14} {error:>14} {unit}");
        writeln!(out, "{}", line.trim_end())?;
    }
    if !modes.is_empty() {
        let unit = match unit_of("stiffness", scene).as_str() {
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
