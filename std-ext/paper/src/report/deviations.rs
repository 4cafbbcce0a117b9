//! The first table of the page: deviations from published data, each with a verdict.

use super::capsule::{is_of_article, solver};
use super::{Page, converging};
use crate::flow::{Deviation, FlowRow, Solver, boxes, deviation, published, resolved};
use crate::literature::{COMPUTED, DIGITISED, Mesh, computed, steady};
use helfrich_study::report::page::text::{Table, count, csv_line, digits, escaped};
use helfrich_study::study::Row;
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

    fn word(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Near => "near",
            Self::Differs => "differs",
        }
    }
}

/// The verdict on the largest difference from a curve that ends at `value`, and on that at its end.
fn verdict(found: &Deviation, value: f64, error: f64) -> String {
    let [largest, last] =
        [found.largest, found.last].map(|difference| Agreement::of(difference, value, error));
    let part = |difference: f64| format!("{} %", digits(100.0 * (difference / value).abs()));
    let (agreement, text) = match (largest, last) {
        (Agreement::Agrees, _) => (largest, "agrees".to_owned()),
        (_, Agreement::Agrees) => (
            Agreement::Near,
            format!(
                "agrees at the end; {} of the steady value off at γ̇t = {}",
                part(found.largest),
                found.at
            ),
        ),
        (_, last) => (last, format!("{}: {} off", last.word(), part(found.last))),
    };
    format!("<b class=\"{}\">{text}</b>", agreement.class())
}

/// A difference with its sign.
fn signed(difference: f64) -> String {
    match format!("{difference:+.4}").as_str() {
        "-0.0000" | "+0.0000" => "0.0000".to_owned(),
        text => text.replace('-', "−"),
    }
}

/// Which shift of γ̇t would make the largest difference, if it is not a lasting one.
fn shift(found: &Deviation) -> String {
    let [largest, last] = [found.largest, found.last].map(f64::abs);
    match largest > DIGITISED && last <= DIGITISED {
        true => format!("; a shift by {}", digits(found.shift)),
        false => String::new(),
    }
}

/// Number of columns.
const COLUMNS: usize = 7;

struct Lines {
    rows: Vec<[String; COLUMNS]>,
    csv: String,
}

impl Lines {
    fn add(&mut self, cells: [String; COLUMNS], numbers: Option<&Deviation>) {
        if let Some(found) = numbers {
            let quoted = [0, 2, 4].map(|cell| format!("\"{}\"", plain(&cells[cell])));
            csv_line(
                &mut self.csv,
                &[
                    &quoted[0],
                    &quoted[1],
                    &quoted[2],
                    &found.largest,
                    &found.at,
                    &found.last,
                    &found.last_at,
                ],
            );
        }
        self.rows.push(cells);
    }

    /// A row without published data.
    fn missing(&mut self, result: &str, instead: &str) {
        let [none, missing] = ["–", "not in this repository"].map(str::to_owned);
        let cells = [
            result.to_owned(),
            instead.to_owned(),
            none.clone(),
            none.clone(),
            missing,
            none.clone(),
            none,
        ];
        self.add(cells, None);
    }

