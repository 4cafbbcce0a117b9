//! The potential of a triangle at a point.

use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};

/// A triangle that may be near another surface, its lengths in units of the range.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Face<T> {
    /// Edges from the first corner to the other two.
    edges: [Vec3<T>; 2],
    normal: Vec3<T>,
    over_normal: T,
    /// 1/length² of the sides from each corner to the next.
    over_lengths: Vec3<T>,
    /// Weight that is subtracted for each side, so that it counts once with the triangle beyond: ½, or 0 at a
    /// boundary.
    sides: Vec3<T>,
    /// Weight that is added for each corner: 1 over the number of triangles around, or 0 at a boundary.
    corners: Vec3<T>,
}

/// Potential `(1 − q)³ (1/q − c)` at a point, q its squared distance, in units of `k r_c²/4`, and minus its gradients with respect to the point
/// and the three corners, in units of `k r_c/2`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Felt<T> {
    pub(super) potential: T,
    pub(super) force: Vec3<T>,
    pub(super) corners: [Vec3<T>; 3],
}

impl<T: Real> Felt<T> {
    /// Adds the potential of a point of the triangle, given by its weights of the corners. The
    /// gradient treats the weights as fixed, because the point is the nearest one.
    #[inline(always)]
    fn add(&mut self, attraction: T, count: T, apart: Vec3<T>, squared: T, weights: [T; 3]) {
        let one = T::one();
        if count == T::zero() || squared >= one {
            return;
        }
        let inside = one - squared;
        let over = squared.recip();
        let common = count * (inside * inside * over);
        let drawn = attraction * squared;
        self.potential += common * inside * (one - drawn);
        let three = one + one + one;
        let pressed = one + squared + squared - three * drawn * squared;
        let push = scale(common * pressed * over, apart);
        self.force = add(self.force, push);
        for (corner, weight) in self.corners.iter_mut().zip(weights) {
            *corner = sub(*corner, scale(weight, push));
        }
    }
}

impl<T: Real> Face<T> {
    /// The triangle with these edges from its first corner.
    pub(super) fn new(edges: [Vec3<T>; 2], sides: Vec3<T>, corners: Vec3<T>) -> Self {
        let [b, c] = edges;
        let normal = cross(b, c);
        let over_lengths = [b, sub(c, b), c].map(|side| dot(side, side).reciprocal_or_zero());
        Self {
            edges,
            normal,
            over_normal: dot(normal, normal).reciprocal_or_zero(),
            over_lengths,
            sides,
            corners,
        }
    }

    /// Potential and forces at a point, given by its difference from the first corner; none where
    /// that is beyond the range.
    ///
    /// Near triangles are added, near sides subtracted and near corners added, so that a point of
    /// the surface that is nearest for several of these counts once (Euler's formula).
    #[inline(always)]
    pub(super) fn felt(&self, from_corner: Vec3<T>, attraction: T) -> Option<Felt<T>> {
        let (zero, one) = (T::zero(), T::one());
        let height = dot(from_corner, self.normal);
        // The order of operations avoids overflow for very long ranges.
        let over_height = height * self.over_normal;
        let squared = over_height * height;
        if squared >= one {
            return None;
        }
        let [b, c] = self.edges;
        let places = [from_corner, sub(from_corner, b), sub(from_corner, c)];
        let directions = [b, sub(c, b), [-c[0], -c[1], -c[2]]];
        // The position of the nearest point along each side.
        let along = |side: usize| {
            let along = dot(places[side], directions[side]) * self.over_lengths[side];
            if along > zero && along < one {
                along
            } else if along >= one {
                one
            } else {
                zero
            }
        };
        let along = [along(0), along(1), along(2)];
        let feet = [0, 1, 2].map(|side| sub(places[side], scale(along[side], directions[side])));
        let distances = feet.map(|foot| dot(foot, foot));

        let second = dot(cross(from_corner, c), self.normal) * self.over_normal;
        let third = dot(cross(b, from_corner), self.normal) * self.over_normal;
        let first = one - second - third;
        let above = second > zero && third > zero && first > zero;
        let nearest = (1..3).fold(0, |nearest, side| {
            if distances[side] < distances[nearest] {
                side
            } else {
                nearest
            }
        });
        if !above && distances[nearest] >= one {
            return None;
        }
        let mut felt = Felt {
            potential: zero,
            force: [zero; 3],
            corners: [[zero; 3]; 3],
        };
        if above {
            let foot = scale(over_height, self.normal);
            felt.add(attraction, one, foot, squared, [first, second, third]);
        }
        // If the nearest point of a side is one of its ends, it counts as that corner.
        let mut counts = self.corners;
        for side in 0..3 {
            let own = if !above && side == nearest { one } else { zero };
            let count = own - self.sides[side];
            let (from, to) = (side, (side + 1) % 3);
            if along[side] == zero {
                counts[from] += count;
            } else if along[side] == one {
                counts[to] += count;
            } else {
                let mut weights = [zero; 3];
                weights[from] = one - along[side];
                weights[to] = along[side];
                felt.add(attraction, count, feet[side], distances[side], weights);
            }
        }
        for corner in 0..3 {
            let mut weights = [zero; 3];
            weights[corner] = one;
            let place = places[corner];
            felt.add(
                attraction,
                counts[corner],
                place,
                dot(place, place),
                weights,
            );
        }
        Some(felt)
    }
}
