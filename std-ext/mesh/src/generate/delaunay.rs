//! Delaunay triangulations of the sphere and of the torus, by exact predicates in the plane.

use glam::DVec3;
use helfrich::shapes::Torus;
use spade::{DelaunayTriangulation, InsertionError, Point2, Triangulation};
use std::f64::consts::TAU;

/// Convex hull of points of the unit sphere, which is their Delaunay triangulation on it.
///
/// In the stereographic projection from the last point, circles through that point are straight lines. The
/// hull is therefore the planar Delaunay triangulation of the other points, with its outer edges joined to
/// the last point.
pub(super) fn sphere(points: &[DVec3]) -> Result<Vec<[u32; 3]>, InsertionError> {
    let Some((&pole, others)) = points.split_last() else {
        return Ok(Vec::new());
    };
    let last = others.len() as u32;
    let right = pole.any_orthonormal_vector();
    let up = pole.cross(right);
    let projection = others.iter().map(|&point| {
        // 1 − point·pole = |point − pole|²/2, without the cancellation near the pole.
        let away = point - pole;
        let image = 2.0 * away / away.length_squared();
        Point2::new(image.dot(right), image.dot(up))
    });
    let plane = DelaunayTriangulation::<_>::bulk_load_stable(projection.collect())?;
    let inner = plane
        .inner_faces()
        .map(|face| face.vertices().map(|vertex| vertex.index() as u32));
    let outer = plane
        .convex_hull()
        .map(|edge| [edge.from().index() as u32, edge.to().index() as u32, last]);
    // (right, up, pole) is right-handed: the plane is seen from inside the sphere.
    Ok(inner.chain(outer).map(|[a, b, c]| [a, c, b]).collect())
}

/// Delaunay triangulation of points of a torus in its conformal coordinates φ and ψ = ∫ r/(R + r cosθ) dθ, in
/// which small circles of the surface are circles.
///
/// The points are extended periodically in both coordinates, and as many copies are triangulated as can
/// influence one period.
pub(super) fn torus(shape: &Torus<f64>, points: &[DVec3]) -> Result<Vec<[u32; 3]>, InsertionError> {
    let (radius, tube) = (shape.radius, shape.tube_radius);
    // R² − r² without cancellation.
    let squares = (radius - tube) * (radius + tube);
    let periods = [1.0, on_grid(tube / squares.sqrt())];
    let home = Vec::from_iter(points.iter().map(|point| {
        let distance = point.truncate().length() - radius;
        let (cos, sin) = (distance / tube, point.z / tube);
        // ψ = 2r/√(R² − r²) atan(√((R − r)/(R + r)) tan θ/2).
        let half = libm::atan2(
            (radius - tube).sqrt() * sin,
            (radius + tube).sqrt() * (1.0 + cos),
        );
        let across = on_grid(2.0 * half / TAU * periods[1]);
        [on_grid(libm::atan2(point.y, point.x) / TAU), across]
    }));

    // Points are sparsest on the inner equator, by this factor relative to the mean; random points leave
    // holes of a few spacings.
    let sparsest = radius * squares.sqrt() / ((radius - tube) * (radius - tube));
    let margin = 8.0 * (sparsest * periods[1] / points.len() as f64).sqrt();
    let reach = periods.map(|period| 0.5 * period + margin.min(period));

    let mut copies = Vec::new();
    let mut origins = Vec::new();
    for (site, &[x, y]) in home.iter().enumerate() {
        for shift_x in [0.0, -1.0, 1.0] {
            for shift_y in [0.0, -1.0, 1.0] {
                let copy = [x + shift_x * periods[0], y + shift_y * periods[1]];
                if copy[0].abs() <= reach[0] && copy[1].abs() <= reach[1] {
                    copies.push(Point2::new(copy[0], copy[1]));
                    origins.push((site as u32, shift_x == 0.0 && shift_y == 0.0));
                }
            }
        }
    }
    let plane = DelaunayTriangulation::<_>::bulk_load_stable(copies)?;
    // One copy of a triangle is kept, the one whose lowest-numbered corner is in the first period.
    let kept = plane.inner_faces().filter_map(|face| {
        let corners = face.vertices().map(|vertex| origins[vertex.index()]);
        let lowest = corners.iter().min_by_key(|(site, _)| site)?;
        lowest.1.then(|| corners.map(|(site, _)| site))
    });
    Ok(kept.collect())
}

/// The nearest multiple of 2⁻⁴⁰. Such numbers are added exactly, so that all copies of a point are exact
/// translates and the predicates decide alike for all copies of a triangle.
fn on_grid(coordinate: f64) -> f64 {
    let cells = (1u64 << 40) as f64;
    (coordinate * cells).round() / cells
}