    /// A row of a steady value.
    fn steady(
        &mut self,
        [result, ours, published]: [String; 3],
        [found, value, error]: [f64; 3],
        strain: f64,
    ) {
        let difference = found - value;
        let found_at = Deviation {
            largest: difference,
            at: strain,
            shift: f64::NAN,
            last: difference,
            last_at: strain,
        };
        let cells = [
            result,
            verdict(&found_at, value, error),
            ours,
            format!("{found:.4}"),
            published,
            "–".to_owned(),
            signed(difference),
        ];
        self.add(cells, Some(&found_at));
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
    let text = text.replace("&lt;", "<").replace("&gt;", ">");
    text.replace("&amp;", "&").replace('"', "'")
}

/// The verdicts as text.
pub(super) fn summary(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    for row in lines(page).rows {
        let [result, verdict, with, ours, published, ..] = row.map(|cell| plain(&cell));
        writeln!(
            out,
            "{result}, {with}: {ours}; published ({published}): {verdict}"
        )?;
    }
    Ok(())
}

fn lines(page: &Page<'_>) -> Lines {
    let mut lines = Lines {
        rows: Vec::new(),
        csv: "result,ours,published,largest_difference,at_strain,difference_at_end,end_strain\n"
            .to_owned(),
    };
    if let Some(cell) = &page.cell {
        statement(cell.rows, &mut lines);
        lines.missing(
            "H, Δ<sub>S</sub>H and f along the meridian, and their errors over refinement",
            "compared with exact values below",
        );
    }
    if let Some(rows) = page.capsules {
        transients(rows, &mut lines);
        extrapolated(rows, &mut lines);
        others(rows, &mut lines);
        lines.missing(
            "inclination θ(γ̇t); D(γ̇t) on the article’s own lattice",
            "ours below, with nothing to compare",
        );
    }
    lines
}

pub(super) fn write(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Lines { rows, csv } = lines(page);
    writeln!(
        out,
        "<section id=\"deviations\"><h2>How far from what was published?</h2>\
         <p>Every result that can be compared with a published one. <b>Agrees</b>: within the error of the published value, which is ±{DIGITISED} \
         where it was read from a figure. <b>Near</b>: within {} % of the steady value. “C, S” is the curve D(γ̇t) of methods C and S in the article. \
         Where only the largest difference is beyond that error, its row says by how much γ̇t would have to be shifted for as much.</p>",
        100.0 * NEAR
    )?;
    Table {
        caption: "Ours minus published".to_owned(),
        head: [
            "result",
            "verdict",
            "ours by",
            "ours",
            "published by",
            "largest difference",
            "at the end",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: Vec::from_iter(rows.into_iter().map(Vec::from)),
        csv,
    }
    .write("published-deviations", out)?;
    notes(page, out)?;
    writeln!(out, "</section>")
}

/// Reasons of differences.
fn notes(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Some(rows) = page.capsules else {
        return Ok(());
    };
    let mut own = rows.iter().filter(|row| is_of_article(row));
    let mut notes = Vec::new();
    if own.clone().any(|row| row.case.method.letter() == Some("A")) {
        notes.push("A: its energy depends on the shapes of the triangles, which change here.");
    }
    if own.any(|row| row.case.solver != Solver::BoundaryIntegral) {
        notes.push(
            "Lattice: nearby walls and the thickness of the membrane, a part of the distance of nodes, raise D. \
             Runs in two boxes with two distances show how far; their extrapolation takes the first term of each.",
        );
    }
    if page.quick {
        notes.push("The quick form has meshes of 162 vertices, which are coarser than the article’s, and one lattice.");
    }
    writeln!(out, "<p class=\"note\">{}</p>", notes.join(" "))
}

/// The article's statement on convergence.
fn statement(rows: &[Row], lines: &mut Lines) {
    let found = converging(rows);
    let finest = rows.iter().map(|row| row.vertices).max().unwrap_or(0);
    let ours = found
        .iter()
        .map(|(family, methods)| match methods.as_slice() {
            [] => format!("{family}: none"),
            methods => format!("{family}: {}", methods.join(", ")),
        });
    let ours = Vec::from_iter(ours).join("; ");
    let holds = |(family, methods): &(&'static str, Vec<_>)| methods.is_empty().then_some(*family);
    let confirmed = Vec::from_iter(found.iter().filter_map(holds));
    if found.is_empty() {
        return;
    }
    let (class, verdict) = match confirmed.len() {
        all if all == found.len() => ("yes", "confirmed on all these meshes".to_owned()),
        0 => ("no", "not confirmed on these meshes".to_owned()),
        _ => (
            "near",
            format!("confirmed on {} meshes only", confirmed.join(", ")),
        ),
    };
    let cells = [
        "methods of A, B, C, D, E, S whose f converges at all nodes of the red blood cell"
            .to_owned(),
        format!("<b class=\"{class}\">{verdict}</b>"),
        format!("N up to {}", count(finest)),
        ours,
        "the article: none".to_owned(),
        "–".to_owned(),
        "–".to_owned(),
    ];
    lines.add(cells, None);
}

/// D over time of every run with the article's parameters.
fn transients(rows: &[FlowRow], lines: &mut Lines) {
    let Some(curve) = published().into_iter().next() else {
        return;
    };
    let steady = curve.points.last().map_or(f64::NAN, |point| point[1]);
    for row in rows.iter().filter(|row| is_of_article(row)) {
        let Some(found) = deviation(row, &curve) else {
            continue;
        };
        let cells = [
            format!("D(γ̇t) of {}", escaped(row.case.method.label())),
            verdict(&found, steady, DIGITISED),
            format!(
                "{} <span>N = {}</span>",
                solver(row),
                count(row.case.vertices)
            ),
            format!("{:.4}", row.outcome.deformation),
            "C, S".to_owned(),
            format!(
                "{} <span>at γ̇t = {}{}</span>",
                signed(found.largest),
                found.at,
                shift(&found)
            ),
            format!(
                "{} <span>at γ̇t = {}</span>",
                signed(found.last),
                found.last_at
            ),
        ];
        lines.add(cells, Some(&found));
    }
}

/// D on lattices, extrapolated to unbounded fluid and a fine lattice.
fn extrapolated(rows: &[FlowRow], lines: &mut Lines) {
    let own = Vec::from_iter(rows.iter().filter(|row| is_of_article(row)).cloned());
    let curve = published().into_iter().next();
    let Some([_, value]) = curve.and_then(|curve| curve.points.last().copied()) else {
        return;
    };
    let strain = own.first().map_or(f64::NAN, |row| row.case.strain);
    for found in resolved(&boxes(&own)) {
        let [a, b] = found.resolutions;
        lines.steady(
            [
                "steady D of C".to_owned(),
                format!("lattices, extrapolated <span>a = {a} and {b} h, two boxes</span>"),
                "C, S".to_owned(),
            ],
            [found.resolved, value, DIGITISED],
            strain,
        );
    }
}

/// Steady D of others for parameters of which there are runs with boundary integrals, and of the prototype on as many
/// triangles; the review has those of the article's parameters.
fn others(rows: &[FlowRow], lines: &mut Lines) {
    let published = steady().into_iter();
    let published = published.filter(|row| row.error != COMPUTED);
    for published in published.chain(computed(Mesh::Coarse)) {
        let parameters = (published.capillary, published.bending);
        let same = |row: &&FlowRow| {
            row.case.solver == Solver::BoundaryIntegral
                && !is_of_article(row)
                && (row.case.capillary, row.case.bending) == parameters
        };
        let Some(row) = rows.iter().find(same) else {
            continue;
        };
        lines.steady(
            [
                format!("steady D, Ca = {}, no bending", published.capillary),
                format!(
                    "boundary integral <span>N = {}</span>",
                    count(row.case.vertices)
                ),
                escaped(&published.source),
            ],
            [
                row.outcome.deformation,
                published.deformation,
                published.error,
            ],
            row.case.strain,
        );
    }
}
