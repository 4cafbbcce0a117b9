//! Wavefront OBJ.
//!
//! Source: Wavefront Technologies, Advanced Visualizer manual, appendix B1: "Object Files".

use super::text::{Text, parsed};
use super::{MeshBuilder, ParseError, Problem, Unknown};
use std::io::{self, Write};

pub(super) fn parse(bytes: &[u8], unknown: Unknown) -> Result<MeshBuilder, ParseError> {
    let mut text = Text::joining_lines(bytes).with_unknown(unknown);
    let mut builder = MeshBuilder::new(1);
    let mut corners = Vec::new();
    while let Some(keyword) = text.statement() {
        match keyword {
            // A weight or a colour may follow.
            b"v" => {
                let first = text.word();
                let point = text.coordinates(first, builder.next_vertex())?;
                builder.positions.push(point);
            }
            b"f" => {
                let position = text.position();
                corners.clear();
                while let Some(word) = text.word() {
                    corners.push(corner(word, &text, &builder)?);
                }
                builder.add_face(&corners, position);
            }
            // Normals, groups, materials, lines, free-form surfaces and extensions are skipped.
            _ if keyword[0].is_ascii_alphabetic() => {}
            _ => {
                let expected = "an OBJ keyword such as v or f";
                return Err(text.expected(expected, Some(keyword), None));
            }
        }
    }
    Ok(builder)
}

pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    for (vertex, [x, y, z]) in positions.iter().enumerate() {
        write!(out, "v {x:?} {y:?} {z:?}")?;
        if let Some(colours) = colours {
            let [r, g, b] = colours[vertex].map(|part| f32::from(part) / 255.0);
            write!(out, " {r:?} {g:?} {b:?}")?;
        }
        writeln!(out)?;
    }
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Vertex, from 0, of a corner `i`, `i/t`, `i//n` or `i/t/n`; i counts from 1, or backwards from −1 for the
/// last vertex so far.
#[inline]
fn corner(word: &[u8], text: &Text<'_>, builder: &MeshBuilder) -> Result<u32, ParseError> {
    let end = word.iter().position(|&byte| byte == b'/');
    let vertices = builder.positions.len();
    let number: Option<i64> = parsed(Some(&word[..end.unwrap_or(word.len())]));
    let vertex = match number {
        Some(number) if number > 0 => number - 1,
        Some(number) if number < 0 && number.unsigned_abs() <= vertices as u64 => {
            vertices as i64 + number
        }
        Some(number) => {
            let problem = Problem::VertexOutOfRange {
                vertex: number,
                vertices,
                first: 1,
            };
            return Err(problem.at(text.position(), Some(builder.next_face())));
        }
        None => -1,
    };
    u32::try_from(vertex).map_err(|_| {
        let expected = "a vertex number from 1 to 4294967296, or from -1 downwards";
        text.expected(expected, Some(word), Some(builder.next_face()))
    })
}
