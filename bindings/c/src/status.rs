//! Status codes, and texts of errors.

use helfrich::{MeshError, SurfaceError};
use std::ffi::{CStr, c_char, c_int};

/// The outcome of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// The call has done what it says.
    Ok = 0,
    /// A pointer that is needed is NULL.
    NullPointer = 1,
    /// An array has another number of entries than the mesh or the call asks for.
    InvalidCount = 2,
    /// An argument is out of its range, misaligned, no text in UTF-8, or overlaps another one.
    InvalidArgument = 3,
    /// The triangles do not form an oriented manifold.
    InvalidMesh = 4,
    /// A coordinate is not finite, or too far away.
    InvalidPositions = 5,
    /// The text of effects is wrong, or an effect cannot act on the mesh.
    InvalidEffects = 6,
    /// A file cannot be read, or has no mesh.
    UnreadableFile = 7,
    /// The result is not defined, such as the volume of an open surface, or beyond the numbers of its type.
    Undefined = 8,
    /// An error of the library itself: please report it. The handles of the call can only be freed.
    Internal = 9,
}

impl Status {
    const ALL: [(Self, &'static CStr); 10] = [
        (Self::Ok, c"no error"),
        (Self::NullPointer, c"a pointer is NULL"),
        (
            Self::InvalidCount,
            c"an array has the wrong number of entries",
        ),
        (Self::InvalidArgument, c"an argument is invalid"),
        (
            Self::InvalidMesh,
            c"the triangles do not form an oriented manifold",
        ),
        (Self::InvalidPositions, c"a position is invalid"),
        (Self::InvalidEffects, c"the effects are invalid"),
        (Self::UnreadableFile, c"the file cannot be read"),
        (Self::Undefined, c"the result is not defined"),
        (Self::Internal, c"an error of the library itself"),
    ];
}

/// The meaning of a status in a few words. The text is static; for numbers without meaning it is "unknown
/// status".
#[unsafe(no_mangle)]
pub extern "C" fn hf_status_text(status: c_int) -> *const c_char {
    let known = Status::ALL.iter();
    let text = known
        .filter(|(known, _)| *known as c_int == status)
        .map(|(_, text)| *text)
        .next();
    text.unwrap_or(c"unknown status").as_ptr()
}

/// Number of bytes of the text of an error, with the zero byte at its end.
pub const TEXT_BYTES: usize = 1020;

/// The error of a call, owned by the caller. A call that succeeds sets it to HF_STATUS_OK and an empty text.
#[derive(Debug)]
#[repr(C)]
pub struct Error {
    /// The status that the call returned.
    pub status: Status,
    /// The problem, its place, and what would be right: UTF-8, ended by a zero byte, and cut if it is long.
    pub text: [c_char; TEXT_BYTES],
}

/// The reason why a call fails.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: Status,
    pub(crate) text: String,
}

impl Failure {
    pub(crate) fn new(status: Status, text: impl ToString) -> Self {
        Self {
            status,
            text: text.to_string(),
        }
    }

    pub(crate) fn argument(text: impl ToString) -> Self {
        Self::new(Status::InvalidArgument, text)
    }

    pub(crate) fn count(name: &str, found: usize, needed: usize, of: &str) -> Self {
        let text = format!("`{name}` has {found} entries: {needed} are needed, {of}");
        Self::new(Status::InvalidCount, text)
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::new(Status::InvalidMesh, error)
    }
}

impl From<SurfaceError> for Failure {
    fn from(error: SurfaceError) -> Self {
        let status = match error {
            SurfaceError::CountMismatch { .. } => Status::InvalidCount,
            _ => Status::InvalidPositions,
        };
        Self::new(status, error)
    }
}

/// A result that a call passes on.
pub(crate) type Outcome = Result<(), Failure>;

/// Writes as much of a text as fits, ended by a zero byte and cut between characters.
pub(crate) fn put_text(text: &str, into: &mut [c_char]) {
    let Some(most) = into.len().checked_sub(1) else {
        return;
    };
    let mut length = most.min(text.len());
    while !text.is_char_boundary(length) {
        length -= 1;
    }
    for (byte, place) in text.as_bytes()[..length].iter().zip(&mut *into) {
        *place = *byte as c_char;
    }
    into[length] = 0;
}
