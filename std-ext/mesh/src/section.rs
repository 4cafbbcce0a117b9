//! Sections of a surface by a plane.

use glam::DVec3;
use helfrich::Surface;

/// Line segments in which a plane cuts the triangles. The plane passes through a point and is perpendicular
/// to `normal`, which may have any length.
///
/// Each triangle has at most one segment, in the order of triangles; triangles in the plane have none.
/// Segments of adjacent triangles share their ends bit for bit, so that a closed surface gives closed
/// curves. These run counter-clockwise around the inside, seen from the tip of the normal.
pub fn section(surface: Surface<'_, f64>, point: [f64; 3], normal: [f64; 3]) -> Vec<[[f64; 3]; 2]> {
    let (point, normal) = (DVec3::from(point), DVec3::from(normal));
    let place = |vertex: u32| DVec3::from(surface.positions()[vertex as usize]);
    // A vertex in the plane counts as above it, so that every triangle is cut in two sides or not at all.
    let height = |vertex: u32| (place(vertex) - point).dot(normal);
    let crossing = |below: u32, above: u32| {
        let [low, high] = [height(below), height(above)];
        place(below).lerp(place(above), low / (low - high))
    };
    let mut lines = Vec::new();
    for &triangle in surface.mesh().triangles() {
        let above = triangle.map(|vertex| height(vertex) >= 0.0);
        // The corner that is alone on its side of the plane.
        let Some(alone) = (0..3).find(|&corner| {
            above[corner] != above[(corner + 1) % 3] && above[corner] != above[(corner + 2) % 3]
        }) else {
            continue;
        };
        let [apex, next, last] = [0, 1, 2].map(|step| triangle[(alone + step) % 3]);
        let line = if above[alone] {
            [crossing(next, apex), crossing(last, apex)]
        } else {
            [crossing(apex, last), crossing(apex, next)]
        };
        lines.push(line.map(|end| end.to_array()));
    }
    lines
}
