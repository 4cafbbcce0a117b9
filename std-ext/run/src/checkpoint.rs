//! Checkpoints: the whole state of a run in one file, kept bit for bit.
//!
//! A file is, in little-endian order: the 16 bytes `helfrich state\r\n`; the format's version (u32);
//! the length of the body (u64); the SHA-256 of the three and the body; the body. The body is, in
//! the postcard encoding (postcard.jamesmunns.com), the program's version, the fingerprint of the
//! scene, and the state. postcard stores floats as their bits.
//!
//! postcard stores no field names: a state can be read back only as the type that was written, and
//! must not use `flatten`, `untagged` or `skip_serializing_if` of serde.

use crate::io::replace_file;
use crate::io::sha256;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The first bytes of a checkpoint. Programs that treat the file as text change its line break, so that
/// the damage is noticed.
const MAGIC: [u8; 16] = *b"helfrich state\r\n";
/// Increases whenever the layout before the state changes.
const FORMAT: u32 = 1;
/// The version of the program: other versions may interpret the same bytes differently.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");
/// Bytes of the magic, the format's version and the body's length.
const PREFIX: usize = MAGIC.len() + size_of::<u32>() + size_of::<u64>();
/// Bytes of a SHA-256.
const CHECKSUM: usize = 32;
/// Bytes before the body.
const HEADER: usize = PREFIX + CHECKSUM;

/// The identity of a scene: the SHA-256 of a text with everything that determines its numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Fingerprint([u8; 32]);

impl Fingerprint {
    /// The fingerprint of a text.
    pub fn of(text: &str) -> Self {
        Self(sha256(&[text.as_bytes()]))
    }

    /// The whole fingerprint in hexadecimal digits.
    pub fn to_hex(self) -> String {
        self.0.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The first eight hexadecimal digits.
impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0[..4]
            .iter()
            .try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Fingerprint({self}…)")
    }
}

/// The reason why a checkpoint cannot be written or used. The message is one line that starts with
/// the name of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct CheckpointError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: CheckpointProblem,
}

/// Problems of a checkpoint.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointProblem {
    /// The operating system refused to read or write the file.
    #[error("{0}")]
    Inaccessible(io::Error),
    /// The file starts with other bytes.
    #[error("is not a checkpoint: a file written by `helfrich run` is needed")]
    NotACheckpoint,
    /// The file was written in another layout.
    #[error("is a checkpoint of format {found}: this program reads format {FORMAT}")]
    OtherFormat {
        /// The file's format.
        found: u32,
    },
    /// The file ends before it should.
    #[error("the checkpoint is truncated: it has {found} of {expected} bytes")]
    Truncated {
        /// Length of the file.
        found: u64,
        /// Expected length.
        expected: u64,
    },
    /// The file is longer than expected, or its bytes have changed.
    #[error("the checkpoint is damaged: its checksum does not fit its content")]
    Damaged,
    /// Another version of the program wrote the file.
    #[error(
        "the checkpoint was written by version {found} of the program: this is {PROGRAM}, and a \
         run continues only with the version that started it"
    )]
    OtherProgram {
        /// The version found.
        found: String,
    },
    /// The checkpoint belongs to another scene.
    #[error(
        "the checkpoint belongs to another scene (fingerprint {found}, this scene has {expected}): \
         between a run and its continuation only `title`, `output`, `duration` or `strain` may change, \
         and under a single load `residual` and `iterations`"
    )]
    OtherScene {
        /// The fingerprint of the scene that was run.
        found: Fingerprint,
        /// The fingerprint of the scene to continue.
        expected: Fingerprint,
    },
    /// The state cannot be encoded.
    #[error("the state cannot be written: {0}")]
    NotEncodable(String),
    /// The bytes are intact, but do not encode a state of this type.
    #[error("the checkpoint does not contain the requested state: {0}")]
    OtherState(String),
}

impl CheckpointProblem {
    fn of(self, path: &Path) -> CheckpointError {
        CheckpointError {
            path: path.to_owned(),
            problem: self,
        }
    }
}

