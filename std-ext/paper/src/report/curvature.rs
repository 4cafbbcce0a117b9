//! The red blood cell: errors over refinement, errors at vertices, and values along the meridian.

use super::CellResults;
use crate::curvature::{LARGE, NodeRow, QUANTITIES, Spread};
use helfrich_draw::picture::{Axis, Chart, Curve, Marks, Point};
use helfrich_evaluate::method::AnyMethod;
use helfrich_study::report::page::text::{Table, count, csv_line, escaped, percent};
use helfrich_study::report::page::{
    Section, convergence_section, open_both, style_of, svg, verdict_section,
};
use helfrich_study::study::Quantity;
use helfrich_study::verdict::verdicts;
use std::io::{self, Write};

/// The part of the range of the exact values by which the axis of a figure along the meridian is wider.
const MARGIN: f64 = 0.5;

/// Number of points of the exact line in a figure.
const DRAWN: usize = 96;

/// The section; `about` describes the rows, `program` its version.
pub(super) fn section(cell: &CellResults<'_>, about: &str, program: &str) -> io::Result<Section> {
    let verdicts = verdicts(cell.rows);
    let mut section = Section::default();
    let out = &mut section.html;
    writeln!(
        out,
        "<section id=\"curvature\"><h2>Curvature and force on a red blood cell</h2><p>Mean curvature H, its Laplacian Δ<sub>S</sub>H and the force density f \
         on the exact discocyte, whose values are known by formula. Options are those of the publications: B with Voronoi areas, C with mixed ones, D with the mixed area \
         of each vertex as bandwidth. G and J are not in the article.</p>"
    )?;
    let mut errors = convergence_section(cell.rows, &verdicts, &QUANTITIES, about)?;
    out.append(&mut errors.html);
    section.charts.append(&mut errors.charts);
    verdict_section(&verdicts, out)?;
    at_nodes(cell, out)?;
    let charts = along_meridian(cell, program, out)?;
    section.charts.extend(charts);
    writeln!(section.html, "</section>")?;
    Ok(section)
}

/// Tables of errors at vertices with six neighbours and at the others.
fn at_nodes(cell: &CellResults<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Some(first) = cell.nodes.first() else {
        return Ok(());
    };
    writeln!(
        out,
        "<h2 id=\"nodes\">Where it does not converge</h2><p>“None converges at all nodes” is about the worst of them. At N = {} the tables say \
         which these are, and how many vertices are far off.</p>",
        count(first.vertices)
    )?;
    let families = cell.nodes.chunk_by(|a, b| a.family == b.family);
    for (number, rows) in families.enumerate() {
        for (place, quantity) in QUANTITIES.into_iter().enumerate() {
            let family = rows[0].family.name();
            open_both(quantity, family, number + place > 0, out)?;
            let id = format!("nodes-{}-{family}", quantity.symbol());
            node_table(rows, place, quantity).write(&id, out)?;
            writeln!(out, "</div>")?;
        }
    }
    Ok(())
}

fn node_table(rows: &[NodeRow], place: usize, quantity: Quantity) -> Table {
    let mut csv =
        "family,vertices,method,quantity,six,other,part_above,valence_of_worst\n".to_owned();
    let defined = rows
        .iter()
        .filter_map(|row| Some((row, row.spreads[place]?)));
    let line = |(row, spread): (&NodeRow, Spread)| {
        let Spread {
            six,
            other,
            above,
            valence,
        } = spread;
        let known = other.map_or_else(String::new, |other| other.to_string());
        csv_line(
            &mut csv,
            &[
                &row.family,
                &row.vertices,
                &row.method,
                &quantity.symbol(),
                &six,
                &known,
                &above,
                &valence,
            ],
        );
        vec![
            format!(
                "{} <span>{}</span>",
                escaped(row.method.label()),
                escaped(row.method.title())
            ),
            percent(six),
            other.map_or("–".to_owned(), percent),
            percent(above),
            valence.to_string(),
        ]
    };
    let rows_shown = defined.map(line).collect();
    Table {
        caption: format!(
            "{} on the {} mesh, f64: largest error at vertices with six neighbours and at all others, \
             vertices with errors above {}, and the number of neighbours of the worst vertex",
            symbol(quantity),
            rows[0].family,
            percent(LARGE)
        ),
        head: [
            "method",
            "six neighbours",
            "others",
            "vertices far off",
            "worst has",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows_shown,
        csv,
    }
}

fn symbol(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::LaplacianOfMean => "Δ<sub>S</sub>H",
        other => other.symbol(),
    }
}

