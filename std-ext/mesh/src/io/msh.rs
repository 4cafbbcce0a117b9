//! Meshes of Gmsh, versions 2 and 4, ASCII and binary.
//!
//! Source: Gmsh reference manual, "Gmsh file formats". Sections from `$Name` to `$EndName` have nodes and elements,
//! which have numbers of their own: tags. The nodes of elements are listed with the corners first. Numbers of sections
//! are words in ASCII files; in binary ones, only those of the format and, in version 2, of the counts.

mod data;
mod types;

use std::collections::HashMap;

use self::types::of_gmsh;
use super::cells::{Cell, CellFaces, at_triangles};
use super::number::Number;
use super::tokens::Tokens;
use super::{Column, ColumnPlace, Columns, Element, ParseError, Parsed, Problem, Reading, finite};

/// The start of every file, unless comments precede it.
pub(super) const HEADER: &[u8] = b"$MeshFormat";

const INT: Number = Number::Signed(4);
const DOUBLE: Number = Number::Float(8);
const COUNT: &str = "a number of nodes or elements";
const TAG: &str = "the tag of a node or element";
const COORDINATE: &str = "a coordinate";

/// The layout of sections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    Two,
    /// Each node and its coordinates together.
    FourZero,
    FourOne,
}

/// A file while it is read.
struct Reader<'a> {
    tokens: Tokens<'a>,
    version: Version,
    /// The type of counts, and of tags in version 4.1.
    size: Number,
    reading: Reading<'a>,
    cells: CellFaces,
    /// The vertices of the tags of nodes, and the cells of the tags of elements if columns are read.
    nodes: HashMap<i64, u32>,
    elements: HashMap<i64, u32>,
    /// Numbers of the surface and of the physical group of each cell.
    geometrical: Vec<f64>,
    physical: Vec<f64>,
    columns: Vec<Column>,
}

pub(super) fn parse(bytes: &[u8], reading: Reading<'_>) -> Result<Parsed, ParseError> {
    let mut tokens = Tokens::new(bytes);
    while tokens.peek().is_some_and(|word| word != HEADER) {
        let word = tokens.word();
        let is_section = word.is_some_and(|word| word.starts_with(b"$"));
        if !is_section || tokens.skip_section(word).is_none() {
            return Err(tokens.expected("the section $MeshFormat", word, None));
        }
    }
    let (version, size) = format(&mut tokens)?;
    let mut reader = Reader {
        tokens,
        version,
        size,
        reading,
        cells: CellFaces::new(0),
        nodes: HashMap::new(),
        elements: HashMap::new(),
        geometrical: Vec::new(),
        physical: Vec::new(),
        columns: Vec::new(),
    };
    while let Some(word) = reader.tokens.word() {
        match (word, version) {
            (b"$Nodes", Version::Two) => reader.nodes_of_two()?,
            (b"$Nodes", _) => reader.nodes_of_four()?,
            (b"$Elements", Version::Two) => reader.elements_of_two()?,
            (b"$Elements", _) => reader.elements_of_four()?,
            (b"$NodeData" | b"$ElementData", _) if reading.columns == Columns::Read => {
                reader.data(word == b"$NodeData")?;
            }
            _ if word.starts_with(b"$End") => {}
            _ if word.starts_with(b"$") => {
                if reader.tokens.skip_section(Some(word)).is_none() {
                    return Err(reader.tokens.expected(
                        "the end of this section",
                        Some(word),
                        None,
                    ));
                }
            }
            _ => {
                return Err(reader
                    .tokens
                    .expected("a section such as $Nodes", Some(word), None));
            }
        }
    }
    reader.faces()
}

