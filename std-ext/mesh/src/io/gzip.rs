//! Files that are compressed by gzip.
//!
//! Source: RFC 1952 (GZIP file format). A file has one or more members, each with a header, data compressed by
//! deflate, and the checksum and length of the data.

use std::borrow::Cow;

use miniz_oxide::inflate::stream::{InflateState, inflate};
use miniz_oxide::{DataFormat, MZError, MZFlush, MZStatus};

use super::{Budget, ParseError, Position, Problem};

/// The first bytes of a member: two that identify gzip, and its only method of compression.
const MAGIC: &[u8] = &[0x1f, 0x8b, 8];

/// The content of a file, unpacked if it is compressed by gzip. Zeros after the last member are padding.
pub(super) fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, ParseError> {
    if !bytes.starts_with(MAGIC) {
        return Ok(bytes.into());
    }
    let budget = Budget::new(bytes.len(), true);
    let mut whole = Vec::new();
    let mut rest = bytes;
    while rest.starts_with(MAGIC) {
        let at = Position::Byte(bytes.len() - rest.len());
        let damaged = |expected| move || wrong(expected, at);
        let body = after_header(rest).ok_or_else(damaged("the header of a gzip member"))?;
        let before = whole.len();
        let after = inflated(body, DataFormat::Raw, &budget, &mut whole)
            .map_err(|problem| problem.at(at, None))?
            .ok_or_else(damaged("data compressed by gzip"))?;
        let (end, after) = after
            .split_first_chunk::<8>()
            .ok_or_else(damaged("the checksum of a gzip member"))?;
        let [a, b, c, d, ..] = *end;
        if u32::from_le_bytes([a, b, c, d]) != checksum(&whole[before..]) {
            return Err(damaged("data with the checksum of the gzip member")());
        }
        rest = after;
    }
    if rest.iter().any(|&byte| byte != 0) {
        let at = Position::Byte(bytes.len() - rest.len());
        return Err(wrong("the end of the file or another gzip member", at));
    }
    Ok(whole.into())
}

fn wrong(expected: &'static str, at: Position) -> ParseError {
    let found = "damaged or truncated data".to_owned();
    Problem::Expected { expected, found }.at(at, None)
}

/// The bytes after the header of a member.
fn after_header(member: &[u8]) -> Option<&[u8]> {
    const CHECKSUM: u8 = 2;
    const EXTRA: u8 = 4;
    const TEXTS: [u8; 2] = [8, 16];
    let flags = *member.get(3)?;
    let mut rest = member.get(10..)?;
    if flags & EXTRA != 0 {
        let (length, after) = rest.split_first_chunk::<2>()?;
        rest = after.get(usize::from(u16::from_le_bytes(*length))..)?;
    }
    // The name of the file, and a comment, each up to a zero.
    for flag in TEXTS {
        if flags & flag != 0 {
            let length = rest.iter().position(|&byte| byte == 0)?;
            rest = &rest[length + 1..];
        }
    }
    if flags & CHECKSUM != 0 {
        rest = rest.get(2..)?;
    }
    Some(rest)
}

/// Unpacks deflated data to the end of `whole`, and returns what follows them; `None` if they are damaged. The budget
/// bounds the memory.
pub(super) fn inflated<'a>(
    mut data: &'a [u8],
    format: DataFormat,
    budget: &Budget,
    whole: &mut Vec<u8>,
) -> Result<Option<&'a [u8]>, Problem> {
    const BLOCK: usize = 1 << 15;
    let mut state = InflateState::new_boxed(format);
    let mut block = vec![0; BLOCK];
    loop {
        let step = inflate(&mut state, data, &mut block, MZFlush::None);
        data = &data[step.bytes_consumed..];
        budget.take(step.bytes_written.div_ceil(size_of::<f64>()))?;
        whole.extend_from_slice(&block[..step.bytes_written]);
        match step.status {
            Ok(MZStatus::StreamEnd) => return Ok(Some(data)),
            Ok(_) if step.bytes_consumed + step.bytes_written > 0 => {}
            Err(MZError::Buf) if step.bytes_written > 0 => {}
            _ => return Ok(None),
        }
    }
}

/// The checksum CRC-32 of gzip and ZIP files.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut byte = 0;
        while byte < 256 {
            let mut value = byte as u32;
            let mut bit = 0;
            while bit < 8 {
                value = (value >> 1) ^ if value & 1 == 1 { 0xedb8_8320 } else { 0 };
                bit += 1;
            }
            table[byte] = value;
            byte += 1;
        }
        table
    };
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        TABLE[((sum ^ u32::from(byte)) & 0xff) as usize] ^ (sum >> 8)
    })
}
