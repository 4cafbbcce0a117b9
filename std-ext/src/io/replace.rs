//! Files that are written as a whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// How the names of files begin that [`replace_file`] is still writing, or was when it was killed.
pub const UNFINISHED: &str = ".helfrich-";

/// Writes a file through `write`. A regular file appears, or replaces the one that was there, only
/// when all of it has been written: until then the old one stays as it is. The new one has the
/// old one's permissions, and a link keeps pointing to it. Anything else (a device, a pipe) is
/// written to directly.
///
/// # Errors
/// Whatever the operating system says of the folder, the file or the disk, or `write` returns.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    if !is_replaced(path) {
        let mut out = BufWriter::new(fs::OpenOptions::new().write(true).open(path)?);
        write(&mut out)?;
        return out.flush();
    }
    let target = target_of(path);
    let mut out = BufWriter::new(unfinished(&target)?);
    write(&mut out)?;
    let unfinished = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Ok(old) = fs::metadata(&target) {
        unfinished.as_file().set_permissions(old.permissions())?;
    }
    unfinished.as_file().sync_all()?;
    unfinished
        .persist(&target)
        .map_err(|failure| failure.error)?;
    Ok(())
}

/// Whether [`replace_file`] could start to write, before the work for it is done. Nothing is left
/// behind or changed.
///
/// # Errors
/// What [`replace_file`] would return.
pub fn check_replaceable(path: &Path) -> io::Result<()> {
    if is_replaced(path) {
        unfinished(&target_of(path)).map(drop)
    } else if path.is_dir() {
        Err(io::ErrorKind::IsADirectory.into())
    } else {
        // Opening a pipe and leaving again would be seen at its other end.
        Ok(())
    }
}

/// Whether a file is, or will be, a regular one.
fn is_replaced(path: &Path) -> bool {
    fs::metadata(path).map_or(true, |metadata| metadata.is_file())
}

/// Where a link leads; any other path as it is.
fn target_of(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A new file in the folder of `path`, removed unless it is persisted.
fn unfinished(path: &Path) -> io::Result<tempfile::NamedTempFile> {
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
    let file = unfinished.prefix(UNFINISHED).tempfile_in(folder);
    // The name of the unfinished file, which the error tells, means nothing to anybody.
    file.map_err(|error| match error.kind() {
        kind @ io::ErrorKind::NotFound => io::Error::new(kind, "there is no such folder"),
        kind => kind.into(),
    })
}
