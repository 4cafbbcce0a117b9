//! Integrals over one triangle.

use super::kernel::{Gradient, Kernel, Stokeslet, Stresslet, StressletPressure, source};
use glam::DVec3;

/// A triangle is near a point if the distance of its centre is below this many times its longest
/// edge.
const REACH: f64 = 2.0;

/// Largest number of times that the edges of a near triangle are halved.
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

    /// The corners relative to a point.
    pub(super) fn corners_from(&self, at: DVec3) -> [DVec3; 3] {
        self.corners().map(|corner| corner - at)
    }

    /// The values of a field at the corners.
    pub(super) fn of(&self, field: &[DVec3]) -> [DVec3; 3] {
        self.triangle.map(|vertex| field[vertex as usize])
    }

    /// The same triangle with this vertex, which is one of its corners, as the first.
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

    /// The normal with twice the area as its length.
    pub(super) fn doubled_normal(&self) -> DVec3 {
        doubled_normal(self.corners())
    }

    /// Twice the area.
    pub(super) fn doubled_area(&self) -> f64 {
        self.doubled_normal().length()
    }

    pub(super) fn centre(&self) -> DVec3 {
        let [a, b, c] = self.corners();
        a + ((b - a) + (c - a)) / 3.0
    }

    /// The square of the distance of the centre within which the triangle is near.
    pub(super) fn squared_reach(&self) -> f64 {
        REACH * REACH * squared_longest(self.corners())
    }

    /// The middles of the edges and the field there, each a third of the triangle, exact to degree 2.
    pub(super) fn points(&self, values: [DVec3; 3]) -> [(DVec3, DVec3); 3] {
        let middles = |[a, b, c]: [DVec3; 3]| [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        let (at, of) = (middles(self.corners()), middles(values));
        [0, 1, 2].map(|k| (at[k], of[k]))
    }

    /// `∫ G(x − x₀)·q dS`, x₀ the first corner, exact to rounding.
    ///
    /// With `x = x₀ + ρ v(s)`, v from v₁ to v₂ along the opposite edge, dS is 2A ρ dρ ds and G is
    /// `(I/|v| + v v/|v|³)/ρ`: linear in ρ under the integral. That leaves
    /// `A ∫₀¹ (I/|v| + v v/|v|³)·[q₀ + (1 − s) q₁ + s q₂] ds`, in whose terms tⁿ/|v| and tⁿ/|v|³, t
    /// the length along the edge from the foot of x₀, are elementary.
    pub(super) fn stokeslets_about_corner(&self, tractions: [DVec3; 3]) -> DVec3 {
        let [x, a, b] = self.corners();
        let [own, first, second] = tractions;
        let Some(edge) = PanelEdge::new(a - x, b - x) else {
            return DVec3::ZERO;
        };
        let PanelEdge {
            length,
            along,
            foot,
            height,
            ends: [(t1, r1), (t2, r2)],
            over_r,
        } = edge;
        if !height.is_normal() {
            return DVec3::ZERO;
        }
        // The direction of the foot is finite, however small the height of the triangle.
        let up = foot / height;
        // q = base + slope t along the edge; this includes the contribution of the corner x₀.
        let slope = (second - first) / length;
        let base = own + first - t1 * slope;
        // v·q as a polynomial of t.
        let constant = foot.dot(base);
        let linear = along.dot(base) + foot.dot(slope);
        let square = along.dot(slope);
        // Differences between the ends are computed as quotients, because for a short distant edge
        // only these keep all digits.
        let over_sum = (t1 + t2) / (r1 + r2) * length;
        let ratio = if t1 * t2 > 0.0 {
            height * height * over_sum * (r1 + r2) / ((t2 * r1 + t1 * r2) * r1 * r2)
        } else {
            t2 / r2 - t1 / r1
        };
        let inverses = over_sum / (r1 * r2);
        // ∫ tⁿ/r³ dt for n = 0 (times the squared height), 1, 2, 3.
        let cubes = [
            ratio,
            inverses,
            over_r - ratio,
            over_sum - height * height * inverses,
        ];
        let isotropic = over_r * base + over_sum * slope;
        let upward =
            constant / height * cubes[0] + height * (linear * cubes[1] + square * cubes[2]);
        let forward = constant * cubes[1] + linear * cubes[2] + square * cubes[3];
        0.5 * height * (isotropic + upward * up + forward * along)
    }

    /// `∫ G(x − at)·q dS` for a point near the triangle.
    pub(super) fn stokeslets(&self, at: DVec3, tractions: [DVec3; 3]) -> [f64; 3] {
        in_parts(self.corners_from(at), tractions, HALVINGS, &|x, q| {
            Stokeslet.one([0.0; 3], &source(&[x, q]))
        })
    }

    /// `∫ r·q/r³ dS`, r = x − at, for a point near the triangle.
    ///
    /// The value of q at the nearest point is integrated exactly. Only the rest, whose integrand is
    /// one power of r less singular, is integrated in parts. The other layers below use the same
    /// splitting.
    pub(super) fn gradients(&self, at: DVec3, values: [DVec3; 3]) -> [f64; 1] {
        let flat = Flat::new(self.corners_from(at));
        let (base, values) = flat.split(values);
        let exact = base.dot(flat.attraction());
        let rest = in_parts(flat.corners, values, HALVINGS, &|x, q| {
            Gradient.one([0.0; 3], &source(&[x, q]))
        });
        sum([exact], rest)
    }

    /// `∫ r (r·n)(r·u)/r⁵ dS` for a point near the triangle.
    pub(super) fn stresslets(&self, at: DVec3, values: [DVec3; 3]) -> [f64; 3] {
        let flat = Flat::new(self.corners_from(at));
        let (base, values) = flat.split(values);
        let exact = flat.stresslet(base).to_array();
        let rest = in_parts(flat.corners, values, HALVINGS, &|x, u| {
            Stresslet.one([0.0; 6], &source(&[x, flat.normal, u]))
        });
        sum(exact, rest)
    }

    /// `∫ [3 (r·n)(r·u)/r⁵ − n·u/r³] dS` for a point near the triangle.
    pub(super) fn stresslet_pressures(&self, at: DVec3, values: [DVec3; 3]) -> [f64; 1] {
        let flat = Flat::new(self.corners_from(at));
        let (base, values) = flat.split(values);
        let exact = base.dot(flat.normal_derivative());
        let rest = in_parts(flat.corners, values, HALVINGS, &|x, u| {
            StressletPressure.one([0.0; 3], &source(&[x, flat.normal, u]))
        });
        sum([exact], rest)
    }

    /// `∫ r·n/r³ dS`, exactly.
    pub(super) fn solid_angle(&self, at: DVec3) -> f64 {
        Flat::new(self.corners_from(at)).solid_angle()
    }
}

