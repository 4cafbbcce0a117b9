//! Images of surfaces in a periodic box.

use crate::real::Real;
use crate::vec3::{Vec3, add, sub};
use alloc::vec::Vec;
use core::ops::RangeInclusive;

/// The images of surfaces in a periodic box: a point at x has images at `x + n L` along each
/// periodic axis, for every integer n.
///
/// Positions may lie anywhere, and a surface may cross the ends of the box: wrapping is not
/// necessary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Images<T> {
    /// L, the length of the box along each axis. An axis is periodic only if its length is positive
    /// and finite; 0 means not periodic.
    pub periods: [T; 3],
    /// Whether a surface acts on its own images.
    pub own: bool,
}

impl<T: Real> Images<T> {
    /// Free space: no axis is periodic.
    pub fn none() -> Self {
        Self {
            periods: [T::zero(); 3],
            own: false,
        }
    }

    /// L along an axis; none if it is not periodic.
    pub fn period(&self, axis: usize) -> Option<T> {
        let period = self.periods[axis];
        (period > T::zero() && period.is_finite()).then_some(period)
    }

    /// Whether any axis is periodic.
    pub fn is_periodic(&self) -> bool {
        (0..3).any(|axis| self.period(axis).is_some())
    }

    /// The first and the last integer n with `low ≤ n L ≤ high` along an axis, `None` if there are
    /// none; only n = 0 for an axis that is not periodic.
    pub fn shifts(&self, axis: usize, low: T, high: T) -> Option<[T; 2]> {
        let zero = T::zero();
        let [first, last] = match self.period(axis) {
            Some(period) => [(low / period).ceil(), (high / period).floor()],
            None if low <= zero && zero <= high => [zero; 2],
            None => return None,
        };
        (first <= last).then_some([first, last])
    }

    /// Adds the images of a box, given by its lower and upper corner, that intersect another box.
    /// If both are the same (`itself`), the box itself is skipped. Instead of very many images it
    /// adds one box that is all of space.
    pub(super) fn add_meeting(
        &self,
        [low, high]: [Vec3<T>; 2],
        other: [Vec3<T>; 2],
        itself: bool,
        images: &mut Vec<[Vec3<T>; 2]>,
    ) {
        let mut first = [T::zero(); 3];
        let mut counts = first;
        for axis in 0..3 {
            let nearest = other[0][axis] - high[axis];
            let farthest = other[1][axis] - low[axis];
            let Some(range) = self.shifts(axis, nearest, farthest) else {
                return;
            };
            first[axis] = range[0];
            counts[axis] = range[1] - range[0] + T::one();
        }
        let [count_x, count_y, count_z] = counts;
        let count = (count_x * count_y * count_z).to_u32();
        let Some(count @ 0..=MANY) = count else {
            images.push([T::neg_infinity(), T::infinity()].map(|bound| [bound; 3]));
            return;
        };
        let [rows, columns] = [count_y, count_z].map(|count| count.to_u32().unwrap_or(1));
        for number in 0..count {
            let place = [
                number / columns / rows,
                number / columns % rows,
                number % columns,
            ];
            let shift = [0, 1, 2].map(|axis| {
                let place = T::from_u32(place[axis]).unwrap_or_else(T::zero);
                first[axis] + place
            });
            if itself && shift == [T::zero(); 3] {
                continue;
            }
            let period = |axis: usize| self.period(axis).unwrap_or_else(T::zero);
            let length = [0, 1, 2].map(|axis| shift[axis] * period(axis));
            images.push([low, high].map(|corner| add(corner, length)));
        }
    }
}

/// Largest number of images of a surface that are examined one by one. Only surfaces many times longer
/// than the box have more.
const MANY: u32 = 64;

/// Periods prepared to find nearby images for many pairs of points.
pub(super) struct NearImages<T> {
    periods: Vec3<T>,
    over_periods: Vec3<T>,
    /// The periods; infinite along axes that are not periodic.
    lengths: Vec3<T>,
}

impl<T: Real> NearImages<T> {
    pub(super) fn new(images: &Images<T>) -> Self {
        let periods = [0, 1, 2].map(|axis| images.period(axis));
        Self {
            periods: periods.map(|period| period.unwrap_or_else(T::zero)),
            over_periods: periods.map(|period| period.map_or(T::zero(), T::recip)),
            lengths: periods.map(|period| period.unwrap_or_else(T::infinity)),
        }
    }

    /// Calls `act` for each image of a point that lies, along each axis, within `reach` of the
    /// position at `offset` from another point. The arguments are the difference of the image from
    /// the other point, and whether the image is not the point itself.
    #[inline(always)]
    pub(super) fn each_within(
        &self,
        apart: Vec3<T>,
        offset: Vec3<T>,
        reach: Vec3<T>,
        mut act: impl FnMut(Vec3<T>, bool),
    ) {
        let from = [0, 1, 2].map(|axis| apart[axis] - offset[axis]);
        if (0..3).all(|axis| from[axis].abs() + reach[axis] < self.lengths[axis]) {
            if (0..3).all(|axis| from[axis].abs() <= reach[axis]) {
                act(apart, false);
            }
            return;
        }
        // Plain values: the number of periods has no derivative, even for dual numbers.
        if (0..3).all(|axis| reach[axis] + reach[axis] < self.lengths[axis]) {
            // At most the nearest image.
            let half = T::constant(0.5);
            let count = [0, 1, 2].map(|axis| {
                let count = (from[axis] * self.over_periods[axis] + half).floor();
                count.to_i64().unwrap_or(0)
            });
            let along = |axis: usize| {
                let count = T::from_i64(count[axis]).unwrap_or_else(T::zero);
                count * self.periods[axis]
            };
            let shift = [along(0), along(1), along(2)];
            if (0..3).all(|axis| (from[axis] - shift[axis]).abs() <= reach[axis]) {
                act(sub(apart, shift), count != [0; 3]);
            }
            return;
        }
        let bounds = |axis: usize| {
            if self.lengths[axis].is_infinite() {
                return if from[axis].abs() <= reach[axis] {
                    0..=0
                } else {
                    // None.
                    RangeInclusive::new(1, 0)
                };
            }
            let bound = |x: T, round: fn(T) -> T| round(x * self.over_periods[axis]).to_i64();
            let low = bound(from[axis] - reach[axis], T::ceil);
            let high = bound(from[axis] + reach[axis], T::floor);
            low.unwrap_or(1)..=high.unwrap_or(0)
        };
        for x in bounds(0) {
            for y in bounds(1) {
                for z in bounds(2) {
                    let count = [x, y, z].map(|count| T::from_i64(count).unwrap_or_else(T::zero));
                    let along = |axis: usize| apart[axis] - count[axis] * self.periods[axis];
                    act([0, 1, 2].map(along), [x, y, z] != [0; 3]);
                }
            }
        }
    }
}