/// Reads the version and the storage of numbers.
fn format(tokens: &mut Tokens<'_>) -> Result<(Version, Number), ParseError> {
    tokens.word();
    let word = tokens.word();
    let version = match word {
        Some(word) if word.starts_with(b"2") => Version::Two,
        Some(b"4" | b"4.0") => Version::FourZero,
        Some(b"4.1") => Version::FourOne,
        _ => return Err(tokens.expected("a version of 2, 4.0 or 4.1", word, None)),
    };
    let is_binary: u8 = tokens.parsed("0 for ASCII or 1 for binary")?;
    let word = tokens.word();
    let size = match word {
        Some(b"4") => Number::Unsigned(4),
        Some(b"8") => Number::Unsigned(8),
        _ => return Err(tokens.expected("the size of a number, 4 or 8", word, None)),
    };
    if is_binary == 1 {
        tokens.line();
        let mut other = tokens.clone();
        tokens.binary = Some(false);
        other.binary = Some(true);
        let one = tokens.integer(INT, "the number 1")?;
        if one != 1 {
            tokens.binary = other.binary;
            if other.integer(INT, "the number 1")? != 1 {
                let problem = Problem::Expected {
                    expected: "the number 1 in 4 bytes",
                    found: format!("`{one}`"),
                };
                return Err(problem.at(tokens.position(), None));
            }
        }
    }
    tokens.word();
    Ok((version, size))
}