/// An edge relative to the origin.
struct PanelEdge {
    length: f64,
    /// The unit vector along it.
    along: DVec3,
    /// The nearest point of its line, and its distance.
    foot: DVec3,
    height: f64,
    /// For both ends, the length t along the line from the foot, and the distance.
    ends: [(f64, f64); 2],
    /// ∫ dt/r; not finite for the origin on the edge.
    over_r: f64,
}

impl PanelEdge {
    /// `None` for an edge without length.
    fn new(v1: DVec3, v2: DVec3) -> Option<Self> {
        let edge = v2 - v1;
        let (length, doubled_area) = (edge.length(), v1.cross(v2).length());
        if !length.is_normal() {
            return None;
        }
        let along = edge / length;
        let [t1, t2] = [v1.dot(along), v2.dot(along)];
        let [r1, r2] = [v1.length(), v2.length()];
        // ∫ dt/r = ln[(r1 + r2 + L)/(r1 + r2 − L)] = ln[1 + 2L/(r1 + r2 − L)], where
        // (r1 + r2)² − L² = 2 (r1 r2 + v1·v2): the difference is taken without cancellation.
        let inner = v1.dot(v2);
        let spread = if inner >= 0.0 {
            r1 * r2 + inner
        } else {
            doubled_area * doubled_area / (r1 * r2 - inner)
        };
        let around = r1 + r2 + length;
        Some(Self {
            length,
            along,
            foot: v1 - t1 * along,
            height: doubled_area / length,
            ends: [(t1, r1), (t2, r2)],
            over_r: (length * around / spread).ln_1p(),
        })
    }

    /// `∫ r/r³ dt`; 0 for the origin on the line, where its multiples by the distance from the
    /// plane end.
    fn attraction(&self) -> DVec3 {
        let [(t1, r1), (t2, r2)] = self.ends;
        let across = (t2 / r2 - t1 / r1) / (self.height * self.height);
        if !across.is_finite() {
            return DVec3::ZERO;
        }
        across * self.foot + (r1.recip() - r2.recip()) * self.along
    }
}

