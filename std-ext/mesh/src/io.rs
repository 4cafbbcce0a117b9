//! Mesh files: reads the formats of [`Format`], also compressed by gzip, and writes some of them.
//!
//! Coordinates keep the unit of the file and all digits of `f64`. A convex polygon is split into
//! the fan of triangles around its first corner: (a, b, c, d, …) becomes (a, b, c), (a, c, d), …; others are
//! split by [`polygon::triangulate`](crate::polygon::triangulate). Everything other than positions and faces, such as normals, colours and
//! textures, is skipped; [`read_with_columns`] also reads numbers at vertices and triangles.
//!
//! Surfaces with fields on them, and fields on grids, are also written for VTK and ParaView: [`write_vtp`],
//! [`write_vti`], [`Collection`].
//!
//! A file is read completely and parsed from memory; it may take up to half of the free memory. From
//! pipes and devices at most 1 GiB is read. For any bytes the parsers return a mesh or an error, in
//! time and memory proportional to the length of the file: where a file can state a number many times, or
//! compressed, its numbers may take 64 MiB and 16 times its length, or 256 times if it is compressed; a file that is
//! compressed as a whole may be so much longer when it is unpacked. A byte order mark before a text is skipped.

mod budget;
mod builder;
mod cells;
mod decimal;
mod format;
mod gifti;
mod gltf;
mod gzip;
mod legacy;
mod msh;
mod number;
mod obj;
mod off;
mod ply;
mod replace;
mod sha256;
mod stl;
mod text;
mod three_mf;
mod tokens;
mod vti;
mod vtk;
mod vtp;
mod weld;
mod whole;
mod write;
mod xml;
mod zip;

pub use decimal::{push_fields, push_number};
pub use format::Format;
pub use replace::{
    LOCK_NAME, UNFINISHED, check_replaceable, is_same_file, remove_unfinished, replace_file,
};
pub use sha256::sha256;
pub use vti::{Grid, write_vti};
pub use vtk::{PointField, PointValues, VtkError};
pub use vtp::{Collection, CollectionEntry, write_vtp, write_vtp_with_cells};
pub(crate) use weld::merged;
pub use weld::{Welded, weld};
pub use whole::{free_memory, read_whole, without_mark};
pub use write::{WriteError, write, write_to, write_with_colours};

use std::fmt;
use std::path::{Path, PathBuf};

use crate::polygon::TooManyCorners;
use crate::repair::{Soup, is_repairable};
use budget::Budget;
use builder::MeshBuilder;
use helfrich::{MeshError, TriangleMesh};

/// The content of a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Positions of the vertices, in the unit of length of the file; all coordinates are finite.
    pub positions: Vec<[f64; 3]>,
    /// The triangles over these vertices.
    pub mesh: TriangleMesh,
    /// Number of vertices of the file that were left out: no face has them, and a coordinate is not finite.
    pub left_out: usize,
}

impl MeshFile {
    /// A mesh with all of its vertices.
    pub fn new(positions: Vec<[f64; 3]>, mesh: TriangleMesh) -> Self {
        Self {
            positions,
            mesh,
            left_out: 0,
        }
    }
}

/// Numbers at the vertices or the triangles of a mesh file: an array of VTK's point data or cell data
/// with one component, a property of PLY's vertices or faces, and their like in MSH and GIFTI.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the array or property; in MSH also `gmsh:physical` and `gmsh:geometrical`, the numbers of groups.
    pub name: String,
    /// The parts of the mesh that have its numbers.
    pub place: ColumnPlace,
    /// One number for each vertex or triangle, which need not be finite. All triangles of a polygon have the
    /// polygon's number.
    pub values: Vec<f64>,
}

/// The parts of a mesh that have the numbers of a [`Column`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColumnPlace {
    /// The vertices.
    Vertices,
    /// The triangles.
    Triangles,
}

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

/// Reads a mesh file. The ending of its name identifies the format; if it does not, the first bytes
/// of the file do.
///
/// # Errors
/// If the file cannot be read, if its format is unknown, or if its content is not an oriented manifold
/// with finite coordinates; see [`ReadError`] and [`Problem`].
pub fn read(path: &Path) -> Result<MeshFile, ReadError> {
    let (file, _) = read_and(path, Columns::Skipped, mesh_of)?;
    Ok(file)
}

/// Reads a mesh file, and the numbers at its vertices and triangles in the order of the file: of PLY, VTP, VTU, VTK,
/// MSH and GIFTI, other formats have none. Arrays of several components, such as vectors, are skipped.
///
/// # Errors
/// As [`read`]; also if a column cannot be read.
pub fn read_with_columns(path: &Path) -> Result<(MeshFile, Vec<Column>), ReadError> {
    read_and(path, Columns::Read, mesh_of)
}

