//! Errors on noisy shapes, as a table of text and as a part of a page.

use crate::method::BendingMethod;
use crate::picture::{Axis, AxisScale, Chart, Curve, Marks, Numbers, Point};
use crate::report::page::text::{Table, count, csv_line, escaped, percent};
use crate::report::page::{Section, style_of, svg};
use crate::study::{BEST_FIXED, NoiseRow};
use std::io::{self, Write};
use std::iter;

/// The quantities of [`NoiseRow::errors`].
const SYMBOLS: [&str; 3] = ["H", "K", "f"];

/// The rows of one mesh, and the noises in their order.
fn meshes(rows: &[NoiseRow]) -> impl Iterator<Item = (&[NoiseRow], Vec<f64>)> {
    let is_same = |a: &NoiseRow, b: &NoiseRow| (a.family, a.vertices) == (b.family, b.vertices);
    rows.chunk_by(is_same).map(|rows| {
        let mut deviations = Vec::from_iter(rows.iter().map(|row| row.deviation));
        deviations.dedup();
        (rows, deviations)
    })
}

/// The methods in their order, the best fixed fit last.
fn methods(rows: &[NoiseRow]) -> Vec<&'static str> {
    let first = rows.first().map_or(0.0, |row| row.deviation);
    let of_first = rows.iter().filter(|row| row.deviation == first);
    of_first.map(|row| row.method).collect()
}

fn find<'a>(rows: &'a [NoiseRow], method: &str, deviation: f64) -> Option<&'a NoiseRow> {
    let mut rows = rows.iter();
    rows.find(|row| row.method == method && row.deviation == deviation)
}

/// An error with two digits, a dash if it is not defined.
fn error(row: Option<&NoiseRow>, quantity: usize) -> String {
    let error = row.and_then(|row| row.errors[quantity]);
    error.map_or_else(|| "–".to_owned(), |error| format!("{error:.1e}"))
}

/// The reliability of the error bars of a row: the fraction of the vertices within them, and the median
/// of bar over error.
fn bars(row: Option<&NoiseRow>, quantity: usize) -> String {
    let bars = row.and_then(|row| row.bars).map(|bars| bars[quantity]);
    bars.map_or_else(String::new, |bars| {
        format!("{:.1} %, ×{:.1}", 100.0 * bars.within, bars.median)
    })
}

