//! New meshes of smooth surfaces in f64, compiled once here for all other crates: edge lengths, creases, fields.

use crate::execute::Parallel;
use crate::held::VolumeError;
use crate::noise::{NotQuieted, Quieted, noise_of};
use helfrich::{
    Curvature, MeshPoint, Noise, Remeshed, Remeshing, SmoothSurface, Surface, TriangleMesh,
    crossing_triangles,
};
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
                angle / largest_curvature(&smooth.vertices()[vertex])
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

/// The largest magnitude of a principal curvature.
fn largest_curvature(point: &Curvature<f64>) -> f64 {
    let root = (point.mean.powi(2) - point.gaussian).max(0.0).sqrt();
    point.mean.abs() + root
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

/// Properties that a new mesh is to have.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshRequest {
    /// The edge lengths.
    pub lengths: EdgeLengths,
    /// The number of vertices; lengths are then relative to each other.
    pub vertices: Option<usize>,
    /// The angle between triangles, in radians, above which their edge is a crease.
    pub creases: f64,
    /// The treatment of noise of the positions.
    pub noise: OfNoise,
}

/// The treatment of noise of the positions of a surface that is to have a new mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfNoise {
    /// Noise that would be considerable bumps of the new mesh is an error.
    Refused,
    /// It is removed first.
    Removed,
    /// It is not sought, and is taken for part of the shape.
    Kept,
}

impl OfNoise {
    /// Removal, or refusal.
    pub fn removed_if(removed: bool) -> Self {
        if removed {
            Self::Removed
        } else {
            Self::Refused
        }
    }
}

/// A new mesh, and the smooth surface on which its vertices are.
#[derive(Debug)]
pub struct NewMesh {
    /// The smooth surface through the old vertices.
    pub smooth: SmoothSurface<f64>,
    /// The new mesh.
    pub made: Remeshed<f64>,
    /// The root mean square of the displacements that removed noise; `None` if there was none.
    pub moved: Option<f64>,
}

/// The reason why there is no new mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RemeshError {
    /// Noise that would be considerable bumps of the new mesh.
    #[error(
        "the positions have noise of {:.1e} ({:.1e} mean edges), which the new mesh would have as bumps", .0.length, .0.edges
    )]
    Noise(Noise<f64>),
    /// More vertices than [`MOST_VERTICES`].
    #[error(
        "edges of these lengths ask for about {0:.1e} vertices, more than {MOST_VERTICES}: choose longer ones, or the number of \
         vertices"
    )]
    TooManyVertices(f64),
    /// Noise that was not removed.
    #[error(transparent)]
    NotQuieted(#[from] NotQuieted),
    /// Triangles that cross, where the old ones do not.
    #[error(
        "{0} pairs of triangles would cross each other, where the surface is thinner than the new edges: choose more \
         vertices or shorter edges"
    )]
    Crossings(usize),
    /// A volume that a new mesh does not have.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// The caller ended the work.
    #[error("interrupted")]
    Interrupted,
}

/// Most vertices of a new mesh: about 60 GB of memory.
pub const MOST_VERTICES: usize = 1 << 27;

/// Noise, in mean edges, from which on bumps are a considerable part of H: about this number times the edges that fit into a
/// radius of curvature.
const ROUGH: f64 = 1e-3;

/// A part of the noise that the misfits of half of the vertices exceed: of noise of 1e-3 mean edges they are at least 0.25
/// on spheres, discocytes, ellipsoids and tori of 162 to 10 242 vertices, and 0.11 of 42. Misfits of exact meshes of these
/// are below 0.04 of it from 1280 vertices on.
const SEEN: f64 = 0.1;

