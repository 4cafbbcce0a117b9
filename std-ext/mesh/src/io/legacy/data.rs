//! Numbers at the points and cells of legacy files.

use super::super::number::Number;
use super::super::tokens::Tokens;
use super::super::{Column, ColumnPlace, ParseError, Position};
use super::{keyword, number};

const NUMBER: &str = "a number";
const NAME: &str = "the name of an array";

/// The type of numbers with a name of legacy files.
pub(super) fn named(word: Option<&[u8]>) -> Option<Number> {
    Some(match keyword(word).as_str() {
        "FLOAT" => Number::Float(4),
        "DOUBLE" => Number::Float(8),
        "CHAR" | "SIGNED_CHAR" => Number::Signed(1),
        "SHORT" => Number::Signed(2),
        // The type of indices has 32 bits here, whatever VTK computes with.
        "INT" | "VTKIDTYPE" => Number::Signed(4),
        "LONG" | "LONG_LONG" | "VTKTYPEINT64" => Number::Signed(8),
        "UNSIGNED_CHAR" => Number::Unsigned(1),
        "UNSIGNED_SHORT" => Number::Unsigned(2),
        "UNSIGNED_INT" => Number::Unsigned(4),
        "UNSIGNED_LONG" | "UNSIGNED_LONG_LONG" | "VTKTYPEUINT64" => Number::Unsigned(8),
        _ => return None,
    })
}

/// The columns so far, with the places of their arrays.
type Arrays = Vec<(Position, Column)>;

/// The place of arrays, and the number of its points or cells.
type At = Option<(ColumnPlace, usize)>;

/// Reads a section of numbers at points or cells, which begins with this word.
pub(super) fn read(
    tokens: &mut Tokens<'_>,
    word: &[u8],
    at: At,
    columns: &mut Arrays,
) -> Result<(), ParseError> {
    let count = at.map_or(0, |(_, count)| count);
    let section = keyword(Some(word));
    match section.as_str() {
        "METADATA" => {
            // Up to an empty line.
            tokens.line();
            while tokens.line().is_some_and(|line| !line.is_empty()) {}
            return Ok(());
        }
        "FIELD" => {
            named_word(tokens)?;
            let arrays: usize = tokens.parsed("the number of arrays")?;
            for _ in 0..arrays {
                field_array(tokens, at, columns)?;
            }
            return Ok(());
        }
        "SCALARS"
        | "COLOR_SCALARS"
        | "LOOKUP_TABLE"
        | "VECTORS"
        | "NORMALS"
        | "TENSORS"
        | "TENSORS6"
        | "TEXTURE_COORDINATES"
        | "GLOBAL_IDS"
        | "PEDIGREE_IDS"
        | "EDGE_FLAGS" => {}
        _ => return Err(tokens.expected("a keyword such as POINTS or POLYGONS", Some(word), None)),
    }
    let name = named_word(tokens)?;
    // Colours are bytes in binary files.
    let bytes = Number::Unsigned(1);
    let (count, components, kind) = match section.as_str() {
        "SCALARS" => {
            let kind = tokens.word();
            let rest = tokens.line().unwrap_or_default();
            let components = match rest {
                b"" => 1,
                rest => super::super::text::parsed(Some(rest))
                    .ok_or_else(|| tokens.expected("a number of components", Some(rest), None))?,
            };
            if keyword(tokens.peek()) == "LOOKUP_TABLE" {
                tokens.word();
                tokens.line();
            }
            return array(tokens, (name, kind), (count, components), at, columns);
        }
        "COLOR_SCALARS" => (count, tokens.parsed("a number of components")?, bytes),
        "LOOKUP_TABLE" => (tokens.parsed("the size of a table")?, 4, bytes),
        "TEXTURE_COORDINATES" => (
            count,
            tokens.parsed("a number of components")?,
            number(tokens)?,
        ),
        "TENSORS" => (count, 9, number(tokens)?),
        "TENSORS6" => (count, 6, number(tokens)?),
        "VECTORS" | "NORMALS" => (count, 3, number(tokens)?),
        _ => {
            let kind = tokens.word();
            tokens.line();
            return array(tokens, (name, kind), (count, 1), at, columns);
        }
    };
    tokens.line();
    skip(tokens, count, components, kind)
}

