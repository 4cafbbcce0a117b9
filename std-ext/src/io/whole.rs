//! Files that are read whole, as far as there is room for them.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// What is read at most, in bytes, of what is no regular file: pipes and devices do not say how long
/// they are, and some have no end.
const LONGEST_STREAM: u64 = 1 << 30;

/// The share of the free memory that a file may take: what is made of it needs room, too.
const SHARE: u64 = 2;

/// What spreadsheets and some editors put before the first line of a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// All bytes of a file of this length at most; of any length that there is memory for if `None`.
///
/// # Errors
/// What the operating system says, or that the file is too large, with the limit.
pub(crate) fn read_whole(path: &Path, longest: Option<u64>) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    let room = free_memory().map_or(u64::MAX, |free| free / SHARE);
    let (limit, why) = match longest {
        Some(longest) => (longest, "the most that makes sense"),
        None if metadata.is_file() => (room, "half of the memory that is free"),
        None => (
            room.min(LONGEST_STREAM),
            "the most that is read of a pipe or a device: save it as a file",
        ),
    };
    let too_large = |what: String| {
        let message = format!("{what}, more than {limit} bytes, {why}");
        io::Error::new(io::ErrorKind::FileTooLarge, message)
    };
    if metadata.is_file() && metadata.len() > limit {
        return Err(too_large(format!("it has {} bytes", metadata.len())));
    }
    let mut bytes = Vec::new();
    if metadata.is_file() {
        let length = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
        bytes.try_reserve_exact(length)?;
    }
    let read = file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if read as u64 > limit {
        return Err(too_large("it goes on and on".to_owned()));
    }
    Ok(bytes)
}

/// A text without the mark that some editors put before it.
pub(crate) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// Memory that is free, in bytes, where the system says so.
pub(crate) fn free_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024 * kilobytes)
}
