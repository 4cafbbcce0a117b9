//! Search for the nodes of a lattice inside a closed mesh.

use std::ops::Range;

/// Calls `inside` with rows along x of unit cells whose centres (i + ½, j + ½, k + ½) the surface
/// winds around: the range of i, j and k, and the distance between the two crossings of the line
/// through them. They are not bounded by any lattice. Where the surface winds around a cell twice,
/// there is a row for each time, one within the other.
///
/// A line along x crosses a triangle if the projected triangle winds around it. Both triangles at
/// an edge compute the same number to decide on which side of the edge the line passes, so that
/// lines through edges and vertices are neither lost nor counted twice.
pub(super) fn for_each_row_inside(
    triangles: &[[u32; 3]],
    positions: &[[f64; 3]],
    mut inside: impl FnMut(Range<i64>, i64, i64, f64),
) {
    // (k, j, x, winding)
    let mut crossings = Vec::new();
    for triangle in triangles {
        let corners = triangle.map(|vertex| positions[vertex as usize]);
        let [_, y, z] = [0, 1, 2].map(|axis| centres(corners.map(|corner| corner[axis])));
        for k in z {
            for j in y.clone() {
                let line = [j as f64 + 0.5, k as f64 + 0.5];
                let winding: i32 = (0..3)
                    .map(|corner| crossing(triangle, corner, &corners, line))
                    .sum();
                if winding != 0 {
                    crossings.push((k, j, height(corners, line), winding));
                }
            }
        }
    }
    crossings.sort_unstable_by(|a, b| {
        let places = (a.0, a.1).cmp(&(b.0, b.1));
        places.then(a.2.total_cmp(&b.2)).then(a.3.cmp(&b.3))
    });
    for line in crossings.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        // Crossings at which the line has entered and not yet left.
        let mut entered = Vec::new();
        let mut winding = 0_i32;
        for &(k, j, x, turn) in line {
            let before = winding;
            winding += turn;
            if winding.abs() > before.abs() {
                entered.push(x);
            } else if let Some(start) = entered.pop() {
                let [first, end] = [start, x].map(|x: f64| (x - 0.5).ceil() as i64);
                inside(first..end, j, k, x - start);
            }
        }
    }
}

/// The numbers n with n + ½ among or between the values. Rounding may add one, which is harmless,
/// but removes none.
fn centres([a, b, c]: [f64; 3]) -> Range<i64> {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    (low - 0.5).ceil() as i64..(high - 0.5).floor() as i64 + 1
}

/// 1 or −1 if a triangle's side crosses the half-line from `line` towards larger z, up or down y.
fn crossing(triangle: &[u32; 3], side: usize, corners: &[[f64; 3]; 3], line: [f64; 2]) -> i32 {
    let next = (side + 1) % 3;
    let (from, to) = (corners[side], corners[next]);
    let (before, after) = (from[1] <= line[0], to[1] <= line[0]);
    if before == after {
        return 0;
    }
    // Computed from the vertex with the lower number, so that both triangles get the same result.
    let (a, b) = if triangle[side] < triangle[next] {
        (from, to)
    } else {
        (to, from)
    };
    let z = a[2] + (b[2] - a[2]) * ((line[0] - a[1]) / (b[1] - a[1]));
    match (z > line[1], before) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}

/// x of a triangle's plane on a line, no farther than the triangle reaches.
fn height([a, b, c]: [[f64; 3]; 3], [y, z]: [f64; 2]) -> f64 {
    let (by, bz) = (b[1] - a[1], b[2] - a[2]);
    let (cy, cz) = (c[1] - a[1], c[2] - a[2]);
    let (y, z) = (y - a[1], z - a[2]);
    let over = (by * cz - bz * cy).recip();
    let (s, t) = ((y * cz - z * cy) * over, (by * z - bz * y) * over);
    let x = a[0] + s * (b[0] - a[0]) + t * (c[0] - a[0]);
    let (low, high) = (a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0]));
    if x > low { x.min(high) } else { low }
}
