//! Arrays of numbers in VTK files: as text, in base64, or appended at the end of the file; raw or
//! compressed.
//!
//! Source: *VTK file formats* (docs.vtk.org, XML formats). Compressed data begin with the number of blocks,
//! the length of a block, the length of the last block if it is shorter (else 0), and the compressed length
//! of each block.

use super::super::number::Number;
use super::super::xml::{Tag, line_of};
use super::super::{Budget, ParseError, Position, Problem};
use super::compressor::Compressor;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;

/// Storage of the numbers of a file.
#[derive(Debug)]
pub(super) struct Storage<'a> {
    pub(super) file: &'a [u8],
    pub(super) big_endian: bool,
    /// Bytes of a stored length: 4 or 8.
    pub(super) header: usize,
    pub(super) compressor: Option<Compressor>,
    pub(super) budget: Budget,
    /// The data after the `_` at the end of the file, and whether they are in base64.
    pub(super) appended: Option<(&'a [u8], bool)>,
}

/// An array as described by its tag.
#[derive(Clone, Debug)]
pub(super) struct Array<'a> {
    /// The position of its tag.
    at: usize,
    number: Number,
    format: Format<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Format<'a> {
    /// Text from this byte on.
    Text(&'a [u8], usize),
    Base64(&'a [u8]),
    /// Appended data from this byte on.
    Appended(usize),
}

/// Numbers that were read.
#[derive(Clone, Debug)]
pub(super) struct Numbers<T> {
    pub(super) values: Vec<T>,
    at: usize,
    /// The position of the text.
    text: Option<usize>,
}

impl<T> Numbers<T> {
    /// The position of a number.
    pub(super) fn position(&self, file: &[u8], index: usize) -> Position {
        let place = self.text.and_then(|start| {
            let (place, _) = words(&file[start..]).nth(index)?;
            Some(start + place)
        });
        line_of(file, place.unwrap_or(self.at))
    }

    /// The position of the array.
    pub(super) fn first_position(&self, file: &[u8]) -> Position {
        line_of(file, self.at)
    }
}

/// Words of a text up to the next tag, with their positions.
fn words(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let end = text.iter().position(|&byte| byte == b'<');
    let text = &text[..end.unwrap_or(text.len())];
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at
            + text[at..]
                .iter()
                .position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &text[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace);
        at = start + length.unwrap_or(rest.len());
        Some((start, &text[start..at]))
    })
}

impl<'a> Array<'a> {
    /// The array of a `DataArray` tag.
    pub(super) fn new(file: &'a [u8], tag: &Tag<'a>) -> Result<Self, ParseError> {
        let wrong = |expected, attribute: &str| {
            let found = tag.attribute(attribute).unwrap_or("none");
            let found = format!("`{}`", found.escape_debug());
            Problem::Expected { expected, found }.at(line_of(file, tag.start), None)
        };
        let number = tag.attribute("type").and_then(named);
        let number = number.ok_or_else(|| wrong("a type of numbers such as Float64", "type"))?;
        let content = &file[tag.end..];
        let end = content.iter().position(|&byte| byte == b'<');
        let content = &content[..end.unwrap_or(content.len())];
        let format = match tag.attribute("format") {
            Some("ascii") => Format::Text(content, tag.end),
            Some("binary") => Format::Base64(content),
            Some("appended") => {
                let offset = tag.attribute("offset").and_then(|text| text.parse().ok());
                Format::Appended(offset.ok_or_else(|| wrong("an offset", "offset"))?)
            }
            _ => return Err(wrong("the format ascii, binary or appended", "format")),
        };
        Ok(Self {
            at: tag.start,
            number,
            format,
        })
    }

    /// The numbers as coordinates.
    pub(super) fn floats(&self, storage: &Storage<'_>) -> Result<Numbers<f64>, ParseError> {
        let (number, big_endian) = (self.number, storage.big_endian);
        self.numbers(storage, "a number", |stored| {
            number.float(stored, big_endian)
        })
    }