/// A new mesh of the smooth surface through the vertices, on all threads; `go_on` gets the part that is done, and ends the
/// work by `false`. See [`SmoothSurface::remesh`].
///
/// # Errors
/// If positions are noisy, if their noise cannot be removed, if triangles would cross, or if the work is ended.
pub fn remeshed(
    surface: Surface<'_, f64>,
    request: &MeshRequest,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<NewMesh, RemeshError> {
    let quiet = match request.noise {
        // The fits take most of the time, before anything of the new mesh is done.
        OfNoise::Removed => match Quieted::new(surface, &mut |_| go_on(0.0)) {
            Err(NotQuieted::Interrupted) => return Err(RemeshError::Interrupted),
            // Noise that is no considerable bump may stay.
            Err(NotQuieted::NoNoise) => None,
            Err(NotQuieted::Unresolved(noise)) if noise.edges <= ROUGH => None,
            quiet => Some(quiet?),
        },
        OfNoise::Refused | OfNoise::Kept => None,
    };
    let mesh = surface.mesh();
    let surface = match &quiet {
        Some(quiet) => {
            Surface::new(mesh, &quiet.positions).map_err(|_| RemeshError::Noise(quiet.noise))?
        }
        None => surface,
    };
    let jet = SmoothSurface::jet_for(mesh);
    let lines = surface.creases(request.creases);
    let smooth = SmoothSurface::with_lines(&Parallel::new(), surface, &jet, &lines);
    if request.noise == OfNoise::Refused && may_be_rough(&smooth) {
        let noise = noise_of(surface);
        if noise.edges > ROUGH {
            return Err(RemeshError::Noise(noise));
        }
    }
    let sizes = request.lengths.at_vertices(&smooth);
    let expected = request
        .vertices
        .map_or_else(|| vertices_of(surface, &sizes), |count| count as f64);
    if expected > MOST_VERTICES as f64 {
        return Err(RemeshError::TooManyVertices(expected));
    }
    let settings = Remeshing {
        sizes: &sizes,
        vertices: request.vertices,
        rounds: Remeshing::<f64>::ROUNDS,
    };
    let made = smooth.remesh(&Parallel::new(), &settings, go_on);
    let made = made.ok_or(RemeshError::Interrupted)?;
    let crossings = made.crossings.len();
    if crossings > 0 && crossings > crossing_triangles(surface).len() {
        return Err(RemeshError::Crossings(crossings));
    }
    let moved = quiet.map(|quiet| quiet.moved);
    Ok(NewMesh {
        smooth,
        made,
        moved,
    })
}

/// Whether noise may be rough. Most surfaces are far from it, which the fits show at no cost.
fn may_be_rough(smooth: &SmoothSurface<f64>) -> bool {
    let surface = smooth.surface();
    let edges = surface.mesh().edges();
    let lengths = edges.iter().map(|&[from, to]| length(surface, from, to));
    let limit = SEEN * ROUGH * lengths.sum::<f64>() / edges.len() as f64;
    let misfits = smooth.misfits();
    let above = misfits.iter().filter(|&&misfit| misfit > limit).count();
    2 * above > misfits.len()
}

/// The number of vertices of equilateral triangles with these lengths: of each, an edge of length l has the area √3/2 l².
fn vertices_of(surface: Surface<'_, f64>, sizes: &[f64]) -> f64 {
    let triangles = surface.mesh().triangles().iter().enumerate();
    let counts = triangles.map(|(triangle, corners)| {
        let size = corners.map(|corner| sizes[corner as usize]);
        let size = size.into_iter().sum::<f64>() / 3.0;
        2.0 / 3.0_f64.sqrt() * surface.triangle_area(triangle) / (size * size)
    });
    counts.sum()
}

/// A triangle of the old mesh for each new one: that at its first corner.
pub fn old_triangles(made: &Remeshed<f64>) -> Vec<usize> {
    let first = made.mesh.triangles().iter().map(|corners| corners[0]);
    first
        .map(|corner| made.places[corner as usize].triangle)
        .collect()
}

/// Numbers the vertices of a new mesh so that its components come in the order of those of the old one; within a
/// component the order stays.
pub fn in_order_of_components(old: &TriangleMesh, made: &mut Remeshed<f64>) {
    let (components, count) = old.components();
    if count < 2 {
        return;
    }
    let component =
        |place: &MeshPoint<f64>| components[old.triangles()[place.triangle][0] as usize];
    let mut order = Vec::from_iter(0..made.places.len());
    order.sort_by_key(|&vertex| component(&made.places[vertex]));
    let mut numbers = vec![0; order.len()];
    for (number, &vertex) in order.iter().enumerate() {
        numbers[vertex] = number as u32;
    }
    let triangles = made.mesh.triangles().iter();
    let triangles = triangles.map(|corners| corners.map(|corner| numbers[corner as usize]));
    // The same mesh in another order has no other errors.
    if let Ok(mesh) = TriangleMesh::new(order.len(), triangles.collect()) {
        made.mesh = mesh;
        made.places = order.iter().map(|&vertex| made.places[vertex]).collect();
        made.points = order.iter().map(|&vertex| made.points[vertex]).collect();
    }
}

/// The values of fields at places of a surface, from those at its vertices: integers, which may be labels, from the
/// nearest corner; other fields as accurate as the positions of the surface, see [`SmoothSurface::fields`]. They are
/// interpolated linearly where they have values that are not finite, and where polynomials leave the range of the values
/// around the corners by more than its width.
///
/// # Panics
/// If a vertex has no value, or a place is in a triangle that does not exist.
pub fn carried(
    smooth: &SmoothSurface<f64>,
    places: &[MeshPoint<f64>],
    fields: &[&[f64]],
) -> Vec<Vec<f64>> {
    let execution = Parallel::new();
    let are_labels = |field: &[f64]| field.iter().all(|value| value.fract() == 0.0);
    let are_smooth =
        |field: &[f64]| field.iter().all(|value| value.is_finite()) && !are_labels(field);
    let polynomials = fields.iter().copied().filter(|field| are_smooth(field));
    let polynomials = smooth.fields(&execution, &Vec::from_iter(polynomials));
    let mesh = smooth.surface().mesh();
    let corners = |place: &MeshPoint<f64>, field: &[f64]| {
        let values = mesh.triangles()[place.triangle].map(|corner| field[corner as usize]);
        [0, 1, 2].map(|corner| (values[corner], place.barycentric[corner]))
    };
    let nearest = |place: &MeshPoint<f64>, field: &[f64]| {
        let corners = corners(place, field).into_iter();
        let nearest = corners.max_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or(f64::NAN, |(value, _)| value)
    };
    let linear = |place: &MeshPoint<f64>, field: &[f64]| -> f64 {
        let corners = corners(place, field).into_iter();
        corners.map(|(value, weight)| value * weight).sum()
    };
    let is_within = |place: &MeshPoint<f64>, field: &[f64], value: f64| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in mesh.triangles()[place.triangle] {
            for &other in mesh.one_ring(corner as usize) {
                let value = field[other as usize];
                (low, high) = (low.min(value), high.max(value));
            }
        }
        let room = high - low;
        (low - room..=high + room).contains(&value)
    };
    let mut number = 0;
    let carry = |field: &&[f64]| -> Vec<f64> {
        if are_labels(field) {
            return places.iter().map(|place| nearest(place, field)).collect();
        }
        if !are_smooth(field) {
            return places.iter().map(|place| linear(place, field)).collect();
        }
        let points = polynomials.all_at(&execution, number, places);
        number += 1;
        let values = places.iter().zip(points).map(|(place, point)| {
            if is_within(place, field, point.value) {
                point.value
            } else {
                linear(place, field)
            }
        });
        values.collect()
    };
    fields.iter().map(carry).collect()
}
