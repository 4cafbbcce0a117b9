//! What is inside of closed surfaces.

use glam::DVec3;
use helfrich::Surface;
use std::f64::consts::PI;

/// Whether a closed surface winds around a point, by the solid angle under which it is seen from
/// there: A. Van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125. Right to rounding
/// at any distance; open surfaces enclose nothing.
pub fn encloses(surface: Surface<'_, f64>, point: [f64; 3]) -> bool {
    if !surface.mesh().is_closed() {
        return false;
    }
    let at = DVec3::from(point);
    let place = |vertex: u32| DVec3::from(surface.positions()[vertex as usize]) - at;
    let angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(place);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        // a·(b × c), by edges: seen from afar, the three are all but parallel.
        let doubled = a.dot((b - a).cross(c - a));
        2.0 * doubled.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    let triangles = surface.mesh().triangles().iter();
    triangles.map(angle).sum::<f64>().abs() > 2.0 * PI
}

/// The first vertex of one surface that is inside of another, and how many there are; none if there
/// is none.
pub fn vertices_inside(inner: Surface<'_, f64>, outer: Surface<'_, f64>) -> Option<(usize, usize)> {
    let corners = |surface: Surface<'_, f64>| {
        let points = || surface.positions().iter().copied().map(DVec3::from);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        (low, points().fold(DVec3::NEG_INFINITY, DVec3::max))
    };
    let (low, high) = corners(outer);
    let in_the_box = |point: &DVec3| point.cmpge(low).all() && point.cmple(high).all();
    let mut inside = (0..inner.positions().len()).filter(|&vertex| {
        let point = inner.positions()[vertex];
        in_the_box(&point.into()) && encloses(outer, point)
    });
    let first = inside.next()?;
    Some((first, 1 + inside.count()))
}
