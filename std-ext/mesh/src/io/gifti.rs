//! GIFTI: surfaces of brains.
//!
//! Source: GIFTI Surface Data Format 1.0 (NITRC, 2011). An XML file has arrays with an intent: coordinates, triangles,
//! and numbers at the vertices. Coordinates are those of the file; transformations to other coordinate systems are
//! not applied.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::DataFormat;

use super::number::Number;
use super::tokens::Tokens;
use super::xml::{Tag, Tags, line_of};
use super::{
    Budget, Column, ColumnPlace, Columns, Element, MeshBuilder, ParseError, Parsed, Position,
    Problem, Reading, finite, gzip,
};

/// The storage of numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum TextEncoding {
    Text,
    Base64,
    Compressed,
}

/// An array of a file.
struct Array<'a> {
    file: &'a [u8],
    /// The byte of its data, whose line is counted only for messages.
    at: usize,
    intent: &'a str,
    name: Option<String>,
    number: Number,
    counts: [usize; 2],
    is_by_column: bool,
    encoding: TextEncoding,
    is_big_endian: bool,
    data: &'a [u8],
}

pub(super) fn parse(bytes: &[u8], reading: Reading<'_>) -> Result<Parsed, ParseError> {
    let arrays = arrays(bytes)?;
    let budget = Budget::new(reading.length, true);
    let of_intent = |intent, missing| {
        let mut arrays = arrays.iter();
        let found = arrays.find(|array| array.intent == intent && array.counts[1] == 3);
        found.ok_or_else(|| Problem::Undeclared { missing }.anywhere())
    };
    let points = of_intent(
        "NIFTI_INTENT_POINTSET",
        "array of points (NIFTI_INTENT_POINTSET)",
    )?;
    let faces = of_intent(
        "NIFTI_INTENT_TRIANGLE",
        "array of triangles (NIFTI_INTENT_TRIANGLE)",
    )?;
    let mut builder = MeshBuilder::new(0);
    for row in points.numbers(&budget)?.as_chunks::<3>().0 {
        let vertex = builder.positions.len();
        let mut point = *row;
        for (axis, coordinate) in point.iter_mut().enumerate() {
            let value = *coordinate;
            *coordinate = finite(value, axis, reading.unknown, || value.to_string())
                .map_err(|problem| problem.at(points.position(), Some(Element::Vertex(vertex))))?;
        }
        builder.positions.push(point);
    }
    let vertices = builder.positions.len();
    let here = faces.position();
    for row in faces.numbers(&budget)?.as_chunks::<3>().0 {
        if let Some(&vertex) = row
            .iter()
            .find(|&&vertex| !(0.0..vertices as f64).contains(&vertex))
        {
            let problem = Problem::VertexOutOfRange {
                vertex: vertex as i64,
                vertices,
                first: 0,
            };
            return Err(problem.at(here, Some(builder.next_face())));
        }
        builder.add_face(&row.map(|vertex| vertex as u32), here);
    }
    let mut columns = Vec::new();
    if reading.columns == Columns::Read {
        for array in &arrays {
            let is_of_surface = ["POINTSET", "TRIANGLE", "NODE_INDEX"]
                .iter()
                .any(|name| array.intent.ends_with(name));
            if is_of_surface || array.counts != [vertices, 1] {
                continue;
            }
            let intent = array.intent.trim_start_matches("NIFTI_INTENT_");
            let name = array.name.clone();
            columns.push(Column {
                name: name.unwrap_or_else(|| intent.to_lowercase()),
                place: ColumnPlace::Vertices,
                values: array.numbers(&budget)?,
            });
        }
    }
    Ok((builder, columns))
}

/// The arrays of a file, without their numbers.
fn arrays(bytes: &[u8]) -> Result<Vec<Array<'_>>, ParseError> {
    let mut tags = Tags::new(bytes);
    let mut arrays: Vec<Array<'_>> = Vec::new();
    let (mut is_gifti, mut is_name) = (false, false);
    while let Some(tag) = tags.next()? {
        match tag.name {
            b"GIFTI" => is_gifti = true,
            _ if !is_gifti => return Err(wrong(bytes, &tag, "the tag GIFTI", "another tag")),
            b"DataArray" if !tag.closes => arrays.push(array(bytes, &tag)?),
            b"Name" if !tag.closes => is_name = text(bytes, &tag) == "Name",
            b"Value" if !tag.closes && is_name => {
                if let Some(array) = arrays.last_mut() {
                    array.name = Some(text(bytes, &tag)).filter(|name| !name.is_empty());
                }
                is_name = false;
            }
            b"Data" if !tag.closes => {
                if let Some(array) = arrays.last_mut() {
                    let content = &bytes[tag.end..];
                    let end = content.iter().position(|&byte| byte == b'<');
                    array.data = &content[..end.unwrap_or(content.len())];
                    array.at = tag.start;
                }
            }
            _ => {}
        }
    }
    Ok(arrays)
}

