//! Data as CSV.

use crate::execute::{available_threads, in_parts};
use crate::io::push_fields;
use crate::measurement::{Column, ColumnValues, verdict_name};
use crate::method::Fields;
use crate::series::quoted;
use crate::study::Row;
use helfrich::Real;
use std::any::Any;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::ops::Range;

/// Writes a line for each quantity of a method on a mesh, under the names of the fields of [`Row`].
/// Numbers have enough digits to be identified. A field is empty if the value is unknown or the options
/// are the defaults; an error is `inf` if a vertex has no result.
///
/// # Errors
/// If `out` cannot be written to.
pub fn study_csv(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    let known = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
    writeln!(
        out,
        "shape,family,vertices,method,options,scalar,quantity,max,mean,order_max,order_mean,\
         ns_per_vertex,ns_scatter,bytes_per_vertex"
    )?;
    for row in rows {
        let options = quoted(&row.options.to_string());
        writeln!(
            out,
            "{},{},{},{},{options},{},{},{:?},{:?},{},{},{:?},{:?},{}",
            row.shape,
            row.family,
            row.vertices,
            row.method,
            row.scalar,
            row.quantity.symbol(),
            row.max,
            row.mean,
            known(row.order_max),
            known(row.order_mean),
            row.ns_per_vertex,
            row.ns_scatter,
            known(row.bytes_per_vertex),
        )?;
    }
    Ok(())
}

/// Writes a line for each vertex, with the header `vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz` and
/// the names of the columns `more`, for vectors with `_x`, `_y` and `_z`. Numbers have enough digits to
/// identify every f64; fields are empty where the value is unknown.
///
/// # Errors
/// If `out` cannot be written to.
pub fn curvature_csv<T: Real>(
    positions: &[[T; 3]],
    fields: &Fields<T>,
    more: &[Column],
    out: &mut dyn Write,
) -> io::Result<()> {
    write!(out, "vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz")?;
    for Column { name, values } in more {
        match values {
            ColumnValues::Vectors(_) => write!(out, ",{name}_x,{name}_y,{name}_z")?,
            _ => write!(out, ",{name}")?,
        }
    }
    writeln!(out)?;
    let threads = available_threads().get();
    // Rows are written in order; only a bounded number of them is formatted at a time.
    let mut texts = vec![String::new(); threads];
    for start in (0..positions.len()).step_by(threads * ROWS_OF_A_THREAD) {
        let ranges = (start..positions.len()).step_by(ROWS_OF_A_THREAD);
        let ranges = ranges.map(|first| first..positions.len().min(first + ROWS_OF_A_THREAD));
        let work = Vec::from_iter(texts.iter_mut().zip(ranges));
        let count = work.len();
        in_parts(work.into_iter(), &|(text, range): (
            &mut String,
            Range<usize>,
        )| {
            text.clear();
            for vertex in range {
                push_row(text, vertex, positions[vertex], fields, more);
            }
        });
        for text in &texts[..count] {
            out.write_all(text.as_bytes())?;
        }
    }
    Ok(())
}

/// The number of rows that a thread formats at a time: about two megabytes of text.
const ROWS_OF_A_THREAD: usize = 8192;

/// Appends the line of a vertex.
fn push_row<T: Real>(
    text: &mut String,
    vertex: usize,
    position: [T; 3],
    fields: &Fields<T>,
    more: &[Column],
) {
    let normal = fields.normal[vertex];
    let has_normal = normal.iter().any(|component| !component.is_zero());
    let _ = write!(text, "{vertex}");
    push_known(text, &position.map(Some));
    push_known(text, &[Some(fields.area[vertex])]);
    push_known(
        text,
        &normal.map(|component| has_normal.then_some(component)),
    );
    let [mean, gaussian, laplacian] =
        [&fields.mean, &fields.gaussian, &fields.laplacian_of_mean].map(|values| values[vertex]);
    push_known(text, &[mean, gaussian, laplacian]);
    let density = fields.force_density[vertex];
    push_known(
        text,
        &density.map_or([None; 3], |density| density.map(Some)),
    );
    for Column { values, .. } in more {
        // A bar that is not known is infinite, which is not the same as none.
        let known = |value: f64| (!value.is_nan()).then_some(value);
        match values {
            ColumnValues::Scalars(values) => push_fields(text, &[known(values[vertex])]),
            ColumnValues::Vectors(values) => push_fields(text, &values[vertex].map(known)),
            ColumnValues::Verdicts(verdicts) => {
                text.push(',');
                text.push_str(verdict_name(verdicts[vertex]));
            }
        }
    }
    text.push('\n');
}

/// Appends a comma and a number with enough digits for each, or only the comma if the number is unknown.
fn push_known<T: Real, const N: usize>(text: &mut String, values: &[Option<T>; N]) {
    if let Some(numbers) = (values as &dyn Any).downcast_ref::<[Option<f64>; N]>() {
        return push_fields(text, numbers);
    }
    for value in values {
        text.push(',');
        if let Some(value) = value {
            let _ = write!(text, "{value:?}");
        }
    }
}