/// Writes a block for each mesh and quantity: a line for each method, a column for each noise.
///
/// # Errors
/// If `out` cannot be written to.
pub fn noise_table(rows: &[NoiseRow], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "Root mean square errors over that of the exact field, by the noise of every coordinate in mean\n\
         edges. Bars of jet: part of the vertices whose error is within the bar, and the median of the bar\n\
         over the error. – : the method does not define it."
    )?;
    for (rows, deviations) in meshes(rows) {
        let NoiseRow {
            family, vertices, ..
        } = rows[0];
        for (quantity, symbol) in SYMBOLS.iter().enumerate() {
            writeln!(out, "\n{family} · {vertices} vertices · {symbol}")?;
            write!(out, "{:15}", "noise")?;
            for deviation in &deviations {
                write!(out, " {:>13}", format!("{deviation:e}"))?;
            }
            writeln!(out)?;
            for method in methods(rows) {
                write!(out, "{method:15}")?;
                for &deviation in &deviations {
                    let row = find(rows, method, deviation);
                    write!(out, " {:>13}", error(row, quantity))?;
                }
                writeln!(out)?;
            }
            write!(out, "{:15}", "bars of jet")?;
            for &deviation in &deviations {
                write!(out, " {:>13}", bars(find(rows, "jet", deviation), quantity))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The table of one quantity on one mesh, the bars of `jet` below its errors.
fn table_of(rows: &[NoiseRow], deviations: &[f64], quantity: usize) -> Table {
    let own = rows.iter().filter(|row| row.method != BEST_FIXED);
    let least = |deviation: f64| {
        let same = own.clone().filter(|row| row.deviation == deviation);
        let errors = same.filter_map(|row| row.errors[quantity]);
        errors.fold(f64::INFINITY, f64::min)
    };
    let cell = |row: Option<&NoiseRow>| {
        let Some((row, error)) = row.and_then(|row| Some((row, row.errors[quantity]?))) else {
            return "–".to_owned();
        };
        match row.method != BEST_FIXED && error == least(row.deviation) {
            true => format!("<b>{}</b>", percent(error)),
            false => percent(error),
        }
    };
    let line = |head: &str, cell: &dyn Fn(f64) -> String| {
        let cells = deviations.iter().map(|&deviation| cell(deviation));
        Vec::from_iter(iter::once(escaped(head)).chain(cells))
    };
    let mut lines = Vec::new();
    for method in methods(rows) {
        lines.push(line(method, &|deviation| {
            cell(find(rows, method, deviation))
        }));
        if method == "jet" {
            lines.push(line("bars of jet", &|deviation| {
                let text = bars(find(rows, method, deviation), quantity);
                format!("<span>{text}</span>")
            }));
        }
    }
    let mut csv = "method,noise_in_edges,error,within_bar,median_of_bar_over_error\n".to_owned();
    for row in rows {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let bars = row.bars.map(|bars| bars[quantity]);
        let [within, median] = [bars.map(|bars| bars.within), bars.map(|bars| bars.median)];
        let error = number(row.errors[quantity]);
        let (within, median) = (number(within), number(median));
        csv_line(
            &mut csv,
            &[&row.method, &row.deviation, &error, &within, &median],
        );
    }
    let NoiseRow {
        family, vertices, ..
    } = rows[0];
    Table {
        caption: format!(
            "{}: errors on {} meshes of {} vertices",
            SYMBOLS[quantity],
            escaped(family),
            count(vertices)
        ),
        head: head(deviations, "method"),
        rows: lines,
        csv,
    }
}

/// The results of `jet` beside its errors: σ, numbers of neighbours, error bars and verdicts.
fn table_of_findings(rows: &[NoiseRow], deviations: &[f64]) -> Table {
    let jets = || deviations.iter().map(|&noise| find(rows, "jet", noise));
    let line = |head: String, cell: &dyn Fn(&NoiseRow) -> Option<String>| {
        let cells = jets().map(|row| row.and_then(cell).unwrap_or_else(|| "–".to_owned()));
        Vec::from_iter(iter::once(head).chain(cells))
    };
    let sigma = |row: &NoiseRow| Some(format!("{:.1e}", row.found?));
    let mut lines = vec![line("noise found, in edges".to_owned(), &sigma)];
    for (quantity, symbol) in SYMBOLS.iter().enumerate() {
        let taken = |row: &NoiseRow| Some(row.bars?[quantity].neighbours.to_string());
        lines.push(line(format!("neighbours for {symbol}"), &taken));
        let size = |row: &NoiseRow| Some(percent(row.bars?[quantity].size));
        lines.push(line(format!("error bars of {symbol}"), &size));
    }
    for (verdict, name) in ["clean", "noise", "unresolved"].into_iter().enumerate() {
        let part = |row: &NoiseRow| Some(percent(row.verdicts?[verdict]));
        lines.push(line(format!("verdict {name}"), &part));
    }
    let NoiseRow {
        family, vertices, ..
    } = rows[0];
    Table {
        caption: format!(
            "Noise, fits, error bars and verdicts of <code>jet</code> on {} meshes of {} vertices",
            escaped(family),
            count(vertices)
        ),
        head: head(deviations, ""),
        rows: lines,
        csv: String::new(),
    }
}

/// The head of a table with a column for each noise.
fn head(deviations: &[f64], first: &str) -> Vec<String> {
    let each = deviations.iter().map(|&deviation| match deviation {
        0.0 => "no noise".to_owned(),
        _ => format!("{deviation} edges"),
    });
    iter::once(first.to_owned()).chain(each).collect()
}

/// Errors of one quantity against the noise: of `jet` with its error bars, of J6, and of the best fixed fit.
fn chart_of(rows: &[NoiseRow], deviations: &[f64], quantity: usize) -> Chart {
    type Value = fn(&NoiseRow, usize) -> Option<f64>;
    let error: Value = |row, quantity| row.errors[quantity];
    let bar: Value = |row, quantity| Some(row.bars?[quantity].size);
    let jet = Some(style_of(BendingMethod::Jet));
    let curves = [
        (
            "j6",
            "J6",
            Some(style_of(BendingMethod::J6)),
            Marks::LineAndPoints,
            error,
        ),
        (BEST_FIXED, BEST_FIXED, None, Marks::DashesAndPoints, error),
        ("jet", "bars of jet", jet, Marks::DashesAndPoints, bar),
        ("jet", "jet", jet, Marks::LineAndPoints, error),
    ];
    let curves = curves.map(|(method, name, style, marks, value)| {
        let points = deviations.iter().filter(|deviation| **deviation > 0.0);
        let points = points.filter_map(|&deviation| {
            let size = value(find(rows, method, deviation)?, quantity)?;
            Some(Point {
                note: format!("{name}, noise of {deviation} edges: {}", percent(size)),
                ..Point::from([deviation, size])
            })
        });
        Curve {
            hollow: false,
            name: name.to_owned(),
            points: points.collect(),
            marks,
            style,
            label: name.to_owned(),
            ..Curve::default()
        }
    });
    let axis = |label: String, numbers| Axis {
        label,
        scale: AxisScale::Logarithmic,
        numbers,
        ..Axis::default()
    };
    Chart {
        axes: [
            axis("noise in mean edges".to_owned(), Numbers::Plain),
            axis(format!("error of {}", SYMBOLS[quantity]), Numbers::Share),
        ],
        curves: Vec::from_iter(curves.into_iter().filter(|curve| !curve.points.is_empty())),
        ..Chart::default()
    }
}

/// The part of a page that compares the methods on noisy vertices.
///
/// # Errors
/// None: a buffer in memory can always be written to.
pub fn noise_section(rows: &[NoiseRow]) -> io::Result<Section> {
    let mut html = Vec::new();
    writeln!(
        html,
        "<section id=\"noise\"><h2>Which method at which noise</h2><p>Root mean square errors over that of the \
         exact field, by the standard deviation of every coordinate in mean lengths of an edge. The least \
         error of a method is printed bold; “{BEST_FIXED}” is the least of any regression jet with the same \
         degree and number of neighbours at every vertex, which a user cannot know. Bars of <code>jet</code>: \
         the part of the vertices whose error is within its error bar, and the median of the bar over the \
         error. Noise is taken to be independent from vertex to vertex; where the mesh does not resolve the \
         shape, the verdict is “unresolved”, and a finer mesh is needed.</p>"
    )?;
    let mut charts = Vec::new();
    for (rows, deviations) in meshes(rows) {
        let mesh = format!("{}-{}", rows[0].family, rows[0].vertices);
        writeln!(html, "<div class=\"pair\">")?;
        for quantity in [0, 2] {
            let chart = chart_of(rows, &deviations, quantity);
            if chart.is_empty() {
                continue;
            }
            let name = format!("noise-error-{mesh}-{}", SYMBOLS[quantity]);
            let caption = format!(
                "Error of {} against the noise, and its error bars: {} mesh of {} vertices",
                SYMBOLS[quantity],
                escaped(rows[0].family),
                count(rows[0].vertices)
            );
            writeln!(html, "<figure><figcaption>{caption}</figcaption>")?;
            svg::write(&chart, &name, false, &mut html)?;
            writeln!(html, "</figure>")?;
            charts.push((name, chart));
        }
        writeln!(html, "</div>")?;
        table_of_findings(rows, &deviations).write(&format!("noise-found-{mesh}"), &mut html)?;
        for (quantity, symbol) in SYMBOLS.iter().enumerate() {
            let id = format!("noise-{mesh}-{symbol}");
            table_of(rows, &deviations, quantity).write(&id, &mut html)?;
        }
    }
    writeln!(html, "</section>")?;
    Ok(Section { html, charts })
}