    /// The numbers as indices, which have to be whole.
    pub(super) fn indices(&self, storage: &Storage<'_>) -> Result<Numbers<i64>, ParseError> {
        if let Number::Float(_) = self.number {
            let problem = Problem::Expected {
                expected: "a type of whole numbers such as Int64",
                found: "one of fractions".to_owned(),
            };
            return Err(problem.at(line_of(storage.file, self.at), None));
        }
        let (number, big_endian) = (self.number, storage.big_endian);
        self.numbers(storage, "a whole number", |stored| {
            number.integer(stored, big_endian)
        })
    }

    fn numbers<T: std::str::FromStr>(
        &self,
        storage: &Storage<'_>,
        expected: &'static str,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Numbers<T>, ParseError> {
        let text = match self.format {
            Format::Text(_, start) => Some(start),
            _ => None,
        };
        let mut numbers = Numbers {
            values: Vec::new(),
            at: self.at,
            text,
        };
        let size = self.number.size();
        let payload = match self.format {
            Format::Text(content, start) => {
                for (place, word) in words(content) {
                    let value = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
                    numbers.values.push(value.ok_or_else(|| {
                        let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
                        let found = format!("`{}`", shown.escape_debug());
                        let place = line_of(storage.file, start + place);
                        Problem::Expected { expected, found }.at(place, None)
                    })?);
                }
                return Ok(numbers);
            }
            Format::Base64(content) => storage.encoded_payload(content, size, self.at),
            Format::Appended(offset) => {
                let rest = storage
                    .appended
                    .and_then(|(bytes, base64)| Some((bytes.get(offset..)?, base64)));
                match rest {
                    Some((bytes, true)) => storage.encoded_payload(bytes, size, self.at),
                    Some((bytes, false)) => storage.payload(bytes, size, self.at),
                    None => Err(Problem::Expected {
                        expected: "appended data",
                        found: "the end of the file".to_owned(),
                    }
                    .at(line_of(storage.file, self.at), None)),
                }
            }
        }?;
        let stored = payload.chunks_exact(size);
        numbers.values.extend(stored.map(read));
        Ok(numbers)
    }
}

