//! Files of a ZIP archive.
//!
//! Source: PKWARE, .ZIP File Format Specification (APPNOTE), without its 64-bit extension and encryption. The
//! directory at the end of the archive says where each file begins and how it is compressed.

use std::borrow::Cow;
use std::collections::HashMap;

use miniz_oxide::DataFormat;

use super::gzip::{checksum, inflated};
use super::{Budget, ParseError, Position, Problem};

/// The start of every archive that is not empty.
pub(super) const MAGIC: &[u8] = b"PK\x03\x04";

const ENTRY: &[u8] = b"PK\x01\x02";
const END: &[u8] = b"PK\x05\x06";

/// Lengths of the records before their names.
const FILE_HEADER: usize = 30;
const ENTRY_HEADER: usize = 46;
const END_RECORD: usize = 22;

/// An archive.
pub(super) struct Archive<'a> {
    bytes: &'a [u8],
    /// The records of its files in the directory, by names in lower case.
    entries: HashMap<Vec<u8>, &'a [u8]>,
}

/// Little-endian numbers of 2 and 4 bytes.
fn short(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..)?.first_chunk()?;
    Some(usize::from(u16::from_le_bytes(*bytes)))
}

fn long(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*bytes)).ok()
}

impl<'a> Archive<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, ParseError> {
        Self::directory(bytes).ok_or_else(|| {
            let problem = Problem::Expected {
                expected: "the directory of a ZIP archive at its end",
                found: "a truncated or damaged one".to_owned(),
            };
            problem.anywhere()
        })
    }

    fn directory(bytes: &'a [u8]) -> Option<Self> {
        // A comment may follow.
        let least = bytes
            .len()
            .saturating_sub(END_RECORD + usize::from(u16::MAX));
        let windows = bytes[least..].windows(END.len());
        let end = least
            + windows
                .rev()
                .position(|here| here == END)
                .map(|after| bytes.len() - least - END.len() - after)?;
        let end = &bytes[end..];
        let mut rest = bytes.get(long(end, 16)?..)?;
        let mut entries = HashMap::new();
        for _ in 0..short(end, 10)? {
            if !rest.starts_with(ENTRY) {
                return None;
            }
            let name_end = ENTRY_HEADER + short(rest, 28)?;
            let record_end = name_end + short(rest, 30)? + short(rest, 32)?;
            entries.insert(rest.get(ENTRY_HEADER..name_end)?.to_ascii_lowercase(), rest);
            rest = rest.get(record_end..)?;
        }
        Some(Self { bytes, entries })
    }

    /// The content of a file, if there is one of this name.
    pub(super) fn file(
        &self,
        name: &str,
        budget: &Budget,
    ) -> Result<Option<Cow<'a, [u8]>>, ParseError> {
        let Some(entry) = self.entries.get(name.to_ascii_lowercase().as_bytes()) else {
            return Ok(None);
        };
        let at = Position::Byte(long(entry, 42).unwrap_or(0));
        let content = self
            .content(entry, budget)
            .map_err(|problem| problem.at(at, None))?;
        let content = content.filter(|content| Some(checksum(content) as usize) == long(entry, 16));
        let content = content.ok_or_else(|| {
            let problem = Problem::Expected {
                expected: "a file of an archive, stored or deflated",
                found: "a truncated, damaged or encrypted one".to_owned(),
            };
            problem.at(at, None)
        })?;
        Ok(Some(content))
    }

    /// The content of the file of a record, `None` if it is damaged.
    fn content(&self, entry: &[u8], budget: &Budget) -> Result<Option<Cow<'a, [u8]>>, Problem> {
        let find = || {
            let header = self.bytes.get(long(entry, 42)?..)?;
            let start = FILE_HEADER + short(header, 26)? + short(header, 28)?;
            let is_header = header.starts_with(MAGIC);
            let data = header.get(start..start.checked_add(long(entry, 20)?)?)?;
            is_header.then_some((short(entry, 10)?, data))
        };
        match find() {
            Some((0, data)) => Ok(Some(data.into())),
            Some((8, data)) => {
                let mut whole = Vec::new();
                let rest = inflated(data, DataFormat::Raw, budget, &mut whole)?;
                Ok(rest.map(|_| whole.into()))
            }
            _ => Ok(None),
        }
    }
}
