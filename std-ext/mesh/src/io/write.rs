//! Writers of mesh files; the encoder of each format is in the file of its parser.

use super::{Format, gltf, obj, off, ply, replace_file, stl, vtp};
use helfrich::TriangleMesh;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reason why a mesh file could not be written. The message is one line that starts with the name of
/// the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The ending of the name does not identify a format.
    #[error("{}: unknown format: {} files can be written", path.display(), Format::writable())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The format has numbers of 32 bits, and a coordinate is outside their range.
    #[error(
        "{}: coordinate {} of vertex {vertex} is beyond the 32-bit numbers of this format: choose \
         .obj, .off, .ply or .vtp", path.display(), ["x", "y", "z"][*axis]
    )]
    OutOfRange {
        /// The file.
        path: PathBuf,
        /// The vertex, from 0.
        vertex: usize,
        /// 0, 1 or 2.
        axis: usize,
    },
    /// The format has no colours, or there is not one for each vertex.
    #[error(
        "{}: {colours} colours of {vertices} vertices: one for each vertex is needed, and a format with colours: \
         .ply, .obj, .off, .vtp or .glb", path.display()
    )]
    Colours {
        /// The file.
        path: PathBuf,
        /// The number of colours.
        colours: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// The operating system refused to write the file.
    #[error("{}: {error}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
}

/// Writes a mesh file, completely or not at all. The ending of its name identifies the format.
///
/// OBJ and OFF are texts with enough digits to distinguish every `f64`. PLY is binary, little endian,
/// with coordinates of 64 bits, and so is VTP, in base64. STL and GLB are binary, with coordinates of 32 bits.
///
/// # Errors
/// If the ending does not identify a format, the format cannot hold a coordinate, or the file cannot be
/// written; see [`WriteError`].
///
/// # Panics
/// If there are fewer positions than the mesh has vertices.
pub fn write(path: &Path, positions: &[[f64; 3]], mesh: &TriangleMesh) -> Result<(), WriteError> {
    write_file(path, positions, mesh, None)
}

/// Writes a mesh file with a colour of each vertex (red, green and blue), as [`write()`]: in PLY, OFF and GLB as their
/// specifications say, in OBJ behind the position, in VTP as the array `RGB`. STL has no colours.
///
/// # Errors
/// As [`write()`]; also if the format is STL, or there is not one colour for each vertex.
///
/// # Panics
/// As [`write()`].
pub fn write_with_colours(
    path: &Path,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
    colours: &[[u8; 3]],
) -> Result<(), WriteError> {
    if Format::to_write(path) == Some(Format::Stl) || colours.len() != mesh.vertex_count() {
        return Err(WriteError::Colours {
            path: path.to_owned(),
            colours: colours.len(),
            vertices: mesh.vertex_count(),
        });
    }
    write_file(path, positions, mesh, Some(colours))
}

fn write_file(
    path: &Path,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
    colours: Option<&[[u8; 3]]>,
) -> Result<(), WriteError> {
    let format = Format::to_write(path).ok_or_else(|| WriteError::UnknownFormat {
        path: path.to_owned(),
    })?;
    if matches!(format, Format::Stl | Format::Gltf)
        && let Some((vertex, axis)) = beyond_single_precision(positions)
    {
        return Err(WriteError::OutOfRange {
            path: path.to_owned(),
            vertex,
            axis,
        });
    }
    replace_file(path, |out| encode(out, format, positions, mesh, colours)).map_err(|error| {
        WriteError::Unwritable {
            path: path.to_owned(),
            error,
        }
    })
}

/// Writes a mesh in a format, as [`write()`] does; in STL and GLB, numbers outside the range of 32 bits become
/// infinite.
///
/// # Errors
/// Any error of `out`, or of the kind `Unsupported` for a format that is only read.
///
/// # Panics
/// If there are fewer positions than the mesh has vertices.
pub fn write_to(
    out: &mut dyn Write,
    format: Format,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
) -> io::Result<()> {
    encode(out, format, positions, mesh, None)
}

/// Writes a mesh with a colour of each vertex in a format, as [`write_with_colours`] does; STL has no colours and
/// leaves them out.
///
/// # Errors
/// As [`write_to`].
///
/// # Panics
/// As [`write_to`]; also if there is not one colour for each vertex.
pub fn write_to_with_colours(
    out: &mut dyn Write,
    format: Format,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
    colours: &[[u8; 3]],
) -> io::Result<()> {
    assert_eq!(
        colours.len(),
        mesh.vertex_count(),
        "one colour for each vertex is needed"
    );
    encode(out, format, positions, mesh, Some(colours))
}

fn encode(
    out: &mut dyn Write,
    format: Format,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    let positions = &positions[..mesh.vertex_count()];
    let triangles = mesh.triangles();
    match format {
        Format::Obj => obj::write(out, positions, triangles, colours),
        Format::Off => off::write(out, positions, triangles, colours),
        Format::Stl => stl::write(out, positions, triangles),
        Format::Ply => ply::write(out, positions, triangles, colours),
        Format::Vtp => vtp::write(out, positions, triangles, colours),
        Format::Gltf => gltf::write(out, positions, triangles, colours),
        Format::Vtu | Format::Vtk | Format::Msh | Format::Gifti | Format::ThreeMf => {
            let message = format!("{format:?} files can only be read");
            Err(io::Error::new(io::ErrorKind::Unsupported, message))
        }
    }
}

/// The first coordinate that has no finite nearest `f32`.
fn beyond_single_precision(positions: &[[f64; 3]]) -> Option<(usize, usize)> {
    let infinite = |x: &f64| !(*x as f32).is_finite();
    let mut rows = positions.iter().enumerate();
    rows.find_map(|(vertex, row)| Some((vertex, row.iter().position(infinite)?)))
}

/// Writes values in blocks, because a call of an encoder or file costs more than a number.
pub(super) fn write_blocks<B: AsRef<[u8]>>(
    out: &mut (impl Write + ?Sized),
    values: impl Iterator<Item = B>,
) -> io::Result<()> {
    const BLOCK: usize = 1 << 13;
    let mut block = Vec::with_capacity(2 * BLOCK);
    for value in values {
        block.extend_from_slice(value.as_ref());
        if block.len() >= BLOCK {
            out.write_all(&block)?;
            block.clear();
        }
    }
    out.write_all(&block)
}