/// Reads a mesh file as triangles that need not form a mesh, as [`parse_soup`].
///
/// # Errors
/// If the file cannot be read, its format is unknown, or its content is not as [`parse_soup`] needs it.
pub fn read_soup(path: &Path) -> Result<(Soup, Vec<Column>), ReadError> {
    read_and(path, Columns::Read, soup_of)
}

/// Reads a file, unpacks it, and parses it in its format.
fn read_and<T>(
    path: &Path,
    columns: Columns,
    parse: impl FnOnce(&[u8], Format, Reading<'_>) -> Result<T, ParseError>,
) -> Result<T, ReadError> {
    let bytes = read_whole(path, None).map_err(|error| {
        let path = path.to_owned();
        match error.kind() {
            std::io::ErrorKind::NotFound => ReadError::Missing { path },
            _ if path.is_dir() => ReadError::Directory { path },
            _ => ReadError::Unreadable { path, error },
        }
    })?;
    let refused = |error| ReadError::Parse {
        path: path.to_owned(),
        error,
    };
    let content = gzip::unpacked(&bytes).map_err(refused)?;
    let format = Format::from_extension(path)
        .or_else(|| Format::from_content(&content))
        .ok_or_else(|| ReadError::UnknownFormat {
            path: path.to_owned(),
        })?;
    let folder = Some(path.parent().unwrap_or(Path::new("")));
    let reading = Reading::new(columns, &bytes, folder);
    parse(&content, format, reading).map_err(refused)
}

/// Reads a mesh file, and merges vertices at the same point: [`MeshFile::welded`].
///
/// # Errors
/// If the file cannot be read, or the merged mesh is not a manifold; see [`ReadError`].
pub fn read_welded(path: &Path) -> Result<MeshFile, ReadError> {
    read_welded_within(path, 0.0)
}

/// Reads a mesh file, and merges vertices that are at most this far apart: [`MeshFile::welded_within`].
///
/// # Errors
/// As [`read_welded`].
pub fn read_welded_within(path: &Path, distance: f64) -> Result<MeshFile, ReadError> {
    let file = read(path)?;
    let left_out = file.left_out;
    let welded = file.welded_within(distance);
    let welded = welded.map_err(|error| ReadError::Weld {
        path: path.to_owned(),
        distance,
        error,
    })?;
    Ok(MeshFile { left_out, ..welded })
}

/// Parses the bytes of a mesh file, which may be compressed by gzip.
///
/// # Errors
/// If the bytes are not a mesh in this format, or not an oriented manifold with finite coordinates; see
/// [`Problem`].
pub fn parse(bytes: &[u8], format: Format) -> Result<MeshFile, ParseError> {
    let (file, _) = parse_in_memory(bytes, format, Columns::Skipped)?;
    Ok(file)
}

/// Parses the bytes of a mesh file, and the numbers at its vertices and triangles as [`read_with_columns`].
///
/// # Errors
/// As [`parse`]; also if a column cannot be read.
pub fn parse_with_columns(
    bytes: &[u8],
    format: Format,
) -> Result<(MeshFile, Vec<Column>), ParseError> {
    parse_in_memory(bytes, format, Columns::Read)
}

/// Whether numbers at vertices and triangles are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Columns {
    Read,
    Skipped,
}

/// What is read of a file, and how.
#[derive(Clone, Copy, Debug)]
struct Reading<'a> {
    columns: Columns,
    unknown: Unknown,
    /// Length of the file in bytes, before it is unpacked, which bounds the memory of numbers.
    length: usize,
    /// The folder of the file, if it is known.
    folder: Option<&'a Path>,
}

impl<'a> Reading<'a> {
    fn new(columns: Columns, bytes: &[u8], folder: Option<&'a Path>) -> Self {
        Self {
            columns,
            unknown: Unknown::Refused,
            length: bytes.len(),
            folder,
        }
    }
}

/// The faces and columns of a file, before the faces are checked and vertices are left out.
type Parsed = (MeshBuilder, Vec<Column>);

fn parse_faces(bytes: &[u8], format: Format, reading: Reading<'_>) -> Result<Parsed, ParseError> {
    if bytes.is_empty() {
        return Err(Problem::EmptyFile.anywhere());
    }
    let text = without_mark(bytes);
    match format {
        Format::Obj => Ok((obj::parse(text, reading.unknown)?, Vec::new())),
        Format::Off => Ok((off::parse(text, reading.unknown)?, Vec::new())),
        Format::Stl => Ok((stl::parse(bytes, reading.unknown)?, Vec::new())),
        Format::Ply => ply::parse(text, reading.columns, reading.unknown),
        Format::Vtp | Format::Vtu => vtp::parse(text, reading),
        Format::Vtk => legacy::parse(text, reading),
        Format::Msh => msh::parse(text, reading),
        Format::Gifti => gifti::parse(text, reading),
        Format::ThreeMf => Ok((three_mf::parse(text, reading)?, Vec::new())),
        Format::Gltf => Ok((gltf::parse(text, reading)?, Vec::new())),
    }
}

