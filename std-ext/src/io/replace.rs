//! Files that are written as a whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file through `write`. A regular file appears, or replaces the one that was there, only
/// when all of it has been written: until then the old one stays as it is. Anything else (a
/// device, a pipe) is written to directly.
///
/// # Errors
/// Whatever the operating system says of the folder, the file or the disk, or `write` returns.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        let mut out = BufWriter::new(fs::OpenOptions::new().write(true).open(path)?);
        write(&mut out)?;
        return out.flush();
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut unfinished = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // As any new file: what the user's umask leaves of read and write for all.
        use std::os::unix::fs::PermissionsExt;
        unfinished.permissions(fs::Permissions::from_mode(0o666));
    }
    let unfinished = unfinished.prefix(".helfrich-").tempfile_in(folder)?;
    let mut out = BufWriter::new(unfinished);
    write(&mut out)?;
    let unfinished = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    unfinished.as_file().sync_all()?;
    unfinished.persist(path).map_err(|failure| failure.error)?;
    Ok(())
}
