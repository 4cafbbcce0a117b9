//! Lines and words of a text, read directly from its bytes.

use super::{Element, ParseError, Position, Problem, Unknown, finite};

/// The expected coordinate, for error messages.
const COORDINATES: [&str; 3] = ["coordinate x", "coordinate y", "coordinate z"];

/// Reader of a text, from one statement (a line with a word) to the next, and through the words of each. A
/// word that starts with `#` opens a comment to the end of the line.
pub(super) struct Text<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    started: bool,
    /// Whether the end of the text was reached in search of a statement.
    ended: bool,
    /// Whether a `\` at the end of a line joins the next one to it.
    joins_lines: bool,
    unknown: Unknown,
}

impl<'a> Text<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            line: 1,
            started: false,
            ended: false,
            joins_lines: false,
            unknown: Unknown::Refused,
        }
    }

    pub(super) fn joining_lines(bytes: &'a [u8]) -> Self {
        Self {
            joins_lines: true,
            ..Self::new(bytes)
        }
    }

    /// The same with coordinates that may be unknown.
    pub(super) fn with_unknown(self, unknown: Unknown) -> Self {
        Self { unknown, ..self }
    }

    /// The line that was last read from.
    pub(super) fn position(&self) -> Position {
        Position::Line(self.line)
    }

    /// Whether the end of the text was reached in search of a statement.
    pub(super) fn has_ended(&self) -> bool {
        self.ended
    }

    /// The bytes after the current line.
    pub(super) fn rest(mut self) -> &'a [u8] {
        while self.word().is_some() {}
        self.bytes.get(self.at + 1..).unwrap_or_default()
    }

    /// The first word of the next line that has one; `None` at the end of the text.
    #[inline]
    pub(super) fn statement(&mut self) -> Option<&'a [u8]> {
        if self.started {
            while self.word().is_some() {}
            self.next_line()?;
        }
        self.started = true;
        loop {
            if let Some(word) = self.word() {
                return Some(word);
            }
            self.next_line()?;
        }
    }

    /// Moves from the end of a line to the start of the next, if there is one.
    #[inline]
    fn next_line(&mut self) -> Option<()> {
        if self.at + 1 >= self.bytes.len() {
            self.ended = true;
            return None;
        }
        self.at += 1;
        self.line += 1;
        Some(())
    }

    /// The next word of this line.
    #[inline]
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            match *self.bytes.get(self.at)? {
                b'\n' => return None,
                b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c' => self.at += 1,
                b'#' => {
                    self.at += line_length(&self.bytes[self.at..]);
                    return None;
                }
                b'\\' if self.join_length() > 0 => {
                    self.at += self.join_length();
                    self.line += 1;
                }
                _ => break,
            }
        }
        let start = self.at;
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte.is_ascii_whitespace()
                || byte == b'\x0b'
                || (byte == b'\\' && self.join_length() > 0)
            {
                break;
            }
            self.at += 1;
        }
        Some(&self.bytes[start..self.at])
    }

    /// Length of a `\` at the current position with the following end of line; 0 if there is no such pair.
    fn join_length(&self) -> usize {
        match self.bytes[self.at..] {
            _ if !self.joins_lines => 0,
            [b'\\', b'\n', ..] => 2,
            [b'\\', b'\r', b'\n', ..] => 3,
            _ => 0,
        }
    }

    /// Three coordinates: `word` and the two that follow it.
    #[inline]
    pub(super) fn coordinates(
        &mut self,
        mut word: Option<&'a [u8]>,
        element: Element,
    ) -> Result<[f64; 3], ParseError> {
        let mut point = [0.0; 3];
        for (axis, coordinate) in point.iter_mut().enumerate() {
            if axis > 0 {
                word = self.word();
            }
            *coordinate = self.coordinate(axis, word, element)?;
        }
        Ok(point)
    }

    /// A word of this line as a coordinate.
    #[inline]
    pub(super) fn coordinate(
        &self,
        axis: usize,
        word: Option<&[u8]>,
        element: Element,
    ) -> Result<f64, ParseError> {
        let value =
            parsed(word).ok_or_else(|| self.expected(COORDINATES[axis], word, Some(element)))?;
        finite(value, axis, self.unknown, || found(word))
            .map_err(|problem| problem.at(self.position(), Some(element)))
    }

    /// Checks that the text has ended.
    pub(super) fn end_of_file(&mut self) -> Result<(), ParseError> {
        match self.statement() {
            None => Ok(()),
            word => Err(self.expected("the end of the file", word, None)),
        }
    }

    /// An error about this line: `word` (`None` at the end of it) is not what was expected.
    #[cold]
    pub(super) fn expected(
        &self,
        expected: &'static str,
        word: Option<&[u8]>,
        element: Option<Element>,
    ) -> ParseError {
        let found = if self.ended {
            "the end of the file".to_owned()
        } else {
            found(word)
        };
        Problem::Expected { expected, found }.at(self.position(), element)
    }
}

/// Length of the line that starts here, without its line break.
fn line_length(bytes: &[u8]) -> usize {
    bytes
        .iter()
        .position(|&byte| byte == b'\n')
        .unwrap_or(bytes.len())
}

/// Parses a word as a number; `None` if there is no word or it is not such a number.
#[inline]
pub(super) fn parsed<T: core::str::FromStr>(word: Option<&[u8]>) -> Option<T> {
    core::str::from_utf8(word?).ok()?.parse().ok()
}

/// A word for an error message: printable, and not too long.
pub(super) fn found(word: Option<&[u8]>) -> String {
    const LONGEST: usize = 40;
    let Some(word) = word else {
        return "the end of the line".to_owned();
    };
    let shown = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]);
    let ellipsis = if word.len() > LONGEST { "…" } else { "" };
    format!("`{}{ellipsis}`", shown.escape_debug())
}
