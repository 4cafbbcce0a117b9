//! New meshes of smooth surfaces in f64, compiled once here for all other crates: edge lengths, creases, fields.

use crate::execute::Parallel;
use helfrich::{MeshPoint, Remeshed, Remeshing, SmoothPoint, SmoothSurface, Surface};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The edge lengths of a new mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeLengths {
    /// The same everywhere.
    Uniform(f64),
    /// Lengths at the vertices of the input, in its unit of length.
    AtVertices(Vec<f64>),
    /// An edge turns by at most this angle, in radians: it is as long as the smaller radius of curvature times the angle.
    ByCurvature(f64),
    /// As long as the error of H may be at most this part of the largest |H|, by the disagreement of neighbouring fits.
    ByError(f64),
}

impl EdgeLengths {
    /// The largest relative increase of lengths along the surface, so that triangles stay even.
    const GROWTH: f64 = 0.3;

    /// Lengths by curvature and error are between the length of edges at the vertex over this factor, and times it: outside,
    /// nothing is known about the surface, or too much would be lost.
    const RANGE: f64 = 4.0;

    /// The lengths at the vertices.
    fn at_vertices(&self, smooth: &SmoothSurface<f64>) -> Vec<f64> {
        let surface = smooth.surface();
        let mut lengths = match self {
            Self::Uniform(length) => return vec![*length; surface.positions().len()],
            Self::AtVertices(lengths) => lengths.clone(),
            Self::ByCurvature(angle) => within_range(surface, |vertex, _| {
                let curvature = &smooth.vertices()[vertex];
                let root = (curvature.mean.powi(2) - curvature.gaussian)
                    .max(0.0)
                    .sqrt();
                angle / (curvature.mean.abs() + root)
            }),
            Self::ByError(part) => {
                let largest = smooth.vertices().iter().map(|vertex| vertex.mean.abs());
                let allowed = part * largest.fold(0.0, f64::max);
                let orders = smooth.degree() as f64 - 1.0;
                let errors = smooth.curvature_errors();
                within_range(surface, |vertex, edge| {
                    edge * (allowed / errors[vertex][0]).powf(1.0 / orders)
                })
            }
        };
        limit_growth(surface, &mut lengths, Self::GROWTH);
        lengths
    }
}

/// Lengths at the vertices, of the vertex and its mean edge length, within the range.
fn within_range(surface: Surface<'_, f64>, wanted: impl Fn(usize, f64) -> f64) -> Vec<f64> {
    let lengths = (0..surface.positions().len()).map(|vertex| {
        let ring = surface.mesh().one_ring(vertex);
        let lengths = ring
            .iter()
            .map(|&other| length(surface, vertex as u32, other));
        let edge = lengths.sum::<f64>() / (ring.len().max(1) as f64);
        let wanted = wanted(vertex, edge);
        let least = edge / EdgeLengths::RANGE;
        // Unknown curvatures and errors are NaN.
        if wanted.is_nan() {
            least
        } else {
            wanted.clamp(least, EdgeLengths::RANGE * edge)
        }
    });
    lengths.collect()
}

fn length(surface: Surface<'_, f64>, from: u32, to: u32) -> f64 {
    let [x, y, z] = surface.difference(from, to);
    x.hypot(y).hypot(z)
}

/// Lowers lengths so that they grow by at most this part of the distance along the edges.
fn limit_growth(surface: Surface<'_, f64>, lengths: &mut [f64], growth: f64) {
    // Lengths are not negative, so that their bits have the same order.
    let entry = |length: f64, vertex: u32| Reverse((length.to_bits(), vertex));
    let mut pending = BinaryHeap::with_capacity(lengths.len());
    pending.extend(
        lengths
            .iter()
            .zip(0..)
            .map(|(&length, vertex)| entry(length, vertex)),
    );
    while let Some(Reverse((bits, vertex))) = pending.pop() {
        let here = f64::from_bits(bits);
        if here > lengths[vertex as usize] {
            continue;
        }
        for &other in surface.mesh().one_ring(vertex as usize) {
            let most = here + growth * length(surface, vertex, other);
            if most < lengths[other as usize] {
                lengths[other as usize] = most;
                pending.push(entry(most, other));
            }
        }
    }
}

