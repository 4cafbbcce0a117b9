//! Mesh files: reads and writes OBJ, OFF, STL (ASCII and binary) and PLY (ASCII and binary).
//!
//! Coordinates keep the unit that the file has, and all the digits of an `f64`. Polygons are split
//! into the fan of triangles around their first corner: (a, b, c, d, …) becomes (a, b, c),
//! (a, c, d), …; that is right for convex polygons. Normals, colours, textures and whatever else a
//! file says beside positions and faces are skipped.
//!
//! Surfaces with fields on them, and fields on grids, are written for VTK and ParaView: [`write_vtp`],
//! [`write_vti`], [`Collection`].
//!
//! A file is read whole and parsed from memory, unless it has more than half of the memory that is
//! free; of pipes and devices 1 GiB at most is read. Whatever its bytes are, the parsers return a mesh
//! or an error, in time and memory proportional to the file's length. A byte order mark before a text
//! is skipped.

mod builder;
mod obj;
mod off;
mod ply;
mod replace;
mod stl;
mod text;
mod vti;
mod vtk;
mod vtp;
mod whole;
mod write;

pub use replace::{UNFINISHED, check_replaceable, replace_file};
pub use vti::{Grid, write_vti};
pub use vtk::{PointField, PointValues, VtkError};
pub use vtp::{Collection, CollectionEntry, write_vtp};
pub(crate) use whole::{free_memory, read_whole, without_mark};
pub use write::{WriteError, write, write_to};

use std::fmt;
use std::path::{Path, PathBuf};

use builder::Builder;
use helfrich::{MeshError, TriangleMesh};

/// What a mesh file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Where each vertex is, in the file's unit of length; all coordinates are finite.
    pub positions: Vec<[f64; 3]>,
    /// The triangles over these vertices.
    pub mesh: TriangleMesh,
}

/// The formats that can be read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: `v` and `f` statements; everything else is skipped, free-form surfaces too.
    Obj,
    /// Object File Format, text, three coordinates a vertex: `OFF`, and the variants with normals,
    /// colours or texture coordinates behind the position (`COFF`, `NOFF`, `STOFF`, …).
    Off,
    /// Stereolithography, ASCII or binary. Corners with the same coordinates, bit for bit, become
    /// one vertex, numbered in the order in which they first appear; −0 counts as 0.
    Stl,
    /// Polygon File Format (Stanford), ASCII or binary, little or big endian.
    Ply,
}

impl Format {
    /// The format that a file name's ending stands for, in upper or lower case.
    pub fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "off" => Some(Self::Off),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            _ => None,
        }
    }

    /// The format that a file's first word stands for. OBJ and binary STL have no such word.
    pub fn from_content(bytes: &[u8]) -> Option<Self> {
        match text::Text::new(without_mark(bytes)).statement()? {
            b"ply" => Some(Self::Ply),
            b"solid" => Some(Self::Stl),
            header if off::is_header(header) => Some(Self::Off),
            _ => None,
        }
    }
}

/// Why a file could not be read. The message is one line that starts with the file's name.
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
        /// What the operating system says.
        error: std::io::Error,
    },
    /// Neither the name's ending nor the first word tells the format.
    #[error("{}: unknown format: .obj, .off, .stl and .ply files can be read", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file's bytes are no mesh.
    #[error("{}: {error}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        error: ParseError,
    },
}

/// Why bytes are no mesh, and where in them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// The places that the problem concerns; none if it is about the whole file.
    pub places: Vec<Place>,
    /// What is wrong there.
    pub problem: Problem,
}

/// A place in a file, such as `line 1042 (face 17)` or `byte 934 (vertex 71)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// How far into the file.
    pub position: Position,
    /// Which part of the mesh is described there.
    pub element: Option<Element>,
}

/// How far into a file.
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