impl Reader<'_> {
    fn count(&mut self) -> Result<usize, ParseError> {
        let count = self.tokens.integer(self.size, COUNT)?;
        let wrong = || {
            self.tokens
                .expected(COUNT, Some(b"a negative number"), None)
        };
        usize::try_from(count).map_err(|_| wrong())
    }

    /// A number between the name of a section of version 2 and its items, which is a word in binary files, too.
    fn count_in_words(&mut self) -> Result<usize, ParseError> {
        let count = self.tokens.parsed(COUNT)?;
        if self.tokens.binary.is_some() {
            self.tokens.line();
        }
        Ok(count)
    }

    fn add_node(&mut self, tag: i64) -> Result<(), ParseError> {
        let vertex = self.cells.builder.positions.len();
        let element = Element::Vertex(vertex);
        let mut point = [0.0; 3];
        for (axis, coordinate) in point.iter_mut().enumerate() {
            let value = self.tokens.float(DOUBLE, COORDINATE)?;
            *coordinate = finite(value, axis, self.reading.unknown, || value.to_string())
                .map_err(|problem| problem.at(self.tokens.position(), Some(element)))?;
        }
        self.nodes.insert(tag, vertex as u32);
        self.cells.builder.positions.push(point);
        Ok(())
    }

    fn nodes_of_two(&mut self) -> Result<(), ParseError> {
        for _ in 0..self.count_in_words()? {
            let tag = self.tokens.integer(INT, TAG)?;
            self.add_node(tag)?;
        }
        Ok(())
    }

    fn nodes_of_four(&mut self) -> Result<(), ParseError> {
        self.after_name();
        let blocks = self.count()?;
        self.totals()?;
        for _ in 0..blocks {
            let first = self.tokens.integer(INT, "an entity")?;
            let second = self.tokens.integer(INT, "an entity")?;
            let dimension = match self.version {
                Version::FourOne => first,
                _ => second,
            };
            // Coordinates on the entity follow those in space.
            let parameters = match self.tokens.integer(INT, "0 or 1")? {
                0 => 0,
                _ => dimension.clamp(0, 3),
            };
            let count = self.count()?;
            let tags = match self.version {
                Version::FourOne => self.tokens.integers(count, self.size, TAG)?,
                _ => Vec::new(),
            };
            for at in 0..count {
                let tag = match tags.get(at) {
                    Some(&tag) => tag,
                    None => self.tokens.integer(INT, TAG)?,
                };
                self.add_node(tag)?;
                for _ in 0..parameters {
                    self.tokens.float(DOUBLE, COORDINATE)?;
                }
            }
        }
        Ok(())
    }

    fn elements_of_two(&mut self) -> Result<(), ParseError> {
        let mut left = self.count_in_words()?;
        while left > 0 {
            // Binary elements come in blocks of one type, ASCII ones each with its type.
            let is_binary = self.tokens.binary.is_some();
            let mut tag = match is_binary {
                true => 0,
                false => self.tokens.integer(INT, TAG)?,
            };
            let kind = self.kind()?;
            let block = match is_binary {
                true => usize::try_from(self.tokens.integer(INT, COUNT)?).unwrap_or(0),
                false => 1,
            };
            let tags = self.tokens.integer(INT, "the number of tags")?;
            if block == 0 || block > left {
                let found = format!("{block}");
                let expected = "a block of one to all elements that are left";
                let problem = Problem::Expected { expected, found };
                return Err(problem.at(self.tokens.position(), None));
            }
            for _ in 0..block {
                if is_binary {
                    tag = self.tokens.integer(INT, TAG)?;
                }
                let mut groups = [0, 0];
                for at in 0..tags {
                    let number = self.tokens.integer(INT, "the number of a group")?;
                    if let Some(group) = usize::try_from(at).ok().and_then(|at| groups.get_mut(at))
                    {
                        *group = number;
                    }
                }
                let [physical, geometrical] = groups;
                self.physical.push(physical as f64);
                self.add_element(tag, kind, geometrical, INT)?;
            }
            left -= block;
        }
        Ok(())
    }

    fn elements_of_four(&mut self) -> Result<(), ParseError> {
        self.after_name();
        let blocks = self.count()?;
        self.totals()?;
        for _ in 0..blocks {
            let first = self.tokens.integer(INT, "an entity")?;
            let second = self.tokens.integer(INT, "an entity")?;
            let (entity, tag) = match self.version {
                Version::FourOne => (second, self.size),
                _ => (first, INT),
            };
            let kind = self.kind()?;
            for _ in 0..self.count()? {
                let own = self.tokens.integer(tag, TAG)?;
                self.add_element(own, kind, entity, tag)?;
            }
        }
        Ok(())
    }

    /// Binary numbers follow the end of the line.
    fn after_name(&mut self) {
        if self.tokens.binary.is_some() {
            self.tokens.line();
        }
    }

    /// Skips the numbers of all items, and of the least and largest tag.
    fn totals(&mut self) -> Result<(), ParseError> {
        let numbers = match self.version {
            Version::FourOne => 3,
            _ => 1,
        };
        for _ in 0..numbers {
            self.tokens.integer(self.size, COUNT)?;
        }
        Ok(())
    }

    fn kind(&mut self) -> Result<(Cell, usize), ParseError> {
        let number = self.tokens.integer(INT, "a type of elements")?;
        of_gmsh(number).ok_or_else(|| {
            let problem = Problem::Expected {
                expected: "a type of elements of Gmsh, such as 2 for triangles",
                found: format!("`{number}`"),
            };
            problem.at(self.tokens.position(), None)
        })
    }

    fn add_element(
        &mut self,
        tag: i64,
        (cell, count): (Cell, usize),
        geometrical: i64,
        kind: Number,
    ) -> Result<(), ParseError> {
        let position = self.tokens.position();
        let mut nodes = [0; 125];
        for node in &mut nodes[..count] {
            let tag = self.tokens.integer(kind, TAG)?;
            *node = *self.nodes.get(&tag).ok_or_else(|| {
                let problem = Problem::Expected {
                    expected: "the tag of a node of the section $Nodes",
                    found: format!("`{tag}`"),
                };
                problem.at(position, Some(self.cells.builder.next_face()))
            })?;
        }
        if self.reading.columns == Columns::Read {
            self.elements.insert(tag, self.cells.triangles.len() as u32);
        }
        self.geometrical.push(geometrical as f64);
        self.cells.add(cell, &nodes[..count], position);
        Ok(())
    }

    fn faces(mut self) -> Result<Parsed, ParseError> {
        // Nodes of lines and points that no face has, such as centres of circles.
        self.cells.builder.leaves_out_unused = true;
        let (builder, triangles) = self.cells.faces()?;
        if self.reading.columns == Columns::Skipped {
            return Ok((builder, Vec::new()));
        }
        let groups = [
            ("gmsh:physical", self.physical),
            ("gmsh:geometrical", self.geometrical),
        ];
        for (name, values) in groups {
            if values.len() == triangles.len() {
                self.columns.push(Column {
                    name: name.to_owned(),
                    place: ColumnPlace::Triangles,
                    values,
                });
            }
        }
        for column in &mut self.columns {
            if column.place == ColumnPlace::Triangles {
                column.values = at_triangles(&column.values, &triangles);
            }
        }
        Ok((builder, self.columns))
    }
}