/// The smooth surface through the vertices, on all threads. It is folded along edges at which triangles differ by more than
/// `creases`, in radians.
pub fn smooth_surface(surface: Surface<'_, f64>, creases: f64) -> SmoothSurface<f64> {
    let jet = SmoothSurface::jet_for(surface.mesh());
    SmoothSurface::with_lines(&Parallel::new(), surface, &jet, &surface.creases(creases))
}

/// A new mesh of a smooth surface with edges of these lengths, which are relative to each other if a number of vertices is
/// given; see [`SmoothSurface::remesh`].
pub fn remesh(
    smooth: &SmoothSurface<f64>,
    lengths: &EdgeLengths,
    vertices: Option<usize>,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Option<Remeshed<f64>> {
    let sizes = lengths.at_vertices(smooth);
    let settings = Remeshing {
        sizes: &sizes,
        vertices,
        rounds: Remeshing::<f64>::ROUNDS,
    };
    smooth.remesh(&Parallel::new(), &settings, go_on)
}

/// The values of a field at places of a surface, from those at its vertices: integers, which may be labels, from the
/// nearest corner; other fields with errors of order 7, or 9 from 2500 vertices on.
///
/// The vertices are moved by ±ε times the field along their normals: the smooth surfaces through them are apart by
/// 2 ε times the field. Where they are not smooth, values are interpolated linearly.
///
/// # Panics
/// If a vertex has no value, or a place is in a triangle that does not exist.
pub fn carried(smooth: &SmoothSurface<f64>, places: &[MeshPoint<f64>], field: &[f64]) -> Vec<f64> {
    let surface = smooth.surface();
    let corners = |place: &MeshPoint<f64>| {
        let corners = surface.mesh().triangles()[place.triangle];
        let values = corners.map(|corner| field[corner as usize]);
        values.into_iter().zip(place.barycentric)
    };
    if field.iter().all(|value| value.fract() == 0.0) {
        let nearest = |place| {
            corners(place)
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(value, _)| value)
        };
        return places
            .iter()
            .map(|place| nearest(place).unwrap_or(f64::NAN))
            .collect();
    }
    let linear = |place| -> f64 { corners(place).map(|(value, weight)| value * weight).sum() };
    let least = field.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = field.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = 0.5 * (least + largest);
    let edges = surface.mesh().edges();
    let edge = edges.iter().map(|&[from, to]| length(surface, from, to));
    let edge = edge.sum::<f64>() / edges.len() as f64;
    // The square root of rounding would be best for a difference; the surfaces are curved, so that it is a little more.
    let step = 1e-5 * edge / (largest - middle);
    if !step.is_finite() || field.iter().any(|value| !value.is_finite()) {
        return places.iter().map(linear).collect();
    }
    let moved = |sign: f64| -> Vec<SmoothPoint<f64>> {
        let vertices = surface.positions().iter().zip(smooth.vertices()).zip(field);
        let positions = vertices.map(|((at, curvature), value)| {
            let distance = sign * step * (value - middle);
            [0, 1, 2].map(|axis| at[axis] + distance * curvature.normal[axis])
        });
        let positions = Vec::from_iter(positions);
        let surface = Surface::new(surface.mesh(), &positions).expect("finite positions");
        let jet = SmoothSurface::jet_for(surface.mesh());
        let moved = SmoothSurface::with_lines(&Parallel::new(), surface, &jet, smooth.lines());
        moved.all_at(&Parallel::new(), places)
    };
    let (above, below) = (moved(1.0), moved(-1.0));
    let values = places
        .iter()
        .zip(above.iter().zip(&below))
        .map(|(place, (above, below))| {
            let apart = (0..3)
                .map(|axis| (above.position[axis] - below.position[axis]) * above.normal[axis]);
            let value = middle + apart.sum::<f64>() / (2.0 * step);
            // Beyond the values at the corners by more than their differences, a fit is not to be trusted.
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for (corner, _) in corners(place) {
                (low, high) = (low.min(corner), high.max(corner));
            }
            let room = high - low;
            if (low - room..=high + room).contains(&value) {
                value
            } else {
                linear(place)
            }
        });
    values.collect()
}
