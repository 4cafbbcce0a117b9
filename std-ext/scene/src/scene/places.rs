//! Places of surfaces in a text file.

use crate::io::{read_whole, without_mark};
use helfrich_mesh::packing::Place;
use std::io;
use std::path::Path;

/// Largest length of a file of places: a million of them, with all their digits.
const LONGEST: u64 = 200_000_000;

/// The reason why places cannot be read. The file is not quoted, because the scene of somebody else may name any.
#[derive(Debug, thiserror::Error)]
pub(super) enum PlacesError {
    #[error("{0}")]
    Inaccessible(#[from] io::Error),
    #[error(
        "line {0} has not three finite numbers, the position, or seven, with an axis and an angle in degrees about it"
    )]
    Line(usize),
    #[error("line {0} has an angle about an axis without length")]
    Axis(usize),
    #[error("there is no place in it")]
    Empty,
}

/// The places in a file: one in each line, with numbers between commas, semicolons or blanks. A line that begins with `#`, and
/// a first line of words, are titles.
pub(super) fn read_places(path: &Path) -> Result<Vec<Place>, PlacesError> {
    let bytes = read_whole(path, Some(LONGEST))?;
    let text = String::from_utf8_lossy(without_mark(&bytes));
    let mut places = Vec::new();
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        let is_title = number == 1 && line.starts_with(|first: char| first.is_alphabetic());
        if line.is_empty() || line.starts_with('#') || is_title {
            continue;
        }
        let words = line
            .split([',', ';', ' ', '\t'])
            .filter(|word| !word.is_empty());
        let numbers = words.map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite()));
        let numbers = numbers.collect::<Option<Vec<_>>>();
        let (position, axis, angle) = match numbers.as_deref() {
            Some(&[x, y, z]) => ([x, y, z], [0.0, 0.0, 1.0], 0.0),
            Some(&[x, y, z, a, b, c, angle]) => ([x, y, z], [a, b, c], angle),
            _ => return Err(PlacesError::Line(number)),
        };
        if angle != 0.0 && axis == [0.0; 3] {
            return Err(PlacesError::Axis(number));
        }
        places.push(Place {
            position,
            axis,
            angle,
        });
    }
    match places.is_empty() {
        true => Err(PlacesError::Empty),
        false => Ok(places),
    }
}
