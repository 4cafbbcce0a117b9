//! A triangular lattice of the torus's two angles.

use super::Draft;
use glam::DVec3;
use helfrich::shapes::Torus;
use std::f64::consts::TAU;

/// Four rows of four.
pub(super) const LEAST_VERTICES: usize = 16;

/// Rows of equal angle around the tube, each shifted by half a column against the last.
///
/// The triangles are equilateral half-way between the inner and the outer equator; the rows start at
/// an angle that makes neither equator a mirror of the mesh.
pub(super) fn lattice(torus: &Torus<f64>, vertices: usize) -> Draft {
    let (rows, columns) = size(torus, vertices);
    let mut preimages = Vec::with_capacity(rows * columns);
    for row in 0..rows {
        let around_tube = TAU * (row as f64 + 0.3) / rows as f64;
        let (sin_tube, cos_tube) = libm::sincos(around_tube);
        let distance = torus.radius + torus.tube_radius * cos_tube;
        let shift = 0.5 * (row % 2) as f64;
        for column in 0..columns {
            let around_axis = TAU * (column as f64 + shift) / columns as f64;
            let (sin_axis, cos_axis) = libm::sincos(around_axis);
            preimages.push(DVec3::new(
                distance * cos_axis,
                distance * sin_axis,
                torus.tube_radius * sin_tube,
            ));
        }
    }

    let index = |row: usize, column: usize| (row % rows * columns + column % columns) as u32;
    let mut triangles = Vec::with_capacity(2 * rows * columns);
    for row in 0..rows {
        for column in 0..columns {
            let here = index(row, column);
            let next = index(row, column + 1);
            // The vertex above and between the two, and its successor.
            let above = index(row + 1, column + row % 2);
            let above_next = index(row + 1, column + row % 2 + 1);
            triangles.push([here, next, above]);
            triangles.push([next, above_next, above]);
        }
    }
    Draft {
        preimages,
        triangles,
    }
}

/// Rows and columns: an even number of rows, so that the shifts close, whose spacing suits
/// equilateral triangles to 15 %, and among these the product nearest to `vertices`.
fn size(torus: &Torus<f64>, vertices: usize) -> (usize, usize) {
    let ideal = (vertices as f64 * 2.0 * torus.tube_radius / (3f64.sqrt() * torus.radius)).sqrt();
    let fewest = ((0.85 * ideal / 2.0).ceil() as usize).max(2);
    let most = ((1.15 * ideal / 2.0).floor() as usize).max(fewest);
    let candidates = (fewest..=most).map(|half| {
        let rows = 2 * half;
        (
            rows,
            ((vertices as f64 / rows as f64).round() as usize).max(4),
        )
    });
    let mut best = (2 * fewest, 4);
    let mut best_misfit = (usize::MAX, f64::INFINITY);
    for (rows, columns) in candidates {
        let misfit = (
            (rows * columns).abs_diff(vertices),
            (rows as f64 / ideal - 1.0).abs(),
        );
        if misfit < best_misfit {
            (best, best_misfit) = ((rows, columns), misfit);
        }
    }
    best
}
