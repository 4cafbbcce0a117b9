//! Polygon File Format (Stanford), ASCII and binary.
//!
//! Source: G. Turk, The PLY Polygon File Format (1994). A text header declares elements, each with
//! a number and a list of properties; the body holds them one after the other. This reader uses the
//! properties `x`, `y`, `z` of the element `vertex` and the list `vertex_indices` (or
//! `vertex_index`) of the element `face`, and skips all others.

use super::text::{Text, parsed};
use super::{Builder, CORNER, Element, MeshFile, ParseError, Position, Problem, finite};
use std::io::{self, Write};

pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile, ParseError> {
    let mut text = Text::new(bytes);
    let (encoding, groups) = header(&mut text)?;
    match encoding {
        Encoding::Ascii => {
            let mut body = Ascii { text, first: None };
            let builder = elements(&mut body, &groups, bytes.len())?;
            body.text.end_of_file()?;
            builder.finish()
        }
        Encoding::Binary(order) => {
            let rest = text.rest();
            let mut body = Binary {
                bytes,
                at: bytes.len() - rest.len(),
                order,
                ended: false,
            };
            let builder = elements(&mut body, &groups, rest.len())?;
            body.end_of_file()?;
            builder.finish()
        }
    }
}

pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "element vertex {}", positions.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property double {axis}")?;
    }
    writeln!(out, "element face {}", triangles.len())?;
    // `int` instead of `uint`, because every reader knows it; the limit of a mesh is below 2³¹.
    writeln!(out, "property list uchar int vertex_indices\nend_header")?;
    for coordinate in positions.iter().flatten() {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    for triangle in triangles {
        out.write_all(&[3])?;
        for vertex in triangle {
            out.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

#[derive(Clone, Copy)]
enum ByteOrder {
    Little,
    Big,
}

/// An element in the sense of the header: a number of records with the same properties.
struct Group {
    role: Role,
    count: usize,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, PartialEq)]
enum Role {
    Vertex,
    Face,
    Other,
}

enum Property {
    /// A coordinate of a vertex, by axis.
    Coordinate(usize, Scalar),
    /// The list of a face's corners.
    Corners { length: Scalar, item: Scalar },
    /// Something to skip.
    Scalar(Scalar),
    /// A list to skip.
    List { length: Scalar, item: Scalar },
}

#[derive(Clone, Copy, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Its length in bytes.
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

fn header(text: &mut Text<'_>) -> Result<(Encoding, Vec<Group>), ParseError> {
    match text.statement() {
        Some(b"ply") => {}
        word => return Err(text.expected("the header `ply`", word, None)),
    }
    match text.statement() {
        Some(b"format") => {}
        word => return Err(text.expected("`format`", word, None)),
    }
    let encoding = match text.word() {
        Some(b"ascii") => Encoding::Ascii,
        Some(b"binary_little_endian") => Encoding::Binary(ByteOrder::Little),
        Some(b"binary_big_endian") => Encoding::Binary(ByteOrder::Big),
        word => {
            let expected = "ascii, binary_little_endian or binary_big_endian";
            return Err(text.expected(expected, word, None));
        }
    };
    let mut groups = Vec::<Group>::new();
    loop {
        match text.statement() {
            Some(b"comment" | b"obj_info") => {}
            Some(b"element") => groups.push(group(text)?),
            Some(b"property") => match groups.last_mut() {
                Some(group) => {
                    let property = property(text, group.role)?;
                    group.properties.push(property);
                }
                None => return Err(text.expected("`element` first", Some(b"property"), None)),
            },
            Some(b"end_header") => break,
            word => {
                let expected = "`element`, `property`, `comment` or `end_header`";
                return Err(text.expected(expected, word, None));
            }
        }
    }
    match undeclared(&groups) {
        Some(missing) => Err(Problem::Undeclared { missing }.at(text.position(), None)),
        None => Ok((encoding, groups)),
    }
}

fn group(text: &mut Text<'_>) -> Result<Group, ParseError> {
    let role = match text.word() {
        Some(b"vertex") => Role::Vertex,
        Some(b"face") => Role::Face,
        Some(_) => Role::Other,
        None => return Err(text.expected("the element's name", None, None)),
    };
    let word = text.word();
    let count = parsed(word).ok_or_else(|| text.expected("the number of elements", word, None))?;
    Ok(Group {
        role,
        count,
        properties: Vec::new(),
    })
}

fn property(text: &mut Text<'_>, role: Role) -> Result<Property, ParseError> {
    const NAME: &str = "the property's name";
    let word = text.word();
    if word == Some(b"list") {
        let length = text.word();
        let length = integer(length, text)?;
        let item = text.word();
        return match text.word() {
            Some(b"vertex_indices" | b"vertex_index") if role == Role::Face => {
                let item = integer(item, text)?;
                Ok(Property::Corners { length, item })
            }
            Some(_) => {
                let item = scalar(item, text)?;
                Ok(Property::List { length, item })
            }
            None => Err(text.expected(NAME, None, None)),
        };
    }
    let kind = scalar(word, text)?;
    let axis = match text.word() {
        Some(b"x") => Some(0),
        Some(b"y") => Some(1),
        Some(b"z") => Some(2),
        Some(_) => None,
        None => return Err(text.expected(NAME, None, None)),
    };
    Ok(match axis {
        Some(axis) if role == Role::Vertex => Property::Coordinate(axis, kind),
        _ => Property::Scalar(kind),
    })
}

fn scalar(word: Option<&[u8]>, text: &Text<'_>) -> Result<Scalar, ParseError> {
    word.and_then(Scalar::named)
        .ok_or_else(|| text.expected("a type such as float, double, uchar or int", word, None))
}

fn integer(word: Option<&[u8]>, text: &Text<'_>) -> Result<Scalar, ParseError> {
    word.and_then(Scalar::named)
        .filter(|kind| kind.is_integer())
        .ok_or_else(|| text.expected("an integer type such as uchar or int", word, None))
}

/// The first declaration that a mesh needs and the header lacks.
fn undeclared(groups: &[Group]) -> Option<&'static str> {
    for (role, missing) in [
        (Role::Vertex, "element `vertex`"),
        (Role::Face, "element `face`"),
    ] {
        if !groups.iter().any(|group| group.role == role) {
            return Some(missing);
        }
    }
    for group in groups {
        let has_axis = |wanted: usize| {
            let mut properties = group.properties.iter();
            properties.any(
                |property| matches!(property, Property::Coordinate(axis, _) if *axis == wanted),
            )
        };
        let has_corners = || {
            let mut properties = group.properties.iter();
            properties.any(|property| matches!(property, Property::Corners { .. }))
        };
        match group.role {
            Role::Vertex if !has_axis(0) => return Some("property `x` of element `vertex`"),
            Role::Vertex if !has_axis(1) => return Some("property `y` of element `vertex`"),
            Role::Vertex if !has_axis(2) => return Some("property `z` of element `vertex`"),
            Role::Face if !has_corners() => {
                return Some("property `list … vertex_indices` of element `face`");
            }
            _ => {}
        }
    }
    None
}

/// The part of a file behind its header, value by value. `element` is the one that is being read,
/// for error messages.
trait Body {
    /// Starts a record.
    fn begin(&mut self, element: Option<Element>) -> Result<(), ParseError>;
    /// The current position.
    fn position(&self) -> Position;
    fn coordinate(
        &mut self,
        axis: usize,
        kind: Scalar,
        element: Element,
    ) -> Result<f64, ParseError>;
    fn corner(&mut self, kind: Scalar, element: Element) -> Result<u32, ParseError>;
    fn length(&mut self, kind: Scalar, element: Option<Element>) -> Result<usize, ParseError>;
    fn skip(
        &mut self,
        kind: Scalar,
        count: usize,
        element: Option<Element>,
    ) -> Result<(), ParseError>;
    /// Finishes a record.
    fn end(&mut self, element: Option<Element>) -> Result<(), ParseError>;
    /// Whether the last error was that there is nothing left.
    fn has_ended(&self) -> bool;
}

/// Reads all groups; `length` is the body's, in bytes.
fn elements(body: &mut impl Body, groups: &[Group], length: usize) -> Result<Builder, ParseError> {
    let mut builder = Builder::new(0);
    let mut corners = Vec::new();
    for group in groups {
        let what = match group.role {
            Role::Vertex => {
                builder.reserve(group.count, 0, length);
                "vertices"
            }
            Role::Face => {
                builder.reserve(0, group.count, length);
                "faces"
            }
            Role::Other => "elements",
        };
        // Elements without properties take no bytes, so their number is not limited by the length
        // of the file.
        let count = if group.properties.is_empty() {
            0
        } else {
            group.count
        };
        for found in 0..count {
            if let Err(error) = element(body, group, &mut corners, &mut builder) {
                return Err(if body.has_ended() {
                    Problem::truncated(what, count, found).at(body.position(), None)
                } else {
                    error
                });
            }
        }
    }
    Ok(builder)
}

/// Reads one record of a group.
fn element(
    body: &mut impl Body,
    group: &Group,
    corners: &mut Vec<u32>,
    builder: &mut Builder,
) -> Result<(), ParseError> {
    let vertex = builder.next_vertex();
    let face = builder.next_face();
    let element = match group.role {
        Role::Vertex => Some(vertex),
        Role::Face => Some(face),
        Role::Other => None,
    };
    body.begin(element)?;
    let position = body.position();
    let mut point = [0.0; 3];
    for property in &group.properties {
        match *property {
            Property::Coordinate(axis, kind) => {
                point[axis] = body.coordinate(axis, kind, vertex)?
            }
            Property::Corners { length, item } => {
                corners.clear();
                for _ in 0..body.length(length, element)? {
                    corners.push(body.corner(item, face)?);
                }
            }
            Property::Scalar(kind) => body.skip(kind, 1, element)?,
            Property::List { length, item } => {
                let count = body.length(length, element)?;
                body.skip(item, count, element)?;
            }
        }
    }
    body.end(element)?;
    match group.role {
        Role::Vertex => builder.positions.push(point),
        Role::Face => builder.add_face(corners, position)?,
        Role::Other => {}
    }
    Ok(())
}

const LIST_LENGTH: &str = "a list's length";

/// A body with one element per line.
struct Ascii<'a> {
    text: Text<'a>,
    /// The line's first word, until it is used.
    first: Option<&'a [u8]>,
}