/// What can be wrong with a mesh file's content.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// There is not a byte.
    #[error("the file is empty")]
    EmptyFile,
    /// Something else stands where the format wants a certain thing.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What would be right.
        expected: &'static str,
        /// What is there: the word in backquotes, or the end of the line or file.
        found: String,
    },
    /// A PLY header lacks something.
    #[error("the header declares no {missing}")]
    Undeclared {
        /// What it should declare.
        missing: &'static str,
    },
    /// The file ends before everything that its header announces.
    #[error("the file is truncated: it ends after {found} of {announced} {what}")]
    Truncated {
        /// What is missing, in the plural.
        what: &'static str,
        /// How many should be there.
        announced: usize,
        /// How many are there, complete.
        found: usize,
    },
    /// A binary STL file is not as long as its number of faces asks for.
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
        /// What is there.
        found: String,
    },
    /// A face has less than three corners.
    #[error("a face of {corners} corners: three or more are needed")]
    TooFewCorners {
        /// How many there are.
        corners: usize,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "the face names vertex {vertex}, but there are {vertices} vertices, numbered from {first}"
    )]
    VertexOutOfRange {
        /// The vertex, as the file names it.
        vertex: i64,
        /// How many vertices there are.
        vertices: usize,
        /// The first vertex's number: 1 in OBJ, 0 elsewhere.
        first: usize,
    },
    /// Two corners of a face are one vertex, by number or, in STL, by position.
    #[error("corners {} and {} of the face are a repeated vertex: all have to differ", corners[0], corners[1])]
    RepeatedVertex {
        /// The corners, counted from 1.
        corners: [usize; 2],
    },
    /// The faces do not form a mesh.
    #[error("{error}{}", numbering(error))]
    Mesh {
        /// Why not.
        error: MeshError,
    },
}

/// [`MeshError`] counts from 0 and after polygons were split: said wherever it gives a number.
fn numbering(error: &MeshError) -> &'static str {
    match error {
        MeshError::Empty | MeshError::TooLarge { .. } => "",
        _ => " (triangles and vertices counted from 0)",
    }
}

/// What a corner that cannot be read should have been, where vertices count from 0.
const CORNER: &str = "a vertex number from 0 to 4294967295";

impl Problem {
    fn truncated(what: &'static str, announced: usize, found: usize) -> Self {
        Self::Truncated {
            what,
            announced,
            found,
        }
    }

    fn at(self, position: Position, element: Option<Element>) -> ParseError {
        ParseError {
            places: vec![Place { position, element }],
            problem: self,
        }
    }

    fn anywhere(self) -> ParseError {
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

/// Reads a mesh file; the name's ending tells the format, or else the file's first word.
///
/// # Errors
/// If the file cannot be read, if its format is unknown, or if its content is no oriented manifold
/// with finite coordinates; see [`ReadError`] and [`Problem`].
pub fn read(path: &Path) -> Result<MeshFile, ReadError> {
    let bytes = read_whole(path, None).map_err(|error| {
        let path = path.to_owned();
        match error.kind() {
            std::io::ErrorKind::NotFound => ReadError::Missing { path },
            _ if path.is_dir() => ReadError::Directory { path },
            _ => ReadError::Unreadable { path, error },
        }
    })?;
    let format = Format::from_extension(path)
        .or_else(|| Format::from_content(&bytes))
        .ok_or_else(|| ReadError::UnknownFormat {
            path: path.to_owned(),
        })?;
    parse(&bytes, format).map_err(|error| ReadError::Parse {
        path: path.to_owned(),
        error,
    })
}

/// The mesh in a file's bytes.
///
/// # Errors
/// If the bytes are no mesh in this format, or no oriented manifold with finite coordinates; see
/// [`Problem`].
pub fn parse(bytes: &[u8], format: Format) -> Result<MeshFile, ParseError> {
    if bytes.is_empty() {
        return Err(Problem::EmptyFile.anywhere());
    }
    let text = without_mark(bytes);
    match format {
        Format::Obj => obj::parse(text),
        Format::Off => off::parse(text),
        Format::Stl => stl::parse(bytes),
        Format::Ply => ply::parse(text),
    }
}

/// A coordinate, if it is finite; `found` says what the file has.
fn finite(value: f64, axis: usize, found: impl FnOnce() -> String) -> Result<f64, Problem> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Problem::NotFinite {
            axis: ['x', 'y', 'z'][axis],
            found: found(),
        })
    }
}
