//! Data as CSV.

use crate::measurement::{Column, ColumnValues, verdict_name};
use crate::method::Fields;
use crate::series::quoted;
use crate::study::Row;
use helfrich::Real;
use std::io::{self, Write};

/// Writes a line for each quantity of a method on a mesh, under the names of the fields of [`Row`];
/// numbers with as many digits as tell them from every other. An empty field is one that is not known,
/// or options by default; an error is `inf` where a vertex has no result.
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

/// Writes a line for each vertex, with the header
/// `vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz` and the names of `more` columns, for vectors with `_x`,
/// `_y` and `_z`; numbers with enough digits to identify every f64, and empty fields where nothing is known.
///
/// # Errors
/// If `out` cannot be written to.
pub fn curvature_csv<T: Real>(
    positions: &[[T; 3]],
    fields: &Fields<T>,
    more: &[Column],
    out: &mut dyn Write,
) -> io::Result<()> {
    let all = |values: Option<[T; 3]>| match values {
        // `{:?}` and not `{}`, which writes 1e-18 with 18 zeros.
        Some([x, y, z]) => format!("{x:?},{y:?},{z:?}"),
        None => ",,".to_owned(),
    };
    let one = |value: Option<T>| value.map_or_else(String::new, |value| format!("{value:?}"));
    write!(out, "vertex,x,y,z,area,nx,ny,nz,H,K,LapH,fx,fy,fz")?;
    for Column { name, values } in more {
        match values {
            ColumnValues::Vectors(_) => write!(out, ",{name}_x,{name}_y,{name}_z")?,
            _ => write!(out, ",{name}")?,
        }
    }
    writeln!(out)?;
    for (vertex, &position) in positions.iter().enumerate() {
        let normal = fields.normal[vertex];
        let has_normal = normal.iter().any(|component| !component.is_zero());
        write!(
            out,
            "{vertex},{},{:?},{},{},{},{},{}",
            all(Some(position)),
            fields.area[vertex],
            all(has_normal.then_some(normal)),
            one(fields.mean[vertex]),
            one(fields.gaussian[vertex]),
            one(fields.laplacian_of_mean[vertex]),
            all(fields.force_density[vertex]),
        )?;
        for Column { values, .. } in more {
            match values {
                ColumnValues::Scalars(values) => write!(out, ",{}", number(values[vertex]))?,
                ColumnValues::Vectors(values) => {
                    let [x, y, z] = values[vertex].map(number);
                    write!(out, ",{x},{y},{z}")?;
                }
                ColumnValues::Verdicts(verdicts) => {
                    write!(out, ",{}", verdict_name(verdicts[vertex]))?;
                }
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A number with enough digits; nothing if it is not known.
fn number(value: f64) -> String {
    match value.is_finite() {
        true => format!("{value:?}"),
        false => String::new(),
    }
}
