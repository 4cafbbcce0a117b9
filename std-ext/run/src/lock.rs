//! Locks on folders and files, which let only one process write.
//!
//! A [`Lock`] is a small file that a process keeps locked while it writes. The operating system
//! releases the lock when the process ends, even if it is killed. The file may remain, but nobody is
//! locked out by it. Links are not followed, and no file is changed that does not begin as a lock does.

use crate::io::LOCK_NAME;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// The name of a folder's lock. That of a file's lock is the same with the name of the file behind it.
pub const LOCK: &str = LOCK_NAME;

/// The name of a folder's lock in earlier versions.
const FORMER: &str = "lock";

/// The words with which a lock begins.
const SIGNATURE: &str = "process ";

/// Maximal length of the description of a process, in bytes.
const LONGEST: u64 = 200;

/// A folder or file to which only this process writes, as long as this value exists.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
    /// Whether the file was there before, left by a process that was killed.
    found: bool,
    warning: Option<String>,
}

/// The reason why a lock cannot be acquired. The message is one line that starts with the name of
/// the folder or file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LockError {
    /// Another process writes there.
    #[error(
        "{}: {holder} is writing here: wait until it has ended, or choose another place",
        place.display()
    )]
    Taken {
        /// The folder or file.
        place: PathBuf,
        /// The process and its machine.
        holder: String,
    },
    /// Something else has the lock's name: a link, a folder, or a file that is no lock. It is not changed.
    #[error(
        "{}: is no lock of this program, and was not changed: give it another name, or choose another place",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The lock cannot be opened or written.
    #[error("{}: {source}", path.display())]
    Inaccessible {
        /// The lock's file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
}

impl Lock {
    /// Locks an existing folder.
    ///
    /// # Errors
    /// If another process writes there, or no file can be made there; see [`LockError`].
    pub fn of_folder(folder: &Path) -> Result<Self, LockError> {
        Self::at(folder.join(LOCK), folder)
    }

    /// Locks a file that is replaced as a whole, through a file beside it.
    ///
    /// # Errors
    /// If another process writes there, or no file can be made there; see [`LockError`].
    pub fn of_file(file: &Path) -> Result<Self, LockError> {
        let name = file.file_name().unwrap_or_default();
        let mut own = OsString::from(format!("{LOCK}-"));
        own.push(name);
        Self::at(file.with_file_name(own), file)
    }

    /// Removes the lock of a folder that a killed process of an earlier version has left, and returns whether
    /// there was one. Files of that name that are no locks are not changed.
    ///
    /// # Errors
    /// If a process of an earlier version writes there; see [`LockError`].
    pub fn remove_former(folder: &Path) -> Result<bool, LockError> {
        let path = folder.join(FORMER);
        // What cannot be opened is not the program's.
        let Ok(Some(mut file)) = existing(&path) else {
            return Ok(false);
        };
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(LockError::Taken {
                place: folder.to_owned(),
                holder: holder(&mut file),
            });
        }
        Ok(fs::remove_file(&path).is_ok())
    }

    /// Whether the lock's file was there before: a process that wrote here was killed.
    pub fn was_found(&self) -> bool {
        self.found
    }

    /// A warning that the file system has no locks, so that other processes are not kept out.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    fn at(path: PathBuf, place: &Path) -> Result<Self, LockError> {
        let inaccessible = |source| LockError::Inaccessible {
            path: path.clone(),
            source,
        };
        loop {
            // A new file is made in no place but this: links are not followed.
            let mut options = OpenOptions::new();
            options.read(true).write(true).create_new(true);
            let (mut file, found) = match options.open(&path) {
                Ok(file) => (file, false),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    match existing(&path).map_err(inaccessible)? {
                        Some(file) => (file, true),
                        // It was removed in between, or is not a lock.
                        None if fs::symlink_metadata(&path).is_err() => continue,
                        None => return Err(LockError::Foreign { path: path.clone() }),
                    }
                }
                Err(error) => return Err(inaccessible(error)),
            };
            let warning = match file.try_lock() {
                Ok(()) => None,
                Err(TryLockError::WouldBlock) => {
                    return Err(LockError::Taken {
                        place: place.to_owned(),
                        holder: holder(&mut file),
                    });
                }
                Err(TryLockError::Error(error)) => Some(format!(
                    "{}: this file system has no locks ({error}): nothing keeps another process from \
                     writing here as well",
                    place.display()
                )),
            };
            // The previous owner of the lock may have removed its file.
            if !same_file(&path, &file) {
                continue;
            }
            let sign = || -> io::Result<()> {
                file.set_len(0)?;
                (&file).rewind()?;
                (&file).write_all(this_process().as_bytes())
            };
            sign().map_err(inaccessible)?;
            return Ok(Self {
                path,
                file,
                found,
                warning,
            });
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // The file is removed while the lock is held, so that no other process can believe that it
        // owns the lock. A file that remains is harmless.
        if same_file(&self.path, &self.file) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The lock that another process has left under this name; `None` if there is none, or another kind of file.
fn existing(path: &Path) -> io::Result<Option<File>> {
    loop {
        match fs::symlink_metadata(path) {
            Ok(metadata) if metadata.is_file() && metadata.len() <= LONGEST => {}
            _ => return Ok(None),
        }
        let mut file = match OpenOptions::new().read(true).write(true).open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            opened => opened?,
        };
        let mut text = Vec::new();
        (&mut file).take(LONGEST).read_to_end(&mut text)?;
        // A process that has just made its lock has not written into it.
        let is_lock = text.is_empty() || text.starts_with(SIGNATURE.as_bytes());
        if same_file(path, &file) {
            return Ok(is_lock.then_some(file));
        }
    }
}

/// Whether an open file is still the one of that name.
#[cfg(unix)]
fn same_file(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let here = fs::symlink_metadata(path).map(|it| (it.dev(), it.ino()));
    let open = file.metadata().map(|it| (it.dev(), it.ino()));
    matches!((here, open), (Ok(here), Ok(open)) if here == open)
}

#[cfg(not(unix))]
fn same_file(path: &Path, _file: &File) -> bool {
    fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_file())
}

/// The signature in a lock.
fn holder(file: &mut File) -> String {
    let mut text = String::new();
    let read = file
        .rewind()
        .and_then(|()| file.take(LONGEST).read_to_string(&mut text));
    match (read, text.trim()) {
        (Ok(_), text) if !text.is_empty() => text.to_owned(),
        _ => "another process".to_owned(),
    }
}

/// A description of this process.
fn this_process() -> String {
    let process = std::process::id();
    // The name of the machine is included, because folders may be shared between machines.
    match fs::read_to_string("/proc/sys/kernel/hostname") {
        Ok(host) => format!("{SIGNATURE}{process} on {}", host.trim()),
        Err(_) => format!("{SIGNATURE}{process}"),
    }
}
