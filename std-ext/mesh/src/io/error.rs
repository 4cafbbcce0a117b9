//! Reasons why a file is not read, with their places.

use super::Format;
use crate::polygon::TooManyCorners;
use helfrich::MeshError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Reason why a file could not be read. The message is one line that starts with the name of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// There is no such file.
    #[error("{}: there is no such file", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The path names a directory.
    #[error("{}: is a directory: a mesh file is needed", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The operating system refused to read the file.
    #[error("{}: cannot be read: {error}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// Neither the ending of the name nor the first bytes identify the format.
    #[error("{}: unknown format: {} files can be read, also compressed as .gz", path.display(), Format::readable())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The content is not a mesh.
    #[error("{}: {error}{}", path.display(), remedy(path, error))]
    Parse {
        /// The file.
        path: PathBuf,
        /// The problem and its place.
        error: ParseError,
    },
    /// Vertices at the same point cannot be merged.
    #[error(
        "{}: {error} after vertices are merged: `helfrich repair --weld={distance:?} {} -o OUT` mends it",
        path.display(), word(path)
    )]
    Weld {
        /// The file.
        path: PathBuf,
        /// The largest distance of vertices that are merged.
        distance: f64,
        /// The reason.
        error: MeshError,
    },
}

/// The command that mends a file, if it can be mended.
fn remedy(path: &Path, error: &ParseError) -> String {
    if error.is_repairable() {
        format!(": `helfrich repair {} -o OUT` mends it", word(path))
    } else {
        String::new()
    }
}

/// A path as a word of a command.
fn word(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+,:@%=".contains(c);
    if path.chars().all(is_plain) {
        path
    } else {
        format!("'{}'", path.replace('\'', r"'\''"))
    }
}

impl ReadError {
    /// The same error without the words of the file that it quotes.
    #[must_use]
    pub fn without_words(mut self) -> Self {
        if let Self::Parse { error, .. } = &mut self
            && let Problem::Expected { found, .. } | Problem::NotFinite { found, .. } =
                &mut error.problem
            && found.starts_with('`')
        {
            "something else".clone_into(found);
        }
        self
    }
}

/// Reason why bytes are not a mesh, with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// The places of the problem; none if it concerns the whole file.
    pub places: Vec<Place>,
    /// The problem there.
    pub problem: Problem,
}

/// A place in a file, which a message shows as `line 1042 (face 17)` or `byte 934 (vertex 71)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The position in the file.
    pub position: Position,
    /// The part of the mesh that is described there.
    pub element: Option<Element>,
}

/// A position in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// Line of a text, from 1.
    Line(usize),
    /// Byte of a binary file, from 0.
    Byte(usize),
}

/// A part of a mesh, counted as the format counts its vertices: from 1 in OBJ, from 0 elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// A vertex.
    Vertex(usize),
    /// A face, before it is split into triangles.
    Face(usize),
}

/// Problems of the content of a mesh file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file is empty.
    #[error("the file is empty")]
    EmptyFile,
    /// The content is not what the format requires at this place.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// The expected content.
        expected: &'static str,
        /// The content found: the word in backquotes, or the end of the line or file.
        found: String,
    },
    /// A header, or a file that declares its parts, lacks something.
    #[error("the header declares no {missing}")]
    Undeclared {
        /// The declaration that is missing.
        missing: &'static str,
    },
    /// The file ends before everything that its header announces.
    #[error("the file is truncated: it ends after {found} of {announced} {what}")]
    Truncated {
        /// The missing items, in the plural.
        what: &'static str,
        /// The expected number.
        announced: usize,
        /// The number of complete items found.
        found: usize,
    },
    /// An array of numbers at the vertices or faces has another length.
    #[error("an array of {section} has {found} numbers, and its piece {places}")]
    ColumnLength {
        /// `PointData` or `CellData`.
        section: &'static str,
        /// The number of its numbers.
        found: usize,
        /// The number of points or cells, in words.
        places: String,
    },
    /// Numbers that the file states many times, or compressed, take too much memory.
    #[error(
        "the arrays take more than {limit} bytes, too many for a file of {length} bytes: they are named by \
         many pieces, or compressed beyond reason: write every array once, uncompressed"
    )]
    TooLarge {
        /// The file's length in bytes.
        length: usize,
        /// The largest number of bytes for this length.
        limit: u64,
    },
    /// The length of a binary STL file does not match its number of faces.
    #[error(
        "a binary STL file of {faces} faces has {} bytes, but there are {length}: it is truncated or damaged", 84 + 50 * faces
    )]
    WrongLength {
        /// The number of faces that the header announces.
        faces: u64,
        /// The file's length in bytes.
        length: usize,
    },
    /// A coordinate is NaN, infinite, or too large for an `f64`.
    #[error("coordinate {axis} is {found}: a finite number is needed")]
    NotFinite {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// The content found.
        found: String,
    },
    /// A face has fewer than three corners.
    #[error("a face of {corners} corners: three or more are needed")]
    TooFewCorners {
        /// The number of corners.
        corners: usize,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "the face names vertex {vertex}, but there are {vertices} vertices, numbered from {first}"
    )]
    VertexOutOfRange {
        /// The vertex, as the file names it.
        vertex: i64,
        /// The number of vertices.
        vertices: usize,
        /// The first vertex's number: 1 in OBJ, 0 elsewhere.
        first: usize,
    },
    /// Two corners of a face are the same vertex, by number or, in STL, by position.
    #[error("corners {} and {} of the face are a repeated vertex: all have to differ", corners[0], corners[1])]
    RepeatedVertex {
        /// The corners, counted from 1.
        corners: [usize; 2],
    },
    /// A polygon is too intricate to be split into triangles.
    #[error("{error}: divide it")]
    Polygon {
        /// The reason.
        error: TooManyCorners,
    },
    /// The faces do not form a mesh.
    #[error("{error}{}", numbering(error))]
    Mesh {
        /// The reason.
        error: MeshError,
    },
}

/// Text for messages with numbers: [`MeshError`] counts from 0, after polygons are split.
fn numbering(error: &MeshError) -> &'static str {
    match error {
        MeshError::Empty | MeshError::TooLarge { .. } | MeshError::IncompleteTriangle { .. } => "",
        _ => " (triangles and vertices counted from 0)",
    }
}

/// The expected form of a corner, for error messages, where vertices count from 0.
pub(super) const CORNER: &str = "a vertex number from 0 to 4294967295";

impl Problem {
    pub(super) fn truncated(what: &'static str, announced: usize, found: usize) -> Self {
        Self::Truncated {
            what,
            announced,
            found,
        }
    }

    pub(super) fn at(self, position: Position, element: Option<Element>) -> ParseError {
        ParseError {
            places: vec![Place { position, element }],
            problem: self,
        }
    }

    pub(super) fn anywhere(self) -> ParseError {
        ParseError {
            places: Vec::new(),
            problem: self,
        }
    }
}

impl std::error::Error for ParseError {}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, place) in self.places.iter().enumerate() {
            write!(f, "{}{place}", if at == 0 { "" } else { " and " })?;
        }
        let separator = if self.places.is_empty() { "" } else { ": " };
        write!(f, "{separator}{}", self.problem)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Position::Line(line) => write!(f, "line {line}")?,
            Position::Byte(byte) => write!(f, "byte {byte}")?,
        }
        match self.element {
            Some(Element::Vertex(vertex)) => write!(f, " (vertex {vertex})"),
            Some(Element::Face(face)) => write!(f, " (face {face})"),
            None => Ok(()),
        }
    }
}
