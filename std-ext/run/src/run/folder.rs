//! Files that are in a folder before a run begins or continues there.

use super::census::Census;
use super::files::Shown;
use super::identity::input_files;
use super::modes::MODES;
use super::rheology::{PROFILES, RHEOLOGY};
use super::{CHECKPOINT, RunError, SERIES, SUMMARY};
use crate::io::{is_same_file, remove_unfinished};
use crate::lock::{LOCK, Lock};
use crate::scene::{Pictures, Scene};
use crate::series::SeriesTable;
use crate::simulation::Simulation;
use std::fs;
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

/// Refuses a folder in which a new run would replace files that are not of a run.
pub(super) fn refuse_foreign(
    scene: &Scene,
    simulation: &Simulation,
    folder: &Path,
) -> Result<(), RunError> {
    let output = &scene.output;
    let used = [
        output.surfaces,
        output.pictures != Pictures::Never,
        !output.slices.is_empty(),
        !output.volumes.is_empty(),
        !output.plots.is_empty(),
    ];
    let folders = FOLDERS.iter().zip(used).filter(|&(_, used)| used);
    let folders = folders.map(|(name, _)| folder.join(name));
    let filled = folders.filter(|path| fs::read_dir(path).is_ok_and(|mut it| it.next().is_some()));
    let names = files(scene, simulation)
        .into_iter()
        .map(|name| folder.join(name));
    match names.filter(|path| is_there(path)).chain(filled).next() {
        Some(path) => Err(RunError::Foreign { path }),
        None => Ok(()),
    }
}

/// Refuses a folder in which the run would replace a file that its scene reads.
pub(super) fn refuse_inputs(
    scene: &Scene,
    simulation: &Simulation,
    folder: &Path,
) -> Result<(), RunError> {
    let inputs = input_files(scene);
    let names = files(scene, simulation).into_iter();
    for path in names
        .chain([SERIES, CHECKPOINT].map(str::to_owned))
        .map(|name| folder.join(name))
    {
        if let Some(input) = inputs.iter().find(|input| is_same_file(input, &path)) {
            let input = input.clone();
            return Err(RunError::Input { path, input });
        }
    }
    Ok(())
}

/// The names of the files that a run replaces, other than its series and its checkpoint.
fn files(scene: &Scene, simulation: &Simulation) -> Vec<String> {
    let fixed = [
        SUMMARY,
        MODES,
        RHEOLOGY,
        PROFILES,
        "surfaces.pvd",
        "slices.pvd",
        "volumes.pvd",
    ];
    let shown = Shown::all(scene, simulation);
    let last = shown.iter().map(|one| one.last_name(shown.len()));
    let own = Census::files(scene);
    fixed
        .map(str::to_owned)
        .into_iter()
        .chain(last)
        .chain(own)
        .collect()
}

/// Whether there is a file, or a link to one that need not exist.
fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
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
    if taken.clone().any(|name| is_there(&folder.join(name))) {
        let folder = folder.to_owned();
        return Err(RunError::Occupied { folder });
    }
    Ok(())
}

/// Whether a run to be resumed has a checkpoint. A run that was stopped before its first checkpoint
/// starts again, and nothing is lost.
pub(super) fn has_checkpoint(folder: &Path, lock: Option<&Lock>) -> Result<bool, RunError> {
    let has_former_lock = Lock::remove_former(folder)?;
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
    if lock.was_found() || has_former_lock || is_empty(folder) {
        return Ok(false);
    }
    Err(none())
}

/// Whether the folder has nothing but our new lock and unfinished files.
fn is_empty(folder: &Path) -> bool {
    remove_unfinished(folder);
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
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
