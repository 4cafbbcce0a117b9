//! The first table of the page: deviations from published data, each with a verdict.

use super::capsule::{is_of_article, solver};
use super::{Page, converging};
use crate::flow::{
    BENDING, CAPILLARY_NUMBER, Deviation, FlowRow, Solver, boxes, deviation, published, resolved,
};
use crate::literature::{COMPUTED, DIGITISED, Steady, steady};
use helfrich_study::report::page::text::{Table, count, csv_line, digits, escaped};
use std::io::{self, Write};

/// The largest part of D by which a result may differ and still be called near.
const NEAR: f64 = 0.05;

/// The judgement of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// Within the error of the published values.
    Agrees,
    /// Beyond that error, but at most 5 % of the value.
    Near,
    /// More than 5 % of the value.
    Differs,
}

impl Agreement {
    /// Judges a difference from `value`, which is known up to `error`.
    pub fn of(difference: f64, value: f64, error: f64) -> Self {
        match difference.abs() {
            size if size <= error => Self::Agrees,
            size if size <= NEAR * value.abs() => Self::Near,
            _ => Self::Differs,
        }
    }

    fn class(self) -> &'static str {
        match self {
            Self::Agrees => "yes",
            Self::Near => "near",
            Self::Differs => "no",
        }
    }

    fn in_words(self, part: f64, error: f64) -> String {
        let part = digits(100.0 * part.abs());
        match self {
            Self::Agrees => format!("agrees within ±{error}, the error of the published value"),
            Self::Near => format!("near: {part} % off, more than the published error of ±{error}"),
            Self::Differs => format!("differs by {part} %"),
        }
    }
}

/// A cell with the judgement of a difference from `value`.
fn verdict(difference: f64, value: f64, error: f64, why: &str) -> String {
    let agreement = Agreement::of(difference, value, error);
    format!(
        "<b class=\"{}\">{}</b>{}",
        agreement.class(),
        agreement.in_words(difference / value, error),
        if why.is_empty() || agreement == Agreement::Agrees {
            String::new()
        } else {
            format!(" <span>{why}</span>")
        }
    )
}

/// A difference with its sign.
fn signed(difference: f64) -> String {
    format!("{difference:+.4}").replace('-', "−")
}

/// The reason why a run may differ from the article's.
fn reason(row: &FlowRow) -> &'static str {
    match row.case.solver {
        Solver::LatticeBoltzmann { .. } => {
            "walls and the thickness of the membrane on the lattice raise D: see the extrapolated row"
        }
        Solver::BoundaryIntegral => match row.case.method.letter() {
            Some("A") => "its energy is another one on meshes that are not equilateral",
            _ if row.case.vertices < 642 => "the mesh is coarser than the article’s",
            _ => "",
        },
    }
}

struct Lines {
    rows: Vec<Vec<String>>,
    csv: String,
}

impl Lines {
    fn add(&mut self, cells: [String; 6], numbers: Option<Deviation>) {
        if let Some(deviation) = numbers {
            let quoted = [&cells[0], &cells[1]].map(|cell| format!("\"{}\"", plain(cell)));
            csv_line(
                &mut self.csv,
                &[
                    &quoted[0],
                    &quoted[1],
                    &deviation.largest,
                    &deviation.at,
                    &deviation.last,
                    &deviation.last_at,
                ],
            );
        }
        self.rows.push(cells.to_vec());
    }
}

/// A cell without its elements.
fn plain(cell: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for letter in cell.chars() {
        match letter {
            '<' => inside = true,
            '>' => inside = false,
            letter if !inside => text.push(letter),
            _ => {}
        }
    }
    text.replace('"', "'")
}

/// The verdicts as text.
pub(super) fn summary(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    for row in lines(page).rows {
        if let [result, _, ours, .., verdict] = row.as_slice() {
            let [result, ours, verdict] = [result, ours, verdict].map(|cell| plain(cell));
            writeln!(out, "{result}: {ours}: {verdict}")?;
        }
    }
    Ok(())
}

fn lines(page: &Page<'_>) -> Lines {
    let mut lines = Lines {
        rows: Vec::new(),
        csv: "result,published,largest_deviation,at_strain,deviation_at_end,end_strain\n"
            .to_owned(),
    };
    if let Some(cell) = &page.cell {
        statement(cell.rows, &mut lines);
        lines.add(
            [
                "H, Δ<sub>S</sub>H and f along the meridian, errors over refinement".to_owned(),
                "the article’s curves: not in this repository".to_owned(),
                "–".to_owned(),
                "–".to_owned(),
                "–".to_owned(),
                "no published data here: compared with exact values".to_owned(),
            ],
            None,
        );
    }
    if let Some(rows) = page.capsules {
        transients(rows, &mut lines);
        extrapolated(rows, &mut lines);
        others(rows, &mut lines);
        lines.add(
            [
                "inclination θ(γ̇t), and D(γ̇t) on the article’s own lattice".to_owned(),
                "the article’s curves: not in this repository".to_owned(),
                "–".to_owned(),
                "–".to_owned(),
                "–".to_owned(),
                "no published data here".to_owned(),
            ],
            None,
        );
    }
    lines
}

