//! Files that are in a folder before a run begins or continues there.

use super::{CHECKPOINT, RunError, SERIES, SUMMARY};
use crate::io::remove_unfinished;
use crate::lock::{LOCK, Lock};
use crate::series::SeriesTable;
use std::path::Path;

/// The subfolders of a run.
const FOLDERS: [&str; 5] = ["surfaces", "pictures", "slices", "volumes", "plots"];

/// Locks the folder of a run, if it exists: no other process writes there from now on.
pub(super) fn lock_if_there(folder: &Path) -> Result<Option<Lock>, RunError> {
    if !folder.is_dir() {
        return Ok(None);
    }
    Ok(Some(Lock::of_folder(folder)?))
}

/// Creates and locks the folder of a new run.
pub(super) fn make(folder: &Path, lock: Option<Lock>) -> Result<Lock, RunError> {
    let lock = match lock {
        Some(lock) => lock,
        None => {
            super::make_folder(folder)?;
            let lock = Lock::of_folder(folder)?;
            // The check is repeated under the lock, because another process may have run and ended
            // in between.
            refuse_occupied(folder)?;
            lock
        }
    };
    Ok(lock)
}

/// Refuses a folder that holds a run.
pub(super) fn refuse_occupied(folder: &Path) -> Result<(), RunError> {
    let taken = [CHECKPOINT, SERIES].iter();
    if taken.clone().any(|name| folder.join(name).exists()) {
        let folder = folder.to_owned();
        return Err(RunError::Occupied { folder });
    }
    Ok(())
}

/// Whether a run to be resumed has a checkpoint. A run that was stopped before its first checkpoint
/// starts again, and nothing is lost.
pub(super) fn has_checkpoint(folder: &Path, lock: Option<&Lock>) -> Result<bool, RunError> {
    if folder.join(CHECKPOINT).exists() {
        return Ok(true);
    }
    let none = || RunError::NoRun {
        folder: folder.to_owned(),
    };
    let lock = lock.ok_or_else(none)?;
    let series = folder.join(SERIES);
    if folder.join(SUMMARY).exists() || series.exists() {
        // Runs store their state before the first row.
        let rows = SeriesTable::read(&series).map_or(None, |table| Some(table.rows.len()));
        if folder.join(SUMMARY).exists() || rows.is_none_or(|rows| rows > 1) {
            let folder = folder.to_owned();
            return Err(RunError::NoCheckpoint { folder });
        }
        return Ok(false);
    }
    if lock.was_found() || is_empty(folder) {
        return Ok(false);
    }
    Err(none())
}

/// Whether the folder has nothing but our new lock and unfinished files.
fn is_empty(folder: &Path) -> bool {
    remove_unfinished(folder);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.file_name())
        .all(|name| name == LOCK)
}

/// Removes the files that a run was writing when it was killed.
pub(super) fn tidy(folder: &Path) {
    remove_unfinished(folder);
    for name in FOLDERS {
        remove_unfinished(&folder.join(name));
    }
}
