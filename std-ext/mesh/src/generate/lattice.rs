//! Triangular lattice in the two angles of the torus.

use super::Draft;
use glam::DVec3;
use helfrich::shapes::Torus;
use std::f64::consts::TAU;

/// Number of vertices of four rows of four.
pub(super) const LEAST_VERTICES: usize = 16;

/// Rows of equal angle around the tube, each shifted by half a column against the previous one.
///
/// Triangles are equilateral half-way between the inner and the outer equator. The rows start at an angle
/// that makes neither equator a mirror line of the mesh.
pub(super) fn lattice(torus: &Torus<f64>, rows: usize, columns: usize) -> Draft {
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
            // The vertex between the two in the next row, and its successor.
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

/// Size of a lattice: `rows`, an even number so that the shifts match at the seam, by `columns`, both doubled
/// `level` times.
pub(super) struct Size {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) level: u32,
}

impl Size {
    /// Largest number of vertices of the coarse lattice, before its rows and columns are doubled.
    const COARSE: usize = 1280;

    /// A size with about this many vertices, within 1 % from 200 vertices on.
    ///
    /// The coarse lattice is the nearest among those whose triangles are equilateral to 15 %. A fourfold
    /// number of vertices doubles rows and columns, so that refinement keeps the shape of triangles.
    pub(super) fn nearest(torus: &Torus<f64>, vertices: usize) -> Self {
        let mut coarse = vertices as f64;
        let mut level = 0;
        while coarse > Self::COARSE as f64 {
            coarse /= 4.0;
            level += 1;
        }
        let ideal = (coarse * 2.0 * torus.tube_radius / (3f64.sqrt() * torus.radius)).sqrt();
        let fewest = ((0.85 * ideal / 2.0).ceil() as usize).max(2);
        let most = ((1.15 * ideal / 2.0).floor() as usize).max(fewest);
        let candidates = (fewest..=most).map(|half| {
            let rows = 2 * half;
            let columns = ((coarse / rows as f64).round() as usize).max(4);
            (rows, columns)
        });
        let misfit = |(rows, columns): (usize, usize)| {
            let missing = ((rows * columns) as f64 - coarse).abs();
            (missing.round(), (rows as f64 / ideal - 1.0).abs())
        };
        let nearest = candidates.reduce(|best, other| {
            if misfit(other) < misfit(best) {
                other
            } else {
                best
            }
        });
        let (rows, columns) = nearest.unwrap_or((2 * fewest, 4));
        Self {
            rows,
            columns,
            level,
        }
    }
}
