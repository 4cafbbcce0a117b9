//! Parts of a sweep: `K/N`.

use std::fmt;
use std::num::NonZeroUsize;
use std::str::FromStr;

/// One of N parts of a sweep, counted from 1: every Nth combination from the Kth on. Processes on different machines run
/// different parts in one folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    number: NonZeroUsize,
    count: NonZeroUsize,
}

/// A text without the form `K/N`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no part: write K/N with K from 1 to N, as in 3/8")]
pub struct PartSyntaxError {
    text: String,
}

impl Part {
    /// Whether the combination with this number, from 0, belongs to the part.
    pub fn contains(self, case: usize) -> bool {
        case % self.count == self.number.get() - 1
    }

    /// The name of its table.
    pub(super) fn table(self) -> String {
        format!("sweep-{}-of-{}.csv", self.number, self.count)
    }
}

impl FromStr for Part {
    type Err = PartSyntaxError;

    fn from_str(text: &str) -> Result<Self, PartSyntaxError> {
        let parts = text.split_once('/');
        let numbers =
            parts.and_then(|(number, count)| Some([number.parse().ok()?, count.parse().ok()?]));
        match numbers {
            Some([number, count]) if number <= count => Ok(Self { number, count }),
            _ => Err(PartSyntaxError {
                text: text.to_owned(),
            }),
        }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}