pub(super) fn write(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    let lines = lines(page);
    writeln!(
        out,
        "<section id=\"deviations\"><h2>How far from what was published?</h2>\
         <p>Each result that can be compared with a published value, with the largest difference and that at the end. \
         “Agrees” means within the error of the published value (curves were read from figures within ±{DIGITISED}), “near” within {} % of the value.</p>",
        100.0 * NEAR
    )?;
    Table {
        caption: "Ours minus published".to_owned(),
        head: [
            "result",
            "published",
            "ours",
            "largest difference",
            "at the end",
            "verdict",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: lines.rows,
        csv: lines.csv,
    }
    .write("published-deviations", out)?;
    writeln!(out, "</section>")
}

/// The article's statement on convergence.
fn statement(rows: &[helfrich_study::study::Row], lines: &mut Lines) {
    for (family, methods) in converging(rows) {
        let (class, verdict) = match methods.as_slice() {
            [] => ("yes", "confirmed on these meshes"),
            _ => (
                "no",
                "not so on these meshes: order p ≥ ½ of the largest error",
            ),
        };
        let ours = match methods.as_slice() {
            [] => "none of them does".to_owned(),
            methods => format!("converges: {}", methods.join(", ")),
        };
        lines.add(
            [
                format!("f at every vertex of the red blood cell, {family} meshes"),
                "of A, B, C, D, E and S none converges at all nodes <span>Guckenberger et al. 2016</span>".to_owned(),
                ours,
                "–".to_owned(),
                "–".to_owned(),
                format!("<b class=\"{class}\">{verdict}</b>"),
            ],
            None,
        );
    }
}

/// D over time of every run with the article's parameters.
fn transients(rows: &[FlowRow], lines: &mut Lines) {
    let Some(curve) = published().into_iter().next() else {
        return;
    };
    let steady = curve.points.last().map_or(f64::NAN, |point| point[1]);
    for row in rows.iter().filter(|row| is_of_article(row)) {
        let name = format!(
            "D(γ̇t), {} <span>{}, N = {}</span>",
            row.case.method.label(),
            solver(row),
            count(row.case.vertices)
        );
        let source = format!("{} <span>digitised</span>", escaped(&curve.name));
        let Some(found) = deviation(row, &curve) else {
            continue;
        };
        let cells = [
            name,
            source,
            format!("D = {:.4}", row.deformation),
            format!(
                "{} <span>at γ̇t = {}</span>",
                signed(found.largest),
                found.at
            ),
            format!(
                "{} <span>at γ̇t = {}</span>",
                signed(found.last),
                found.last_at
            ),
            verdict(found.largest, steady, DIGITISED, reason(row)),
        ];
        lines.add(cells, Some(found));
    }
}

/// D on lattices, extrapolated to unbounded fluid and a fine lattice.
fn extrapolated(rows: &[FlowRow], lines: &mut Lines) {
    let own = Vec::from_iter(rows.iter().filter(|row| is_of_article(row)).cloned());
    let curve = published().into_iter().next();
    let Some([_, value]) = curve.and_then(|curve| curve.points.last().copied()) else {
        return;
    };
    for found in resolved(&boxes(&own)) {
        let difference = found.resolved - value;
        let [a, b] = found.resolutions;
        lines.add(
            [
                format!("steady D, lattice, extrapolated <span>{a} and {b} nodes per radius, two boxes</span>"),
                "Guckenberger et al. 2016, methods C and S <span>digitised</span>".to_owned(),
                format!("D = {:.4}", found.resolved),
                "–".to_owned(),
                signed(difference),
                verdict(difference, value, DIGITISED, "both extrapolations are of first terms only"),
            ],
            Some(Deviation {
                largest: difference,
                at: f64::NAN,
                last: difference,
                last_at: f64::NAN,
            }),
        );
    }
}

/// Steady D of others for parameters of which there are runs with boundary integrals.
fn others(rows: &[FlowRow], lines: &mut Lines) {
    for Steady {
        source,
        capillary,
        bending,
        deformation,
        ..
    } in steady()
    {
        let is_article = (capillary, bending) == (CAPILLARY_NUMBER, BENDING);
        // The review has these.
        if is_article {
            continue;
        }
        let same = |row: &&FlowRow| {
            row.case.solver == Solver::BoundaryIntegral
                && (row.case.capillary, row.case.bending) == (capillary, bending)
        };
        let Some(row) = rows.iter().find(same) else {
            continue;
        };
        let error = match source.contains("prototype") {
            true => COMPUTED,
            false => DIGITISED,
        };
        let difference = row.deformation - deformation;
        lines.add(
            [
                format!(
                    "steady D, Ca = {capillary}, no bending <span>boundary integral, N = {}</span>",
                    count(row.case.vertices)
                ),
                escaped(&source),
                format!("D = {:.4}", row.deformation),
                "–".to_owned(),
                signed(difference),
                verdict(
                    difference,
                    deformation,
                    error,
                    "publications differ among themselves",
                ),
            ],
            Some(Deviation {
                largest: difference,
                at: f64::NAN,
                last: difference,
                last_at: row.case.strain,
            }),
        );
    }
}
