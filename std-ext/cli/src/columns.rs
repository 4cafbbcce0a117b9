//! Mesh files with the numbers of their vertices and triangles.

use crate::terminal::{Failure, say};
use helfrich::TriangleMesh;
use helfrich_std::io::{
    Column, ColumnPlace, Format, PointField, PointValues, WriteError, write, write_vtp_with_cells,
};
use std::path::Path;

/// Writes a mesh with its columns, if the format keeps them; otherwise names what is left out.
pub(crate) fn write_with_columns(
    output: &Path,
    positions: &[[f64; 3]],
    mesh: &TriangleMesh,
    columns: &[Column],
) -> Result<(), Failure> {
    if Format::from_extension(output) == Some(Format::Vtp) {
        let [vertices, cells] = [ColumnPlace::Vertices, ColumnPlace::Triangles];
        let [vertices, cells] = [vertices, cells].map(|place| fields(columns, place));
        return write_vtp_with_cells(output, mesh, positions, None, &vertices, &cells)
            .map_err(|error| Failure::Output(error.to_string()));
    }
    saved(write(output, positions, mesh))?;
    if !columns.is_empty() {
        let names = columns.iter().map(|column| column.name.as_str());
        let names = Vec::from_iter(names).join(", ");
        say(format_args!(
            "note: {}: left out: the numbers {names}, which .vtp files keep",
            output.display()
        ));
    }
    Ok(())
}

/// The failure of a mesh that was not written.
pub(crate) fn saved(written: Result<(), WriteError>) -> Result<(), Failure> {
    written.map_err(|error| match error {
        WriteError::Unwritable { .. } => Failure::Output(error.to_string()),
        _ => Failure::input(error),
    })
}

/// The columns at one kind of places as fields, the first of each name.
fn fields(columns: &[Column], place: ColumnPlace) -> Vec<PointField<'_>> {
    let mut fields: Vec<PointField<'_>> = Vec::new();
    for column in columns.iter().filter(|column| column.place == place) {
        if fields.iter().all(|field| field.name != column.name) {
            fields.push(PointField {
                name: &column.name,
                values: PointValues::Scalars(&column.values),
            });
        }
    }
    fields
}
