//! Tags of an XML file, as needed for mesh files.
//!
//! Text between tags, comments, declarations and instructions are skipped without checks.

use super::{ParseError, Position, Problem};

/// An opening, closing or empty tag.
#[derive(Clone, Debug)]
pub(super) struct Tag<'a> {
    pub(super) name: &'a [u8],
    /// Whether the tag has the form `</NAME>`.
    pub(super) closes: bool,
    /// The text after the name.
    attributes: &'a [u8],
    /// Start of the tag, and start of the following text.
    pub(super) start: usize,
    pub(super) end: usize,
}

/// The tags of a file, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Tags<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tags<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The next tag; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Tag<'a>>, ParseError> {
        loop {
            let Some(start) = find(self.bytes, self.at, b"<") else {
                return Ok(None);
            };
            let inside = &self.bytes[start + 1..];
            let end: &[u8] = match inside {
                [b'!', b'-', b'-', ..] => b"-->",
                [b'!', b'[', ..] => b"]]>",
                [b'?', ..] => b"?>",
                [b'!', ..] => b">",
                _ => b"",
            };
            let unfinished = || {
                let problem = Problem::Expected {
                    expected: "the end of a tag",
                    found: "the end of the file".to_owned(),
                };
                problem.at(line_of(self.bytes, start), None)
            };
            if !end.is_empty() {
                let at = find(self.bytes, start + 1, end).ok_or_else(unfinished)?;
                self.at = at + end.len();
                continue;
            }
            let length = tag_length(inside).ok_or_else(unfinished)?;
            let inside = &inside[..length];
            let (inside, closes) = match inside {
                [b'/', rest @ ..] => (rest, true),
                inside => (inside, false),
            };
            let name = inside
                .iter()
                .position(|byte| byte.is_ascii_whitespace() || *byte == b'/')
                .unwrap_or(inside.len());
            let (name, attributes) = inside.split_at(name);
            self.at = start + length + 2;
            return Ok(Some(Tag {
                name,
                closes,
                attributes,
                start,
                end: self.at,
            }));
        }
    }
}

impl<'a> Tag<'a> {
    /// Value of an attribute. Entities are not decoded, because numbers and names of VTK have none.
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.attributes;
        loop {
            rest = rest.trim_ascii_start();
            let equals = rest.iter().position(|&byte| byte == b'=')?;
            let key = rest[..equals].trim_ascii_end();
            rest = rest[equals + 1..].trim_ascii_start();
            let (&quote, after) = rest.split_first()?;
            let length = after.iter().position(|&byte| byte == quote)?;
            if key == name.as_bytes() {
                return str::from_utf8(&after[..length]).ok();
            }
            rest = &after[length + 1..];
        }
    }
}

/// Line of a byte.
pub(super) fn line_of(bytes: &[u8], at: usize) -> Position {
    let before = &bytes[..at.min(bytes.len())];
    Position::Line(1 + before.iter().filter(|&&byte| byte == b'\n').count())
}

/// Next position of a sequence of bytes.
fn find(bytes: &[u8], from: usize, what: &[u8]) -> Option<usize> {
    let rest = bytes.get(from..)?;
    Some(from + rest.windows(what.len()).position(|here| here == what)?)
}

/// Length of a tag up to its `>`, ignoring `>` in quotation marks.
fn tag_length(inside: &[u8]) -> Option<usize> {
    let mut quote = None;
    inside.iter().position(|&byte| {
        match quote {
            Some(open) if byte == open => quote = None,
            Some(_) => {}
            None if byte == b'"' || byte == b'\'' => quote = Some(byte),
            None => return byte == b'>',
        }
        false
    })
}
