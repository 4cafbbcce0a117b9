//! A cell grid for neighbour searches.

use super::images::Images;
use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::Vec3;
use alloc::vec::Vec;
use core::ops::Range;

/// Cells are wider than the range by this fraction, which exceeds the rounding of cell coordinates.
pub(super) const MARGIN: f64 = 1.0 / 64.0;

/// Number of items that are looked at together.
const BLOCK: usize = 32;

/// The numbers of a cell along the three axes in one: cells next to each other along the third axis follow each other.
pub(super) type Cell = u128;

/// Number of bits of the number along an axis, of which the highest is free.
const BITS: u32 = 42;

fn joined([x, y, z]: [i64; 3]) -> Cell {
    let bits = |number: i64| Cell::from(number.unsigned_abs());
    (bits(x) << (2 * BITS)) | (bits(y) << BITS) | bits(z)
}

/// Runs of items in a cell and its neighbours: along the third axis they follow each other, except across the end of a
/// period.
pub(super) type Near = [[u32; 2]; 18];

/// The part of an item of a cell that a search looks at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<T> {
    pub(super) cell: Cell,
    /// The number of this cell among the occupied ones.
    pub(super) occupied: u32,
    pub(super) surface: u32,
    /// The number of the item in its surface.
    pub(super) number: u32,
    /// Whether its surface, by its parts or images, may be near it.
    pub(super) own: bool,
    /// The middle of the item; once it is sorted, within the first period.
    pub(super) middle: Vec3<T>,
    /// The largest distance at which another middle counts, added to the reach of that.
    pub(super) reach: T,
}

/// Items sorted by cell, surface and number.
#[derive(Clone, Debug)]
pub(super) struct Sorted<T> {
    pub(super) places: Vec<Place<T>>,
    /// The occupied cells.
    pub(super) cells: Vec<Cell>,
    /// Items of one surface in one cell: the cell, the surface and the first of them. At the end, the number of items.
    runs: Vec<(Cell, u32, u32)>,
}

impl<T> Default for Sorted<T> {
    fn default() -> Self {
        Self {
            places: Vec::new(),
            cells: Vec::new(),
            runs: Vec::new(),
        }
    }
}

impl<T: Real> Sorted<T> {
    pub(super) fn clear(&mut self) {
        self.places.clear();
        self.cells.clear();
        self.runs.clear();
    }

    /// Sets the cells of places, and sorts these.
    pub(super) fn sort(&mut self, cells: &Cells<T>) {
        for place in &mut self.places {
            place.cell = cells.cell(place.middle);
            place.middle = cells.within_period(place.middle);
        }
        let key = |place: &Place<T>| (place.cell, place.surface, place.number);
        self.places.sort_unstable_by_key(key);
        let mut last = None;
        for (k, place) in self.places.iter_mut().enumerate() {
            let run = (place.cell, place.surface);
            if last.replace(run) != Some(run) {
                self.runs.push((run.0, run.1, k as u32));
            }
            if self.cells.last() != Some(&place.cell) {
                self.cells.push(place.cell);
            }
            place.occupied = self.cells.len() as u32 - 1;
        }
        self.runs
            .push((Cell::MAX, u32::MAX, self.places.len() as u32));
    }
}

/// A regular grid over some points, whose cells are at least `width` wide. Along periodic axes a
/// whole number of cells fills the period, and the last cell is next to the first.
pub(super) struct Cells<T> {
    corner: Vec3<T>,
    /// Cells per length.
    over: Vec3<T>,
    periods: [Option<Period<T>>; 3],
    /// The lengths of the periods; infinite along axes that are not periodic.
    lengths: Vec3<T>,
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
        let last = last.min(T::constant((1_u64 << (BITS - 2)) as f64));
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
            lengths: [0, 1, 2].map(|axis| images.period(axis).unwrap_or_else(T::infinity)),
            last,
        }
    }

    /// The cell of a point.
    fn cell(&self, x: Vec3<T>) -> Cell {
        joined([0, 1, 2].map(|axis| {
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
        }))
    }

    /// A point moved by whole periods into the first one.
    fn within_period(&self, x: Vec3<T>) -> Vec3<T> {
        [0, 1, 2].map(|axis| match self.periods[axis] {
            None => x[axis],
            Some(Period { over, .. }) => {
                let along = (x[axis] - self.corner[axis]) * over;
                x[axis] - along.floor() * self.lengths[axis]
            }
        })
    }

    /// Where the items in a cell and its neighbours are.
    pub(super) fn near(&self, items: &Sorted<T>, cell: Cell) -> Near {
        let [x, y, z] = [2, 1, 0].map(|shift| {
            let number = (cell >> (shift * BITS)) & ((1 << BITS) - 1);
            self.beside(2 - shift as usize, number as i64)
        });
        let mut near = Near::default();
        let mut count = 0;
        for x in x.into_iter().flatten() {
            for y in y.clone().into_iter().flatten() {
                for z in z.iter().filter(|z| !z.is_empty()) {
                    let [start, end] = [z.start, z.end].map(|z| joined([x, y, z]));
                    let begin = items.runs.partition_point(|run| run.0 < start);
                    let many = items.runs[begin..].iter();
                    let many = many.take_while(|run| run.0 < end).count();
                    near[count] = [begin as u32, (begin + many) as u32];
                    count += 1;
                }
            }
        }
        near
    }

    /// Calls `act` with the numbers of items near a place that it may meet. Their order is that of cells, except for
    /// neighbours across the end of a period.
    #[inline(always)]
    pub(super) fn each_near(
        &self,
        items: &Sorted<T>,
        near: &[Near],
        place: &Place<T>,
        mut act: impl FnMut(usize),
    ) {
        for &[begin, end] in &near[place.occupied as usize] {
            for run in begin as usize..end as usize {
                let [(_, surface, first), (_, _, end)] = [items.runs[run], items.runs[run + 1]];
                if place.own || surface != place.surface {
                    let range = first as usize..end as usize;
                    self.each_within_reach(items, place, range, &mut act);
                }
            }
        }
    }

    /// As [`Self::each_near`], of some items.
    #[inline(always)]
    fn each_within_reach(
        &self,
        items: &Sorted<T>,
        place: &Place<T>,
        range: Range<usize>,
        mut act: impl FnMut(usize),
    ) {
        // Without branches: which ones are within reach cannot be predicted.
        for first in range.clone().step_by(BLOCK) {
            let block = first..range.end.min(first + BLOCK);
            let mut met = [0; BLOCK];
            let mut count = 0;
            for (number, other) in block.clone().zip(&items.places[block]) {
                let along = |axis: usize| {
                    let apart = (place.middle[axis] - other.middle[axis]).abs();
                    apart.min(self.lengths[axis] - apart)
                };
                let [x, y, z] = [along(0), along(1), along(2)];
                let reach = place.reach + other.reach;
                met[count % BLOCK] = number;
                count += usize::from(x * x + y * y + z * z <= reach * reach);
            }
            met[..count].iter().for_each(|&number| act(number));
        }
    }

    /// Ranges of cells along an axis: the cell of this number and its neighbours, each once.
    fn beside(&self, axis: usize, cell: i64) -> [Range<i64>; 2] {
        let none = 0..0;
        match self.periods[axis] {
            None => [(cell - 1).max(0)..cell + 2, none],
            Some(Period { count: 1, .. }) => [0..1, none],
            Some(Period { count, .. }) if cell == 0 => [0..2, count - 1..count],
            Some(Period { count, .. }) if cell == count - 1 => [0..1, count - 2..count],
            Some(_) => [cell - 1..cell + 2, none],
        }
    }
}
