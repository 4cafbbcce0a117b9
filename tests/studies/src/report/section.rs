//! Section of the page about flow: a capsule in shear with every method, and the costs of effects.

use crate::effects::{EffectCost, EffectCosts};
use crate::flow::{BENDING, CAPILLARY_NUMBER, FlowRow, Solver, largest_deviation, published};
use helfrich_std::picture::{Axis, Chart, Curve, Marks, Point};
use helfrich_std::report::page::text::{Table, count, csv_line, digits, escaped, percent, time};
use helfrich_std::report::page::{Section, style_of, svg};
use helfrich_std::run::End;
use std::io::{self, Write};

/// Style of published results: one that no method has.
const PUBLISHED: usize = svg::COLOURS.len() - 1;

/// Section of a page about a capsule in flow and the costs of its effects.
///
/// # Errors
/// Never: writing to memory does not fail.
pub fn page_section(rows: &[FlowRow], effects: &EffectCosts) -> io::Result<Section> {
    let charts = charts(rows);
    let mut html = Vec::new();
    write_flow(rows, &charts, &mut html)?;
    write_effects(effects, &mut html)?;
    Ok(Section { html, charts })
}

fn write_flow(rows: &[FlowRow], charts: &[(String, Chart)], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "<section id=\"flow\"><h2>In flow</h2>")?;
    writeln!(
        out,
        "<p>An elastic capsule, a sphere at rest, is drawn out by a shear flow until it keeps its shape and its membrane circulates around it. \
         D says by how much: 0 for a sphere. Neo-Hookean membrane, Ca = {CAPILLARY_NUMBER}, κ/(a²G) = {BENDING}, the paper’s own case; \
         by boundary integrals, and by a lattice Boltzmann fluid in a box. \
         Methods that diverge on the red blood cell do well here: elasticity keeps this surface smooth, and D is an integral over it.</p>"
    )?;
    for (id, chart) in charts {
        writeln!(
            out,
            "<figure class=\"one\"><figcaption>D over the strain γ̇t: full lines by boundary integrals, broken lines on a lattice, circles published</figcaption>"
        )?;
        svg::write(chart, id, false, out)?;
        transients(rows).write_folded("transients", out)?;
        writeln!(out, "</figure>")?;
    }
    steady(rows).write("flow-steady", out)?;
    others().write("flow-published", out)?;
    writeln!(out, "</section>")
}

/// Description of the solver.
fn solver(row: &FlowRow) -> String {
    match row.case.solver {
        Solver::BoundaryIntegral => "boundary integral".to_owned(),
        Solver::LatticeBoltzmann {
            resolution,
            size,
            precision,
        } => format!("lattice, {precision}, a = {resolution} h, box {size} a"),
    }
}