/// Figures of values along the meridian: one for each method and quantity.
fn along_meridian(
    cell: &CellResults<'_>,
    program: &str,
    out: &mut dyn Write,
) -> io::Result<Vec<(String, Chart)>> {
    let mut charts = Vec::new();
    let rows = cell.nodes.iter().filter(|row| !row.nodes.is_empty());
    let rows = Vec::from_iter(rows);
    let Some(first) = rows.first() else {
        return Ok(charts);
    };
    writeln!(
        out,
        "<h2 id=\"meridian\">Along the meridian</h2><p>Values at the vertices of a twelfth of the cell over the arc length from its pole to its rim, in radii, \
         and the exact line, with N = {}, R = 1 and κ = 1. All figures of a quantity have the same axis, beyond which vertices are not shown. \
         {}</p>",
        count(first.vertices),
        match cell.nodes.iter().any(|row| row.nodes.is_empty()) {
            true => "Meshes other than regular and irregular ones have no such figures.",
            false => "",
        }
    )?;
    let exact = cell.study.meridian();
    let families = rows.chunk_by(|a, b| a.family == b.family);
    for (number, rows) in families.enumerate() {
        for (place, quantity) in QUANTITIES.into_iter().enumerate() {
            let family = rows[0].family.name();
            open_both(quantity, family, number + place > 0, out)?;
            writeln!(out, "<div class=\"gallery\">")?;
            let defined = rows.iter().filter(|row| row.spreads[place].is_some());
            for row in defined {
                let (chart, beyond) = chart(row, &exact, place, quantity);
                let id = format!("meridian-{}-{family}-{}", quantity.symbol(), row.method);
                let left_out = match beyond {
                    0 => String::new(),
                    beyond => format!(
                        "; {beyond} of {} vertices are beyond the axis",
                        row.nodes.len()
                    ),
                };
                writeln!(
                    out,
                    "<figure><figcaption><b>{}</b> {}<span>{left_out}</span></figcaption>",
                    escaped(row.method.label()),
                    escaped(row.method.title()),
                )?;
                svg::write(&chart, &id, false, out)?;
                writeln!(out, "</figure>")?;
                charts.push((id, chart));
            }
            writeln!(
                out,
                "</div><p class=\"note\">{} over the arc length, {family} mesh of the discocyte, N = {}; f64; {program}</p></div>",
                symbol(quantity),
                count(rows[0].vertices)
            )?;
        }
    }
    Ok(charts)
}

/// The figure of one method, and the number of vertices beyond its axis.
fn chart(row: &NodeRow, exact: &[[f64; 4]], place: usize, quantity: Quantity) -> (Chart, usize) {
    let values = exact.iter().map(|point| point[place + 1]);
    let [low, high] = [
        values.clone().fold(f64::INFINITY, f64::min),
        values.fold(f64::NEG_INFINITY, f64::max),
    ];
    let margin = MARGIN * (high - low);
    let range = [low - margin, high + margin];
    let end = exact.last().map_or(1.0, |point| point[0]);
    let label = row.method.label();
    let points = row.nodes.iter().map(|node| Point {
        at: [node.arc, node.values[place]],
        bounds: None,
        note: format!(
            "{label}: {:.4} at s = {:.3}, {} neighbours",
            node.values[place], node.arc, node.valence
        ),
    });
    let is_inside = |point: &Point| (range[0]..=range[1]).contains(&point.at[1]);
    let points = Vec::from_iter(points.filter(is_inside));
    let beyond = row.nodes.len() - points.len();
    let step = (exact.len() / DRAWN).max(1);
    let line = exact.iter().step_by(step).chain(exact.last());
    let line = line.map(|point| Point::from([point[0], point[place + 1]]));
    let style = match row.method {
        AnyMethod::Listed(method) => style_of(method),
        AnyMethod::Own(_) => 0,
    };
    let axis = |label: &str, range| Axis {
        label: label.to_owned(),
        range: Some(range),
        ..Axis::default()
    };
    let name = match quantity {
        Quantity::LaplacianOfMean => "ΔH",
        other => other.symbol(),
    };
    let chart = Chart {
        title: format!("{name} of {label} along the meridian"),
        axes: [
            axis("arc length s from the pole", [0.0, end]),
            axis(name, range),
        ],
        curves: vec![
            Curve {
                name: format!("{label}, vertices"),
                points,
                marks: Marks::Points,
                style: Some(style),
                ..Curve::default()
            },
            Curve {
                name: "exact".to_owned(),
                points: line.collect(),
                marks: Marks::Line,
                style: Some(super::capsule::PUBLISHED),
                ..Curve::default()
            },
        ],
        guides: Vec::new(),
    };
    (chart, beyond)
}
