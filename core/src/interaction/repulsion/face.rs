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
    /// The length of the longest side.
    longest: T,
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
    /// Minus the gradient with respect to the unit normal of the point, if its surface is that of the triangle.
    pub(super) turn: Vec3<T>,
}

/// A rule for the part of a surface that is felt: all of another surface, or the parts of the same one that face a vertex.
pub(super) trait Sight<T>: Copy {
    /// Whether forces are not along the difference from the nearest point.
    const IS_TILTED: bool;

    /// The potential with its force and its turn as far as they are felt, at a point `apart` from a surface.
    fn felt(self, potential: T, force: Vec3<T>, apart: Vec3<T>, over: T) -> (T, [Vec3<T>; 2]);

    /// Whether nothing is felt of a triangle with these corners, given as differences from them, and longest side.
    fn misses(self, places: &[Vec3<T>; 3], longest: T) -> bool;
}

/// All of another surface.
#[derive(Clone, Copy)]
pub(super) struct Everywhere;

impl<T: Real> Sight<T> for Everywhere {
    const IS_TILTED: bool = false;

    #[inline(always)]
    fn felt(self, potential: T, force: Vec3<T>, _: Vec3<T>, _: T) -> (T, [Vec3<T>; 2]) {
        (potential, [force, [T::zero(); 3]])
    }

    #[inline(always)]
    fn misses(self, _: &[Vec3<T>; 3], _: T) -> bool {
        false
    }
}

/// Parts of the same surface in the direction of this unit normal, forward and back.
///
/// With c the cosine of the angle between the normal and the direction to the nearest point, and t = 2c² − ½ within 0 and 1,
/// the potential is multiplied by `t² (3 − 2t)`: 0 beyond 60°, 1 within 30°.
#[derive(Clone, Copy)]
pub(super) struct Facing<T>(pub(super) Vec3<T>);

impl<T: Real> Sight<T> for Facing<T> {
    const IS_TILTED: bool = true;

    #[inline(always)]
    fn felt(self, potential: T, force: Vec3<T>, apart: Vec3<T>, over: T) -> (T, [Vec3<T>; 2]) {
        let (zero, one) = (T::zero(), T::one());
        let along = dot(self.0, apart);
        let cosine = along * over * along;
        let t = cosine + cosine - T::constant(0.5);
        if t <= zero {
            return (zero, [[zero; 3]; 2]);
        }
        if t >= one {
            return (potential, [force, [zero; 3]]);
        }
        let share = t * t * (T::constant(3.0) - t - t);
        // Half of the derivative with respect to c², times 2 (n·p)/p², of which the derivatives of c² are multiples.
        let slope = T::constant(12.0) * potential * t * (one - t) * along * over;
        let turn = scale(-slope, apart);
        let tilt = sub(scale(along * over, apart), self.0);
        (
            share * potential,
            [add(scale(share, force), scale(slope, tilt)), turn],
        )
    }

    #[inline(always)]
    fn misses(self, places: &[Vec3<T>; 3], longest: T) -> bool {
        let most = |values: [T; 3]| values.into_iter().fold(T::zero(), T::max);
        let height = most(places.map(|place| dot(self.0, place).abs()));
        let distance = most(places.map(|place| dot(place, place))).sqrt();
        // The nearest point is at most a side nearer than the farthest corner.
        height + height + longest <= distance
    }
}

/// A point of a triangle: the nearest one of its inside, of a side, or a corner.
struct NearestPoint<T, S> {
    /// The point from which it is seen, as the difference from this one, and the square of its length.
    apart: Vec3<T>,
    squared: T,
    /// Its weights of the corners.
    weights: [T; 3],
    /// The gradients of these with respect to the point from which it is seen.
    slopes: S,
}

impl<T: Real> Felt<T> {
    /// Adds the potential of a point of a triangle with these edges from its first corner.
    ///
    /// The gradient of a potential that depends on the distance alone treats the weights as fixed, because the point is the
    /// nearest one. With a force F that is not along the difference p, the weights w_k change, too: the point feels the part
    /// F' of F at right angles to the triangle or side, and corner k feels −w_k F' − (F·∇w_k) p.
    #[inline(always)]
    fn add<S: Sight<T>>(
        &mut self,
        (attraction, sight): (T, S),
        [b, c]: &[Vec3<T>; 2],
        count: T,
        nearest: NearestPoint<T, impl FnOnce() -> [Vec3<T>; 3]>,
    ) {
        let NearestPoint {
            apart,
            squared,
            weights,
            slopes,
        } = nearest;
        let one = T::one();
        if count == T::zero() || squared >= one {
            return;
        }
        let inside = one - squared;
        let over = squared.recip();
        let common = count * (inside * inside * over);
        let drawn = attraction * squared;
        let potential = common * inside * (one - drawn);
        let three = one + one + one;
        let pressed = one + squared + squared - three * drawn * squared;
        let push = scale(common * pressed * over, apart);
        let (potential, [mut push, turn]) = sight.felt(potential, push, apart, over);
        self.potential += potential;
        if S::IS_TILTED {
            let along = slopes().map(|slope| dot(push, slope));
            push = sub(push, add(scale(along[1], *b), scale(along[2], *c)));
            for (corner, along) in self.corners.iter_mut().zip(along) {
                *corner = sub(*corner, scale(along, apart));
            }
            self.turn = add(self.turn, turn);
        }
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
        let squares = [b, sub(c, b), c].map(|side| dot(side, side));
        Self {
            edges,
            normal,
            over_normal: dot(normal, normal).reciprocal_or_zero(),
            over_lengths: squares.map(T::reciprocal_or_zero),
            longest: squares.into_iter().fold(T::zero(), T::max).sqrt(),
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
    pub(super) fn felt(
        &self,
        from_corner: Vec3<T>,
        attraction: T,
        sight: impl Sight<T>,
    ) -> Option<Felt<T>> {
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
        if sight.misses(&places, self.longest) {
            return None;
        }
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
            turn: [zero; 3],
        };
        let law = (attraction, sight);
        if above {
            let foot = NearestPoint {
                apart: scale(over_height, self.normal),
                squared,
                weights: [first, second, third],
                slopes: || {
                    let [second, third] = [cross(c, self.normal), cross(self.normal, b)]
                        .map(|slope| scale(self.over_normal, slope));
                    [scale(-one, add(second, third)), second, third]
                },
            };
            felt.add(law, &self.edges, one, foot);
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
                let foot = NearestPoint {
                    apart: feet[side],
                    squared: distances[side],
                    weights,
                    slopes: || {
                        let slope = scale(self.over_lengths[side], directions[side]);
                        let mut slopes = [[zero; 3]; 3];
                        slopes[from] = scale(-one, slope);
                        slopes[to] = slope;
                        slopes
                    },
                };
                felt.add(law, &self.edges, count, foot);
            }
        }
        for corner in 0..3 {
            let mut weights = [zero; 3];
            weights[corner] = one;
            let apart = places[corner];
            let corner_itself = NearestPoint {
                apart,
                squared: dot(apart, apart),
                weights,
                slopes: || [[zero; 3]; 3],
            };
            felt.add(law, &self.edges, counts[corner], corner_itself);
        }
        Some(felt)
    }
}