fn charts(rows: &[FlowRow]) -> Vec<(String, Chart)> {
    let shown = rows.iter().filter(|row| row.case.bending == BENDING);
    let mut curves = Vec::new();
    for row in shown {
        let lattice = row.case.solver != Solver::BoundaryIntegral;
        let points = row.transient.iter().filter(|at| at[1].is_finite());
        let points = points.map(|&at| Point {
            at,
            note: format!(
                "{}, {}: D = {:.4} at γ̇t = {:.2}",
                row.case.method.label(),
                solver(row),
                at[1],
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
    // Published points are drawn over the lines.
    for curve in published() {
        let points = curve.points.iter().map(|&at| Point {
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
    let chart = Chart {
        title: "Deformation D of a capsule in shear flow over the strain".to_owned(),
        axes: ["strain γ̇t", "Taylor deformation D"].map(|label| Axis {
            label: label.to_owned(),
            ..Axis::default()
        }),
        curves,
        guides: Vec::new(),
    };
    vec![("flow-deformation".to_owned(), chart)]
}

/// Every run's D over time, at whole strains.
fn transients(rows: &[FlowRow]) -> Table {
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
        ],
    );
    for row in rows {
        let solver = format!("\"{}\"", solver(row));
        for [strain, deformation] in &row.transient {
            csv_line(
                &mut csv,
                &[
                    &row.case.method,
                    &solver,
                    &row.case.bending,
                    &row.case.vertices,
                    strain,
                    deformation,
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
            let point = row.transient.iter().find(near);
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

fn steady(rows: &[FlowRow]) -> Table {
    let paper = published().into_iter().next();
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"solver",
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
                &row.case.bending,
                &row.case.vertices,
                &row.deformation,
                &row.inclination,
                &row.volume_change,
                &row.steps,
                &row.seconds,
                &row.end.name(),
            ],
        );
        let deviation = paper
            .as_ref()
            .filter(|_| row.case.bending == BENDING)
            .and_then(|curve| largest_deviation(row, curve));
        vec![
            format!(
                "{} <span>{}</span>",
                row.case.method.label(),
                row.case.method.title()
            ),
            solver(row),
            count(row.case.vertices),
            format!("{}", row.case.bending),
            format!("{:.4}", row.deformation),
            format!("{:.1}°", row.inclination),
            deviation.map_or("–".to_owned(), |deviation| format!("{deviation:.4}")),
            time(row.seconds),
            match row.end {
                End::Completed => String::new(),
                _ => escaped(&row.message),
            },
        ]
    };
    Table {
        caption: "D and inclination at the end of each run, the largest difference of D(γ̇t) from the paper’s curve (digitised, ±0.002), and the time that the run took".to_owned(),
        head: ["method", "solver", "N", "κ/(a²G)", "D", "θ", "from the paper", "time", "note"].map(str::to_owned).to_vec(),
        rows: rows.iter().map(line).collect(),
        csv,
    }
}

/// Results of theory and of other authors.
fn others() -> Table {
    // Barthès-Biesel's small-deformation theory, with bending.
    let theory = 25.0 / 12.0 * CAPILLARY_NUMBER / (1.0 + 11.0 * BENDING);
    let mut lines = vec![vec![
        "theory of small deformations, (25/12) Ca/(1 + 11 κ/(a²G))".to_owned(),
        format!("{theory:.4}"),
    ]];
    let mut csv = "source,deformation\n".to_owned();
    csv_line(&mut csv, &[&"\"theory of small deformations\"", &theory]);
    for curve in published() {
        if let Some([_, steady]) = curve.points.last() {
            csv_line(&mut csv, &[&format!("\"{}\"", curve.name), steady]);
            lines.push(vec![escaped(&curve.name), format!("{steady:.4}")]);
        }
    }
    Table {
        caption: "Steady D of the same case, theory and published (they scatter, because each has another bending law)".to_owned(),
        head: ["source", "D"].map(str::to_owned).to_vec(),
        rows: lines,
        csv,
    }
}

fn write_effects(costs: &EffectCosts, out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "<section id=\"effects\"><h2>What each effect costs</h2><p>The capsule with bending, elasticity, a penalty on its area, a fluid inside that is five times as viscous, and a viscous membrane: \
         {} an evaluation of the velocities. A scene pays only for what it names; here is the same scene without one effect after the other.</p>",
        time(costs.seconds)
    )?;
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"effect",
            &"own_seconds",
            &"seconds_with_all",
            &"seconds_without",
            &"evaluations_with_all",
            &"evaluations_without",
        ],
    );
    let line = |cost: &EffectCost| {
        let own = cost.own.map_or(String::new(), |own| own.to_string());
        csv_line(
            &mut csv,
            &[
                &cost.effect,
                &own,
                &costs.seconds,
                &cost.without,
                &costs.evaluations,
                &cost.evaluations_without,
            ],
        );
        vec![
            format!("<code>{}</code>", escaped(&cost.effect)),
            cost.own.map_or("part of the fluid".to_owned(), |own| {
                format!(
                    "{} <span>{}</span>",
                    time(own),
                    percent(own / costs.seconds)
                )
            }),
            time(cost.without),
            format!("×{}", digits(costs.seconds / cost.without)),
            cost.evaluations_without.to_string(),
        ]
    };
    Table {
        caption: format!(
            "Own time in an evaluation, with its share; an evaluation without the effect; how many evaluations the same strain takes ({} with all)",
            costs.evaluations
        ),
        head: ["effect", "its own time", "evaluation without it", "with all over without", "evaluations without it"].map(str::to_owned).to_vec(),
        rows: costs.effects.iter().map(line).collect(),
        csv,
    }
    .write("effect-costs", out)?;
    writeln!(out, "</section>")
}
