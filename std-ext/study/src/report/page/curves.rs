//! The rows of a study, sorted into curves.

use super::text::count;
use super::{each, style_in};
use crate::answer::Recommended;
use crate::method::AnyMethod;
use crate::picture::{Axis, AxisScale, Curve, Marks, Numbers, Point};
use crate::scalar::Scalar;
use crate::study::{Quantity, Row};

/// The rows of one method in one number type on one family, coarse to fine.
type Series<'a> = (AnyMethod, Scalar, Vec<&'a Row>);

/// The series of all methods and number types.
pub(super) fn series<'a>(rows: &'a [Row], family: &str, quantity: Quantity) -> Vec<Series<'a>> {
    let rows = rows
        .iter()
        .filter(|row| row.family == family && row.quantity == quantity);
    let rows = Vec::from_iter(rows);
    let kinds = each(rows.iter().map(|row| (row.method, row.scalar)));
    let of = |(method, scalar)| {
        let own = rows.iter().copied();
        let own = own.filter(|row| (row.method, row.scalar) == (method, scalar));
        let mut own = Vec::from_iter(own);
        own.sort_by_key(|row| row.vertices);
        (method, scalar, own)
    };
    kinds.into_iter().map(of).collect()
}

/// Numbers of vertices, and the head of a table with a column for each.
pub(super) fn columns(series: &[Series<'_>]) -> (Vec<usize>, Vec<String>) {
    let rows = series.iter().flat_map(|(.., rows)| rows);
    let mut numbers = each(rows.map(|row| row.vertices));
    numbers.sort_unstable();
    let columns = numbers
        .iter()
        .map(|&number| format!("N = {}", count(number)));
    let head = std::iter::once("method".to_owned()).chain(columns);
    let head = head.collect();
    (numbers, head)
}

/// A logarithmic axis.
pub(super) fn logarithmic(label: &str, numbers: Numbers) -> Axis {
    Axis {
        label: label.to_owned(),
        range: None,
        scale: AxisScale::Logarithmic,
        numbers,
    }
}

/// A curve for each method and number type, strong where it is of the recommended method; pairs of f32 have their own
/// section.
pub(super) fn curves(
    rows: &[Row],
    recommended: Option<&Recommended<'_>>,
    (family, quantity): (&str, Quantity),
    point: impl Fn(&Row) -> Option<Point>,
) -> Vec<Curve> {
    let all = rows;
    let series = series(rows, family, quantity).into_iter();
    let series = series.filter(|(_, scalar, _)| *scalar != Scalar::F32Pair);
    let both = each(rows.iter().map(|row| row.scalar)).contains(&Scalar::F64);
    let curves = series.map(|(method, scalar, rows)| Curve {
        hollow: false,
        name: format!("{method} {scalar}"),
        style: Some(style_in(all, method)),
        marks: match scalar {
            Scalar::F32 => Marks::DashesAndPoints,
            _ => Marks::LineAndPoints,
        },
        label: if scalar == Scalar::F64 || !both {
            method.label().to_owned()
        } else {
            String::new()
        },
        is_strong: recommended.is_some_and(|found| found.is_of(method, scalar)),
        points: rows.into_iter().filter_map(&point).collect(),
    });
    let mut curves = Vec::from_iter(curves);
    // Full lines over broken ones, and the recommended method over all.
    curves.sort_by_key(|curve| (curve.is_strong, !curve.marks.is_dashed()));
    curves
}
