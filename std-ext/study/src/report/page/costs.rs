//! The cost of evaluations against the number of vertices.

use super::curves::{columns, curves, logarithmic, series};
use super::label;
use super::text::{Table, bytes, count, csv_line, time_of};
use crate::answer::Recommended;
use crate::picture::{Chart, Numbers, Point};
use crate::study::{Quantity, Row};
use std::fmt::Display;

/// The cost of a row: time, or memory if it was measured.
fn cost(row: &Row, kind: &str) -> Option<f64> {
    match kind {
        "cost" => Some(1e-9 * row.ns_per_vertex),
        _ => row.bytes_per_vertex,
    }
}

fn in_words(row: &Row, cost: f64, kind: &str) -> String {
    match kind {
        "cost" => time_of(row, cost),
        _ => bytes(cost),
    }
}

pub(super) fn chart(
    rows: &[Row],
    recommended: Option<&Recommended<'_>>,
    family: &str,
    kind: &str,
) -> Chart {
    let (label, numbers) = match kind {
        "cost" => ("time a vertex", Numbers::Time),
        _ => ("memory a vertex", Numbers::Bytes),
    };
    let point = |row: &Row| {
        let cost = cost(row, kind).filter(|cost| *cost > 0.0)?;
        Some(Point {
            at: [row.vertices as f64, cost],
            note: format!(
                "{} {}, N = {}: {} a vertex",
                row.method.label(),
                row.scalar,
                count(row.vertices),
                in_words(row, cost, kind)
            ),
            bounds: None,
        })
    };
    Chart {
        title: format!("{label} against the number of vertices, {family} meshes"),
        axes: [
            logarithmic("number of vertices N", Numbers::Plain),
            logarithmic(label, numbers),
        ],
        // The costs of f, which every method defines.
        curves: curves(rows, recommended, (family, Quantity::ForceDensity), point),
        guides: Vec::new(),
    }
}

pub(super) fn table(rows: &[Row], family: &str, kind: &str) -> Table {
    let series = series(rows, family, Quantity::ForceDensity);
    let (numbers, head) = columns(&series);
    let mut csv = String::new();
    let unit = match kind {
        "cost" => "seconds_per_vertex",
        _ => "bytes_per_vertex",
    };
    let mut names: Vec<&dyn Display> = vec![&"method", &"scalar", &"family", &"vertices", &unit];
    if kind == "cost" {
        names.push(&"scatter");
    }
    csv_line(&mut csv, &names);
    let mut lines = Vec::new();
    for (method, scalar, rows) in series {
        let mut line = vec![format!("{} {scalar}", label(method))];
        for &number in &numbers {
            let row = rows.iter().find(|row| row.vertices == number);
            let cost = row.and_then(|row| Some((row, cost(row, kind)?)));
            line.push(cost.map_or("–".to_owned(), |(row, cost)| {
                let mut cells: Vec<&dyn Display> = vec![&method, &scalar, &family, &number, &cost];
                if kind == "cost" {
                    cells.push(&row.ns_scatter);
                }
                csv_line(&mut csv, &cells);
                in_words(row, cost, kind)
            }));
        }
        lines.push(line);
    }
    Table {
        caption: format!("A vertex, {family} meshes"),
        head,
        rows: lines,
        csv,
    }
}
