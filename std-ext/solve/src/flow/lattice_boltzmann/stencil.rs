//! The nineteen velocities of D3Q19, and the layout of populations.

use crate::flow::lattice_boltzmann::LatticeError;
use std::array;
use std::ops::Range;

/// Number of velocities.
pub(super) const Q: usize = 19;

/// The velocities c: rest, then nine pairs of opposite ones, so that pairs are neighbours.
pub(super) const VELOCITIES: [[i8; 3]; Q] = [
    [0, 0, 0],
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
    [1, 1, 0],
    [-1, -1, 0],
    [1, -1, 0],
    [-1, 1, 0],
    [1, 0, 1],
    [-1, 0, -1],
    [1, 0, -1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, -1],
    [0, 1, -1],
    [0, -1, 1],
];

/// The weight w of a velocity.
pub(super) fn weight(direction: usize) -> f64 {
    match direction {
        0 => 1.0 / 3.0,
        1..7 => 1.0 / 18.0,
        _ => 1.0 / 36.0,
    }
}

/// The velocity in the other direction.
pub(super) fn opposite(direction: usize) -> usize {
    match direction {
        0 => 0,
        _ => ((direction - 1) ^ 1) + 1,
    }
}

/// A scalar product with a velocity.
pub(super) fn along(direction: usize, vector: [f64; 3]) -> f64 {
    let c = VELOCITIES[direction].map(f64::from);
    c[0] * vector[0] + c[1] * vector[1] + c[2] * vector[2]
}

/// `index + step` modulo `count`; `step` is −1, 0 or 1. Computed without division, because rows
/// call it often.
pub(super) fn wrapped(index: usize, step: i8, count: usize) -> usize {
    match step {
        1 if index + 1 == count => 0,
        1 => index + 1,
        -1 if index == 0 => count - 1,
        -1 => index - 1,
        _ => index,
    }
}

/// The layout of populations: planes of constant z, in each plane one sheet for each direction, in
/// each sheet rows along x.
///
/// A row has one slot more than nodes, on the side to which its direction points. During an odd
/// step, populations that cross the end of the row are copied there, so that all nodes of a row are
/// contiguous.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) cells: [usize; 3],
    /// Slots in a row.
    pub(super) pitch: usize,
    /// Slots in a sheet. This is an odd number of cache lines, because sheets that are read
    /// together would otherwise evict each other from the cache when sizes are powers of two.
    pub(super) sheet: usize,
}

impl Layout {
    const CACHE_LINE: usize = 64;

    pub(super) fn new<T>(cells: [usize; 3]) -> Result<Self, LatticeError> {
        if let Some(axis) = cells.iter().position(|&count| count == 0) {
            return Err(LatticeError::NoCells { axis });
        }
        let too_large = || LatticeError::TooLarge { cells };
        let pitch = cells[0].checked_add(1).ok_or_else(too_large)?;
        let line = Self::CACHE_LINE / size_of::<T>();
        let lines = pitch.checked_mul(cells[1]).ok_or_else(too_large)?;
        let lines = lines.div_ceil(line) | 1;
        let sheet = lines.checked_mul(line).ok_or_else(too_large)?;
        let layout = Self {
            cells,
            pitch,
            sheet,
        };
        // If this does not overflow, neither does any other product in this module.
        (sheet.checked_mul(Q))
            .and_then(|plane| plane.checked_mul(cells[2]))
            .and_then(|slots| slots.checked_mul(size_of::<T>()))
            .filter(|&bytes| isize::try_from(bytes).is_ok())
            .ok_or_else(too_large)?;
        Ok(layout)
    }

    pub(super) fn slots(&self) -> usize {
        self.sheet * Q * self.cells[2]
    }

    pub(super) fn nodes(&self) -> usize {
        self.cells.iter().product()
    }

    /// The number of a node among all, x running fastest.
    pub(super) fn node(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.cells[0] * (y + self.cells[1] * z)
    }

    /// The node with this number.
    pub(super) fn cell(&self, node: usize) -> [usize; 3] {
        let [x, y, _] = self.cells;
        [node % x, node / x % y, node / (x * y)]
    }

    /// The position of node 0 in its row: the additional slot is on the other side.
    pub(super) fn lead(direction: usize) -> usize {
        usize::from(VELOCITIES[direction][0] < 0)
    }

    /// The slot of a direction at a node.
    pub(super) fn slot(&self, direction: usize, [x, y, z]: [usize; 3]) -> usize {
        (z * Q + direction) * self.sheet + y * self.pitch + x + Self::lead(direction)
    }

    /// The stored direction and the offset in nodes at which a node finds the population of a
    /// direction and stores the result for the opposite one. Before even steps these are the same
    /// direction and the node itself; before odd steps, the opposite direction and the node from
    /// which the population came.
    pub(super) fn source(odd: bool, direction: usize) -> (usize, [i8; 3]) {
        if odd {
            let back = opposite(direction);
            (back, VELOCITIES[back])
        } else {
            (direction, [0; 3])
        }
    }

    /// The slot of [`Self::source`].
    pub(super) fn place(&self, odd: bool, direction: usize, cell: [usize; 3]) -> usize {
        let (stored, step) = Self::source(odd, direction);
        self.slot(stored, self.moved(cell, step))
    }

    /// The slots of [`Self::source`] for a node and its successors along x: up to the end of the
    /// row, and after the wrap of x.
    pub(super) fn row(&self, odd: bool, direction: usize, cell: [usize; 3]) -> [Range<usize>; 2] {
        let (stored, step) = Self::source(odd, direction);
        let [x, y, z] = self.moved(cell, step);
        let start = self.slot(stored, [0, y, z]);
        [start + x..start + self.cells[0], start..start + x]
    }

    /// The neighbour of a node in a direction, on the torus.
    pub(super) fn neighbour(&self, cell: [usize; 3], direction: usize) -> [usize; 3] {
        self.moved(cell, VELOCITIES[direction])
    }

    fn moved(&self, cell: [usize; 3], step: [i8; 3]) -> [usize; 3] {
        array::from_fn(|axis| wrapped(cell[axis], step[axis], self.cells[axis]))
    }
}