/// A name, in which spaces and other letters may be written as `%20`.
fn named_word(tokens: &mut Tokens<'_>) -> Result<String, ParseError> {
    let word = tokens.word();
    let word = word.ok_or_else(|| tokens.expected(NAME, None, None))?;
    let mut name = Vec::new();
    let mut rest = word;
    while let [first, after @ ..] = rest {
        let code = after.get(..2).and_then(|code| str::from_utf8(code).ok());
        let code = code.and_then(|code| u8::from_str_radix(code, 16).ok());
        match code {
            Some(code) if *first == b'%' => {
                name.push(code);
                rest = &after[2..];
            }
            _ => {
                name.push(*first);
                rest = after;
            }
        }
    }
    Ok(String::from_utf8_lossy(&name).into_owned())
}

/// An array of a section `FIELD`.
fn field_array(tokens: &mut Tokens<'_>, at: At, columns: &mut Arrays) -> Result<(), ParseError> {
    while keyword(tokens.peek()) == "METADATA" {
        let word = tokens.word().unwrap_or_default();
        read(tokens, word, at, columns)?;
    }
    let name = named_word(tokens)?;
    let components = tokens.parsed("a number of components")?;
    let count = tokens.parsed("a number of tuples")?;
    let kind = tokens.word();
    tokens.line();
    array(tokens, (name, kind), (count, components), at, columns)
}

/// The numbers of an array; those of one component become a column.
fn array(
    tokens: &mut Tokens<'_>,
    (name, kind): (String, Option<&[u8]>),
    (count, components): (usize, usize),
    at: At,
    columns: &mut Arrays,
) -> Result<(), ParseError> {
    let position = tokens.position();
    if let (Some((place, _)), 1, Some(number)) = (at, components, named(kind)) {
        let values = tokens.floats(count, number, NUMBER)?;
        let column = Column {
            name,
            place,
            values,
        };
        columns.push((position, column));
        return Ok(());
    }
    match (keyword(kind).as_str(), tokens.binary) {
        ("BIT", Some(_)) => {
            let bytes = count.saturating_mul(components).div_ceil(8);
            let skipped = tokens.skip(bytes);
            skipped.ok_or_else(|| tokens.expected(NUMBER, None, None))
        }
        ("BIT", None) => skip(tokens, count, components, Number::Unsigned(1)),
        ("STRING", None) => {
            for _ in 0..count.saturating_mul(components) {
                let line = tokens.line();
                line.ok_or_else(|| tokens.expected("a text", None, None))?;
            }
            Ok(())
        }
        ("STRING", Some(_)) => texts(tokens, count.saturating_mul(components)),
        _ => {
            let number = named(kind);
            let expected = "a type such as float or int";
            let number = number.ok_or_else(|| tokens.expected(expected, kind, None))?;
            skip(tokens, count, components, number)
        }
    }
}

/// Skips numbers.
fn skip(
    tokens: &mut Tokens<'_>,
    count: usize,
    components: usize,
    kind: Number,
) -> Result<(), ParseError> {
    let numbers = count.saturating_mul(components);
    if tokens.binary.is_some() {
        let skipped = tokens.skip(numbers.saturating_mul(kind.size()));
        return skipped.ok_or_else(|| tokens.expected(NUMBER, None, None));
    }
    for _ in 0..numbers {
        let word = tokens.word();
        word.ok_or_else(|| tokens.expected(NUMBER, None, None))?;
    }
    Ok(())
}

/// Skips binary texts. The upper two bits of each first byte tell how many bytes their length has.
fn texts(tokens: &mut Tokens<'_>, count: usize) -> Result<(), ParseError> {
    const LENGTH: &str = "the length of a text";
    for _ in 0..count {
        let first = tokens.integer(Number::Unsigned(1), LENGTH)?;
        let more = [7, 3, 1, 0][(first >> 6) as usize];
        let mut length = (first & 0x3f) as usize;
        for _ in 0..more {
            let next = tokens.integer(Number::Unsigned(1), LENGTH)?;
            length = length << 8 | next as usize;
        }
        let skipped = tokens.skip(length);
        skipped.ok_or_else(|| tokens.expected("a text", None, None))?;
    }
    Ok(())
}
