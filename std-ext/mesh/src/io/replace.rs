//! Files that are written completely or not at all.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The prefix of the names of files that [`replace_file`] has not finished.
pub const UNFINISHED: &str = ".helfrich-";

/// The name of locks, or its beginning, which is not that of an unfinished file.
pub const LOCK_NAME: &str = ".helfrich-lock";

/// Writes a file through `write`. A regular file appears, or replaces an old one, only when it is
/// complete; until then the old file is unchanged. The new file has the permissions of the old one, and
/// a link keeps pointing to it. Other files (devices, pipes) are written directly.
///
/// # Errors
/// Any error of `write`, or of the operating system for the folder, the file or the disk.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    if !is_replaced(path) {
        let mut out = BufWriter::new(OpenOptions::new().write(true).open(path)?);
        write(&mut out)?;
        return out.flush();
    }
    let target = target_of(path);
    let mut out = BufWriter::new(unfinished(&target)?);
    write(&mut out)?;
    let unfinished = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Ok(old) = fs::metadata(&target) {
        unfinished.file.set_permissions(old.permissions())?;
    }
    unfinished.file.sync_all()?;
    // The file has its final name from here on, so that there is nothing to remove.
    fs::rename(&unfinished.path, &target)
}

/// Removes files that killed processes were writing in a folder with [`replace_file`].
/// Files that another process still writes are kept, and so are files that cannot be removed; they do
/// no harm.
pub fn remove_unfinished(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_unfinished = name.starts_with(UNFINISHED) && !name.starts_with(LOCK_NAME);
        // Links are not followed, and pipes not opened.
        if is_unfinished && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            // A process that is still writing holds a lock, which ends with the process.
            let file = File::open(entry.path());
            if let Ok(file) = file
                && file.try_lock().is_ok()
            {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}

/// Checks that [`replace_file`] could write, so that an error comes before the work and not after it. The
/// file is not changed; unfinished files of killed processes are removed from its folder.
///
/// # Errors
/// The error that [`replace_file`] would return.
pub fn check_replaceable(path: &Path) -> io::Result<()> {
    if is_replaced(path) {
        let target = target_of(path);
        remove_unfinished(folder_of(&target));
        unfinished(&target).map(drop)
    } else if path.is_dir() {
        Err(io::ErrorKind::IsADirectory.into())
    } else {
        // Pipes are not opened for the check, because their reader would see it.
        Ok(())
    }
}

/// Whether two paths name one file, which need not exist: by symbolic links, by hard links, or by folders.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    let whole = |path: &Path| {
        fs::canonicalize(path).ok().or_else(|| {
            let folder = fs::canonicalize(folder_of(path)).ok()?;
            Some(folder.join(path.file_name()?))
        })
    };
    matches!((whole(one), whole(other)), (Some(one), Some(other)) if one == other)
        || has_links(one, other)
}

/// Whether two paths are hard links to one file.
#[cfg(unix)]
fn has_links(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |path: &Path| fs::metadata(path).map(|it| (it.dev(), it.ino()));
    matches!((place(one), place(other)), (Ok(one), Ok(other)) if one == other)
}

#[cfg(not(unix))]
fn has_links(_: &Path, _: &Path) -> bool {
    false
}

/// Whether a file is, or will be, a regular one.
fn is_replaced(path: &Path) -> bool {
    fs::metadata(path).map_or(true, |metadata| metadata.is_file())
}

/// The target of a link; any other path unchanged.
fn target_of(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A file that is being written; it is removed on drop unless it was renamed.
struct Unfinished {
    path: PathBuf,
    file: File,
}

impl Write for Unfinished {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        // Errors are ignored: the file is gone if it was renamed; otherwise the next process
        // removes it.
        let _ = fs::remove_file(&self.path);
    }
}

/// A new file in the folder of `path`.
fn unfinished(path: &Path) -> io::Result<Unfinished> {
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let folder = folder_of(path);
    loop {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("{UNFINISHED}{}-{number}", process::id()));
        let file = match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => file,
            // The name belongs to a file of a killed process with the same number, or of a process on another
            // machine.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(io::Error::new(error.kind(), "there is no such folder"));
            }
            Err(error) => return Err(error.kind().into()),
        };
        let unfinished = Unfinished { path, file };
        // Another process that cleans up the folder may have removed the file before it was locked.
        match unfinished.file.try_lock() {
            Err(TryLockError::WouldBlock) => {}
            // On a platform without locks, no process removes unfinished files.
            Err(TryLockError::Error(_)) => return Ok(unfinished),
            Ok(()) if unfinished.path.exists() => return Ok(unfinished),
            Ok(()) => {}
        }
    }
}

/// The folder that a path is in.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