impl Storage<'_> {
    /// Bytes of the numbers, of `size` bytes each, after the header at the start of `bytes`; decompressed if
    /// necessary. The array begins at byte `at` of the file.
    fn payload<'b>(
        &self,
        bytes: &'b [u8],
        size: usize,
        at: usize,
    ) -> Result<Cow<'b, [u8]>, ParseError> {
        let truncated = || {
            let problem = Problem::Expected {
                expected: "data as long as their header says",
                found: "less, or what is no base64".to_owned(),
            };
            problem.at(line_of(self.file, at), None)
        };
        let afford = |bytes: usize| {
            let taken = self.budget.take(bytes.div_ceil(size));
            taken.map_err(|problem| problem.at(line_of(self.file, at), None))
        };
        let mut rest = bytes;
        let Some(compressor) = self.compressor else {
            let length = self.length(&mut rest).ok_or_else(truncated)?;
            let payload = rest.get(..length).ok_or_else(truncated)?;
            afford(length)?;
            return Ok(payload.into());
        };
        let next = |rest: &mut &[u8]| self.length(rest).ok_or_else(truncated);
        let [blocks, longest, last] = [next(&mut rest)?, next(&mut rest)?, next(&mut rest)?];
        if blocks > rest.len() / self.header {
            return Err(truncated());
        }
        let (lengths, mut rest) = rest.split_at(blocks * self.header);
        let mut payload = Vec::new();
        for (block, mut length) in lengths.chunks_exact(self.header).enumerate() {
            let length = next(&mut length)?;
            let (compressed, after) = rest.split_at_checked(length).ok_or_else(truncated)?;
            rest = after;
            let whole_length = if block + 1 == blocks && last > 0 {
                last
            } else {
                longest
            };
            afford(whole_length)?;
            match compressor.unpacked(compressed, whole_length) {
                Some(whole) if whole.len() == whole_length => payload.extend(whole),
                _ => {
                    let problem = Problem::Expected {
                        expected: "compressed blocks, as long as their header says",
                        found: "damaged ones".to_owned(),
                    };
                    return Err(problem.at(line_of(self.file, at), None));
                }
            }
        }
        Ok(payload.into())
    }

    /// The same from base64. Only the text of this array is decoded, because others may follow.
    fn encoded_payload(
        &self,
        text: &[u8],
        size: usize,
        at: usize,
    ) -> Result<Cow<'static, [u8]>, ParseError> {
        let mut bytes = decoded(text, self.stored_length(&[]));
        while self.stored_length(&bytes) > bytes.len() {
            let longer = decoded(text, self.stored_length(&bytes));
            if longer.len() <= bytes.len() {
                break;
            }
            bytes = longer;
        }
        Ok(self.payload(&bytes, size, at)?.into_owned().into())
    }

    /// Length of an array with its header, as far as `bytes`, which begin it, tell.
    fn stored_length(&self, bytes: &[u8]) -> usize {
        let mut rest = bytes;
        if self.compressor.is_none() {
            let length = self.length(&mut rest).unwrap_or_default();
            return self.header.saturating_add(length);
        }
        let blocks = self.length(&mut rest).unwrap_or_default();
        let header = blocks.saturating_add(3).saturating_mul(self.header);
        let lengths = bytes.get(3 * self.header..header).unwrap_or_default();
        let lengths = lengths.chunks_exact(self.header);
        let lengths = lengths.filter_map(|mut length| self.length(&mut length));
        lengths.fold(header, usize::saturating_add)
    }

    /// Reads the next length in a header.
    fn length(&self, rest: &mut &[u8]) -> Option<usize> {
        let (stored, after) = rest.split_at_checked(self.header)?;
        *rest = after;
        let mut bytes = [0; 8];
        bytes[..self.header].copy_from_slice(stored);
        if self.big_endian {
            bytes[..self.header].reverse();
        }
        usize::try_from(u64::from_le_bytes(bytes)).ok()
    }
}

/// Decodes at least `least` bytes of base64 as VTK writes it, if there are so many: headers and data may be
/// encoded separately, each with its own padding. Decoding stops at the first invalid character.
fn decoded(text: &[u8], least: usize) -> Vec<u8> {
    let is_of_text = |byte: &&u8| **byte != b'<';
    let letters = text.iter().take_while(is_of_text);
    let letters = letters.filter(|byte| !byte.is_ascii_whitespace());
    // Three bytes for four letters, and up to two for each padding.
    let enough = (least / 3).saturating_add(PADDINGS).saturating_mul(4);
    let text = Vec::from_iter(letters.take(enough).copied());
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let mut rest = &text[..];
    while !rest.is_empty() {
        let padding = rest.iter().position(|&byte| byte == b'=');
        let length = padding.map_or(rest.len(), |at| (at / 4 + 1) * 4);
        let Some((part, after)) = rest.split_at_checked(length) else {
            return bytes;
        };
        match STANDARD.decode(part) {
            Ok(decoded) => bytes.extend(decoded),
            Err(_) => return bytes,
        }
        rest = after;
    }
    bytes
}

/// The largest number of groups of four letters that padding makes shorter: at the end of the header and of the
/// data, and of one that is begun.
const PADDINGS: usize = 3;

/// The type of numbers with a name of VTK.
fn named(name: &str) -> Option<Number> {
    Some(match name {
        "Float32" => Number::Float(4),
        "Float64" => Number::Float(8),
        "Int8" => Number::Signed(1),
        "Int16" => Number::Signed(2),
        "Int32" => Number::Signed(4),
        "Int64" => Number::Signed(8),
        "UInt8" => Number::Unsigned(1),
        "UInt16" => Number::Unsigned(2),
        "UInt32" => Number::Unsigned(4),
        "UInt64" => Number::Unsigned(8),
        _ => return None,
    })
}
