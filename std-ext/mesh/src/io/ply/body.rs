//! The body of a PLY file: its elements, as text or binary.

use super::super::text::{Text, parsed};
use super::super::{CORNER, Element, ParseError, Position, Problem, Unknown, finite};
use super::{ByteOrder, ElementGroup, MeshBuilder, Property, Role, Scalar};

/// The part of a file after its header, read value by value. `element` is the current one, for messages.
pub(super) trait Body {
    /// Reads the first elements of a group of `count` at once, as long as they have the usual form, and
    /// returns their number. The remaining elements, and those with an error, are read value by value.
    fn plain_elements(
        &mut self,
        group: &ElementGroup,
        count: usize,
        builder: &mut MeshBuilder,
    ) -> usize;
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
    fn number(&mut self, kind: Scalar, element: Element) -> Result<f64, ParseError>;
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
    /// Whether the last error was the end of the file.
    fn has_ended(&self) -> bool;
}

const LIST_LENGTH: &str = "a list's length";

/// A body with one element per line.
pub(super) struct Ascii<'a> {
    pub(super) text: Text<'a>,
    /// The first word of the line, until it is consumed.
    pub(super) first: Option<&'a [u8]>,
}

impl<'a> Ascii<'a> {
    fn word(&mut self) -> Option<&'a [u8]> {
        self.first.take().or_else(|| self.text.word())
    }
}

impl Body for Ascii<'_> {
    fn plain_elements(&mut self, _: &ElementGroup, _: usize, _: &mut MeshBuilder) -> usize {
        0
    }

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

    fn number(&mut self, _: Scalar, element: Element) -> Result<f64, ParseError> {
        let word = self.word();
        parsed(word).ok_or_else(|| self.text.expected("a number", word, Some(element)))
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

/// Bytes of a triangle: a length of one byte, and three numbers of four bytes.
const TRIANGLE: usize = 13;

/// Offsets of the coordinates in a record of fixed length.
struct Coordinates {
    places: [usize; 3],
    is_double: bool,
    /// The length of the record.
    length: usize,
}

impl Coordinates {
    /// `None` if the records have a list, or coordinates that are not all `float` or all `double`.
    fn of(properties: &[Property]) -> Option<Self> {
        let mut found = [None; 3];
        let mut length = 0;
        for property in properties {
            let kind = match *property {
                Property::Coordinate(axis, kind) => {
                    if found[axis].replace((length, kind)).is_some() {
                        return None;
                    }
                    kind
                }
                Property::Number(_, kind) | Property::Scalar(kind) => kind,
                Property::Corners { .. } | Property::List { .. } => return None,
            };
            length += kind.size();
        }
        let [(x, kind), (y, second), (z, third)] = [found[0]?, found[1]?, found[2]?];
        let is_double = kind == Scalar::F64;
        let known = is_double || kind == Scalar::F32;
        (known && kind == second && kind == third).then_some(Self {
            places: [x, y, z],
            is_double,
            length,
        })
    }

    /// Reads vertices up to the first that is not finite, and returns their number.
    fn read(
        &self,
        bytes: &[u8],
        order: ByteOrder,
        count: usize,
        builder: &mut MeshBuilder,
    ) -> usize {
        let before = builder.positions.len();
        let records = bytes.chunks_exact(self.length).take(count);
        let number = |record: &[u8], place: usize| {
            let bytes = &record[place..];
            let single = || {
                bytes
                    .first_chunk()
                    .map(|&four| f32::from_le_bytes(order.little(four)))
            };
            let double = || {
                bytes
                    .first_chunk()
                    .map(|&all| f64::from_le_bytes(order.little(all)))
            };
            let value = if self.is_double {
                double()
            } else {
                single().map(f64::from)
            };
            value.unwrap_or(f64::NAN)
        };
        let points = records.map(|record| self.places.map(|place| number(record, place)));
        let is_finite = |point: &[f64; 3]| point.iter().all(|x| x.is_finite());
        builder.positions.extend(points.take_while(is_finite));
        builder.positions.len() - before
    }
}

/// A binary body: records without separators.
pub(super) struct Binary<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) order: ByteOrder,
    pub(super) ended: bool,
    pub(super) unknown: Unknown,
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
        Some(self.order.little(*bytes))
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
            // Unreachable: headers in which a list length or a corner has such a type are refused.
            Scalar::F32 | Scalar::F64 => return None,
        })
    }

    #[inline]
    fn real(&mut self, kind: Scalar) -> Option<f64> {
        match kind {
            Scalar::F32 => self.take().map(|bytes| f32::from_le_bytes(bytes).into()),
            Scalar::F64 => self.take().map(f64::from_le_bytes),
            // Integers of at most 32 bits are exact.
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

    /// Checks that only white space follows, which some programs append.
    pub(super) fn end_of_file(&self) -> Result<(), ParseError> {
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
    fn plain_elements(
        &mut self,
        group: &ElementGroup,
        count: usize,
        builder: &mut MeshBuilder,
    ) -> usize {
        let (rest, order) = (&self.bytes[self.at..], self.order);
        let [length, elements] = match (group.role, &group.properties[..]) {
            (Role::Vertex, properties) => match Coordinates::of(properties) {
                Some(places) => [places.length, places.read(rest, order, count, builder)],
                None => return 0,
            },
            (Role::Face, [Property::Corners { length, item }])
                if length.size() == 1 && item.size() == 4 =>
            {
                let (records, _) = rest.as_chunks::<TRIANGLE>();
                // Negative numbers are no vertices.
                let most = match item {
                    Scalar::I32 => i32::MAX as u32,
                    _ => u32::MAX,
                };
                let triangle = |record: &[u8; TRIANGLE]| {
                    let (corners, _) = record[1..].as_chunks::<4>();
                    [0, 1, 2].map(|corner| u32::from_le_bytes(order.little(corners[corner])))
                };
                let triangles = records.iter().take(count);
                let triangles = triangles.take_while(|record| record[0] == 3).map(triangle);
                let triangles =
                    triangles.take_while(|triangle| triangle.iter().all(|&vertex| vertex <= most));
                [
                    TRIANGLE,
                    builder.add_triangles(triangles, self.at, TRIANGLE),
                ]
            }
            _ => return 0,
        };
        self.at += length * elements;
        elements
    }

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
        finite(value, axis, self.unknown, || value.to_string())
            .map_err(|problem| problem.at(position, Some(element)))
    }

    #[inline]
    fn number(&mut self, kind: Scalar, element: Element) -> Result<f64, ParseError> {
        let number = self.real(kind);
        number.ok_or_else(|| self.expected("a number", None, Some(element)))
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
