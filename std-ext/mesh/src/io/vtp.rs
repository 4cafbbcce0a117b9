//! Surfaces with fields as VTK PolyData files (`.vtp`), read and written, and the index of a run
//! (`.pvd`).
//!
//! Sources: *VTK file formats* (docs.vtk.org, XML formats, PolyData) and the ParaView guide for the
//! collection.

mod array;
mod compressor;
mod parts;
mod read;

pub(super) use read::parse;

use super::replace_file;
use super::vtk::{
    Escaped, PointField, PointValues, VtkError, array, check_count, check_fields, named_fields,
    write_data, write_document,
};
use helfrich::TriangleMesh;
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;

/// Writes a surface and fields at its vertices, completely or not at all. Viewers show `time` as the
/// time of the file.
///
/// # Errors
/// If positions or a field do not have one entry per vertex, a field's name is empty, taken or
/// unprintable, or the file cannot be written; see [`VtkError`].
pub fn write_vtp(
    path: &Path,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    time: Option<f64>,
    fields: &[PointField<'_>],
) -> Result<(), VtkError> {
    write_vtp_with_cells(path, mesh, positions, time, fields, &[])
}

/// Writes a surface and fields at its vertices, as [`write_vtp`], and `cells`, fields at its triangles.
///
/// # Errors
/// As [`write_vtp`]; also if a field of `cells` does not have one entry per triangle.
pub fn write_vtp_with_cells(
    path: &Path,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    time: Option<f64>,
    fields: &[PointField<'_>],
    cells: &[PointField<'_>],
) -> Result<(), VtkError> {
    check(path, mesh, positions, fields, cells)?;
    write_data(path, "PolyData", "", time, |out| {
        piece(out, mesh.triangles(), positions, fields, cells)
    })
}

/// Writes a surface and fields at its vertices, as [`write_vtp`]; `name` begins the messages.
///
/// # Errors
/// As [`write_vtp`]; any error of `out` instead of those of files.
pub fn write_vtp_to(
    out: &mut dyn Write,
    name: &Path,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    fields: &[PointField<'_>],
) -> Result<(), VtkError> {
    check(name, mesh, positions, fields, &[])?;
    let written = write_document(out, "PolyData", "", None, |out| {
        piece(out, mesh.triangles(), positions, fields, &[])
    });
    written.map_err(|error| VtkError::Unwritable {
        path: name.to_owned(),
        error,
    })
}

/// Checks the numbers of positions and of the values of fields, and the names of these.
fn check(
    path: &Path,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    fields: &[PointField<'_>],
    cells: &[PointField<'_>],
) -> Result<(), VtkError> {
    let vertices = (mesh.vertex_count(), "vertices");
    let what = format_args!("the list of positions");
    check_count(path, what, positions.len(), vertices)?;
    check_fields(path, fields, vertices)?;
    check_fields(path, cells, (mesh.triangles().len(), "triangles"))
}

/// Writes a surface without fields, as one of the mesh formats, and the colours of its vertices if there are any.
pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    let field = colours.map(|colours| PointField {
        name: "RGB",
        values: PointValues::Colours(colours),
    });
    write_document(out, "PolyData", "", None, |out| {
        piece(out, triangles, positions, field.as_slice(), &[])
    })
}

fn piece(
    out: &mut dyn Write,
    triangles: &[[u32; 3]],
    positions: &[[f64; 3]],
    fields: &[PointField<'_>],
    cells: &[PointField<'_>],
) -> io::Result<()> {
    writeln!(
        out,
        r#"<Piece NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}">"#,
        positions.len(),
        triangles.len()
    )?;
    named_fields(out, "PointData", fields)?;
    if !cells.is_empty() {
        named_fields(out, "CellData", cells)?;
    }
    writeln!(out, "<Points>")?;
    PointValues::Vectors(positions).write(out, "Points")?;
    writeln!(out, "</Points>\n<Polys>")?;
    let corners = triangles.iter().flatten().map(|&vertex| i64::from(vertex));
    array(out, r#"Name="connectivity""#, corners)?;
    let ends = (1..=triangles.len() as i64).map(|triangle| 3 * triangle);
    array(out, r#"Name="offsets""#, ends)?;
    writeln!(out, "</Polys>\n</Piece>")
}

/// Files of a run with their times: the index (`.pvd`) that ParaView opens.
///
/// It is plain data, so that a checkpoint can contain it and a resumed run continues the list.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Collection {
    /// The entries in the order of writing.
    pub entries: Vec<CollectionEntry>,
}

/// One file of a [`Collection`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CollectionEntry {
    /// The time of the file; several surfaces at one time are several entries.
    pub time: f64,
    /// The index of the surface, from 0.
    pub part: usize,
    /// The file's name, relative to the index, with `/` between folders.
    pub file: String,
}

impl Collection {
    /// Writes the index completely or not at all, so that a killed run leaves a valid one.
    ///
    /// # Errors
    /// Any error of the operating system for the folder, the file or the disk.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        replace_file(path, |out| {
            writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
            writeln!(
                out,
                r#"<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">"#
            )?;
            writeln!(out, "<Collection>")?;
            for CollectionEntry { time, part, file } in &self.entries {
                writeln!(
                    out,
                    r#"<DataSet timestep="{time:?}" group="" part="{part}" file="{}"/>"#,
                    Escaped(file)
                )?;
            }
            writeln!(out, "</Collection>\n</VTKFile>")
        })
    }
}
