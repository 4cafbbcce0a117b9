//! Convergence of methods, decided from measured errors by a fixed rule.

use crate::method::AnyMethod;
use crate::scalar::Scalar;
use crate::study::{Quantity, Row};
use std::fmt;

/// The convergence of an error under refinement.
///
/// The rule: p is the slope of the least-squares line through ln error over ln h, h = N^(−1/2), of
/// the three finest meshes (of two, if there are no more). With p of the largest error and p of the
/// mean one,
/// * the largest at least ½: converges at all vertices;
/// * else the mean at least ½: in the mean only;
/// * else the largest below −½: diverges;
/// * else: stalls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Convergence {
    /// The largest error goes to zero.
    AtAllNodes,
    /// The mean error goes to zero, the largest one does not.
    InTheMeanOnly,
    /// Neither goes to zero, and the largest one does not grow.
    Stalls,
    /// The largest error grows.
    Diverges,
}

/// Least order of a converging error; an error diverges if its order is below minus this. It is
/// half of the lowest theoretical order of all methods.
const ORDER: f64 = 0.5;

impl Convergence {
    /// The rule, for the orders of the largest and of the mean error.
    pub fn of(max: f64, mean: f64) -> Self {
        if max >= ORDER {
            Self::AtAllNodes
        } else if mean >= ORDER {
            Self::InTheMeanOnly
        } else if max < -ORDER {
            Self::Diverges
        } else {
            Self::Stalls
        }
    }
}

impl fmt::Display for Convergence {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::AtAllNodes => "converges",
            Self::InTheMeanOnly => "in the mean",
            Self::Stalls => "stalls",
            Self::Diverges => "diverges",
        })
    }
}

/// The verdict on one quantity of one method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvergenceVerdict {
    /// The mesh family's name.
    pub family: &'static str,
    /// The number type.
    pub scalar: Scalar,
    /// The method.
    pub method: AnyMethod,
    /// The quantity compared.
    pub quantity: Quantity,
    /// Order of the largest error over the finest meshes.
    pub order_max: f64,
    /// Order of the mean error over the finest meshes.
    pub order_mean: f64,
    /// The verdict.
    pub convergence: Convergence,
}

/// The verdicts on everything that was studied on at least two meshes, in the order of the rows.
pub fn verdicts(rows: &[Row]) -> Vec<ConvergenceVerdict> {
    let kind = |row: &Row| (row.family, row.scalar, row.method, row.quantity);
    let mut verdicts = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        if rows[..index]
            .iter()
            .any(|earlier| kind(earlier) == kind(row))
        {
            continue;
        }
        let mut same: Vec<&Row> = rows
            .iter()
            .filter(|other| kind(other) == kind(row))
            .collect();
        same.sort_by_key(|row| row.vertices);
        let finest = &same[same.len().saturating_sub(3)..];
        if finest.len() < 2 {
            continue;
        }
        let (order_max, order_mean) = (order(finest, |row| row.max), order(finest, |row| row.mean));
        verdicts.push(ConvergenceVerdict {
            family: row.family,
            scalar: row.scalar,
            method: row.method,
            quantity: row.quantity,
            order_max,
            order_mean,
            convergence: Convergence::of(order_max, order_mean),
        });
    }
    verdicts
}

/// Slope of the least-squares line through ln error over ln h.
fn order(rows: &[&Row], error: impl Fn(&Row) -> f64) -> f64 {
    let points = rows
        .iter()
        .map(|row| (-0.5 * (row.vertices as f64).ln(), error(row).ln()));
    let count = rows.len() as f64;
    let (x, y) = points
        .clone()
        .fold((0.0, 0.0), |(x, y), point| (x + point.0, y + point.1));
    let (x, y) = (x / count, y / count);
    let (cross, square) = points.fold((0.0, 0.0), |(cross, square), point| {
        (
            cross + (point.0 - x) * (point.1 - y),
            square + (point.0 - x).powi(2),
        )
    });
    cross / square
}
