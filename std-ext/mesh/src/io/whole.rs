//! Files that are read completely, within the limits of memory.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest number of bytes read from a pipe or device, because these do not state their length and may be
/// endless.
const LONGEST_STREAM: u64 = 1 << 30;

/// Divisor of the free memory that a file may take, because the mesh needs memory, too.
const SHARE: u64 = 2;

/// The mark that spreadsheets and some editors write before the first line of a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a file of at most this length; `None` allows any length that fits into memory.
///
/// # Errors
/// Any error of the operating system, or a file that exceeds the limit, which the message names.
pub fn read_whole(path: &Path, longest: Option<u64>) -> io::Result<Vec<u8>> {
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

/// A text without its byte order mark.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// Free memory in bytes, if the system reports it.
pub fn free_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024 * kilobytes)
}
