//! Object File Format.
//!
//! Source: Geomview manual, "OFF Files". This reader expects one vertex or face per line, as all known
//! programs write them.

use super::text::{Text, parsed};
use super::{CORNER, MeshBuilder, ParseError, Problem, Unknown};
use std::io::{self, Write};

/// Whether a word is the header of an OFF text with three coordinates: `OFF` after any of `ST` (texture), `C`
/// (colour) and `N` (normal), whose columns follow those of the position.
pub(super) fn is_header(word: &[u8]) -> bool {
    let rest = word.strip_prefix(b"ST").unwrap_or(word);
    let rest = rest.strip_prefix(b"C").unwrap_or(rest);
    let rest = rest.strip_prefix(b"N").unwrap_or(rest);
    rest == b"OFF"
}

pub(super) fn parse(bytes: &[u8], unknown: Unknown) -> Result<MeshBuilder, ParseError> {
    let mut text = Text::new(bytes).with_unknown(unknown);
    let header = text.statement();
    if !header.is_some_and(is_header) {
        return Err(text.expected("the header OFF, COFF, NOFF or STOFF", header, None));
    }
    // The counts are on the header's line or on the next.
    let vertices = match text.word() {
        None => text.statement(),
        word => word,
    };
    let vertices = count("the number of vertices", vertices, &text)?;
    let faces = text.word();
    let faces = count("the number of faces", faces, &text)?;

    let mut builder = MeshBuilder::new(0);
    builder.reserve(vertices, faces, bytes.len());
    for found in 0..vertices {
        let element = builder.next_vertex();
        let Some(word) = text.statement() else {
            let problem = Problem::truncated("vertices", vertices, found);
            return Err(problem.at(text.position(), None));
        };
        // Normals, colours and texture coordinates may follow.
        let point = text.coordinates(Some(word), element)?;
        builder.positions.push(point);
    }
    let mut corners = Vec::new();
    for found in 0..faces {
        let element = builder.next_face();
        let Some(word) = text.statement() else {
            let problem = Problem::truncated("faces", faces, found);
            return Err(problem.at(text.position(), None));
        };
        let position = text.position();
        let length: usize = parsed(Some(word)).ok_or_else(|| {
            text.expected("the number of a face's corners", Some(word), Some(element))
        })?;
        corners.clear();
        for _ in 0..length {
            let word = text.word();
            corners.push(parsed(word).ok_or_else(|| text.expected(CORNER, word, Some(element)))?);
        }
        // A colour may follow.
        builder.add_face(&corners, position);
    }
    text.end_of_file()?;
    Ok(builder)
}

pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    // The number of edges may be 0, because readers ignore it.
    let header = if colours.is_some() { "COFF" } else { "OFF" };
    writeln!(out, "{header}\n{} {} 0", positions.len(), triangles.len())?;
    for (vertex, [x, y, z]) in positions.iter().enumerate() {
        write!(out, "{x:?} {y:?} {z:?}")?;
        if let Some(colours) = colours {
            let [r, g, b] = colours[vertex];
            write!(out, " {r} {g} {b} 255")?;
        }
        writeln!(out)?;
    }
    for [a, b, c] in triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

fn count(what: &'static str, word: Option<&[u8]>, text: &Text<'_>) -> Result<usize, ParseError> {
    parsed(word).ok_or_else(|| text.expected(what, word, None))
}
