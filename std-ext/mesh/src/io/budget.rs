//! Limit on the memory that the numbers of a file take when they are decoded.
//!
//! Most files state every number once, in at least one byte. Pieces of VTP files can share an array, and
//! compressed data may be a thousand times as long when they are unpacked. Every reader of such data takes the
//! numbers from a budget before it decodes them.

use super::Problem;
use std::cell::Cell;

/// Bytes of a decoded number.
const NUMBER: u64 = 8;

/// Bytes that numbers may take whatever the length of the file: columns of zeros compress well.
const LEAST: u64 = 1 << 26;

/// Bytes that numbers may take for each byte of a file whose data are not compressed: twice as many as if each
/// byte were a number.
const OF_PLAIN: u64 = 2 * NUMBER;

/// The same for compressed data. Coordinates become shorter by a factor of 1 to 3, regular connectivity by 50.
const OF_COMPRESSED: u64 = 32 * NUMBER;

/// The memory that is left for the numbers of a file.
#[derive(Debug)]
pub(super) struct Budget {
    length: usize,
    limit: u64,
    left: Cell<u64>,
}

impl Budget {
    /// The budget of a file of this length in bytes.
    pub(super) fn new(length: usize, is_compressed: bool) -> Self {
        let of_byte = if is_compressed {
            OF_COMPRESSED
        } else {
            OF_PLAIN
        };
        let limit = LEAST.saturating_add(of_byte.saturating_mul(length as u64));
        Self {
            length,
            limit,
            left: Cell::new(limit),
        }
    }

    /// Takes the memory of numbers that are about to be decoded.
    pub(super) fn take(&self, numbers: usize) -> Result<(), Problem> {
        let needed = NUMBER.saturating_mul(numbers as u64);
        let left = self.left.get().checked_sub(needed);
        self.left.set(left.ok_or(Problem::TooLarge {
            length: self.length,
            limit: self.limit,
        })?);
        Ok(())
    }
}