/// The text behind a tag, which may be marked as such: `<![CDATA[…]]>`.
fn text(bytes: &[u8], tag: &Tag<'_>) -> String {
    /// The longest name.
    const LONGEST: usize = 1000;
    let rest = &bytes[tag.end..bytes.len().min(tag.end + LONGEST)];
    let (rest, end) = match rest.trim_ascii_start().strip_prefix(b"<![CDATA[") {
        Some(marked) => (marked, &b"]]>"[..]),
        None => (rest, &b"<"[..]),
    };
    let length = rest.windows(end.len()).position(|here| here == end);
    String::from_utf8_lossy(&rest[..length.unwrap_or(0)])
        .trim()
        .to_owned()
}

fn wrong(bytes: &[u8], tag: &Tag<'_>, expected: &'static str, found: &str) -> ParseError {
    let shown = String::from_iter(found.chars().take(40));
    let found = format!("`{}`", shown.escape_debug());
    Problem::Expected { expected, found }.at(line_of(bytes, tag.start), None)
}

fn array<'a>(bytes: &'a [u8], tag: &Tag<'a>) -> Result<Array<'a>, ParseError> {
    let of = |name| tag.attribute(name).unwrap_or("none");
    let number = match of("DataType") {
        "NIFTI_TYPE_UINT8" => Number::Unsigned(1),
        "NIFTI_TYPE_INT8" => Number::Signed(1),
        "NIFTI_TYPE_UINT16" => Number::Unsigned(2),
        "NIFTI_TYPE_INT16" => Number::Signed(2),
        "NIFTI_TYPE_UINT32" => Number::Unsigned(4),
        "NIFTI_TYPE_INT32" => Number::Signed(4),
        "NIFTI_TYPE_UINT64" => Number::Unsigned(8),
        "NIFTI_TYPE_INT64" => Number::Signed(8),
        "NIFTI_TYPE_FLOAT32" => Number::Float(4),
        "NIFTI_TYPE_FLOAT64" => Number::Float(8),
        found => {
            return Err(wrong(
                bytes,
                tag,
                "a type such as NIFTI_TYPE_FLOAT32",
                found,
            ));
        }
    };
    let count = |name, least| match tag.attribute(name) {
        None => Ok(least),
        Some(text) => text
            .trim()
            .parse()
            .map_err(|_| wrong(bytes, tag, "a number of entries", text)),
    };
    let mut counts = [count("Dim0", 0)?, 1];
    for name in ["Dim1", "Dim2", "Dim3", "Dim4", "Dim5"] {
        counts[1] = usize::saturating_mul(counts[1], count(name, 1)?);
    }
    Ok(Array {
        file: bytes,
        at: tag.start,
        intent: of("Intent"),
        name: None,
        number,
        counts,
        is_by_column: of("ArrayIndexingOrder") == "ColumnMajorOrder",
        // Early files have other names.
        encoding: match of("Encoding") {
            "ASCII" | "GIFTI_ENCODING_ASCII" => TextEncoding::Text,
            "Base64Binary" | "GIFTI_ENCODING_B64BIN" => TextEncoding::Base64,
            "GZipBase64Binary" | "GIFTI_ENCODING_B64GZ" => TextEncoding::Compressed,
            found => {
                let expected = "the encoding ASCII, Base64Binary or GZipBase64Binary";
                return Err(wrong(bytes, tag, expected, found));
            }
        },
        is_big_endian: of("Endian").to_ascii_uppercase().contains("BIG"),
        data: b"",
    })
}

impl Array<'_> {
    fn position(&self) -> Position {
        line_of(self.file, self.at)
    }

    /// The numbers, row by row.
    fn numbers(&self, budget: &Budget) -> Result<Vec<f64>, ParseError> {
        let [rows, columns] = self.counts;
        let count = rows.saturating_mul(columns);
        let damaged = || {
            let problem = Problem::Expected {
                expected: "as many numbers as the dimensions of the array",
                found: "fewer, or damaged ones".to_owned(),
            };
            problem.at(self.position(), None)
        };
        if self.encoding == TextEncoding::Text {
            let mut tokens = Tokens::new(self.data);
            let numbers = tokens.floats(count, self.number, "a number");
            return Ok(self.by_rows(numbers.map_err(|_| damaged())?));
        }
        let text = self.data.iter().filter(|byte| !byte.is_ascii_whitespace());
        let bytes = STANDARD.decode(Vec::from_iter(text.copied()));
        let mut bytes = bytes.map_err(|_| damaged())?;
        if self.encoding == TextEncoding::Compressed {
            let mut whole = Vec::new();
            gzip::inflated(&bytes, DataFormat::Zlib, budget, &mut whole)
                .map_err(|problem| problem.at(self.position(), None))?
                .ok_or_else(damaged)?;
            bytes = whole;
        }
        let size = self.number.size();
        if bytes.len() / size < count {
            return Err(damaged());
        }
        budget
            .take(count)
            .map_err(|problem| problem.at(self.position(), None))?;
        let stored = bytes.chunks_exact(size).take(count);
        let numbers = stored.map(|stored| self.number.float(stored, self.is_big_endian));
        Ok(self.by_rows(numbers.collect()))
    }

    fn by_rows(&self, numbers: Vec<f64>) -> Vec<f64> {
        let [rows, columns] = self.counts;
        if !self.is_by_column {
            return numbers;
        }
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| row + rows * column));
        places.map(|place| numbers[place]).collect()
    }
}
