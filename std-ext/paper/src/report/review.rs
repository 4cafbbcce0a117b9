//! Steady deformations of capsules by many authors, ours among them.

use super::capsule::{PUBLISHED, solver};
use crate::flow::{BENDING, CAPILLARY_NUMBER, FlowRow, Solver};
use crate::literature::steady;
use helfrich_draw::picture::{Axis, Chart, Curve, Marks, Point};
use helfrich_study::report::page::text::{Table, csv_line, escaped};
use helfrich_study::report::page::{Section, style_of, svg};
use std::io::{self, Write};

/// A steady deformation, published or ours.
struct Value {
    name: String,
    from: String,
    capillary: f64,
    bending: f64,
    deformation: f64,
    /// The style of our method; none of a published value.
    own: Option<usize>,
}

/// The section: a figure for the article's parameters, one without bending, and a table.
pub(super) fn section(rows: &[FlowRow], program: &str) -> io::Result<Section> {
    let values = values(rows);
    let mut section = Section::default();
    let out = &mut section.html;
    writeln!(
        out,
        "<section id=\"review\"><h2>What others found</h2><p>Steady D of a neo-Hookean capsule in simple shear, as published and as computed here. \
         With bending the values scatter, because each author has another bending law: they are shown beside ours, and are no targets.</p><div class=\"pair\">"
    )?;
    for (id, chart, caption) in [
        (
            "review-bending",
            bending_chart(&values),
            format!("D at Ca = {CAPILLARY_NUMBER}, κ/(a²G) = {BENDING}, in order of size"),
        ),
        (
            "review-elastic",
            elastic_chart(&values),
            "D over Ca without bending".to_owned(),
        ),
    ] {
        if chart.is_empty() {
            continue;
        }
        writeln!(
            out,
            "<figure><figcaption>{caption} <span>regular meshes (S: smooth), N and methods in the table; f64; {program}</span></figcaption>"
        )?;
        svg::write(&chart, id, false, out)?;
        writeln!(out, "</figure>")?;
        section.charts.push((id.to_owned(), chart));
    }
    writeln!(out, "</div>")?;
    table(&values).write("review", out)?;
    writeln!(out, "</section>")?;
    Ok(section)
}

/// All values, by parameters and size.
fn values(rows: &[FlowRow]) -> Vec<Value> {
    let published = steady().into_iter().map(|row| Value {
        name: row.source,
        from: row.from.to_owned(),
        capillary: row.capillary,
        bending: row.bending,
        deformation: row.deformation,
        own: None,
    });
    let exact = rows
        .iter()
        .filter(|row| row.case.solver == Solver::BoundaryIntegral);
    let ours = exact.map(|row| {
        let method = match row.case.bending {
            0.0 => "no bending".to_owned(),
            _ => row.case.method.label().to_owned(),
        };
        Value {
            name: format!("helfrich, {method}"),
            from: format!(
                "{}, N = {}, γ̇t = {}",
                solver(row),
                row.case.vertices,
                row.case.strain
            ),
            capillary: row.case.capillary,
            bending: row.case.bending,
            deformation: row.outcome.deformation,
            own: Some(style_of(row.case.method)),
        }
    });
    let mut values = Vec::from_iter(published.chain(ours));
    values.sort_by(|a, b| {
        let order = [
            b.bending.total_cmp(&a.bending),
            a.capillary.total_cmp(&b.capillary),
            a.deformation.total_cmp(&b.deformation),
        ];
        order
            .into_iter()
            .fold(std::cmp::Ordering::Equal, |all, by| all.then(by))
    });
    values
}

fn axis(label: &str) -> Axis {
    Axis {
        label: label.to_owned(),
        ..Axis::default()
    }
}

/// Lengths of labels beside marks, in characters.
const SHORT: usize = 30;