impl<'a> Ascii<'a> {
    fn word(&mut self) -> Option<&'a [u8]> {
        self.first.take().or_else(|| self.text.word())
    }
}

impl Body for Ascii<'_> {
    fn begin(&mut self, element: Option<Element>) -> Result<(), ParseError> {
        self.first = self.text.statement();
        match self.first {
            Some(_) => Ok(()),
            None => Err(self.text.expected("an element", None, element)),
        }
    }

    fn position(&self) -> Position {
        self.text.position()
    }

    fn coordinate(&mut self, axis: usize, _: Scalar, element: Element) -> Result<f64, ParseError> {
        let word = self.word();
        self.text.coordinate(axis, word, element)
    }

    fn corner(&mut self, _: Scalar, element: Element) -> Result<u32, ParseError> {
        let word = self.word();
        parsed(word).ok_or_else(|| self.text.expected(CORNER, word, Some(element)))
    }

    fn length(&mut self, _: Scalar, element: Option<Element>) -> Result<usize, ParseError> {
        let word = self.word();
        parsed(word).ok_or_else(|| self.text.expected(LIST_LENGTH, word, element))
    }

    fn skip(
        &mut self,
        _: Scalar,
        count: usize,
        element: Option<Element>,
    ) -> Result<(), ParseError> {
        for _ in 0..count {
            if self.word().is_none() {
                return Err(self.text.expected("another property", None, element));
            }
        }
        Ok(())
    }

    fn end(&mut self, element: Option<Element>) -> Result<(), ParseError> {
        match self.word() {
            None => Ok(()),
            word => Err(self.text.expected("the end of the line", word, element)),
        }
    }

    fn has_ended(&self) -> bool {
        self.text.has_ended()
    }
}

