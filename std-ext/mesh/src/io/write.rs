//! Writers of mesh files; the encoder of each format is in the file of its parser.

use super::{Format, obj, off, ply, replace_file, stl, vtp};
use helfrich::TriangleMesh;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reason why a mesh file could not be written. The message is one line that starts with the name of
/// the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The ending of the name does not identify a format.
    #[error("{}: unknown format: .obj, .off, .stl, .ply and .vtp files can be written", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The format has numbers of 32 bits, and a coordinate is outside their range.
    #[error(
        "{}: coordinate {} of vertex {vertex} is beyond the 32-bit numbers of an STL file: choose \
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
/// with coordinates of 64 bits, and so is VTP, in base64. STL is binary, with coordinates of 32 bits.
///
/// # Errors
/// If the ending does not identify a format, the format cannot hold a coordinate, or the file cannot be
/// written; see [`WriteError`].
///
/// # Panics
/// If there are fewer positions than the mesh has vertices.
pub fn write(path: &Path, positions: &[[f64; 3]], mesh: &TriangleMesh) -> Result<(), WriteError> {
    let format = Format::from_extension(path).ok_or_else(|| WriteError::UnknownFormat {
        path: path.to_owned(),
    })?;
    if format == Format::Stl
        && let Some((vertex, axis)) = beyond_single_precision(positions)
    {
        return Err(WriteError::OutOfRange {
            path: path.to_owned(),
            vertex,
            axis,
        });
    }
    replace_file(path, |out| write_to(out, format, positions, mesh)).map_err(|error| {
        WriteError::Unwritable {
            path: path.to_owned(),
            error,
        }
    })
}

/// Writes a mesh in a format, as [`write()`] does; in STL, numbers outside the range of 32 bits become
/// infinite.
///
/// # Errors
/// Any error of `out`.
///
/// # Panics
/// If there are fewer positions than the mesh has vertices.
pub fn write_to(
    out: &mut dyn Write,
    format: Format,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
) -> io::Result<()> {
    let positions = &positions[..mesh.vertex_count()];
    match format {
        Format::Obj => obj::write(out, positions, mesh.triangles()),
        Format::Off => off::write(out, positions, mesh.triangles()),
        Format::Stl => stl::write(out, positions, mesh.triangles()),
        Format::Ply => ply::write(out, positions, mesh.triangles()),
        Format::Vtp => vtp::write(out, positions, mesh.triangles()),
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
