//! The article's capsule in shear flow: deformation and inclination over time, by both solvers.

use crate::flow::{BENDING, CAPILLARY_NUMBER, FlowRow, Solver, deviation, published};
use crate::literature::steady;
use helfrich_draw::picture::{Axis, Chart, Curve, Marks, Point};
use helfrich_run::run::End;
use helfrich_study::report::page::text::{Table, count, csv_line, escaped, time};
use helfrich_study::report::page::{Section, style_of, svg};
use std::io::{self, Write};

/// Style of published results: one that no method has.
pub(super) const PUBLISHED: usize = svg::COLOURS.len() - 1;

/// Range of the figure of inclinations, in degrees: from 45°, that of small deformations, down.
const ANGLES: [f64; 2] = [32.0, 46.0];

/// Whether a run has the parameters of the article.
pub(super) fn is_of_article(row: &FlowRow) -> bool {
    (row.case.capillary, row.case.bending) == (CAPILLARY_NUMBER, BENDING)
}

/// Section of a page about the article's capsule, for which runs with other parameters only have rows in a table.
///
/// # Errors
/// Never: writing to memory does not fail.
pub fn section(rows: &[FlowRow]) -> io::Result<Section> {
    let mut section = Section::default();
    let out = &mut section.html;
    writeln!(out, "<section id=\"flow\"><h2>In flow</h2>")?;
    writeln!(
        out,
        "<p>An elastic capsule, a sphere at rest, is drawn out by a shear flow until it keeps its shape and its membrane circulates around it. \
         D says by how much: 0 for a sphere. Neo-Hookean membrane, Ca = {CAPILLARY_NUMBER}, κ/(a²G) = {BENDING}, the article’s own case; \
         by boundary integrals, and by a lattice Boltzmann fluid in a box. \
         Methods that diverge on the red blood cell do well here: elasticity keeps this surface smooth, and D is an integral over it.</p>"
    )?;
    section.charts.push(transient_chart(rows, out, "")?);
    transients(rows).write_folded("transients", out)?;
    writeln!(out, "</figure>")?;
    steady_table(rows).write("flow-steady", out)?;
    others().write("flow-published", out)?;
    writeln!(out, "</section>")?;
    Ok(section)
}

/// Writes the figure of D over γ̇t and opens its element, which the caller closes.
pub(super) fn transient_chart(
    rows: &[FlowRow],
    out: &mut dyn Write,
    about: &str,
) -> io::Result<(String, Chart)> {
    figure(
        chart(rows, "D", |row| &row.outcome.transient),
        "flow-deformation",
        &format!(
            "D over the strain γ̇t: full lines by boundary integrals, broken lines on a lattice, circles published <span>{about}</span>"
        ),
        out,
    )
}

/// As [`transient_chart`], of the inclination.
pub(super) fn inclination_chart(
    rows: &[FlowRow],
    out: &mut dyn Write,
    about: &str,
) -> io::Result<(String, Chart)> {
    figure(
        chart(rows, "θ", |row| &row.outcome.inclinations),
        "flow-inclination",
        &format!(
            "Inclination θ of the longest axis to the flow: lines as for D; the article’s is not in this repository <span>{about}</span>"
        ),
        out,
    )
}

fn figure(
    chart: Chart,
    id: &str,
    caption: &str,
    out: &mut dyn Write,
) -> io::Result<(String, Chart)> {
    writeln!(
        out,
        "<figure class=\"one\"><figcaption>{caption}</figcaption>"
    )?;
    svg::write(&chart, id, false, out)?;
    Ok((id.to_owned(), chart))
}

/// Description of the solver.
pub(super) fn solver(row: &FlowRow) -> String {
    match row.case.solver {
        Solver::BoundaryIntegral => "boundary integral".to_owned(),
        Solver::LatticeBoltzmann {
            resolution,
            size,
            precision,
        } => format!("lattice, {precision}, a = {resolution} h, box {size} a"),
    }
}

/// A quantity of the runs with the article's parameters over γ̇t; `D` beside the published curves.
fn chart(rows: &[FlowRow], symbol: &str, values: fn(&FlowRow) -> &[[f64; 2]]) -> Chart {
    let shown = rows.iter().filter(|row| is_of_article(row));
    let is_angle = symbol != "D";
    let shown_value = |value: f64| match is_angle {
        true => format!("{value:.1}°"),
        false => format!("{value:.4}"),
    };
    let mut curves = Vec::new();
    for row in shown {
        let lattice = row.case.solver != Solver::BoundaryIntegral;
        let points = values(row).iter().filter(|at| at[1].is_finite());
        // A sphere has no longest axis.
        let points = points.filter(|at| !is_angle || at[0] > 0.0);
        let points = points.map(|&at| Point {
            at,
            note: format!(
                "{}, {}: {symbol} = {} at γ̇t = {:.2}",
                row.case.method.label(),
                solver(row),
                shown_value(at[1]),
                at[0]
            ),
            bounds: None,
        });
        curves.push(Curve {
            name: format!("{}, {}", row.case.method, solver(row)),
            style: Some(style_of(row.case.method)),
            marks: match lattice {
                true => Marks::Dashes,
                false => Marks::Line,
            },
            label: if lattice {
                String::new()
            } else {
                row.case.method.label().to_owned()
            },
            points: points.collect(),
            ..Curve::default()
        });
    }
    let ends = rows.iter().filter(|row| is_of_article(row));
    let end = ends.map(|row| row.case.strain).fold(0.0, f64::max);
    // Published points are drawn over the lines.
    let published = match is_angle {
        true => Vec::new(),
        false => published(),
    };
    for curve in published {
        let points = curve.points.iter().filter(|point| point[0] <= end);
        let points = points.map(|&at| Point {
            at,
            bounds: None,
            note: format!("{}: D = {:.4} at γ̇t = {}", curve.name, at[1], at[0]),
        });
        curves.push(Curve {
            points: points.collect(),
            name: curve.name,
            style: Some(PUBLISHED),
            marks: Marks::DashesAndPoints,
            ..Curve::default()
        });
    }
    let (title, label) = match is_angle {
        true => ("Inclination", "inclination θ (degrees)"),
        false => ("Deformation D", "Taylor deformation D"),
    };
    Chart {
        title: format!("{title} of a capsule in shear flow over the strain"),
        axes: [
            Axis {
                label: "strain γ̇t".to_owned(),
                ..Axis::default()
            },
            Axis {
                label: label.to_owned(),
                range: is_angle.then_some(ANGLES),
                ..Axis::default()
            },
        ],
        curves,
        guides: Vec::new(),
    }
}