/// A flat triangle relative to the origin: integrals of constant densities, exact to rounding.
///
/// On the plane `r·n` is constant. Derivatives of 1/r along the plane are integrals along the
/// edges, with their outward normals ν in the plane, and 1/r is harmonic: everything comes down to
/// `∫ dt/r` and `∫ r/r³ dt` along edges and to the solid angle, which is that of A. Van Oosterom and
/// J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
struct Flat {
    corners: [DVec3; 3],
    /// The unit normal, 0 without extent.
    normal: DVec3,
}

impl Flat {
    fn new(corners: [DVec3; 3]) -> Self {
        Self {
            corners,
            normal: doubled_normal(corners).normalize_or_zero(),
        }
    }

    /// The value of a linear field at about the nearest point, and what remains at the corners.
    fn split(&self, values: [DVec3; 3]) -> (DVec3, [DVec3; 3]) {
        let [a, b, c] = self.corners;
        let shares =
            [b.cross(c), c.cross(a), a.cross(b)].map(|area| self.normal.dot(area).max(0.0));
        let all: f64 = shares.iter().sum();
        let shares = if all > 0.0 {
            shares.map(|share| share / all)
        } else {
            [1.0 / 3.0; 3]
        };
        let base = mean(values, shares);
        (base, values.map(|value| value - base))
    }

    /// Edges, and their outward normals.
    fn edges(&self) -> impl Iterator<Item = (PanelEdge, DVec3)> {
        let [a, b, c] = self.corners;
        let edges = [(a, b), (b, c), (c, a)].into_iter();
        edges
            .filter_map(|(from, to)| PanelEdge::new(from, to))
            .map(|edge| {
                let outward = edge.along.cross(self.normal);
                (edge, outward)
            })
    }

    /// `∫ r·n/r³ dS`: positive where the normal points away.
    fn solid_angle(&self) -> f64 {
        let [a, b, c] = self.corners;
        let [x, y, z] = self.corners.map(DVec3::length);
        // a·(b × c), computed from edges, because from far away the three vectors are nearly
        // parallel.
        let doubled = a.dot(doubled_normal(self.corners));
        2.0 * doubled.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    }

    /// `∫ r/r³ dS`.
    fn attraction(&self) -> DVec3 {
        let along: DVec3 = self
            .edges()
            .filter(|(edge, _)| edge.over_r.is_finite())
            .map(|(edge, outward)| edge.over_r * outward)
            .sum();
        self.solid_angle() * self.normal - along
    }

    /// `∫ r (r·n)(r·c)/r⁵ dS`: by `3 r r/r⁵ = ∇∇(1/r) + I/r³`.
    fn stresslet(&self, c: DVec3) -> DVec3 {
        let n = self.normal;
        let mut along = DVec3::ZERO;
        let mut trace = 0.0;
        let mut through = DVec3::ZERO;
        for (edge, outward) in self.edges() {
            let attraction = edge.attraction();
            // ∫ (∇ along the plane) ∂_c(1/r) dS, and the same along n.
            along -= attraction.dot(c) * outward;
            through -= attraction.dot(n) * outward;
            trace -= attraction.dot(outward);
        }
        let second = along + (through.dot(c) - trace * n.dot(c)) * n;
        (self.solid_angle() * c + self.corners[0].dot(n) * second) / 3.0
    }

    /// `∫ ∇∂_n(1/r) dS`.
    fn normal_derivative(&self) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (edge, outward) in self.edges() {
            let attraction = edge.attraction();
            sum += attraction.dot(outward) * self.normal - attraction.dot(self.normal) * outward;
        }
        sum
    }
}

/// A triangle whose longest edge is more than this many times its height is halved along it.
const THIN: f64 = 8.0;

/// The integral of `point(x, weighted field)` over a triangle relative to the origin, by
/// subdivision until the parts are far away relative to their size.
fn in_parts<const N: usize>(
    corners: [DVec3; 3],
    values: [DVec3; 3],
    halvings: u32,
    point: &impl Fn(DVec3, DVec3) -> [f64; N],
) -> [f64; N] {
    let [a, b, c] = corners;
    let centre = (a + b + c) / 3.0;
    // Triangles with infinite corners count as far away, because subdivision does not help.
    let near = centre.length_squared() < REACH * REACH * squared_longest(corners);
    if !near || halvings == 0 {
        return by_seven_points(corners, values, point);
    }
    let middles = |[a, b, c]: [DVec3; 3]| [0.5 * (b + c), 0.5 * (c + a), 0.5 * (a + b)];
    let (at, of) = (middles(corners), middles(values));
    if squared_longest(corners) > THIN * doubled_normal(corners).length() {
        // Division into four would produce parts that are as long and as near as those of halving, but
        // twice as many.
        let lengths = [0, 1, 2].map(|k: usize| edge(corners, k).length_squared());
        let k = if lengths[0] >= lengths[1].max(lengths[2]) {
            0
        } else if lengths[1] >= lengths[2] {
            1
        } else {
            2
        };
        let mut parts = [(corners, values); 2];
        for (part, side) in parts.iter_mut().zip([1, 2]) {
            let place = (k + side) % 3;
            (part.0[place], part.1[place]) = (at[k], of[k]);
        }
        let [first, second] =
            parts.map(|(corners, values)| in_parts(corners, values, halvings - 1, point));
        return sum(first, second);
    }
    let mut total = in_parts(at, of, halvings - 1, point);
    for k in 0..3 {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let corners = [corners[k], at[last], at[next]];
        let values = [values[k], of[last], of[next]];
        total = sum(total, in_parts(corners, values, halvings - 1, point));
    }
    total
}