/// D for the article's parameters, one mark for each value, from below in order of size.
fn bending_chart(values: &[Value]) -> Chart {
    let own = values
        .iter()
        .filter(|value| (value.capillary, value.bending) == (CAPILLARY_NUMBER, BENDING));
    let numbers = own.clone().map(|value| value.deformation);
    let [low, high] = [
        numbers.clone().fold(f64::INFINITY, f64::min),
        numbers.fold(f64::NEG_INFINITY, f64::max),
    ];
    // Labels stand to the right of marks.
    let range = [low - 0.1 * (high - low), high + (high - low)];
    let rows = own.clone().count() as f64;
    let curves = own.enumerate().map(|(number, value)| {
        let label = value.name.split(',').next().unwrap_or_default();
        let label = match value.own {
            Some(_) => value.name.clone(),
            None if value.name.contains("vorticity") => "theory, with rotation".to_owned(),
            None if label.starts_with("theory") => "theory".to_owned(),
            None if label.starts_with("prototype") => "prototype".to_owned(),
            None => label.chars().take(SHORT).collect(),
        };
        Curve {
            name: value.name.clone(),
            points: vec![Point {
                at: [value.deformation, (number + 1) as f64],
                bounds: None,
                note: format!("{}: D = {:.4}", value.name, value.deformation),
            }],
            marks: Marks::Points,
            style: Some(value.own.unwrap_or(PUBLISHED)),
            label,
            ..Curve::default()
        }
    });
    let axes = [
        Axis {
            range: Some(range),
            ..axis("Taylor deformation D")
        },
        Axis {
            range: Some([0.0, rows + 1.0]),
            ..axis("number in the table below")
        },
    ];
    Chart {
        title: "Published steady deformations and ours, in order of size".to_owned(),
        axes,
        curves: curves.collect(),
        guides: Vec::new(),
    }
}

/// D over Ca without bending.
fn elastic_chart(values: &[Value]) -> Chart {
    let own = values.iter().filter(|value| value.bending == 0.0);
    let mut curves: Vec<Curve> = Vec::new();
    for value in own {
        let point = Point {
            at: [value.capillary, value.deformation],
            bounds: None,
            note: format!(
                "{}: D = {:.4} at Ca = {}",
                value.name, value.deformation, value.capillary
            ),
        };
        match curves.iter_mut().find(|curve| curve.name == value.name) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                name: value.name.clone(),
                points: vec![point],
                marks: match value.own {
                    Some(_) => Marks::LineAndPoints,
                    None => Marks::DashesAndPoints,
                },
                style: Some(value.own.unwrap_or(PUBLISHED)),
                label: match value.own {
                    Some(_) => "helfrich".to_owned(),
                    None => value
                        .name
                        .split([' ', ','])
                        .next()
                        .unwrap_or_default()
                        .to_owned(),
                },
                ..Curve::default()
            }),
        }
    }
    Chart {
        title: "Steady deformation over Ca without bending".to_owned(),
        axes: [
            Axis {
                range: Some([0.1, 0.85]),
                ..axis("Ca = μγ̇a/G")
            },
            Axis {
                range: Some([0.2, 0.6]),
                ..axis("Taylor deformation D")
            },
        ],
        curves,
        guides: Vec::new(),
    }
}

fn table(values: &[Value]) -> Table {
    let mut csv = "source,from,capillary_number,bending,deformation\n".to_owned();
    let mut number = 0;
    let mut parameters = None;
    let line = |value: &Value| {
        if parameters != Some((value.capillary, value.bending)) {
            parameters = Some((value.capillary, value.bending));
            number = 0;
        }
        number += 1;
        csv_line(
            &mut csv,
            &[
                &format!("\"{}\"", value.name),
                &format!("\"{}\"", value.from),
                &value.capillary,
                &value.bending,
                &value.deformation,
            ],
        );
        let name = escaped(&value.name);
        vec![
            match value.own {
                Some(_) => format!("<b>{name}</b>"),
                None => name,
            },
            number.to_string(),
            value.capillary.to_string(),
            value.bending.to_string(),
            format!("{:.4}", value.deformation),
            escaped(&value.from),
        ]
    };
    let rows = values.iter().map(line).collect();
    Table {
        caption: "Steady D, and the source of each value: a file of the repository, a formula, or a run of this page"
            .to_owned(),
        head: ["source", "number", "Ca", "κ/(a²G)", "D", "from"].map(str::to_owned).to_vec(),
        rows,
        csv,
    }
}
