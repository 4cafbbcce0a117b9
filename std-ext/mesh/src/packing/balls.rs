//! Balls inside closed surfaces.

use glam::DVec3;
use helfrich::Surface;

/// A ball in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre, relative to the body's.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

/// Largest number of vertices for which balls are sought; of more, every second one or fewer are used.
const MOST_VERTICES: usize = 5000;

/// Balls inside a closed surface that come within `tolerance` of its vertices, the largest first.
///
/// At each vertex the largest ball is sought that touches the surface there and has no other vertex inside (J. Ma,
/// S. W. Bae and S. Choi, Vis. Comput. 28 (2012) 7); of these balls, one is left out if larger ones come near its vertex.
pub fn inscribed_balls(surface: Surface<'_, f64>, tolerance: f64) -> Vec<Ball> {
    let stride = surface.positions().len().div_ceil(MOST_VERTICES).max(1);
    let mut normals = vec![DVec3::ZERO; surface.positions().len()];
    for &corners in surface.mesh().triangles() {
        let [a, b, c] = corners.map(|corner| DVec3::from(surface.positions()[corner as usize]));
        for corner in corners {
            normals[corner as usize] += (b - a).cross(c - a);
        }
    }
    let all = surface.positions().iter().zip(&normals).step_by(stride);
    let points = all.map(|(&at, normal)| (DVec3::from(at), normal.normalize_or_zero()));
    let points = Vec::from_iter(points);
    let reach = |from: DVec3| points.iter().map(move |(to, _)| from.distance_squared(*to));
    let touching = points.iter().map(|&(at, normal)| {
        let mut radius = 0.5 * reach(at).fold(0.0, f64::max).sqrt();
        loop {
            let centre = at - radius * normal;
            let inside = (1.0 - 1e-9) * radius * radius;
            let nearest = (points.iter().map(|(to, _)| *to)).min_by(|a, b| {
                a.distance_squared(centre)
                    .total_cmp(&b.distance_squared(centre))
            });
            let smaller = nearest
                .filter(|to| to.distance_squared(centre) < inside)
                .map(|to| {
                    let apart = at - to;
                    apart.length_squared() / (2.0 * apart.dot(normal))
                });
            match smaller {
                Some(next) if next > 0.0 && next < (1.0 - 1e-9) * radius => radius = next,
                _ => return (centre, radius),
            }
        }
    });
    let mut touching = Vec::from_iter(touching.zip(&points));
    touching.sort_by(|(a, _), (b, _)| b.1.total_cmp(&a.1));
    let mut chosen = Vec::<Ball>::new();
    for ((centre, radius), (at, _)) in touching {
        let near = |ball: &Ball| DVec3::from(ball.centre).distance(*at) <= ball.radius + tolerance;
        if !chosen.iter().any(near) {
            chosen.push(Ball {
                centre: centre.to_array(),
                radius,
            });
        }
    }
    chosen
}
