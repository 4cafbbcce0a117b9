//! The numbers of accessors, in buffers within and beside a glTF file.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};

use super::super::beside::{NotBeside, beside, shown};
use super::super::number::Number;
use super::super::{Budget, ParseError, Position, Problem, Reading};
use super::document::{Document, StoredBytes, View};
use super::wrong;

/// The buffers of a file.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    /// The bytes of each buffer, and the place of the first in the file.
    buffers: Vec<(Cow<'a, [u8]>, usize)>,
    budget: Budget,
}

/// The numbers of an accessor.
pub(super) struct AccessorNumbers {
    pub(super) values: Vec<f64>,
    /// The place of the first number, and the bytes of each.
    start: usize,
    size: usize,
}

impl AccessorNumbers {
    /// The place of a number: in the file if its buffer is there, else in the buffer.
    pub(super) fn position(&self, index: usize) -> Position {
        Position::Byte(self.start + self.size * index)
    }
}

impl<'a> Buffers<'a> {
    /// Reads all buffers; `binary` is the place and length of the binary part.
    pub(super) fn new(
        document: &'a Document,
        (bytes, binary): (&'a [u8], Option<(usize, usize)>),
        reading: Reading<'_>,
    ) -> Result<Self, ParseError> {
        let mut length = reading.length;
        let mut buffers = Vec::new();
        for buffer in &document.buffers {
            buffers.push(match (buffer.uri.as_deref(), binary) {
                (None, Some((start, length))) => (bytes[start..start + length].into(), start),
                (None, None) => {
                    let found = "none".to_owned();
                    return Err(wrong("the binary part of a .glb file", found));
                }
                (Some(uri), _) => match uri.strip_prefix("data:") {
                    Some(data) => (embedded(data)?.into(), 0),
                    None => {
                        let bytes = named_buffer(uri, reading)?;
                        length = length.saturating_add(bytes.len());
                        (bytes.into(), 0)
                    }
                },
            });
        }
        Ok(Self {
            document,
            buffers,
            budget: Budget::new(length, false),
        })
    }

    /// The numbers of an accessor of this shape.
    pub(super) fn numbers(&self, at: usize, shape: &str) -> Result<AccessorNumbers, ParseError> {
        let accessor = self.document.accessors.get(at);
        let accessor =
            accessor.ok_or_else(|| wrong("the number of an accessor", format!("{at}")))?;
        if accessor.shape != shape {
            let expected = "positions of the type VEC3 and indices of the type SCALAR";
            let shown = String::from_iter(accessor.shape.chars().take(40));
            return Err(wrong(expected, format!("`{}`", shown.escape_debug())));
        }
        let components = if shape == "VEC3" { 3 } else { 1 };
        let stored = accessor.stored();
        let number = named(stored.component_type)?;
        let mut numbers = match stored.buffer_view {
            Some(_) => self.stored(stored, number, accessor.count, components)?,
            None => {
                self.take(accessor.count.saturating_mul(components))?;
                AccessorNumbers {
                    values: vec![0.0; accessor.count * components],
                    start: 0,
                    size: 0,
                }
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let kind = named(sparse.indices.component_type)?;
            let places = self.stored(sparse.indices, kind, sparse.count, 1)?;
            let values = self.stored(sparse.values, number, sparse.count, components)?;
            for (place, value) in places.values.iter().zip(values.values.chunks(components)) {
                let start = (*place as usize).saturating_mul(components);
                let known = start.checked_add(components);
                let known = known.and_then(|end| numbers.values.get_mut(start..end));
                let known = known.ok_or_else(|| {
                    wrong("places of a sparse accessor within it", format!("{place}"))
                })?;
                known.copy_from_slice(value);
            }
        }
        if accessor.normalized {
            let one = match number {
                Number::Float(_) => 1.0,
                Number::Signed(size) => 2f64.powi(8 * size as i32 - 1) - 1.0,
                Number::Unsigned(size) => 2f64.powi(8 * size as i32) - 1.0,
            };
            let values = numbers.values.iter_mut();
            values.for_each(|value| *value = (*value / one).max(-1.0));
        }
        Ok(numbers)
    }

    fn take(&self, numbers: usize) -> Result<(), ParseError> {
        self.budget.take(numbers).map_err(Problem::anywhere)
    }

    /// Numbers in a view of a buffer.
    fn stored(
        &self,
        stored: StoredBytes,
        number: Number,
        count: usize,
        components: usize,
    ) -> Result<AccessorNumbers, ParseError> {
        let at = stored.buffer_view.unwrap_or(usize::MAX);
        let view = self.document.buffer_views.get(at);
        let view = view.ok_or_else(|| wrong("the number of a view", format!("{at}")))?;
        let buffer = self.buffers.get(view.buffer);
        let (bytes, first) =
            buffer.ok_or_else(|| wrong("the number of a buffer", format!("{}", view.buffer)))?;
        let whole = number.size() * components;
        let stride = view
            .byte_stride
            .filter(|&stride| stride > 0)
            .unwrap_or(whole);
        let own = range(view, stored, count, stride, whole).and_then(|range| bytes.get(range));
        let own = own.ok_or_else(|| {
            let found = format!("a buffer of {} bytes", bytes.len());
            wrong("a buffer as long as its accessors need", found)
        })?;
        self.take(count.saturating_mul(components))?;
        let mut values = Vec::with_capacity(count * components);
        for at in 0..count {
            let tuple = own[at * stride..][..whole].chunks_exact(number.size());
            values.extend(tuple.map(|stored| number.float(stored, false)));
        }
        Ok(AccessorNumbers {
            values,
            start: first + view.byte_offset + stored.byte_offset,
            size: stride / components,
        })
    }
}

/// The bytes of the numbers of an accessor in its buffer.
fn range(
    view: &View,
    stored: StoredBytes,
    count: usize,
    stride: usize,
    whole: usize,
) -> Option<std::ops::Range<usize>> {
    let length = match count.checked_sub(1) {
        None => 0,
        Some(before) => before.checked_mul(stride)?.checked_add(whole)?,
    };
    let within = stored.byte_offset.checked_add(length)?;
    let start = view.byte_offset.checked_add(stored.byte_offset)?;
    (within <= view.byte_length).then_some(start..start.checked_add(length)?)
}

fn named(number: u32) -> Result<Number, ParseError> {
    Ok(match number {
        5120 => Number::Signed(1),
        5121 => Number::Unsigned(1),
        5122 => Number::Signed(2),
        5123 => Number::Unsigned(2),
        5125 => Number::Unsigned(4),
        5126 => Number::Float(4),
        _ => {
            return Err(wrong(
                "a type of numbers from 5120 to 5126",
                format!("{number}"),
            ));
        }
    })
}

/// The bytes of a URI behind `data:`.
fn embedded(data: &str) -> Result<Vec<u8>, ParseError> {
    let text = data.split_once(";base64,").map(|(_, text)| text.trim_end());
    let decoded = text.and_then(|text| {
        let padded = STANDARD.decode(text);
        padded.or_else(|_| STANDARD_NO_PAD.decode(text)).ok()
    });
    decoded.ok_or_else(|| wrong("a buffer in base64", "what is none".to_owned()))
}

/// The bytes of a buffer in a file beside the mesh file.
fn named_buffer(uri: &str, reading: Reading<'_>) -> Result<Vec<u8>, ParseError> {
    let as_binary = || format!("{}: save it as .glb", shown(uri));
    let name = unescaped(uri).unwrap_or_default();
    beside(&name, reading).map_err(|reason| match reason {
        NotBeside::Elsewhere => wrong(
            "a buffer within the file, or a file name beside it",
            as_binary(),
        ),
        NotBeside::InMemory => wrong(
            "buffers within the file, because it is read from memory",
            as_binary(),
        ),
        NotBeside::Unreadable(error) => wrong(
            "the file of a buffer beside the mesh file",
            format!("{}: {error}", shown(uri)),
        ),
    })
}

/// A URI with its codes such as `%20` as bytes.
fn unescaped(uri: &str) -> Option<String> {
    let mut name = Vec::new();
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        rest = after;
        if *first == b'%' {
            let (code, after) = rest.split_first_chunk::<2>()?;
            name.push(u8::from_str_radix(str::from_utf8(code).ok()?, 16).ok()?);
            rest = after;
        } else {
            name.push(*first);
        }
    }
    String::from_utf8(name).ok()
}
