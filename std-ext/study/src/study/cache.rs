//! Measurements kept for later studies.
//!
//! A file is, in little-endian order: the 16 bytes `helfrich cache\r\n`; the format's version (u32);
//! the SHA-256 of the body; the body. The body is, in the postcard encoding, the SHA-256 of the
//! program, the name of the machine, and the entries. A measurement counts only for the very program
//! and machine that made it: times depend on both, results on the program.

use crate::io::replace_file;
use crate::io::sha256;
use crate::lock::{Lock, LockError};
use crate::provenance::Provenance;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const MAGIC: [u8; 16] = *b"helfrich cache\r\n";
/// Increases whenever the meaning of entries changes.
const FORMAT: u32 = 2;
/// Bytes of a SHA-256.
const CHECKSUM: usize = 32;

/// The longest time for which measurements are only in memory.
const EVERY: Duration = Duration::from_secs(1);

/// The longest file that is read, in bytes: a study of everything has a hundredth of it.
const LONGEST: u64 = 1 << 28;

/// Measurements by name, written to a file at intervals.
#[derive(Debug)]
pub struct Cache {
    path: PathBuf,
    content: Content,
    /// The time of the last write.
    written: Instant,
    /// Whether there are measurements that are not in the file.
    changed: bool,
    failure: Option<io::Error>,
    /// The names of entries that were used.
    used: RefCell<BTreeSet<String>>,
    /// The lock: a second process would overwrite the measurements of the first.
    _lock: Lock,
}

/// The content of the body.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Content {
    program: [u8; 32],
    machine: String,
    entries: BTreeMap<String, Vec<u8>>,
}

/// The result of opening a cache.
#[derive(Debug)]
pub struct LoadedCache {
    /// The cache; empty if there was none or it is not valid here.
    pub cache: Cache,
    /// The reason why the content of the file is not valid; it will be replaced.
    pub unused: Option<CacheProblem>,
}

/// The reason why there is no cache. The message is one line that starts with the name of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct CacheError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: CacheProblem,
}

/// Problems of a cache.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CacheProblem {
    /// The operating system refused to read or write the file.
    #[error("{0}")]
    Inaccessible(io::Error),
    /// Something else has the name of its lock.
    #[error("{0}")]
    Lock(LockError),
    /// Another process uses it.
    #[error(
        "{holder} keeps its measurements here: wait until it has ended, or name another file with \
         `--cache`"
    )]
    Taken {
        /// The process and its machine.
        holder: String,
    },
    /// The file starts with other bytes: it is not a cache, and is not changed.
    #[error("is not a cache of measurements, and was not changed: choose another name")]
    NotACache,
    /// The file was written in another layout.
    #[error("the cache has format {found}, this program {FORMAT}: everything is measured again")]
    OtherFormat {
        /// The file's format.
        found: u32,
    },
    /// The bytes have changed since they were written.
    #[error("the cache is damaged: everything is measured again")]
    Damaged,
    /// The measurements are from another program or machine.
    #[error(
        "the cache was written by another build of the program or on another machine: everything \
         is measured again"
    )]
    OtherProgram,
}

impl Cache {
    /// Opens or creates the cache in a file. Invalid content is not an error, because it can be
    /// measured again.
    ///
    /// # Errors
    /// If the file is not a cache, cannot be read, or another process has it open; see
    /// [`CacheProblem`].
    pub fn open(path: &Path, provenance: &Provenance) -> Result<LoadedCache, CacheError> {
        let lock = Lock::of_file(path).map_err(|error| CacheError {
            path: path.to_owned(),
            problem: match error {
                LockError::Taken { holder, .. } => CacheProblem::Taken { holder },
                LockError::Inaccessible { source, .. } => CacheProblem::Inaccessible(source),
                foreign => CacheProblem::Lock(foreign),
            },
        })?;
        let empty = Content {
            program: provenance.program,
            machine: provenance.machine(),
            entries: BTreeMap::new(),
        };
        let (content, unused) = match read(path, &empty) {
            Ok(content) => (content, None),
            Err(
                problem @ (CacheProblem::OtherFormat { .. }
                | CacheProblem::Damaged
                | CacheProblem::OtherProgram),
            ) => (empty, Some(problem)),
            Err(CacheProblem::Inaccessible(error)) if error.kind() == io::ErrorKind::NotFound => {
                (empty, None)
            }
            Err(problem) => {
                return Err(CacheError {
                    path: path.to_owned(),
                    problem,
                });
            }
        };
        let cache = Self {
            path: path.to_owned(),
            content,
            written: Instant::now(),
            changed: false,
            failure: None,
            used: RefCell::default(),
            _lock: lock,
        };
        Ok(LoadedCache { cache, unused })
    }

