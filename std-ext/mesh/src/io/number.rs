//! Types of numbers in binary data.

/// A type of numbers, with its size in bytes: 4 or 8 for fractions, 1, 2, 4 or 8 for whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Float(usize),
    Signed(usize),
    Unsigned(usize),
}

impl Number {
    /// Size in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Float(size) | Self::Signed(size) | Self::Unsigned(size) => size,
        }
    }

    /// The number that begins these bytes, of which there have to be enough.
    pub(super) fn float(self, stored: &[u8], big_endian: bool) -> f64 {
        let bytes = self.bytes(stored, big_endian);
        match self {
            Self::Float(4) => {
                let [a, b, c, d, ..] = bytes;
                f32::from_le_bytes([a, b, c, d]).into()
            }
            Self::Float(_) => f64::from_le_bytes(bytes),
            _ => self.integer(stored, big_endian) as f64,
        }
    }

    /// The whole number that begins these bytes; numbers beyond `i64` become negative, and are refused as indices.
    pub(super) fn integer(self, stored: &[u8], big_endian: bool) -> i64 {
        let bytes = self.bytes(stored, big_endian);
        let shift = 64 - 8 * self.size() as u32;
        match self {
            Self::Signed(_) => i64::from_le_bytes(bytes) << shift >> shift,
            _ => i64::from_le_bytes(bytes),
        }
    }

    /// The bytes of the number in little-endian order, padded with zeros.
    fn bytes(self, stored: &[u8], big_endian: bool) -> [u8; 8] {
        let size = self.size();
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(&stored[..size]);
        if big_endian {
            bytes[..size].reverse();
        }
        bytes
    }
}
