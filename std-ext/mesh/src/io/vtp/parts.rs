//! Files that consist of others: the parts of a surface that several processes wrote (`.pvtp`, `.pvtu`), and
//! blocks (`.vtm`).
//!
//! Source: *VTK file formats* (docs.vtk.org, XML formats, parallel files) and VTK's `vtkXMLMultiBlockDataWriter`.

use std::collections::BTreeSet;

use super::super::beside::{NotBeside, beside, shown};
use super::super::xml::{Tags, line_of};
use super::super::{ParseError, Problem, Reading, gzip};

/// The names of the files that a file consists of.
pub(super) struct Parts {
    pub(super) names: Vec<String>,
    /// Whether they are parts of one surface, which repeat the points that they share.
    pub(super) are_of_one: bool,
}

/// The parts of a file, each once; `None` for a file that is no list of others.
pub(super) fn parts(bytes: &[u8]) -> Result<Option<Parts>, ParseError> {
    let mut tags = Tags::new(bytes);
    let Some(root) = tags.next()?.filter(|tag| tag.name == b"VTKFile") else {
        return Ok(None);
    };
    let (element, attribute, are_of_one): (&[u8], _, _) = match root.attribute("type") {
        Some("PPolyData" | "PUnstructuredGrid") => (b"Piece", "Source", true),
        Some("vtkMultiBlockDataSet") => (b"DataSet", "file", false),
        _ => return Ok(None),
    };
    let mut known = BTreeSet::new();
    let mut names = Vec::new();
    while let Some(tag) = tags.next()? {
        // Blocks may be empty.
        if let Some(name) = tag.attribute(attribute).filter(|_| tag.name == element)
            && known.insert(name.to_owned())
        {
            names.push(name.to_owned());
        }
    }
    if names.is_empty() {
        let problem = Problem::Expected {
            expected: "names of files with pieces",
            found: "none".to_owned(),
        };
        return Err(problem.at(line_of(bytes, root.start), None));
    }
    Ok(Some(Parts { names, are_of_one }))
}

/// The bytes of a part, unpacked.
pub(super) fn part(name: &str, reading: Reading<'_>) -> Result<Vec<u8>, ParseError> {
    let expected = |expected, found| Problem::Expected { expected, found }.anywhere();
    let bytes = beside(name, reading).map_err(|reason| match reason {
        NotBeside::Elsewhere => expected("a file name beside it", shown(name)),
        NotBeside::InMemory => expected("a file in a folder, because it names others", shown(name)),
        NotBeside::Unreadable(error) => {
            let found = format!("{}: {error}", shown(name));
            expected("a file with a piece beside it", found)
        }
    })?;
    match gzip::unpacked(&bytes).map_err(|error| within(name, &error))? {
        std::borrow::Cow::Borrowed(_) => Ok(bytes),
        std::borrow::Cow::Owned(unpacked) => Ok(unpacked),
    }
}

/// An error in a part.
pub(super) fn within(name: &str, error: &ParseError) -> ParseError {
    let problem = Problem::Expected {
        expected: "a file beside it with a piece",
        found: format!("{}: {error}", shown(name)),
    };
    problem.anywhere()
}
