//! Results of the runs compared with published ones, and extrapolated to an infinite box and a fine
//! lattice.

use super::{FlowRow, Solver};
use helfrich_evaluate::scalar::Scalar;
use helfrich_run::plots::{PublishedCurve, read_curves};
use helfrich_scene::scene::SHIPPED;
use serde::Serialize;

/// Published results for the case of the article: curves of D over γ̇t, the article's first.
pub fn published() -> Vec<PublishedCurve> {
    let scene = SHIPPED.iter().find(|scene| scene.name == "capsule-shear");
    let path = scene.map(|scene| scene.path().with_file_name(PUBLISHED));
    // A test checks that it can be read.
    path.and_then(|path| read_curves(&path).ok())
        .unwrap_or_default()
}

/// The name of the file of published curves among the shipped scenes.
pub const PUBLISHED: &str = "capsule-shear-published.csv";

/// Differences of a run's D(t) from a published curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// The difference of the largest magnitude, of the run minus the curve.
    pub largest: f64,
    /// γ̇t of that point of the curve.
    pub at: f64,
    /// The shift of γ̇t that would make as large a difference there, by the slope of the run.
    pub shift: f64,
    /// The difference at the last point of the curve that the run reaches.
    pub last: f64,
    /// γ̇t of that point.
    pub last_at: f64,
}

/// The differences of a run's D(t) from a curve at the curve's points, as far as the run goes, between whose rows D is
/// linear; `None` if no point is that early.
pub fn deviation(row: &FlowRow, curve: &PublishedCurve) -> Option<Deviation> {
    let difference = |&[strain, value]: &[f64; 2]| {
        let after = row
            .outcome
            .transient
            .iter()
            .position(|point| point[0] >= strain)?;
        let [x1, y1] = row.outcome.transient[after];
        let [x0, y0] = row.outcome.transient[after.saturating_sub(1)];
        let slope = if x1 > x0 { (y1 - y0) / (x1 - x0) } else { 0.0 };
        let difference = y0 + slope * (strain - x0) - value;
        Some([strain, difference, (difference / slope).abs()])
    };
    let differences = Vec::from_iter(curve.points.iter().filter_map(difference));
    let size = |found: &[f64; 3]| found[1].abs();
    let &[at, largest, shift] = differences
        .iter()
        .max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let &[last_at, last, _] = differences.last()?;
    Some(Deviation {
        largest,
        at,
        shift,
        last,
        last_at,
    })
}

/// D in unbounded fluid, from two boxes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Boxes {
    /// κ/(a²G).
    pub bending: f64,
    /// Number of nodes along the radius a.
    pub resolution: f64,
    /// Number of vertices of the capsule.
    pub vertices: usize,
    /// Lengths L of the boxes, in radii.
    pub sizes: [f64; 2],
    /// D in each.
    pub deformations: [f64; 2],
    /// c of `D(L) = D(∞) + c (a/L)³`.
    pub coefficient: f64,
    /// D(∞).
    pub unbounded: f64,
}

/// D in unbounded fluid without the error of the lattice, from two resolutions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Resolved {
    /// κ/(a²G).
    pub bending: f64,
    /// Numbers of nodes along the radius a.
    pub resolutions: [f64; 2],
    /// Number of vertices of the capsule on the finer one.
    pub vertices: usize,
    /// D(∞) on each.
    pub deformations: [f64; 2],
    /// D of `D(h) = D + c h/a` with the node spacing h. The error is linear, because kernels thicken a
    /// membrane by a fraction of h.
    pub resolved: f64,
}

/// Pairs of boxes, neighbouring in size, of runs of the same capsule in f64.
pub fn boxes(rows: &[FlowRow]) -> Vec<Boxes> {
    let mut found = Vec::new();
    for row in rows {
        let Some((resolution, size)) = lattice(row) else {
            continue;
        };
        let larger = rows.iter().filter_map(|other| {
            let (same, larger) = lattice(other)?;
            let alike = same == resolution
                && other.case.bending == row.case.bending
                && other.case.method == row.case.method
                && other.case.vertices == row.case.vertices;
            (alike && larger > size).then_some((other, larger))
        });
        let Some((other, larger)) = larger.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        let coefficient = (row.outcome.deformation - other.outcome.deformation)
            / (size.powi(-3) - larger.powi(-3));
        found.push(Boxes {
            bending: row.case.bending,
            resolution,
            vertices: row.case.vertices,
            sizes: [size, larger],
            deformations: [row.outcome.deformation, other.outcome.deformation],
            coefficient,
            unbounded: other.outcome.deformation - coefficient * larger.powi(-3),
        });
    }
    found
}

/// Pairs of neighbouring resolutions with the same bending.
pub fn resolved(boxes: &[Boxes]) -> Vec<Resolved> {
    let mut found = Vec::new();
    for coarse in boxes {
        let finer = boxes
            .iter()
            .filter(|fine| fine.bending == coarse.bending && fine.resolution > coarse.resolution);
        let Some(fine) = finer.min_by(|a, b| a.resolution.total_cmp(&b.resolution)) else {
            continue;
        };
        let [a, b] = [coarse.resolution, fine.resolution];
        found.push(Resolved {
            bending: coarse.bending,
            resolutions: [a, b],
            vertices: fine.vertices,
            deformations: [coarse.unbounded, fine.unbounded],
            resolved: (b * fine.unbounded - a * coarse.unbounded) / (b - a),
        });
    }
    found
}

/// Resolution and size of a lattice of f64.
fn lattice(row: &FlowRow) -> Option<(f64, f64)> {
    match row.case.solver {
        Solver::LatticeBoltzmann {
            resolution,
            size,
            precision: Scalar::F64,
        } => Some((resolution, size)),
        _ => None,
    }
}