/// Every run's D over time, at whole strains.
pub(super) fn transients(rows: &[FlowRow]) -> Table {
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"solver",
            &"bending",
            &"vertices",
            &"strain",
            &"deformation",
            &"inclination",
        ],
    );
    for row in rows {
        let solver = format!("\"{}\"", solver(row));
        for ([strain, deformation], [_, inclination]) in
            row.outcome.transient.iter().zip(&row.outcome.inclinations)
        {
            csv_line(
                &mut csv,
                &[
                    &row.case.method,
                    &solver,
                    &row.case.bending,
                    &row.case.vertices,
                    strain,
                    deformation,
                    inclination,
                ],
            );
        }
    }
    let strains = [0.5, 1.0, 2.0, 3.0, 4.0, 5.0];
    let line = |row: &FlowRow| {
        let mut line = vec![format!(
            "{} <span>{}</span>",
            row.case.method.label(),
            solver(row)
        )];
        line.extend(strains.iter().map(|&strain| {
            let near = |point: &&[f64; 2]| (point[0] - strain).abs() < 0.02;
            let point = row.outcome.transient.iter().find(near);
            point.map_or("–".to_owned(), |point| format!("{:.4}", point[1]))
        }));
        line
    };
    let mut head = vec!["method".to_owned()];
    head.extend(strains.iter().map(|strain| format!("γ̇t = {strain}")));
    Table {
        caption: "D over the strain".to_owned(),
        head,
        rows: rows.iter().map(line).collect(),
        csv,
    }
}

pub(super) fn steady_table(rows: &[FlowRow]) -> Table {
    let paper = published().into_iter().next();
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"solver",
            &"capillary",
            &"bending",
            &"vertices",
            &"deformation",
            &"inclination",
            &"volume_change",
            &"steps",
            &"seconds",
            &"end",
        ],
    );
    let line = |row: &FlowRow| {
        let quoted = format!("\"{}\"", solver(row));
        csv_line(
            &mut csv,
            &[
                &row.case.method,
                &quoted,
                &row.case.capillary,
                &row.case.bending,
                &row.case.vertices,
                &row.outcome.deformation,
                &row.outcome.inclination,
                &row.outcome.volume_change,
                &row.outcome.steps,
                &row.outcome.seconds,
                &row.outcome.end.name(),
            ],
        );
        let deviation = paper
            .as_ref()
            .filter(|_| is_of_article(row))
            .and_then(|curve| deviation(row, curve))
            .map(|deviation| deviation.largest.abs());
        vec![
            format!(
                "{} <span>{}</span>",
                row.case.method.label(),
                row.case.method.title()
            ),
            solver(row),
            count(row.case.vertices),
            format!("{}", row.case.capillary),
            format!("{}", row.case.bending),
            format!("{:.4}", row.outcome.deformation),
            format!("{:.1}°", row.outcome.inclination),
            deviation.map_or("–".to_owned(), |deviation| format!("{deviation:.4}")),
            time(row.outcome.seconds),
            match row.outcome.end {
                End::Completed => String::new(),
                _ => escaped(&row.outcome.message),
            },
        ]
    };
    Table {
        caption: "D and inclination at the end of each run, the largest difference of D(γ̇t) from the article’s curve (digitised, ±0.002), and the time that the run took".to_owned(),
        head: ["method", "solver", "N", "Ca", "κ/(a²G)", "D", "θ", "from the article", "time", "note"].map(str::to_owned).to_vec(),
        rows: rows.iter().map(line).collect(),
        csv,
    }
}

/// Results of theory and of other authors for the article's parameters.
fn others() -> Table {
    let mut csv = "source,deformation\n".to_owned();
    let found = steady().into_iter();
    let found = found.filter(|row| (row.capillary, row.bending) == (CAPILLARY_NUMBER, BENDING));
    let line = |row: crate::literature::Steady| {
        csv_line(
            &mut csv,
            &[&format!("\"{}\"", row.source), &row.deformation],
        );
        vec![escaped(&row.source), format!("{:.4}", row.deformation)]
    };
    let rows = found.map(line).collect();
    Table {
        caption: "Steady D of the same case, theory and published (they scatter, because each has another bending law)".to_owned(),
        head: ["source", "D"].map(str::to_owned).to_vec(),
        rows,
        csv,
    }
}
