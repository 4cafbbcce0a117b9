//! A cell grid for neighbour searches.

use super::images::Images;
use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::Vec3;
use core::ops::Range;

/// Cells are wider than the range by this fraction, which exceeds the rounding of cell coordinates.
pub(super) const MARGIN: f64 = 1.0 / 64.0;

/// The numbers of a cell along the three axes.
pub(super) type Cell = [i64; 3];

/// An item of a cell.
pub(super) trait InCell {
    fn cell(&self) -> Cell;
}

/// A regular grid over some points, whose cells are at least `width` wide. Along periodic axes a
/// whole number of cells fills the period, and the last cell is next to the first.
pub(super) struct Cells<T> {
    corner: Vec3<T>,
    /// Cells per length.
    over: Vec3<T>,
    periods: [Option<Period<T>>; 3],
    /// The last cell along axes that are not periodic.
    last: T,
}

#[derive(Clone, Copy)]
struct Period<T> {
    over: T,
    count: i64,
}

impl<T: Real> Cells<T> {
    /// `low` and `high` are the corners of a box around the points.
    pub(super) fn new(images: &Images<T>, width: T, [low, high]: [Vec3<T>; 2]) -> Self {
        // Beyond this number of cells, the rounding of cell coordinates exceeds the margin; all
        // farther points share the last cell.
        let last = (T::epsilon() * T::constant(256.0)).recip();
        let periods = [0, 1, 2].map(|axis| {
            let period = images.period(axis)?;
            // Far from the origin, positions within a period are rounded more coarsely.
            let extent = ((high[axis] - low[axis]) / period).max(T::one());
            let count = (period / width).min(last / (extent + extent)).floor();
            let count = count.to_i64().unwrap_or(0);
            Some(Period {
                over: period.recip(),
                // With fewer than three cells, all are neighbours.
                count: if count < 3 { 1 } else { count },
            })
        });
        Self {
            corner: low,
            over: [width.reciprocal_or_zero(); 3],
            periods,
            last,
        }
    }

    /// The cell of a point.
    pub(super) fn cell(&self, x: Vec3<T>) -> Cell {
        [0, 1, 2].map(|axis| {
            let along = x[axis] - self.corner[axis];
            match self.periods[axis] {
                None => (along * self.over[axis]).floor().min(self.last).to_i64(),
                Some(Period { over, count }) => {
                    let place = along * over;
                    let place = place - place.floor();
                    let cell = T::from_i64(count).map(|count| (place * count).floor());
                    // Rounding up to the next period would give the first cell.
                    cell.and_then(|cell| cell.to_i64()).map(|cell| cell % count)
                }
            }
            .unwrap_or(0)
        })
    }

    /// Calls `act` with the entries in a cell and its neighbours, of entries sorted by cell. Their
    /// order is kept, except for neighbours across the end of a period.
    #[inline(always)]
    pub(super) fn each_near<'a, E: InCell>(
        &self,
        entries: &'a [E],
        [x, y, z]: Cell,
        mut act: impl FnMut(&'a E),
    ) {
        let [x, y, z] = [self.beside(0, x), self.beside(1, y), self.beside(2, z)];
        for x in x.into_iter().flatten() {
            for y in y.clone().into_iter().flatten() {
                for run in z.iter().filter(|run| !run.is_empty()) {
                    let begin = entries.partition_point(|entry| entry.cell() < [x, y, run.start]);
                    let within = |entry: &&E| entry.cell() < [x, y, run.end];
                    entries[begin..]
                        .iter()
                        .take_while(within)
                        .for_each(&mut act);
                }
            }
        }
    }

    /// Ranges of cells along an axis: the cell of this number and its neighbours, each once.
    fn beside(&self, axis: usize, cell: i64) -> [Range<i64>; 2] {
        let none = 0..0;
        match self.periods[axis] {
            None => [cell - 1..cell + 2, none],
            Some(Period { count: 1, .. }) => [0..1, none],
            Some(Period { count, .. }) if cell == 0 => [0..2, count - 1..count],
            Some(Period { count, .. }) if cell == count - 1 => [0..1, count - 2..count],
            Some(_) => [cell - 1..cell + 2, none],
        }
    }
}