fn parse_in_memory(
    bytes: &[u8],
    format: Format,
    columns: Columns,
) -> Result<(MeshFile, Vec<Column>), ParseError> {
    let reading = Reading::new(columns, bytes, None);
    mesh_of(&gzip::unpacked(bytes)?, format, reading)
}

/// The mesh of the unpacked bytes of a file.
fn mesh_of(
    bytes: &[u8],
    format: Format,
    reading: Reading<'_>,
) -> Result<(MeshFile, Vec<Column>), ParseError> {
    let parse = |unknown: Unknown| {
        let reading = Reading { unknown, ..reading };
        let (builder, mut columns) = parse_faces(bytes, format, reading)?;
        let (file, left_out) = builder.finish()?;
        leave_out(&left_out, &mut columns);
        retain_complete(
            &mut columns,
            file.positions.len(),
            file.mesh.triangles().len(),
        );
        Ok((file, columns))
    };
    // Coordinates that are not finite matter only if a face has the vertex: the error of the first says where it is.
    parse(Unknown::Refused).or_else(|refused: ParseError| match refused.is_of_unknown_vertex() {
        true => parse(Unknown::Kept).map_err(|_| refused),
        false => Err(refused),
    })
}

/// Parses the bytes of a mesh file, which may be compressed by gzip, as triangles that need not form a mesh, and the
/// numbers at its vertices and triangles, for [`repair`](crate::repair::repair).
///
/// # Errors
/// If the bytes are no vertices and faces in this format, or a face names a vertex that does not exist.
pub fn parse_soup(bytes: &[u8], format: Format) -> Result<(Soup, Vec<Column>), ParseError> {
    let reading = Reading::new(Columns::Read, bytes, None);
    soup_of(&gzip::unpacked(bytes)?, format, reading)
}

/// The triangles of the unpacked bytes of a file.
fn soup_of(
    bytes: &[u8],
    format: Format,
    reading: Reading<'_>,
) -> Result<(Soup, Vec<Column>), ParseError> {
    let reading = Reading {
        unknown: Unknown::Kept,
        ..reading
    };
    let (builder, mut columns) = parse_faces(bytes, format, reading)?;
    let (soup, left_out) = builder.soup()?;
    leave_out(&left_out, &mut columns);
    retain_complete(&mut columns, soup.positions.len(), soup.triangles.len());
    Ok((soup, columns))
}

/// Removes columns without one number for each place: a header of PLY may declare vertices or faces twice, each
/// time with other properties.
fn retain_complete(columns: &mut Vec<Column>, vertices: usize, triangles: usize) {
    columns.retain(|column| {
        let places = match column.place {
            ColumnPlace::Vertices => vertices,
            ColumnPlace::Triangles => triangles,
        };
        column.values.len() == places
    });
}

/// Whether coordinates that are not finite are errors where they are read, or kept until all faces are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unknown {
    Refused,
    Kept,
}

impl ParseError {
    /// Whether a [`repair`](crate::repair::repair) of the file's triangles makes a mesh of them.
    pub fn is_repairable(&self) -> bool {
        match &self.problem {
            Problem::TooFewCorners { .. }
            | Problem::RepeatedVertex { .. }
            | Problem::NotFinite { .. } => true,
            Problem::Mesh { error } => is_repairable(error),
            _ => false,
        }
    }

    fn is_of_unknown_vertex(&self) -> bool {
        let is_vertex = |place: &Place| matches!(place.element, Some(Element::Vertex(_)));
        matches!(self.problem, Problem::NotFinite { .. }) && self.places.iter().all(is_vertex)
    }
}

/// Leaves out the numbers of vertices that are left out.
fn leave_out(left_out: &[bool], columns: &mut [Column]) {
    for column in columns {
        let is_of_all = column.values.len() == left_out.len();
        if column.place == ColumnPlace::Vertices && is_of_all {
            let mut is_left_out = left_out.iter();
            column.values.retain(|_| is_left_out.next() == Some(&false));
        }
    }
}

/// Returns a coordinate if it is finite, or may be unknown; otherwise an error with `found`, the content of the file.
fn finite(
    value: f64,
    axis: usize,
    unknown: Unknown,
    found: impl FnOnce() -> String,
) -> Result<f64, Problem> {
    if value.is_finite() || unknown == Unknown::Kept {
        Ok(value)
    } else {
        Err(Problem::NotFinite {
            axis: ['x', 'y', 'z'][axis],
            found: found(),
        })
    }
}