/// A binary body: records without separators.
struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    order: ByteOrder,
    ended: bool,
}

impl Binary<'_> {
    /// The next N bytes, the least significant first.
    #[inline]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let Some(bytes) = self.bytes[self.at..].first_chunk::<N>() else {
            self.ended = true;
            return None;
        };
        self.at += N;
        let mut bytes = *bytes;
        if matches!(self.order, ByteOrder::Big) {
            bytes.reverse();
        }
        Some(bytes)
    }

    #[inline]
    fn integer(&mut self, kind: Scalar) -> Option<i64> {
        Some(match kind {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            // Not reached: headers in which a list length or a corner has such a type are refused.
            Scalar::F32 | Scalar::F64 => return None,
        })
    }

    #[inline]
    fn real(&mut self, kind: Scalar) -> Option<f64> {
        match kind {
            Scalar::F32 => self.take().map(|bytes| f32::from_le_bytes(bytes).into()),
            Scalar::F64 => self.take().map(f64::from_le_bytes),
            // At most 32 bits: exact.
            _ => self.integer(kind).map(|number| number as f64),
        }
    }

    #[cold]
    fn expected(
        &self,
        expected: &'static str,
        number: Option<i64>,
        element: Option<Element>,
    ) -> ParseError {
        let found = match number {
            Some(number) => number.to_string(),
            None => "the end of the file".to_owned(),
        };
        Problem::Expected { expected, found }.at(self.position(), element)
    }

    /// Nothing more than white space, which some programs append.
    fn end_of_file(&self) -> Result<(), ParseError> {
        let rest = &self.bytes[self.at..];
        if rest.iter().all(u8::is_ascii_whitespace) {
            return Ok(());
        }
        let expected = "the end of the file";
        let found = format!("{} bytes more", rest.len());
        Err(Problem::Expected { expected, found }.at(self.position(), None))
    }
}

