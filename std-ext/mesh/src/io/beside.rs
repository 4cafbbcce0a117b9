//! Files beside a mesh file, which names them.

use super::{Reading, read_whole};

/// Why the file of a name is not read.
pub(super) enum NotBeside {
    /// The name leads elsewhere, or is none.
    Elsewhere,
    /// The mesh file is read from memory, so that nothing is beside it.
    InMemory,
    /// The file cannot be read, with the reason.
    Unreadable(String),
}

/// The bytes of a file in the folder of the mesh file, or in a folder in there: parts are separated by `/`.
pub(super) fn beside(name: &str, reading: Reading<'_>) -> Result<Vec<u8>, NotBeside> {
    let is_inside = |part: &str| {
        !part.is_empty() && !part.starts_with('.') && !part.contains(['\\', ':', '\0'])
    };
    if !name.split('/').all(is_inside) {
        return Err(NotBeside::Elsewhere);
    }
    let folder = reading.folder.ok_or(NotBeside::InMemory)?;
    read_whole(&folder.join(name), None).map_err(|error| NotBeside::Unreadable(error.to_string()))
}

/// A name of a file as it is shown in messages.
pub(super) fn shown(name: &str) -> String {
    let start = String::from_iter(name.chars().take(60));
    format!("`{}`", start.escape_debug())
}
