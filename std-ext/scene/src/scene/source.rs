//! The text of a scene, and the places in it to which messages point.

use super::overrides::Overrides;
use super::problem::{Place, Problem, SceneError, SceneErrors};
use super::value::Origin;
use crate::io::{read_whole, without_mark};
use std::path::{Path, PathBuf};

/// A scene's texts, to which origins point.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) path: PathBuf,
    pub(super) text: String,
    pub(super) overrides: Overrides,
}

impl Source {
    /// The error at an origin.
    pub(super) fn error(&self, origin: &Origin, problem: Problem) -> SceneError {
        SceneError {
            path: self.path.clone(),
            place: self.place(origin),
            problem,
        }
    }

    fn place(&self, origin: &Origin) -> Place {
        match origin {
            Origin::File => Place::File,
            Origin::Override(index) => match self.overrides.texts().get(*index) {
                Some(text) => Place::Override(text.clone()),
                None => Place::File,
            },
            Origin::Text(range) => {
                let start = floor(&self.text, range.start);
                let end = floor(&self.text, range.end).max(start);
                let line_start = self.text[..start].rfind('\n').map_or(0, |at| at + 1);
                let text = self.text[line_start..].lines().next().unwrap_or("");
                let within = &self.text[start..end];
                let width = within.lines().next().unwrap_or("").chars().count();
                Place::Text {
                    line: self.text[..start].matches('\n').count() + 1,
                    column: self.text[line_start..start].chars().count() + 1,
                    text: text.to_owned(),
                    width: width.max(1),
                }
            }
        }
    }
}

/// The last character boundary at or before a byte.
fn floor(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// The largest size of a scene file, in bytes.
const LONGEST: u64 = 1 << 24;

/// The text of a scene file, without a byte order mark.
pub(super) fn read_text(path: &Path) -> Result<String, SceneErrors> {
    let failure = |message: String| {
        SceneErrors::from(SceneError {
            path: path.to_owned(),
            place: Place::File,
            problem: Problem::Unreadable { message },
        })
    };
    let bytes = read_whole(path, Some(LONGEST)).map_err(|error| {
        failure(match error.kind() {
            std::io::ErrorKind::NotFound if path.extension().is_none() => {
                "there is no such file, and no scene of that name comes with the program: \
                 `helfrich scenes` lists them"
                    .to_owned()
            }
            std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
            _ if path.is_dir() => "is a directory: a scene file is needed".to_owned(),
            _ => format!("cannot be read: {error}"),
        })
    })?;
    let text = str::from_utf8(without_mark(&bytes)).map_err(|error| {
        let at = error.valid_up_to();
        failure(format!("is no text in UTF-8: byte {at} is wrong"))
    })?;
    Ok(text.to_owned())
}
