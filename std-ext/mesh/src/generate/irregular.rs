//! Well-spaced random points.

use super::random::Random;
use super::{AnyShape, Draft, GenerateError, delaunay, icosphere, position, preimage};
use glam::DVec3;
use helfrich::shapes::{Shape, Torus};

/// Number of smoothing steps.
const STEPS: usize = 4;

/// Fraction of the distance to the mean of its neighbours by which a point moves: large enough to separate
/// points that are close together, small enough that valences from 3 to 12 and a few angles below 12° remain.
const SHARE: f64 = 0.12;

/// Random points, uniform by area, smoothed and triangulated.
pub(super) fn scatter(
    shape: &AnyShape,
    vertices: usize,
    seed: u64,
) -> Result<Draft, GenerateError> {
    let mut random = Random::new(seed);
    let mut preimages = match shape {
        AnyShape::Torus(torus) => on_torus(torus, vertices, &mut random),
        _ => on_sphere_like(shape, vertices, &mut random),
    };
    // Neighbours on the surface become neighbours in memory.
    preimages.sort_by_cached_key(|&point| place_on_curve(point / shape.size().max(1.0)));
    let triangulate = |points: &[DVec3]| {
        let triangles = match shape {
            AnyShape::Torus(torus) => delaunay::torus(torus, points),
            _ => delaunay::sphere(points),
        };
        triangles.map_err(|_| GenerateError::TooExtreme {
            shape: shape.name(),
        })
    };
    for _ in 0..STEPS {
        let triangles = triangulate(&preimages)?;
        smooth(shape, &triangles, &mut preimages);
    }
    Ok(Draft {
        triangles: triangulate(&preimages)?,
        preimages,
    })
}

/// Moves each point towards the mean of its neighbours, and back to the surface.
fn smooth(shape: &AnyShape, triangles: &[[u32; 3]], preimages: &mut [DVec3]) {
    let positions = Vec::from_iter(preimages.iter().map(|&point| position(shape, point)));
    let mut sums = vec![(DVec3::ZERO, 0.0); positions.len()];
    for &[a, b, c] in triangles {
        // In a closed mesh, every neighbour is visited twice.
        for [corner, next, last] in [[a, b, c], [b, c, a], [c, a, b]] {
            let (sum, count) = &mut sums[corner as usize];
            *sum += positions[next as usize] + positions[last as usize];
            *count += 2.0;
        }
    }
    for ((point, start), (sum, count)) in preimages.iter_mut().zip(positions).zip(sums) {
        *point = preimage(shape, start.lerp(sum / count, SHARE));
    }
}

/// Points that are uniform on the unit sphere, accepted in proportion to the area element.
fn on_sphere_like(shape: &AnyShape, vertices: usize, random: &mut Random) -> Vec<DVec3> {
    let element = |point: DVec3| shape.area_element(point.to_array());
    // The area element is smooth: between 2562 samples it exceeds their maximum by much less than 5 %.
    let samples = icosphere::icosphere(4).preimages.into_iter().map(element);
    let largest = 1.05 * samples.fold(0.0, f64::max);
    let mut points = Vec::with_capacity(vertices);
    while points.len() < vertices {
        let point = random.on_sphere();
        if random.unit() * largest < element(point) {
            points.push(point);
        }
    }
    points
}

/// Points that are uniform in both angles, accepted in proportion to their distance from the axis.
fn on_torus(torus: &Torus<f64>, vertices: usize, random: &mut Random) -> Vec<DVec3> {
    let (radius, tube) = (torus.radius, torus.tube_radius);
    let mut points = Vec::with_capacity(vertices);
    while points.len() < vertices {
        let around_tube = random.on_circle();
        let distance = radius + tube * around_tube.x;
        if random.unit() * (radius + tube) < distance {
            let around_axis = distance * random.on_circle();
            points.push(around_axis.extend(tube * around_tube.y));
        }
    }
    points
}

/// Index of a point along a curve that fills the cube −2 … 2 (Morton order): the interleaved bits of the
/// three coordinates.
fn place_on_curve(point: DVec3) -> u64 {
    let cells = f64::from(1 << 18) * (point + 2.0);
    let spread = |coordinate: f64| {
        let cell = coordinate as u64;
        (0..20).fold(0, |place, bit| place | (cell >> bit & 1) << (3 * bit))
    };
    spread(cells.x) | spread(cells.y) << 1 | spread(cells.z) << 2
}
