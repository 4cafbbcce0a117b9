//! Fields on regular grids as VTK ImageData files (`.vti`).
//!
//! Source: *VTK file formats* (docs.vtk.org, XML formats, ImageData). Grids with other axes than the
//! coordinates need VTK 9; older readers show the grid along x, y and z.

use super::vtk::{PointField, VtkError, check_fields, named_fields, write_data};
use glam::DVec3;
use std::path::Path;

/// Points at equal distances along three axes. A plane has one point along the third.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The first point.
    pub origin: [f64; 3],
    /// Unit vectors, perpendicular to each other and right-handed.
    pub axes: [[f64; 3]; 3],
    /// The spacing along each axis.
    pub spacings: [f64; 3],
    /// The number of points along each axis.
    pub counts: [usize; 3],
}

impl Grid {
    /// A grid along x, y and z.
    pub const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// The number of points.
    pub fn point_count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Positions of all points, in the order of fields: the first axis varies fastest.
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        let steps = [0, 1, 2].map(|axis| self.spacings[axis] * DVec3::from(self.axes[axis]));
        let [columns, rows, _] = self.counts;
        (0..self.point_count()).map(move |at| {
            let [x, y, z] =
                [at % columns, at / columns % rows, at / columns / rows].map(|count| count as f64);
            (DVec3::from(self.origin) + x * steps[0] + y * steps[1] + z * steps[2]).to_array()
        })
    }

    fn is_valid(&self) -> bool {
        let numbers = self.axes.as_flattened().iter().chain(&self.origin);
        let finite = numbers
            .chain(&self.spacings)
            .all(|number| number.is_finite());
        let apart = self.spacings.iter().all(|&spacing| spacing > 0.0);
        finite && apart && self.counts.iter().all(|&count| count > 0)
    }
}

/// Writes fields at the points of a grid, completely or not at all. Viewers show `time` as the time of
/// the file.
///
/// # Errors
/// If the grid is invalid, a field does not have one entry per point, a field's name is empty, taken or
/// unprintable, or the file cannot be written; see [`VtkError`].
pub fn write_vti(
    path: &Path,
    grid: &Grid,
    time: Option<f64>,
    fields: &[PointField<'_>],
) -> Result<(), VtkError> {
    if !grid.is_valid() {
        return Err(VtkError::Grid {
            path: path.to_owned(),
            counts: grid.counts,
            spacings: grid.spacings,
        });
    }
    check_fields(path, fields, (grid.point_count(), "points"))?;
    let joined = |numbers: &[f64]| {
        let numbers = numbers.iter().map(|number| format!("{number:?}"));
        Vec::from_iter(numbers).join(" ")
    };
    let [x, y, z] = grid.counts.map(|count| count - 1);
    let extent = format!("0 {x} 0 {y} 0 {z}");
    // VTK expects the matrix row by row; its columns are the axes.
    let [a, b, c] = grid.axes;
    let direction = [0, 1, 2].map(|row| [a[row], b[row], c[row]]);
    let attributes = format!(
        r#" WholeExtent="{extent}" Origin="{}" Spacing="{}" Direction="{}""#,
        joined(&grid.origin),
        joined(&grid.spacings),
        joined(direction.as_flattened())
    );
    write_data(path, "ImageData", &attributes, time, |out| {
        writeln!(out, r#"<Piece Extent="{extent}">"#)?;
        named_fields(out, "PointData", fields)?;
        writeln!(out, "</Piece>")
    })
}
