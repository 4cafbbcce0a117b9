//! Words and numbers of files that are text, or text with binary numbers between its lines.

use super::number::Number;
use super::text::{found, parsed};
use super::{Element, ParseError, Position, Problem};

/// Reader of words and numbers, whatever the line on which they are.
#[derive(Clone, Debug)]
pub(super) struct Tokens<'a> {
    bytes: &'a [u8],
    at: usize,
    /// The line of the last word of a text, from 1.
    line: usize,
    /// Whether binary numbers are big-endian; `None` if numbers are words.
    pub(super) binary: Option<bool>,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            line: 1,
            binary: None,
        }
    }

    /// The line of the last word, or the next byte of a binary file.
    pub(super) fn position(&self) -> Position {
        match self.binary {
            None => Position::Line(self.line),
            Some(_) => Position::Byte(self.at),
        }
    }

    /// The number of bytes that are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next word; `None` at the end of the file.
    #[inline]
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        while let Some(byte) = self.bytes.get(self.at).filter(is_blank) {
            self.line += usize::from(*byte == b'\n');
            self.at += 1;
        }
        let start = self.at;
        let rest = &self.bytes[start..];
        self.at += rest.iter().position(|b| is_blank(&b)).unwrap_or(rest.len());
        (self.at > start).then(|| &self.bytes[start..self.at])
    }

    /// The next word, which is left where it is.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().word()
    }

    /// The rest of this line without spaces around it, and moves to the next line; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&byte| byte == b'\n');
        self.at += end.map_or(rest.len(), |end| end + 1);
        self.line += 1;
        Some(rest[..end.unwrap_or(rest.len())].trim_ascii())
    }

    /// Skips bytes of a binary file; `None` if there are fewer.
    pub(super) fn skip(&mut self, count: usize) -> Option<()> {
        let at = self.at.checked_add(count);
        self.at = at.filter(|&at| at <= self.bytes.len())?;
        Some(())
    }

    /// Moves behind the end `$EndName` of the section `$Name`, whatever is there; `None` if there is no end.
    pub(super) fn skip_section(&mut self, name: Option<&[u8]>) -> Option<()> {
        let end = [b"$End", name?.get(1..)?].concat();
        let rest = &self.bytes[self.at..];
        let place = rest.windows(end.len()).position(|here| here == end)?;
        let lines = rest[..place].iter().filter(|&&byte| byte == b'\n');
        self.line += lines.count();
        self.skip(place + end.len())
    }

    /// The next number, whatever its meaning.
    #[inline]
    pub(super) fn float(
        &mut self,
        kind: Number,
        expected: &'static str,
    ) -> Result<f64, ParseError> {
        match self.binary {
            None => self.parsed(expected),
            Some(big_endian) => Ok(kind.float(self.stored(kind, expected)?, big_endian)),
        }
    }

    /// The next whole number.
    #[inline]
    pub(super) fn integer(
        &mut self,
        kind: Number,
        expected: &'static str,
    ) -> Result<i64, ParseError> {
        match self.binary {
            None => self.parsed(expected),
            Some(big_endian) => Ok(kind.integer(self.stored(kind, expected)?, big_endian)),
        }
    }

    /// The next word as a number.
    #[inline]
    pub(super) fn parsed<T: std::str::FromStr>(
        &mut self,
        expected: &'static str,
    ) -> Result<T, ParseError> {
        let word = self.word();
        parsed(word).ok_or_else(|| self.expected(expected, word, None))
    }

    /// Many numbers.
    pub(super) fn floats(
        &mut self,
        count: usize,
        kind: Number,
        expected: &'static str,
    ) -> Result<Vec<f64>, ParseError> {
        let mut numbers = Vec::with_capacity(count.min(self.left() / self.least(kind)));
        for _ in 0..count {
            numbers.push(self.float(kind, expected)?);
        }
        Ok(numbers)
    }

    /// Many whole numbers.
    pub(super) fn integers(
        &mut self,
        count: usize,
        kind: Number,
        expected: &'static str,
    ) -> Result<Vec<i64>, ParseError> {
        let mut numbers = Vec::with_capacity(count.min(self.left() / self.least(kind)));
        for _ in 0..count {
            numbers.push(self.integer(kind, expected)?);
        }
        Ok(numbers)
    }

    /// The fewest bytes of a number: a digit and a space in a text.
    fn least(&self, kind: Number) -> usize {
        self.binary.map_or(2, |_| kind.size())
    }

    fn stored(&mut self, kind: Number, expected: &'static str) -> Result<&'a [u8], ParseError> {
        let start = self.at;
        match self.skip(kind.size()) {
            Some(()) => Ok(&self.bytes[start..]),
            None => {
                self.at = self.bytes.len();
                Err(self.expected(expected, None, None))
            }
        }
    }

    /// An error at the last word, `None` at the end of the file: it is not what was expected.
    #[cold]
    pub(super) fn expected(
        &self,
        expected: &'static str,
        word: Option<&[u8]>,
        element: Option<Element>,
    ) -> ParseError {
        let found = match word {
            None => "the end of the file".to_owned(),
            word => found(word),
        };
        Problem::Expected { expected, found }.at(self.position(), element)
    }
}

fn is_blank(byte: &&u8) -> bool {
    byte.is_ascii_whitespace() || **byte == b'\x0b'
}
