//! Sheets that meet at edges with three or more triangles.

use super::neighbours::{Manifold, join, root};
use glam::DVec3;

/// Marks a group of sheets of which none is known yet.
const NONE: u32 = u32::MAX;

/// Whether the sheet of each triangle has the largest area of those that meet at edges with three or more.
pub(super) fn are_large(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    manifold: &Manifold,
) -> Vec<bool> {
    // A sheet is named by one of its corners.
    let mut sheets = Vec::from_iter(0..3 * triangles.len() as u32);
    for (triangle, fans) in (0u32..).zip(&manifold.vertices) {
        for (corner, &fan) in (3 * triangle..).zip(fans) {
            join(&mut sheets, 3 * triangle, corner);
            join(&mut sheets, corner, fan);
        }
    }
    let mut groups = sheets.clone();
    for edges in &manifold.crowded {
        for pair in edges.windows(2) {
            join(&mut groups, pair[0], pair[1]);
        }
    }
    let mut areas = vec![0.0; sheets.len()];
    let mut sheet_of = Vec::with_capacity(triangles.len());
    for (triangle, corners) in (0u32..).zip(triangles) {
        let [a, b, c] = corners.map(|vertex| DVec3::from(positions[vertex as usize]));
        let sheet = root(&mut sheets, 3 * triangle) as usize;
        areas[sheet] += (b - a).cross(c - a).length();
        sheet_of.push(sheet);
    }
    let mut largest = vec![NONE; sheets.len()];
    for &sheet in &sheet_of {
        let group = root(&mut groups, sheet as u32) as usize;
        if largest[group] == NONE || areas[sheet] > areas[largest[group] as usize] {
            largest[group] = sheet as u32;
        }
    }
    let is_large = sheet_of.iter().map(|&sheet| {
        let group = root(&mut groups, sheet as u32) as usize;
        largest[group] as usize == sheet
    });
    is_large.collect()
}
