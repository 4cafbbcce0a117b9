//! Division of polygons into triangles.
//!
//! A convex polygon becomes the fan of triangles around its first corner. Any other polygon is divided by
//! cutting off ears, the best-shaped one first: G. H. Meisters, Amer. Math. Monthly 82 (1975) 648. Directions
//! of turns are those seen along the normal of M. E. Newell, whose length is twice the area of a plane
//! polygon, concave or not: I. E. Sutherland, R. F. Sproull and R. A. Schumacker, ACM Comput. Surv. 6 (1974) 1.

use glam::DVec3;

/// The largest number of corners of a polygon that is not convex. The time of its division grows with the
/// square of this number.
pub const MOST_CORNERS: usize = 10_000;

/// The reason why a polygon is not divided: it is not convex, and has more than [`MOST_CORNERS`] corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a polygon of {corners} corners that is not convex: at most {MOST_CORNERS} can be divided into triangles"
)]
pub struct TooManyCorners {
    /// The number of corners.
    pub corners: usize,
}

/// The triangles of a polygon, as numbers of its corners in the order in which they run around it: two fewer
/// than there are corners, none for fewer than three.
///
/// The area of a plane polygon does not depend on its first corner, and corners on a straight line do not
/// make triangles without area where another division exists. A polygon that is not plane is divided as if
/// seen along its normal. One that crosses itself is divided in some way.
///
/// # Errors
/// If the polygon is not convex, and has more than [`MOST_CORNERS`] corners.
pub fn triangulate(corners: &[[f64; 3]]) -> Result<Vec<[u32; 3]>, TooManyCorners> {
    let fan = || (2..corners.len() as u32).map(|last| [0, last - 1, last]);
    let Some(polygon) = Polygon::new(corners).filter(|polygon| !polygon.is_convex()) else {
        return Ok(fan().collect());
    };
    if corners.len() > MOST_CORNERS {
        return Err(TooManyCorners {
            corners: corners.len(),
        });
    }
    Ok(polygon.cut())
}

/// A polygon in units of its size, and the direction from which it is seen.
struct Polygon {
    corners: Vec<DVec3>,
    normal: DVec3,
}

/// The largest rounding error of a turn, in units of the squared size of the polygon: an error of each
/// coordinate, product and sum.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl Polygon {
    /// `None` for a triangle, for a polygon without a normal, and beyond the range of numbers.
    fn new(corners: &[[f64; 3]]) -> Option<Self> {
        let [first, _, _, _, ..] = *corners else {
            return None;
        };
        let from_first = |&corner: &[f64; 3]| DVec3::from(corner) - DVec3::from(first);
        let size = corners
            .iter()
            .map(|corner| from_first(corner).abs().max_element())
            .fold(0.0, f64::max);
        let corners = Vec::from_iter(corners.iter().map(|corner| from_first(corner) / size));
        let normal: DVec3 = corners.windows(2).map(|pair| pair[0].cross(pair[1])).sum();
        let normal = normal.try_normalize()?;
        Some(Self { corners, normal })
    }

    /// Twice the area of a triangle of three corners as seen; 0 within rounding of a straight line.
    fn turn(&self, [a, b, c]: [usize; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|corner| self.corners[corner]);
        let turn = (b - a).cross(c - a).dot(self.normal);
        if turn.abs() > ROUNDING { turn } else { 0.0 }
    }

    /// Whether all corners turn left, and once around.
    fn is_convex(&self) -> bool {
        let count = self.corners.len();
        let fan = (2..count).map(|last| [0, last - 1, last]);
        let turns = (0..count).map(|at| [at, (at + 1) % count, (at + 2) % count]);
        fan.chain(turns).all(|corners| self.turn(corners) > 0.0)
    }

    /// Triangles cut off one after the other.
    fn cut(&self) -> Vec<[u32; 3]> {
        let count = self.corners.len();
        // The polygon that is left, as a ring.
        let mut before = Vec::from_iter((0..count).map(|at| (at + count - 1) % count));
        let mut after = Vec::from_iter((0..count).map(|at| (at + 1) % count));
        let mut left = Vec::from_iter(0..count);
        let of = |at: usize, before: &[usize], after: &[usize]| [before[at], at, after[at]];
        let is_left_turn = |corners: [usize; 3]| self.turn(corners) > 0.0;
        // Only corners that do not turn left can be in the way of an ear.
        let mut inward = left.clone();
        inward.retain(|&at| !is_left_turn(of(at, &before, &after)));
        let rate = |at: usize, inward: &[usize], before: &[usize], after: &[usize]| {
            let corners = of(at, before, after);
            self.is_free(corners, inward).then(|| self.quality(corners))
        };
        let mut rated = Vec::from_iter(left.iter().map(|&at| rate(at, &inward, &before, &after)));
        let mut triangles = Vec::with_capacity(count - 2);
        while left.len() > 3 {
            // Where nothing is free, as in a polygon that crosses itself, the best corner is cut off.
            let value = |at: usize| {
                let quality = || self.quality(of(at, &before, &after));
                rated[at].map_or_else(|| (false, quality()), |quality| (true, quality))
            };
            let best = (0..left.len()).max_by(|&one, &other| {
                let [one, other] = [one, other].map(|place| value(left[place]));
                one.0.cmp(&other.0).then(one.1.total_cmp(&other.1))
            });
            let Some(place) = best else { break };
            let ear = left.remove(place);
            let [last, _, next] = of(ear, &before, &after);
            triangles.push([last, ear, next].map(|corner| corner as u32));
            (after[last], before[next]) = (next, last);
            inward.retain(|&at| {
                at != ear && (![last, next].contains(&at) || !is_left_turn(of(at, &before, &after)))
            });
            for at in [last, next] {
                rated[at] = rate(at, &inward, &before, &after);
            }
        }
        triangles.push([0, 1, 2].map(|place| left[place] as u32));
        triangles
    }

    /// Whether a corner turns left, and no other corner lies in the triangle or on the line that cuts it off.
    /// Corners at the place of one of the three are not in the way: they join a hole to the outline.
    fn is_free(&self, [a, b, c]: [usize; 3], inward: &[usize]) -> bool {
        self.turn([a, b, c]) > 0.0
            && !inward.iter().any(|&p| {
                ![a, b, c].contains(&p)
                    && self.turn([a, b, p]) > 0.0
                    && self.turn([b, c, p]) > 0.0
                    && self.turn([c, a, p]) >= 0.0
            })
    }

    /// Area of a triangle over the sum of its squared edges: largest if it is equilateral, 0 on a line.
    fn quality(&self, corners: [usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| self.corners[corner]);
        let edges = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
        if edges > 0.0 {
            self.turn(corners) / edges
        } else {
            0.0
        }
    }
}