/// The integral by [`seven_points`].
fn by_seven_points<const N: usize>(
    corners: [DVec3; 3],
    values: [DVec3; 3],
    point: &impl Fn(DVec3, DVec3) -> [f64; N],
) -> [f64; N] {
    let area = 0.5 * doubled_normal(corners).length();
    let mut total = [0.0; N];
    for (shares, weight) in seven_points() {
        let values = area * weight * mean(values, shares);
        total = sum(total, point(mean(corners, shares), values));
    }
    total
}

/// The rule of seven interior points, exact to degree 5 (J. Radon 1948): their shares of the corners, and
/// weights.
pub(super) fn seven_points() -> [([f64; 3], f64); 7] {
    let root = 15.0_f64.sqrt();
    let mut points = [([1.0 / 3.0; 3], 9.0 / 40.0); 7];
    for (k, (shares, weight)) in points[1..].iter_mut().enumerate() {
        let root = if k < 3 { root } else { -root };
        let outer = (6.0 + root) / 21.0;
        *shares = [outer; 3];
        shares[k % 3] = 1.0 - 2.0 * outer;
        *weight = (155.0 + root) / 1200.0;
    }
    points
}

fn sum<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] + b[k])
}

fn doubled_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

fn mean(values: [DVec3; 3], [a, b, c]: [f64; 3]) -> DVec3 {
    a * values[0] + b * values[1] + c * values[2]
}

/// The edge opposite to a corner.
fn edge(corners: [DVec3; 3], k: usize) -> DVec3 {
    corners[(k + 2) % 3] - corners[(k + 1) % 3]
}

fn squared_longest(corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| edge(corners, k).length_squared());
    a.max(b).max(c)
}

#[cfg(test)]
mod tests {
    use super::{HALVINGS, in_parts};
    use glam::DVec3;
    use std::cell::Cell;

    fn evaluations(size: f64) -> usize {
        let count = Cell::new(0);
        let corners = [
            DVec3::new(size, -size, 0.0),
            DVec3::new(-size, size, 0.0),
            DVec3::new(-size, -size, size),
        ];
        in_parts(corners, [DVec3::ONE; 3], HALVINGS, &|_, _| {
            count.set(count.get() + 1);
            [0.0]
        });
        count.get()
    }

    #[test]
    fn needles_do_not_double_with_every_halving() {
        let through = |height: f64| {
            let corners = [
                DVec3::new(-1.0, 0.0, 0.0),
                DVec3::new(1.0, 1e-9, 0.0),
                DVec3::new(0.9, height, 0.0),
            ];
            let (count, area) = (Cell::new(0), Cell::new(0.0));
            in_parts(corners, [DVec3::X; 3], HALVINGS, &|_, weighted| {
                count.set(count.get() + 1);
                area.set(area.get() + weighted.x);
                [0.0]
            });
            (count.get(), area.get())
        };
        let (fat, area) = through(1.0);
        assert!((area / 1.0 - 1.0).abs() < 1e-8, "{area}");
        for height in [1e-3, 1e-6, 1e-9] {
            let (thin, area) = through(height);
            assert!(
                thin < 4 * fat,
                "{height}: {thin} points, {fat} for a fat triangle"
            );
            assert!(
                (area / height - 1.0).abs() < 1e-2 || height < 1e-8,
                "{area}"
            );
        }
    }

    #[test]
    fn triangles_beyond_all_numbers_are_not_taken_apart() {
        assert!(evaluations(1.0) > 7);
        assert_eq!(evaluations(f64::INFINITY), 7);
        assert_eq!(evaluations(f64::NAN), 7);
    }
}
