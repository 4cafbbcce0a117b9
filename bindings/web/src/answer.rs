//! Answers for JavaScript: a text in JSON, and arrays of numbers that are copied as they are.

use serde_json::{Value, json};
use std::fmt::Display;

/// Numbers of an answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Array {
    /// Numbers of 64 bits.
    Doubles(Vec<f64>),
    /// Numbers of vertices.
    Indices(Vec<u32>),
    /// The bytes of a file.
    Bytes(Vec<u8>),
}

impl Array {
    /// The address of the first number, and the length in bytes.
    pub fn place(&self) -> (*const u8, usize) {
        match self {
            Self::Doubles(all) => (all.as_ptr().cast(), size_of_val(all.as_slice())),
            Self::Indices(all) => (all.as_ptr().cast(), size_of_val(all.as_slice())),
            Self::Bytes(all) => (all.as_ptr(), all.len()),
        }
    }

    /// The name of the class of JavaScript that holds these numbers.
    fn class(&self) -> &'static str {
        match self {
            Self::Doubles(_) => "Float64Array",
            Self::Indices(_) => "Uint32Array",
            Self::Bytes(_) => "Uint8Array",
        }
    }
}

/// The answer to a request.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// Names, texts and numbers.
    pub text: Value,
    /// Arrays, each with its name.
    pub arrays: Vec<(&'static str, Array)>,
}

impl Answer {
    /// An answer without arrays.
    pub fn new(text: Value) -> Self {
        Self {
            text,
            arrays: Vec::new(),
        }
    }

    /// The answer with a further array.
    #[must_use]
    pub fn with(mut self, name: &'static str, array: Array) -> Self {
        self.arrays.push((name, array));
        self
    }

    /// The text, with the names and classes of the arrays, as JSON.
    pub fn to_json(&self) -> String {
        let arrays = self.arrays.iter();
        let arrays = arrays.map(|(name, array)| json!([name, array.class()]));
        json!({ "text": self.text, "arrays": Vec::from_iter(arrays) }).to_string()
    }
}

/// The reason why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The message of the program.
    pub message: String,
    /// Whether a repair makes a mesh of the file.
    pub is_repairable: bool,
}

impl Refusal {
    /// A refusal that no repair changes.
    pub fn new(message: impl Display) -> Self {
        Self {
            message: message.to_string(),
            is_repairable: false,
        }
    }

    /// The refusal as JSON.
    pub fn to_json(&self) -> String {
        json!({ "refusal": self.message, "repairable": self.is_repairable }).to_string()
    }
}
