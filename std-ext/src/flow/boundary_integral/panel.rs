//! Integrals over one triangle.

use super::stokeslets::{self, Source};
use glam::DVec3;

/// A triangle is near where its centre is nearer than this many times its longest edge.
const REACH: f64 = 2.0;

/// How often a near triangle's edges are halved at most.
const HALVINGS: u32 = 8;

/// A flat triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel<'a> {
    triangle: [u32; 3],
    positions: &'a [DVec3],
}

impl<'a> Panel<'a> {
    pub(super) fn new(triangle: [u32; 3], positions: &'a [DVec3]) -> Self {
        Self {
            triangle,
            positions,
        }
    }

    fn corners(&self) -> [DVec3; 3] {
        self.triangle.map(|vertex| self.positions[vertex as usize])
    }

    /// The same triangle with this vertex, one of its own, as the first.
    pub(super) fn turned_to(self, vertex: u32) -> Self {
        let [a, b, c] = self.triangle;
        let triangle = if vertex == a {
            [a, b, c]
        } else if vertex == b {
            [b, c, a]
        } else {
            [c, a, b]
        };
        Self { triangle, ..self }
    }

    /// Twice the area.
    pub(super) fn doubled_area(&self) -> f64 {
        let [a, b, c] = self.corners();
        (b - a).cross(c - a).length()
    }

    pub(super) fn centre(&self) -> DVec3 {
        let [a, b, c] = self.corners();
        a + ((b - a) + (c - a)) / 3.0
    }

    /// The square of the distance of the centre within which the triangle is near.
    pub(super) fn squared_reach(&self) -> f64 {
        REACH * REACH * squared_longest(self.corners())
    }

    /// The rule of three interior points, exact to degree 2.
    pub(super) fn sources(&self, tractions: &[DVec3]) -> [Source; 3] {
        let corners = self.corners();
        let tractions = self.triangle.map(|vertex| tractions[vertex as usize]);
        let weight = self.doubled_area() / 6.0;
        let shares = [[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]];
        shares.map(|share| {
            let share = share.map(|part| part / 6.0);
            let [x, y, z] = mean(corners, share).to_array();
            let [a, b, c] = (weight * mean(tractions, share)).to_array();
            [x, y, z, a, b, c]
        })
    }

    /// `∫ G(x − x₀)·q dS`, x₀ the first corner, without error but rounding.
    ///
    /// With `x = x₀ + ρ v(s)`, v from v₁ to v₂ along the opposite edge, dS is 2A ρ dρ ds and G is
    /// `(I/|v| + v v/|v|³)/ρ`: linear in ρ under the integral. That leaves
    /// `A ∫₀¹ (I/|v| + v v/|v|³)·[q₀ + (1 − s) q₁ + s q₂] ds`, in whose terms tⁿ/|v| and tⁿ/|v|³, t
    /// the length along the edge from the foot of x₀, are elementary.
    pub(super) fn integral_about_corner(&self, tractions: &[DVec3]) -> DVec3 {
        let [x, a, b] = self.corners();
        let [own, first, second] = self.triangle.map(|vertex| tractions[vertex as usize]);
        let (v1, v2) = (a - x, b - x);
        let edge = v2 - v1;
        let (length, doubled_area) = (edge.length(), v1.cross(v2).length());
        let height = doubled_area / length;
        if !(height.is_normal() && length.is_normal()) {
            return DVec3::ZERO;
        }
        let along = edge / length;
        let [t1, t2] = [v1.dot(along), v2.dot(along)];
        let foot = v1 - t1 * along;
        // The direction of the foot is finite however low the triangle is.
        let up = foot / height;
        let [r1, r2] = [v1.length(), v2.length()];
        // q = base + slope t along the edge, the corner's own included.
        let slope = (second - first) / length;
        let base = own + first - t1 * slope;
        // v·q as a polynomial of t.
        let constant = foot.dot(base);
        let linear = along.dot(base) + foot.dot(slope);
        let square = along.dot(slope);
        // ∫ dt/r = ln[(r1 + r2 + L)/(r1 + r2 − L)]; the difference is taken without cancellation.
        let inner = v1.dot(v2);
        let spread = if inner >= 0.0 {
            r1 * r2 + inner
        } else {
            doubled_area * doubled_area / (r1 * r2 - inner)
        };
        let around = r1 + r2 + length;
        let over_r = (around * around / (2.0 * spread)).ln();
        let ratio = t2 / r2 - t1 / r1;
        // ∫ tⁿ/r³ dt for n = 0 (times the squared height), 1, 2, 3.
        let cubes = [
            ratio,
            r1.recip() - r2.recip(),
            over_r - ratio,
            r2 - r1 + height * height * (r2.recip() - r1.recip()),
        ];
        let isotropic = over_r * base + (r2 - r1) * slope;
        let upward =
            constant / height * cubes[0] + height * (linear * cubes[1] + square * cubes[2]);
        let forward = constant * cubes[1] + linear * cubes[2] + square * cubes[3];
        0.5 * height * (isotropic + upward * up + forward * along)
    }

    /// `∫ G(x − at)·q dS` for a point near the triangle.
    pub(super) fn integral_near(&self, at: DVec3, tractions: &[DVec3]) -> DVec3 {
        let corners = self.corners().map(|corner| corner - at);
        let tractions = self.triangle.map(|vertex| tractions[vertex as usize]);
        halved(corners, tractions, HALVINGS)
    }
}

/// The integral seen from the origin, by parts that are far off by their own measure.
fn halved(corners: [DVec3; 3], tractions: [DVec3; 3], halvings: u32) -> DVec3 {
    let [a, b, c] = corners;
    let centre = (a + b + c) / 3.0;
    let far = centre.length_squared() >= REACH * REACH * squared_longest(corners);
    if far || halvings == 0 {
        return by_seven_points(corners, tractions);
    }
    let middles = |[a, b, c]: [DVec3; 3]| [0.5 * (b + c), 0.5 * (c + a), 0.5 * (a + b)];
    let (at, of) = (middles(corners), middles(tractions));
    let mut sum = halved(at, of, halvings - 1);
    for k in 0..3 {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        sum += halved(
            [corners[k], at[last], at[next]],
            [tractions[k], of[last], of[next]],
            halvings - 1,
        );
    }
    sum
}

/// The rule of seven interior points, exact to degree 5 (J. Radon 1948).
fn by_seven_points(corners: [DVec3; 3], tractions: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let area = 0.5 * (b - a).cross(c - a).length();
    let point = |share: [f64; 3], weight: f64| {
        let [x, y, z] = mean(corners, share).to_array();
        let [f, g, h] = (area * weight * mean(tractions, share)).to_array();
        stokeslets::one(DVec3::ZERO, [x, y, z, f, g, h])
    };
    let root = 15.0_f64.sqrt();
    let mut sum = point([1.0 / 3.0; 3], 9.0 / 40.0);
    for root in [root, -root] {
        let (outer, weight) = ((6.0 + root) / 21.0, (155.0 + root) / 1200.0);
        let inner = 1.0 - 2.0 * outer;
        sum += point([inner, outer, outer], weight)
            + point([outer, inner, outer], weight)
            + point([outer, outer, inner], weight);
    }
    sum
}

fn mean(values: [DVec3; 3], [a, b, c]: [f64; 3]) -> DVec3 {
    a * values[0] + b * values[1] + c * values[2]
}

fn squared_longest([a, b, c]: [DVec3; 3]) -> f64 {
    let [ab, bc, ca] = [a - b, b - c, c - a].map(DVec3::length_squared);
    ab.max(bc).max(ca)
}
