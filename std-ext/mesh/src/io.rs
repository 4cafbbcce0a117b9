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

mod beside;
mod budget;
mod builder;
mod cells;
mod decimal;
mod error;
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
use error::CORNER;
pub use error::{Element, ParseError, Place, Position, Problem, ReadError};
pub use format::Format;
pub use replace::{
    LOCK_NAME, UNFINISHED, check_replaceable, is_same_file, remove_unfinished, replace_file,
};
pub use sha256::sha256;
pub use vti::{Grid, write_vti};
pub use vtk::{PointField, PointValues, VtkError};
pub use vtp::{Collection, CollectionEntry, write_vtp, write_vtp_to, write_vtp_with_cells};
pub(crate) use weld::merged;
pub use weld::{Welded, weld};
pub use whole::{free_memory, read_whole, without_mark};
pub use write::{WriteError, write, write_to, write_to_with_colours, write_with_colours};

use std::path::Path;

use crate::repair::{Soup, is_repairable};
use budget::Budget;
use builder::MeshBuilder;
use helfrich::TriangleMesh;

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

/// Parses the bytes of a file of this name, which identifies the format as in [`read`] and begins messages, with the
/// numbers at its vertices and triangles. Nothing is read from the disk: files beside it are not there.
///
/// # Errors
/// As [`read_with_columns`].
pub fn parse_named(name: &Path, bytes: &[u8]) -> Result<(MeshFile, Vec<Column>), ReadError> {
    parse_file(name, bytes, Columns::Read, None, mesh_of)
}

/// Parses the bytes of a file of this name as triangles that need not form a mesh, as [`parse_named`].
///
/// # Errors
/// As [`read_soup`].
pub fn parse_named_soup(name: &Path, bytes: &[u8]) -> Result<(Soup, Vec<Column>), ReadError> {
    parse_file(name, bytes, Columns::Read, None, soup_of)
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
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_file(path, &bytes, columns, Some(folder), parse)
}

/// Unpacks the bytes of a file, and parses them in its format.
fn parse_file<T>(
    path: &Path,
    bytes: &[u8],
    columns: Columns,
    folder: Option<&Path>,
    parse: impl FnOnce(&[u8], Format, Reading<'_>) -> Result<T, ParseError>,
) -> Result<T, ReadError> {
    let refused = |error| ReadError::Parse {
        path: path.to_owned(),
        error,
    };
    let content = gzip::unpacked(bytes).map_err(refused)?;
    let format = Format::from_extension(path)
        .or_else(|| Format::from_content(&content))
        .ok_or_else(|| ReadError::UnknownFormat {
            path: path.to_owned(),
        })?;
    let reading = Reading::new(columns, bytes, folder);
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

/// The parts of a file that are read, and how.
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
