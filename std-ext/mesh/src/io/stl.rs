//! Stereolithography files, ASCII and binary.
//!
//! Source: 3D Systems, Stereolithography Interface Specification (1989). A binary file has a header of 80
//! bytes, the number n of faces (u32), and 50 bytes per face, little endian: a normal and three corners
//! (f32), and 2 bytes of attributes. Normals are skipped.

use std::io::{self, Write};

use glam::DVec3;

use super::text::Text;
use super::weld::Weld;
use super::{MeshBuilder, ParseError, Position, Problem, Unknown, finite, without_mark};

/// The header and the number of faces, and one face, in bytes.
const HEADER: usize = 84;
const FACE: usize = 50;

/// Number of faces in the header of a binary file, if the file is long enough for a header.
fn announced_faces(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.first_chunk()?;
    Some(u64::from(u32::from_le_bytes(*count)))
}

/// Whether a file has this number of faces. Some programs add bytes, which are skipped; but if they are whole faces,
/// the number in the header is wrong.
fn is_complete(faces: u64, bytes: &[u8]) -> bool {
    let end = HEADER as u64 + FACE as u64 * faces;
    let after = usize::try_from(end).ok().and_then(|end| bytes.get(end..));
    after.is_some_and(|after| {
        let is_padding = !after.len().is_multiple_of(FACE) || after.iter().all(|&byte| byte == 0);
        after.is_empty() || (faces > 0 && is_padding)
    })
}

pub(super) fn parse(bytes: &[u8], unknown: Unknown) -> Result<MeshBuilder, ParseError> {
    // A binary header may start with `solid` too, so the length decides.
    match announced_faces(bytes) {
        Some(faces) if is_complete(faces, bytes) => binary(bytes, faces as usize, unknown),
        Some(faces) if bytes.contains(&0) => {
            let length = bytes.len();
            Err(Problem::WrongLength { faces, length }.anywhere())
        }
        _ => ascii(without_mark(bytes), unknown),
    }
}

fn binary(bytes: &[u8], faces: usize, unknown: Unknown) -> Result<MeshBuilder, ParseError> {
    let mut builder = MeshBuilder::new(0);
    builder.reserve(faces / 2, faces, bytes.len());
    let mut weld = Weld::default();
    let records = bytes[HEADER..].chunks_exact(FACE).take(faces);
    for (face, record) in records.enumerate() {
        let position = Position::Byte(HEADER + FACE * face);
        let mut numbers = record[12..48].chunks_exact(4).map(|number| {
            let mut bytes = [0; 4];
            bytes.copy_from_slice(number);
            f32::from_le_bytes(bytes)
        });
        let mut corners = [0; 3];
        for corner in &mut corners {
            let mut point = [0.0; 3];
            for ((axis, coordinate), number) in point.iter_mut().enumerate().zip(&mut numbers) {
                *coordinate = finite(f64::from(number), axis, unknown, || number.to_string())
                    .map_err(|problem| problem.at(position, Some(builder.next_face())))?;
            }
            *corner = weld.vertex(point, &mut builder.positions);
        }
        builder.add_face(&corners, position);
    }
    Ok(builder)
}

/// Writes binary STL. The header must not start with `solid`, because other readers would take the
/// file for a text.
pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    out.write_all(&[0; HEADER - 4])?;
    // The limit of a mesh is below 2³².
    out.write_all(&(triangles.len() as u32).to_le_bytes())?;
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| DVec3::from(positions[vertex as usize]));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for point in [normal, a, b, c] {
            for coordinate in point.to_array() {
                out.write_all(&(coordinate as f32).to_le_bytes())?;
            }
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

fn ascii(bytes: &[u8], unknown: Unknown) -> Result<MeshBuilder, ParseError> {
    let mut text = Text::new(bytes).with_unknown(unknown);
    let mut builder = MeshBuilder::new(0);
    let mut weld = Weld::default();
    keyword(&mut text, "solid", "`solid` (or a binary STL file)")?;
    loop {
        let word = text.statement();
        if is(word, "facet") {
            let position = text.position();
            let face = builder.next_face();
            keyword(&mut text, "outer", "`outer loop`")?;
            let mut corners = [0; 3];
            for corner in &mut corners {
                keyword(&mut text, "vertex", "`vertex`")?;
                let first = text.word();
                let point = text.coordinates(first, face)?;
                *corner = weld.vertex(point, &mut builder.positions);
            }
            keyword(&mut text, "endloop", "`endloop`")?;
            keyword(&mut text, "endfacet", "`endfacet`")?;
            builder.add_face(&corners, position);
        } else if is(word, "endsolid") {
            // Another solid may follow.
            match text.statement() {
                None => return Ok(builder),
                word if is(word, "solid") => {}
                word => return Err(text.expected("`solid` or the end of the file", word, None)),
            }
        } else {
            return Err(text.expected("`facet` or `endsolid`", word, None));
        }
    }
}

/// Checks that the next statement starts with this keyword.
fn keyword(text: &mut Text<'_>, keyword: &str, expected: &'static str) -> Result<(), ParseError> {
    match text.statement() {
        word if is(word, keyword) => Ok(()),
        word => Err(text.expected(expected, word, None)),
    }
}

/// Whether a word is this keyword, in upper or lower case.
fn is(word: Option<&[u8]>, keyword: &str) -> bool {
    word.is_some_and(|word| word.eq_ignore_ascii_case(keyword.as_bytes()))
}