impl Body for Binary<'_> {
    fn begin(&mut self, _: Option<Element>) -> Result<(), ParseError> {
        Ok(())
    }

    fn position(&self) -> Position {
        Position::Byte(self.at)
    }

    #[inline]
    fn coordinate(
        &mut self,
        axis: usize,
        kind: Scalar,
        element: Element,
    ) -> Result<f64, ParseError> {
        let position = self.position();
        let value = self
            .real(kind)
            .ok_or_else(|| self.expected("a coordinate", None, Some(element)))?;
        finite(value, axis, || value.to_string())
            .map_err(|problem| problem.at(position, Some(element)))
    }

    #[inline]
    fn corner(&mut self, kind: Scalar, element: Element) -> Result<u32, ParseError> {
        let number = self.integer(kind);
        number
            .and_then(|number| number.try_into().ok())
            .ok_or_else(|| self.expected(CORNER, number, Some(element)))
    }

    #[inline]
    fn length(&mut self, kind: Scalar, element: Option<Element>) -> Result<usize, ParseError> {
        let number = self.integer(kind);
        number
            .and_then(|number| number.try_into().ok())
            .ok_or_else(|| self.expected(LIST_LENGTH, number, element))
    }

    #[inline]
    fn skip(
        &mut self,
        kind: Scalar,
        count: usize,
        element: Option<Element>,
    ) -> Result<(), ParseError> {
        let left = self.bytes.len() - self.at;
        match count.checked_mul(kind.size()) {
            Some(length) if length <= left => {
                self.at += length;
                Ok(())
            }
            _ => {
                self.ended = true;
                Err(self.expected("another property", None, element))
            }
        }
    }

    fn end(&mut self, _: Option<Element>) -> Result<(), ParseError> {
        Ok(())
    }

    fn has_ended(&self) -> bool {
        self.ended
    }
}