    /// Removes all measurements.
    pub fn clear(&mut self) {
        self.content.entries.clear();
        self.changed = true;
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of measurements found in the cache.
    pub fn used(&self) -> usize {
        self.used.borrow().len()
    }

    /// The measurement with a name; `None` if there is none, or one of another type.
    pub fn get<V: DeserializeOwned>(&self, name: &str) -> Option<V> {
        let value = postcard::from_bytes(self.content.entries.get(name)?).ok()?;
        self.used.borrow_mut().insert(name.to_owned());
        Some(value)
    }

    /// Stores a measurement. The file is written with a later measurement after about a second, or
    /// by [`Self::save`].
    pub fn insert(&mut self, name: String, value: &impl Serialize) {
        // Numbers, texts and lists can be encoded.
        if let Ok(bytes) = postcard::to_stdvec(value) {
            self.content.entries.insert(name, bytes);
            self.changed = true;
        }
        if self.written.elapsed() >= EVERY {
            self.write();
        }
    }

    /// Writes what is not yet in the file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&mut self) -> Result<(), CacheError> {
        self.write();
        match self.failure.take() {
            None => Ok(()),
            Some(error) => Err(CacheError {
                path: self.path.clone(),
                problem: CacheProblem::Inaccessible(error),
            }),
        }
    }

    fn write(&mut self) {
        if !self.changed {
            return;
        }
        let encoded = postcard::to_stdvec(&self.content).map_err(io::Error::other);
        let written = encoded.and_then(|body| {
            replace_file(&self.path, |out| {
                out.write_all(&MAGIC)?;
                out.write_all(&FORMAT.to_le_bytes())?;
                out.write_all(&sha256(&[&body]))?;
                out.write_all(&body)
            })
        });
        self.written = Instant::now();
        self.changed = written.is_err();
        self.failure = written.err();
    }
}

/// The content of a file, if the program and machine of `own` have written it.
fn read(path: &Path, own: &Content) -> Result<Content, CacheProblem> {
    let metadata = fs::metadata(path).map_err(CacheProblem::Inaccessible)?;
    if !metadata.is_file() || metadata.len() > LONGEST {
        return Err(CacheProblem::NotACache);
    }
    let bytes = fs::read(path).map_err(CacheProblem::Inaccessible)?;
    let rest = bytes.strip_prefix(&MAGIC).ok_or(CacheProblem::NotACache)?;
    let (format, rest) = rest.split_first_chunk().ok_or(CacheProblem::Damaged)?;
    let found = u32::from_le_bytes(*format);
    if found != FORMAT {
        return Err(CacheProblem::OtherFormat { found });
    }
    let (checksum, body) = rest
        .split_first_chunk::<CHECKSUM>()
        .ok_or(CacheProblem::Damaged)?;
    if sha256(&[body]) != *checksum {
        return Err(CacheProblem::Damaged);
    }
    let content: Content = postcard::from_bytes(body).map_err(|_| CacheProblem::Damaged)?;
    if (&content.program, &content.machine) != (&own.program, &own.machine) {
        return Err(CacheProblem::OtherProgram);
    }
    Ok(content)
}
