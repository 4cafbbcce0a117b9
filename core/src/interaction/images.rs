//! Images of surfaces in a box that repeats itself.

use crate::real::Real;
use crate::vec3::{Vec3, add};
use alloc::vec::Vec;
use core::ops::RangeInclusive;

/// The images of surfaces in a periodic box: what is at x is at `x + n L` too, along each periodic
/// axis and for every whole n.
///
/// Positions may lie anywhere, and a surface may reach through the ends of the box: nothing has to be
/// wrapped back into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Images<T> {
    /// L, the length of the box along each axis; an axis is not periodic where it is 0, or in general
    /// where it is not positive and finite.
    pub periods: [T; 3],
    /// Whether a surface acts on the images of itself.
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

    /// Whether some axis is periodic.
    pub fn is_periodic(&self) -> bool {
        (0..3).any(|axis| self.period(axis).is_some())
    }

    /// The first and the last whole n with `low ≤ n L ≤ high` along an axis, none if there is none;
    /// only n = 0 where the axis is not periodic.
    pub fn shifts(&self, axis: usize, low: T, high: T) -> Option<[T; 2]> {
        let zero = T::zero();
        let [first, last] = match self.period(axis) {
            Some(period) => [(low / period).ceil(), (high / period).floor()],
            None if low <= zero && zero <= high => [zero; 2],
            None => return None,
        };
        (first <= last).then_some([first, last])
    }

    /// Adds the images of a box, given by its lower and upper corner, that meet another; of `itself`
    /// if it is the same, images other than the box as it is. In place of very many it adds all space.
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

/// So many images of a surface are looked at one by one. More are those of surfaces that are longer
/// than the box many times.
const MANY: u32 = 64;

/// The images of a point within reach of something, ready to be found for many pairs.
pub(super) struct NearImages<T> {
    periods: Vec3<T>,
    over_periods: Vec3<T>,
    /// The same periods; infinite along axes that are not periodic.
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

    /// Calls `act` with the difference of a point from another for each image of it that is no farther
    /// than `reach` along each axis from a place at `offset` from the other, and with whether that
    /// is another image than the point itself.
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
        // Numbers and no more: of dual ones they have no derivatives.
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
