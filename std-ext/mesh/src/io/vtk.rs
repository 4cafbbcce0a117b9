//! Common parts of VTK's XML files: named fields and the storage of numbers.
//!
//! Numbers are stored as base64 of their bytes, little endian, so that a file is plain XML and
//! keeps every bit. Source: *VTK file formats* (docs.vtk.org, XML formats).

use super::replace_file;
use super::write::write_blocks;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use std::collections::BTreeSet;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A named quantity at every point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointField<'a> {
    /// Its name, which is unique within a file.
    pub name: &'a str,
    /// One entry per point; values that are not finite are kept.
    pub values: PointValues<'a>,
}

/// The values of a [`PointField`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointValues<'a> {
    /// One number per point.
    Scalars(&'a [f64]),
    /// One number of 32 bits per point.
    Scalars32(&'a [f32]),
    /// One vector per point.
    Vectors(&'a [[f64; 3]]),
    /// One vector of numbers of 32 bits per point.
    Vectors32(&'a [[f32; 3]]),
    /// One colour per point: red, green and blue.
    Colours(&'a [[u8; 3]]),
}

/// Reason why a surface or a grid could not be written. The message is one line that starts with the
/// name of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtkError {
    /// A list does not have one entry per point.
    #[error("{}: {what} has {found} entries: there are {expected} {places}", path.display())]
    CountMismatch {
        /// The file.
        path: PathBuf,
        /// The list of positions, or the field.
        what: String,
        /// The number of entries.
        found: usize,
        /// The expected number.
        expected: usize,
        /// Their places: `vertices` or `points`.
        places: &'static str,
    },
    /// A name that XML cannot hold, or an empty one.
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
    #[error("{}: two fields are called `{name}`: names must be unique", path.display())]
    RepeatedName {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// A grid without points, or with an invalid spacing.
    #[error(
        "{}: the grid of {counts:?} points with spacings {spacings:?}: counts have to be 1 or more, \
         spacings above 0, and all numbers finite", path.display()
    )]
    Grid {
        /// The file.
        path: PathBuf,
        /// Numbers of points along the axes.
        counts: [usize; 3],
        /// Distances from one point to the next along the axes.
        spacings: [f64; 3],
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

/// Checks that a list has one entry for each place.
pub(super) fn check_count(
    path: &Path,
    what: fmt::Arguments<'_>,
    found: usize,
    (expected, places): (usize, &'static str),
) -> Result<(), VtkError> {
    if found == expected {
        return Ok(());
    }
    Err(VtkError::CountMismatch {
        path: path.to_owned(),
        what: what.to_string(),
        found,
        expected,
        places,
    })
}

/// Checks that fields have unique names and one entry for each place.
pub(super) fn check_fields(
    path: &Path,
    fields: &[PointField<'_>],
    places: (usize, &'static str),
) -> Result<(), VtkError> {
    let mut names = BTreeSet::new();
    for PointField { name, values } in fields {
        check_count(path, format_args!("field `{name}`"), values.len(), places)?;
        let (path, name) = (path.to_owned(), (*name).to_owned());
        if !is_printable(&name) {
            return Err(VtkError::Name { path, name });
        }
        if !names.insert(name.clone()) {
            return Err(VtkError::RepeatedName { path, name });
        }
    }
    Ok(())
}

/// Writes a VTK file completely or not at all: a data set of the given kind, with its time.
pub(super) fn write_data(
    path: &Path,
    kind: &str,
    attributes: &str,
    time: Option<f64>,
    pieces: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), VtkError> {
    replace_file(path, |out| {
        write_document(out, kind, attributes, time, pieces)
    })
    .map_err(|error| VtkError::Unwritable {
        path: path.to_owned(),
        error,
    })
}

/// Writes the text of such a file.
pub(super) fn write_document(
    out: &mut dyn Write,
    kind: &str,
    attributes: &str,
    time: Option<f64>,
    pieces: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#
    )?;
    writeln!(out, "<{kind}{attributes}>")?;
    if let Some(time) = time {
        writeln!(out, "<FieldData>")?;
        let attributes = r#"Name="TimeValue" NumberOfTuples="1""#;
        array(out, attributes, std::iter::once(time))?;
        writeln!(out, "</FieldData>")?;
    }
    pieces(out)?;
    writeln!(out, "</{kind}>\n</VTKFile>")
}

/// Writes the fields of a piece at its points (`PointData`) or triangles (`CellData`).
pub(super) fn named_fields(
    out: &mut dyn Write,
    section: &str,
    fields: &[PointField<'_>],
) -> io::Result<()> {
    writeln!(out, "<{section}>")?;
    for field in fields {
        field.values.write(out, field.name)?;
    }
    writeln!(out, "</{section}>")
}

fn is_printable(name: &str) -> bool {
    let noncharacter = |c| matches!(c, '\u{fffe}' | '\u{ffff}');
    !name.trim().is_empty() && !name.chars().any(|c| c.is_control() || noncharacter(c))
}

impl PointValues<'_> {
    /// Number of entries.
    fn len(&self) -> usize {
        match self {
            Self::Scalars(values) => values.len(),
            Self::Scalars32(values) => values.len(),
            Self::Vectors(values) => values.len(),
            Self::Vectors32(values) => values.len(),
            Self::Colours(values) => values.len(),
        }
    }

    pub(super) fn write(&self, out: &mut dyn Write, name: &str) -> io::Result<()> {
        let scalar = format!(r#"Name="{}""#, Escaped(name));
        let vector = format!(r#"{scalar} NumberOfComponents="3""#);
        match self {
            Self::Scalars(values) => array(out, &scalar, values.iter().copied()),
            Self::Scalars32(values) => array(out, &scalar, values.iter().copied()),
            Self::Vectors(values) => array(out, &vector, values.iter().flatten().copied()),
            Self::Vectors32(values) => array(out, &vector, values.iter().flatten().copied()),
            Self::Colours(values) => array(out, &vector, values.iter().flatten().copied()),
        }
    }
}

/// A number type with its VTK name and storage.
pub(super) trait StoredArray: Copy {
    const TYPE: &str;
    type Bytes: AsRef<[u8]>;
    fn bytes(self) -> Self::Bytes;
}

macro_rules! stored {
    ($number:ty, $name:literal) => {
        impl StoredArray for $number {
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
stored!(u8, "UInt8");

/// Writes a `DataArray`: the number of bytes as 64 bits, followed by the bytes, in one run of base64.
pub(super) fn array<N: StoredArray>(
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
    write_blocks(&mut encoder, values.map(N::bytes))?;
    encoder.finish()?;
    drop(encoder);
    writeln!(out, "</DataArray>")
}

/// A text to be escaped inside a quoted attribute.
pub(super) struct Escaped<'a>(pub(super) &'a str);

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
