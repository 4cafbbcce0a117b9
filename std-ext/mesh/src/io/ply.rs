//! Polygon File Format (Stanford), ASCII and binary.
//!
//! Source: G. Turk, The PLY Polygon File Format (1994). A text header declares elements, each with
//! a number and a list of properties; the body contains their records in this order. This reader uses the
//! properties `x`, `y`, `z` of the element `vertex` and the list `vertex_indices` (or `vertex_index`) of the
//! element `face`. If columns are requested, it also reads all properties of one number per vertex or face;
//! it skips everything else.

mod body;

use self::body::{Ascii, Binary, Body};
use super::text::{Text, parsed};
use super::write::write_blocks;
use super::{Column, ColumnPlace, Columns, MeshBuilder, ParseError, Problem, Unknown};
use std::io::{self, Write};

pub(super) fn parse(
    bytes: &[u8],
    wanted: Columns,
    unknown: Unknown,
) -> Result<(MeshBuilder, Vec<Column>), ParseError> {
    let mut text = Text::new(bytes).with_unknown(unknown);
    let (encoding, groups) = header(&mut text)?;
    let mut columns = match wanted {
        Columns::Read => Vec::from_iter(groups.iter().flat_map(ElementGroup::columns)),
        Columns::Skipped => Vec::new(),
    };
    let builder = match encoding {
        Encoding::Ascii => {
            let mut body = Ascii { text, first: None };
            let builder = elements(&mut body, &groups, bytes.len(), &mut columns)?;
            body.text.end_of_file()?;
            builder
        }
        Encoding::Binary(order) => {
            let rest = text.rest();
            let mut body = Binary {
                bytes,
                at: bytes.len() - rest.len(),
                order,
                ended: false,
                unknown,
            };
            let builder = elements(&mut body, &groups, rest.len(), &mut columns)?;
            body.end_of_file()?;
            builder
        }
    };
    Ok((builder, columns))
}

pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "element vertex {}", positions.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property double {axis}")?;
    }
    for part in ["red", "green", "blue"]
        .iter()
        .filter(|_| colours.is_some())
    {
        writeln!(out, "property uchar {part}")?;
    }
    writeln!(out, "element face {}", triangles.len())?;
    // `int` instead of `uint`, because every reader knows it; the limit of a mesh is below 2³¹.
    writeln!(out, "property list uchar int vertex_indices\nend_header")?;
    match colours {
        None => {
            let coordinates = positions.iter().flatten();
            write_blocks(out, coordinates.map(|coordinate| coordinate.to_le_bytes()))?;
        }
        Some(colours) => {
            let vertices = positions.iter().zip(colours).map(|(point, colour)| {
                let mut record = [0; 27];
                let (coordinates, rest) = record.split_at_mut(24);
                coordinates.copy_from_slice(point.map(f64::to_le_bytes).as_flattened());
                rest.copy_from_slice(colour);
                record
            });
            write_blocks(out, vertices)?;
        }
    }
    let faces = triangles.iter().map(|triangle| {
        let mut bytes = [3; 13];
        let corners = bytes[1..].as_chunks_mut::<4>().0.iter_mut();
        for (bytes, vertex) in corners.zip(triangle) {
            *bytes = vertex.to_le_bytes();
        }
        bytes
    });
    write_blocks(out, faces)
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

impl ByteOrder {
    /// Reverses the bytes of a number if necessary, so that the least significant is first.
    #[inline]
    fn little<const N: usize>(self, mut bytes: [u8; N]) -> [u8; N] {
        if matches!(self, Self::Big) {
            bytes.reverse();
        }
        bytes
    }
}

/// An element of the header: a number of records with the same properties.
struct ElementGroup {
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

impl ElementGroup {
    /// Empty columns for its properties.
    fn columns(&self) -> impl Iterator<Item = Column> {
        let place = match self.role {
            Role::Face => ColumnPlace::Triangles,
            Role::Vertex | Role::Other => ColumnPlace::Vertices,
        };
        let properties = self.properties.iter();
        properties.filter_map(move |property| match property {
            Property::Number(name, _) => Some(Column {
                name: name.clone(),
                place,
                values: Vec::new(),
            }),
            _ => None,
        })
    }
}

enum Property {
    /// A coordinate of a vertex, by axis.
    Coordinate(usize, Scalar),
    /// The list of a face's corners.
    Corners { length: Scalar, item: Scalar },
    /// Another number of a vertex or face, by its name.
    Number(String, Scalar),
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

fn header(text: &mut Text<'_>) -> Result<(Encoding, Vec<ElementGroup>), ParseError> {
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
    let mut groups = Vec::<ElementGroup>::new();
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

fn group(text: &mut Text<'_>) -> Result<ElementGroup, ParseError> {
    let role = match text.word() {
        Some(b"vertex") => Role::Vertex,
        Some(b"face") => Role::Face,
        Some(_) => Role::Other,
        None => return Err(text.expected("the element's name", None, None)),
    };
    let word = text.word();
    let count = parsed(word).ok_or_else(|| text.expected("the number of elements", word, None))?;
    Ok(ElementGroup {
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
    Ok(match (text.word(), role) {
        (Some(b"x"), Role::Vertex) => Property::Coordinate(0, kind),
        (Some(b"y"), Role::Vertex) => Property::Coordinate(1, kind),
        (Some(b"z"), Role::Vertex) => Property::Coordinate(2, kind),
        (Some(name), Role::Vertex | Role::Face) => {
            Property::Number(String::from_utf8_lossy(name).into_owned(), kind)
        }
        (Some(_), _) => Property::Scalar(kind),
        (None, _) => return Err(text.expected(NAME, None, None)),
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
fn undeclared(groups: &[ElementGroup]) -> Option<&'static str> {
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

/// Reads all groups of a body of this length in bytes. `columns` are those of all groups, or none if they are
/// not requested.
fn elements(
    body: &mut impl Body,
    groups: &[ElementGroup],
    length: usize,
    columns: &mut [Column],
) -> Result<MeshBuilder, ParseError> {
    let mut builder = MeshBuilder::new(0);
    let mut rest = columns;
    let mut corners = Vec::new();
    for group in groups {
        let own = group.columns().count().min(rest.len());
        let (columns, after) = std::mem::take(&mut rest).split_at_mut(own);
        rest = after;
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
        let plain = if columns.is_empty() {
            body.plain_elements(group, count, &mut builder)
        } else {
            0
        };
        for found in plain..count {
            if let Err(error) = element(body, group, &mut corners, columns, &mut builder) {
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
    group: &ElementGroup,
    corners: &mut Vec<u32>,
    columns: &mut [Column],
    builder: &mut MeshBuilder,
) -> Result<(), ParseError> {
    let mut next = columns.iter_mut();
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
            Property::Number(_, kind) => match next.next() {
                Some(column) => {
                    let number = body.number(kind, element.unwrap_or(vertex))?;
                    column.values.push(number);
                }
                None => body.skip(kind, 1, element)?,
            },
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
        Role::Face => {
            builder.add_face(corners, position);
            for column in columns {
                if let Some(number) = column.values.pop() {
                    let triangles = corners.len().saturating_sub(2);
                    column.values.extend(std::iter::repeat_n(number, triangles));
                }
            }
        }
        Role::Other => {}
    }
    Ok(())
}
