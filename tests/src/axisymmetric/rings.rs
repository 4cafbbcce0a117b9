//! Meshes of axisymmetric vesicles: rings of vertices around the axis.

use super::Vesicle;
use std::f64::consts::TAU;
use std::fmt::Write as _;

impl Vesicle {
    /// Positions and outward triangles of a mesh with edges of about one length everywhere, where the area is 4π:
    /// rings at equal distances along the profile, with as many vertices as fit, joined by triangles.
    pub fn rings(&self, edge: f64) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        let inner = self.profile();
        let ends = [inner.first(), inner.last()].map(|end| [0.0, end.map_or(0.0, |end| end[1])]);
        let mut profile = vec![ends[0]];
        profile.extend(inner);
        profile.push(ends[1]);
        let mut arcs = vec![0.0];
        for pair in profile.windows(2) {
            let [x, z] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
            arcs.push(arcs[arcs.len() - 1] + x.hypot(z));
        }
        let length = arcs[arcs.len() - 1];
        let at = |arc: f64| {
            let after = arcs.partition_point(|known| *known < arc);
            let after = after.clamp(1, arcs.len() - 1);
            let share = (arc - arcs[after - 1]) / (arcs[after] - arcs[after - 1]);
            [0, 1].map(|axis| {
                let [before, after] = [profile[after - 1][axis], profile[after][axis]];
                before + share * (after - before)
            })
        };
        let steps = (length / (0.75_f64.sqrt() * edge)).round().max(2.0) as usize;
        let mut positions = Vec::new();
        let mut rings: Vec<std::ops::Range<usize>> = Vec::new();
        for step in 0..=steps {
            let first = positions.len();
            if step == 0 || step == steps {
                positions.push([
                    0.0,
                    0.0,
                    profile[if step == 0 { 0 } else { profile.len() - 1 }][1],
                ]);
            } else {
                let [x, z] = at(length * step as f64 / steps as f64);
                let count = (TAU * x / edge).round().max(6.0);
                for k in 0..count as usize {
                    let (sin, cos) = (TAU * (k as f64 + offset(step)) / count).sin_cos();
                    positions.push([x * cos, x * sin, z]);
                }
            }
            rings.push(first..positions.len());
        }
        let mut triangles = Vec::new();
        for (step, pair) in rings.windows(2).enumerate() {
            join(step, [&pair[0], &pair[1]], &mut triangles);
        }
        (positions, triangles)
    }

    /// The mesh of [`Self::rings`] as a PLY file with six digits.
    pub fn ply(&self, edge: f64, comment: &str) -> String {
        let (positions, triangles) = self.rings(edge);
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment {comment}\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
            positions.len(),
            triangles.len()
        );
        for [x, y, z] in positions {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{x:.6} {y:.6} {z:.6}");
        }
        for [a, b, c] in triangles {
            let _ = writeln!(text, "3 {a} {b} {c}");
        }
        text
    }
}

/// Every other ring is turned by half an edge.
fn offset(step: usize) -> f64 {
    0.5 * (step % 2) as f64
}

/// Joins two rings: always by the edge that goes less far around.
fn join(step: usize, rings: [&std::ops::Range<usize>; 2], triangles: &mut Vec<[usize; 3]>) {
    let counts = rings.map(ExactSizeIterator::len);
    let vertex = |ring: usize, k: usize| rings[ring].start + k % counts[ring];
    // The angle of the next vertex; a pole has none.
    let next = |ring: usize, k: usize| match counts[ring] {
        1 => f64::INFINITY,
        count if k == count => f64::INFINITY,
        count => (k as f64 + 1.0 + offset(step + ring)) / count as f64,
    };
    let (mut i, mut j) = (0, 0);
    while next(0, i).is_finite() || next(1, j).is_finite() {
        if next(0, i) <= next(1, j) {
            triangles.push([vertex(0, i), vertex(1, j), vertex(0, i + 1)]);
            i += 1;
        } else {
            triangles.push([vertex(0, i), vertex(1, j), vertex(1, j + 1)]);
            j += 1;
        }
    }
}