/// Writes the state of a run of a scene. The previous checkpoint remains until the new one is
/// complete on disk.
///
/// # Errors
/// If the state cannot be encoded, or the file cannot be written; see [`CheckpointProblem`].
pub fn write(
    path: &Path,
    scene: Fingerprint,
    state: &impl Serialize,
) -> Result<(), CheckpointError> {
    let body = postcard::to_stdvec(&(PROGRAM, scene, state))
        .map_err(|error| CheckpointProblem::NotEncodable(error.to_string()).of(path))?;
    let mut header = Vec::with_capacity(HEADER);
    header.extend(MAGIC);
    header.extend(FORMAT.to_le_bytes());
    header.extend((body.len() as u64).to_le_bytes());
    header.extend(checksum(&header, &body));
    replace_file(path, |out| {
        out.write_all(&header)?;
        out.write_all(&body)
    })
    .map_err(|error| CheckpointProblem::Inaccessible(error).of(path))
}

/// Reads the state of a run of this scene. For any bytes the result is the written state or an
/// error, and memory is proportional to the length of the file.
///
/// # Errors
/// If the file cannot be read, is not a checkpoint, is damaged, or belongs to another version,
/// scene or type of state; see [`CheckpointProblem`].
pub fn read<D: DeserializeOwned>(path: &Path, scene: Fingerprint) -> Result<D, CheckpointError> {
    read_problem(path, scene).map_err(|problem| problem.of(path))
}

fn read_problem<D: DeserializeOwned>(
    path: &Path,
    scene: Fingerprint,
) -> Result<D, CheckpointProblem> {
    let body = read_body(path).map_err(CheckpointProblem::Inaccessible)??;
    let damaged = |error: postcard::Error| CheckpointProblem::OtherState(error.to_string());
    let (program, rest) = postcard::take_from_bytes::<String>(&body).map_err(damaged)?;
    if program != PROGRAM {
        return Err(CheckpointProblem::OtherProgram { found: program });
    }
    let (found, rest) = postcard::take_from_bytes(rest).map_err(damaged)?;
    if found != scene {
        return Err(CheckpointProblem::OtherScene {
            found,
            expected: scene,
        });
    }
    match postcard::take_from_bytes(rest).map_err(damaged)? {
        (state, []) => Ok(state),
        (_, rest) => {
            let message = format!("{} bytes are left over", rest.len());
            Err(CheckpointProblem::OtherState(message))
        }
    }
}

/// The body, after all checks that do not need to decode it.
fn read_body(path: &Path) -> io::Result<Result<Vec<u8>, CheckpointProblem>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut header = Vec::with_capacity(HEADER);
    file.by_ref().take(HEADER as u64).read_to_end(&mut header)?;
    let magic = &header[..header.len().min(MAGIC.len())];
    if magic.is_empty() || !MAGIC.starts_with(magic) {
        return Ok(Err(CheckpointProblem::NotACheckpoint));
    }
    let truncated = |expected| {
        Ok(Err(CheckpointProblem::Truncated {
            found: length,
            expected,
        }))
    };
    let Some((prefix, claimed)) = header.split_at_checked(PREFIX) else {
        return truncated(HEADER as u64);
    };
    let (format, size) = prefix[MAGIC.len()..].split_at(size_of::<u32>());
    let found = format.iter().rev().fold(0, |n, &b| n << 8 | u32::from(b));
    if found != FORMAT {
        return Ok(Err(CheckpointProblem::OtherFormat { found }));
    }
    let size = size.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b));
    let expected = size.saturating_add(HEADER as u64);
    if length < expected {
        return truncated(expected);
    }
    let mut body = Vec::new();
    file.take(size).read_to_end(&mut body)?;
    if length > expected || claimed != checksum(prefix, &body) {
        return Ok(Err(CheckpointProblem::Damaged));
    }
    Ok(Ok(body))
}

fn checksum(prefix: &[u8], body: &[u8]) -> [u8; CHECKSUM] {
    sha256(&[prefix, body])
}
