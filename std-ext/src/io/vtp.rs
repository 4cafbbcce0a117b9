//! Surfaces with fields as VTK PolyData files (`.vtp`), and the index of a run (`.pvd`).
//!
//! Numbers are stored as base64 of their bytes, little endian, so that a file is plain XML and
//! keeps every bit. Sources: *VTK file formats* (docs.vtk.org, XML formats, PolyData) and the
//! ParaView guide for the collection.

use super::replace_file;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use helfrich::TriangleMesh;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A named quantity at every vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointField<'a> {
    /// What it is called; no two fields of a file may share a name.
    pub name: &'a str,
    /// One entry a vertex; values that are not finite are kept.
    pub values: PointValues<'a>,
}

/// The values of a [`PointField`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointValues<'a> {
    /// A number a vertex.
    Scalars(&'a [f64]),
    /// A number of 32 bits a vertex.
    Scalars32(&'a [f32]),
    /// A vector a vertex.
    Vectors(&'a [[f64; 3]]),
    /// A vector of numbers of 32 bits a vertex.
    Vectors32(&'a [[f32; 3]]),
}

/// Why a surface could not be written. The message is one line that starts with the file's name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtpError {
    /// Something has not one entry a vertex.
    #[error("{}: {what} has {found} entries: the mesh has {vertices} vertices", path.display())]
    CountMismatch {
        /// The file.
        path: PathBuf,
        /// `positions`, or the field.
        what: String,
        /// How many entries there are.
        found: usize,
        /// How many there should be.
        vertices: usize,
    },
    /// A name that XML cannot hold, or none.
    #[error(
        "{}: the name {name:?} of a field is empty or has a control character: a printable name is \
         needed", path.display()
    )]
    Name {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// Two fields have the same name.
    #[error("{}: two fields are called `{name}`: each needs a name of its own", path.display())]
    RepeatedName {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// The operating system refused to write the file.
    #[error("{}: {error}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        error: io::Error,
    },
}

/// Writes a surface and fields at its vertices as a whole or not at all. `time` is what viewers
/// show as the time of the file.
///
/// # Errors
/// If positions or a field have not one entry a vertex, a field's name is empty, taken or
/// unprintable, or the file cannot be written; see [`VtpError`].
pub fn write_vtp(
    path: &Path,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    time: Option<f64>,
    fields: &[PointField<'_>],
) -> Result<(), VtpError> {
    let path_buf = || path.to_owned();
    let vertices = mesh.vertex_count();
    let count = |what: fmt::Arguments<'_>, found| match found {
        found if found == vertices => Ok(()),
        found => Err(VtpError::CountMismatch {
            path: path_buf(),
            what: what.to_string(),
            found,
            vertices,
        }),
    };
    count(format_args!("the list of positions"), positions.len())?;
    let mut names = BTreeSet::new();
    for PointField { name, values } in fields {
        count(format_args!("field `{name}`"), values.len())?;
        let name = || (*name).to_owned();
        if !is_printable(&name()) {
            return Err(VtpError::Name {
                path: path_buf(),
                name: name(),
            });
        }
        if !names.insert(name()) {
            return Err(VtpError::RepeatedName {
                path: path_buf(),
                name: name(),
            });
        }
    }
    replace_file(path, |out| {
        poly_data(out, mesh.triangles(), positions, time, fields)
    })
    .map_err(|error| VtpError::Unwritable {
        path: path_buf(),
        error,
    })
}

fn is_printable(name: &str) -> bool {
    let noncharacter = |c| matches!(c, '\u{fffe}' | '\u{ffff}');
    !name.trim().is_empty() && !name.chars().any(|c| c.is_control() || noncharacter(c))
}

impl PointValues<'_> {
    /// How many vertices there are values for.
    fn len(&self) -> usize {
        match self {
            Self::Scalars(values) => values.len(),
            Self::Scalars32(values) => values.len(),
            Self::Vectors(values) => values.len(),
            Self::Vectors32(values) => values.len(),
        }
    }

    fn write(&self, out: &mut dyn Write, name: &str) -> io::Result<()> {
        let scalar = format!(r#"Name="{}""#, Escaped(name));
        let vector = format!(r#"{scalar} NumberOfComponents="3""#);
        match self {
            Self::Scalars(values) => array(out, &scalar, values.iter().copied()),
            Self::Scalars32(values) => array(out, &scalar, values.iter().copied()),
            Self::Vectors(values) => array(out, &vector, values.iter().flatten().copied()),
            Self::Vectors32(values) => array(out, &vector, values.iter().flatten().copied()),
        }
    }
}

fn poly_data(
    out: &mut dyn Write,
    triangles: &[[u32; 3]],
    positions: &[[f64; 3]],
    time: Option<f64>,
    fields: &[PointField<'_>],
) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#
    )?;
    writeln!(out, "<PolyData>")?;
    if let Some(time) = time {
        writeln!(out, "<FieldData>")?;
        let attributes = r#"Name="TimeValue" NumberOfTuples="1""#;
        array(out, attributes, std::iter::once(time))?;
        writeln!(out, "</FieldData>")?;
    }
    writeln!(
        out,
        r#"<Piece NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}">"#,
        positions.len(),
        triangles.len()
    )?;
    writeln!(out, "<PointData>")?;
    for field in fields {
        field.values.write(out, field.name)?;
    }
    writeln!(out, "</PointData>\n<Points>")?;
    PointValues::Vectors(positions).write(out, "Points")?;
    writeln!(out, "</Points>\n<Polys>")?;
    let corners = triangles.iter().flatten().map(|&vertex| i64::from(vertex));
    array(out, r#"Name="connectivity""#, corners)?;
    let ends = (1..=triangles.len() as i64).map(|triangle| 3 * triangle);
    array(out, r#"Name="offsets""#, ends)?;
    writeln!(out, "</Polys>\n</Piece>\n</PolyData>\n</VTKFile>")
}

/// A number as VTK names and stores it.
trait Stored: Copy {
    const TYPE: &str;
    type Bytes: AsRef<[u8]>;
    fn bytes(self) -> Self::Bytes;
}

macro_rules! stored {
    ($number:ty, $name:literal) => {
        impl Stored for $number {
            const TYPE: &str = $name;
            type Bytes = [u8; size_of::<$number>()];
            fn bytes(self) -> Self::Bytes {
                self.to_le_bytes()
            }
        }
    };
}

stored!(f64, "Float64");
stored!(f32, "Float32");
stored!(i64, "Int64");

/// A `DataArray`: the number of bytes as 64 bits and the bytes, in one run of base64.
fn array<N: Stored>(
    out: &mut dyn Write,
    attributes: &str,
    values: impl Iterator<Item = N> + Clone,
) -> io::Result<()> {
    write!(
        out,
        r#"<DataArray type="{}" {attributes} format="binary">"#,
        N::TYPE
    )?;
    let bytes = values.clone().count() * size_of::<N>();
    let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
    encoder.write_all(&(bytes as u64).to_le_bytes())?;
    for value in values {
        encoder.write_all(value.bytes().as_ref())?;
    }
    encoder.finish()?;
    drop(encoder);
    writeln!(out, "</DataArray>")
}

/// A text inside a quoted attribute.
struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                c => write!(f, "{c}")?,
            }
        }
        Ok(())
    }
}

/// The files of a run with their times, as the index (`.pvd`) that ParaView opens.
///
/// It is plain data, so that a checkpoint can hold it: a run that is resumed goes on with the list
/// that it had there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Collection {
    /// In the order in which they were written.
    pub entries: Vec<CollectionEntry>,
}

/// One file of a [`Collection`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CollectionEntry {
    /// The time of the file; several surfaces at one time are several entries.
    pub time: f64,
    /// Which of the surfaces, from 0.
    pub part: usize,
    /// The file's name, relative to the index, with `/` between folders.
    pub file: String,
}

impl Collection {
    /// Writes the index as a whole or not at all: whenever a run is killed, there is a valid one.
    ///
    /// # Errors
    /// Whatever the operating system says of the folder, the file or the disk.
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
