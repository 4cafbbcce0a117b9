//! Meshes whose vertices lie in rows, on exact surfaces: spheres and ellipsoids by longitude and latitude, stacks
//! of sections, tubes around a circle.

use super::{Mesh, SplitMix64};
use helfrich::shapes::{Ellipsoid, ExactPoint, Shape, Torus};
use std::f64::consts::{PI, TAU};

/// A mesh on an exact surface.
#[derive(Clone, Debug)]
pub struct ExactMesh {
    /// What it is.
    pub name: String,
    /// The mesh.
    pub mesh: Mesh,
    /// The surface at its vertices.
    pub exact: Vec<ExactPoint<f64>>,
}

impl ExactMesh {
    /// The mesh of a shape with these pre-images of the vertices.
    pub fn new(
        name: String,
        shape: &impl Shape<f64>,
        preimages: &[[f64; 3]],
        triangles: Vec<[u32; 3]>,
    ) -> Self {
        let exact = Vec::from_iter(preimages.iter().map(|&at| shape.at(at)));
        let positions = exact.iter().map(|point| point.position).collect();
        Self {
            name,
            mesh: Mesh::new(positions, triangles),
            exact,
        }
    }
}

/// The triangles between a pole, `rows` rows of `around` vertices, and another pole.
fn of_revolution(around: u32, rows: u32) -> Vec<[u32; 3]> {
    let number = |row: u32, step: u32| 1 + row * around + step % around;
    let last = 1 + rows * around;
    let mut triangles = Vec::new();
    for step in 0..around {
        triangles.push([0, number(0, step), number(0, step + 1)]);
        triangles.push([last, number(rows - 1, step + 1), number(rows - 1, step)]);
        for row in 0..rows - 1 {
            let [a, b] = [number(row, step), number(row, step + 1)];
            let [d, c] = [number(row + 1, step), number(row + 1, step + 1)];
            triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    triangles
}

/// A drum of radius 1 and height 2 with flat ends, of `around` vertices in each row.
pub fn drum(around: u32) -> Mesh {
    let edge = TAU / f64::from(around);
    let steps = |length: f64| (length / edge).round().max(1.0) as u32;
    let part = |step: u32, steps: u32| f64::from(step) / f64::from(steps);
    let (inward, up) = (steps(1.0), steps(2.0));
    let mut profile = Vec::from_iter((1..=inward).map(|k| [part(k, inward), 1.0]));
    profile.extend((1..=up).map(|k| [1.0, 1.0 - 2.0 * part(k, up)]));
    profile.extend((1..inward).rev().map(|k| [part(k, inward), -1.0]));
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for (row, &[radius, height]) in profile.iter().enumerate() {
        for step in 0..around {
            let turn = f64::from(step) + 0.5 * (row % 2) as f64;
            let (sine, cosine) = (edge * turn).sin_cos();
            positions.push([radius * cosine, radius * sine, height]);
        }
    }
    positions.push([0.0, 0.0, -1.0]);
    Mesh::new(positions, of_revolution(around, profile.len() as u32))
}

/// How the rows of an ellipsoid lie between the poles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// At equal differences of latitude.
    Latitudes,
    /// At equal differences of height, each rotated by a random angle, as in a stack of sections.
    Sections,
}

/// An ellipsoid of `rows` rows of `around` vertices and two poles.
///
/// # Panics
/// If a semi-axis is not positive.
pub fn ellipsoid(semi_axes: [f64; 3], around: u32, rows: u32, kind: Rows) -> ExactMesh {
    let mut random = SplitMix64::new(u64::from(around * 1000 + rows));
    let mut preimages = vec![[0.0, 0.0, 1.0]];
    for row in 1..=rows {
        let part = f64::from(row) / f64::from(rows + 1);
        let (height, turn) = match kind {
            Rows::Latitudes => ((PI * part).cos(), 0.0),
            Rows::Sections => (
                1.0 - 2.0 * part,
                PI / f64::from(around) * random.symmetric(),
            ),
        };
        let radius = (1.0 - height * height).sqrt();
        for step in 0..around {
            let (sine, cosine) = (turn + TAU * f64::from(step) / f64::from(around)).sin_cos();
            preimages.push([radius * cosine, radius * sine, height]);
        }
    }
    preimages.push([0.0, 0.0, -1.0]);
    let triangles = of_revolution(around, rows);
    let shape = Ellipsoid::new(semi_axes).expect("semi-axes");
    let name = format!("ellipsoid {semi_axes:?}, {around} × {rows}, {kind:?}");
    ExactMesh::new(name, &shape, &preimages, triangles)
}

/// A torus of `around` circles of `across` vertices, each rotated by up to `jitter` spacings.
///
/// # Panics
/// Unless 0 < `tube` < `radius`.
pub fn ring(radius: f64, tube: f64, around: u32, across: u32, jitter: f64) -> ExactMesh {
    let mut random = SplitMix64::new(u64::from(around * 1000 + across));
    let mut preimages = Vec::new();
    let mut triangles = Vec::new();
    let number = |i: u32, j: u32| (i % around) * across + j % across;
    for i in 0..around {
        let (s, c) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
        let turn = jitter * random.symmetric();
        for j in 0..across {
            let (v, u) = (TAU * (f64::from(j) + turn) / f64::from(across)).sin_cos();
            let distance = radius + tube * u;
            preimages.push([distance * c, distance * s, tube * v]);
            let [a, b] = [number(i, j), number(i + 1, j)];
            let [d, c] = [number(i, j + 1), number(i + 1, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let shape = Torus::new(radius, tube).expect("radii");
    let name = format!("torus {radius} {tube}, {around} × {across}, {jitter}");
    ExactMesh::new(name, &shape, &preimages, triangles)
}

/// Spheres, tori, stacks and needles of about 500 to 2000 vertices, with spacings from equal to 20 : 1.
pub fn in_rows() -> Vec<ExactMesh> {
    let sphere = [1.0; 3];
    let mut meshes = Vec::new();
    for (around, rows) in [
        (100, 11),
        (60, 8),
        (40, 16),
        (12, 99),
        (16, 60),
        (44, 22),
        (80, 20),
        (24, 24),
    ] {
        meshes.push(ellipsoid(sphere, around, rows, Rows::Latitudes));
    }
    for (around, rows) in [(150, 13), (60, 12), (30, 20), (20, 40)] {
        meshes.push(ellipsoid(sphere, around, rows, Rows::Sections));
    }
    for (length, around, rows) in [
        (10.0, 30, 29),
        (5.0, 24, 30),
        (4.0, 60, 12),
        (0.3, 50, 14),
        (2.0, 16, 60),
    ] {
        meshes.push(ellipsoid([1.0, 1.0, length], around, rows, Rows::Latitudes));
    }
    for (radius, tube, around, across, jitter) in [
        (3.0, 1.0, 200, 10, 0.0),
        (3.0, 1.0, 100, 12, 0.0),
        (3.0, 1.0, 100, 20, 0.0),
        (3.0, 1.0, 100, 12, 0.5),
        (2.0, 1.0, 30, 60, 0.0),
        (2.0, 1.0, 150, 12, 0.5),
        (5.0, 1.0, 60, 16, 0.0),
        (1.5, 0.5, 20, 70, 0.0),
        (4.0, 1.0, 120, 16, 0.5),
    ] {
        meshes.push(ring(radius, tube, around, across, jitter));
    }
    meshes
}
