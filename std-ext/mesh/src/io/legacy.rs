//! VTK's legacy files, ASCII and binary.
//!
//! Source: *VTK file formats* (docs.vtk.org, legacy formats, and the change of version 5.1). A header of lines is
//! followed by sections, each a line of keywords and its numbers, big-endian in binary files. Before version 5,
//! each cell is the number of its nodes and the nodes; since then, cells are arrays of offsets and nodes.

mod data;

use super::cells::{Cell, CellFaces, CellList, CellPart, Kinds, Solid, at_triangles};
use super::number::Number;
use super::tokens::Tokens;
use super::{Column, ColumnPlace, Columns, ParseError, Parsed, Position, Problem, Reading, finite};

/// The start of every file.
const HEADER: &[u8] = b"# vtk DataFile Version";

pub(super) fn is_header(bytes: &[u8]) -> bool {
    let start = bytes.get(..HEADER.len());
    start.is_some_and(|start| start.eq_ignore_ascii_case(HEADER))
}

/// Nodes of a list of cells, and the end of each.
struct List {
    at: Position,
    nodes: Vec<i64>,
    ends: Vec<i64>,
}

/// The content of a file.
#[derive(Default)]
struct Content {
    has_points: bool,
    /// Vertices, lines, polygons and strips, in the order of arrays of cells; other cells are polygons.
    lists: [Option<List>; 4],
    /// The types of other cells, and their place.
    types: Option<(Position, Vec<i64>)>,
    /// Numbers of points of a grid along its axes.
    dimensions: Option<(Position, [usize; 3])>,
    columns: Vec<(Position, Column)>,
}

const POLYGONS: usize = 2;

pub(super) fn parse(bytes: &[u8], reading: Reading<'_>) -> Result<Parsed, ParseError> {
    let mut tokens = Tokens::new(bytes);
    header(bytes, &mut tokens)?;
    let mut cells = CellFaces::new(0);
    let content = content(&mut tokens, &mut cells, reading)?;
    add_cells(&content, &mut cells)?;
    let vertices = cells.builder.positions.len();
    let (builder, triangles) = cells.faces()?;
    let mut columns = Vec::new();
    for (at, mut column) in content.columns {
        let (section, expected, places) = match column.place {
            ColumnPlace::Vertices => ("POINT_DATA", vertices, "points"),
            ColumnPlace::Triangles => ("CELL_DATA", triangles.len(), "cells"),
        };
        if column.values.len() != expected {
            let problem = Problem::ColumnLength {
                section,
                found: column.values.len(),
                places: format!("{expected} {places}"),
            };
            return Err(problem.at(at, None));
        }
        if column.place == ColumnPlace::Triangles {
            column.values = at_triangles(&column.values, &triangles);
        }
        columns.push(column);
    }
    Ok((builder, columns))
}

/// Reads the lines before the sections.
fn header(bytes: &[u8], tokens: &mut Tokens<'_>) -> Result<(), ParseError> {
    if !is_header(bytes) {
        let word = tokens.word();
        return Err(tokens.expected("the header `# vtk DataFile Version`", word, None));
    }
    // The version, and a title.
    for _ in 0..2 {
        tokens.line();
    }
    let word = tokens.word();
    tokens.binary = match keyword(word).as_str() {
        "ASCII" => None,
        "BINARY" => Some(true),
        _ => return Err(tokens.expected("ASCII or BINARY", word, None)),
    };
    Ok(())
}

/// A word in upper case.
fn keyword(word: Option<&[u8]>) -> String {
    String::from_utf8_lossy(word.unwrap_or_default()).to_ascii_uppercase()
}

fn content(
    tokens: &mut Tokens<'_>,
    cells: &mut CellFaces,
    reading: Reading<'_>,
) -> Result<Content, ParseError> {
    const COUNT: &str = "a number of points or cells";
    let mut content = Content::default();
    let mut place = None;
    while let Some(word) = tokens.word() {
        let list = match keyword(Some(word)).as_str() {
            "DATASET" => {
                let word = tokens.word();
                if !["POLYDATA", "UNSTRUCTURED_GRID", "STRUCTURED_GRID"].contains(&&*keyword(word))
                {
                    let expected =
                        "POLYDATA, UNSTRUCTURED_GRID or STRUCTURED_GRID, which have faces";
                    return Err(tokens.expected(expected, word, None));
                }
                continue;
            }
            "POINTS" => {
                points(tokens, cells, reading)?;
                content.has_points = true;
                continue;
            }
            "VERTICES" => 0,
            "LINES" => 1,
            "POLYGONS" | "CELLS" => POLYGONS,
            "TRIANGLE_STRIPS" => 3,
            "CELL_TYPES" => {
                let count = tokens.parsed(COUNT)?;
                tokens.line();
                let at = tokens.position();
                let types = tokens.integers(count, Number::Signed(4), "the type of a cell")?;
                content.types = Some((at, types));
                continue;
            }
            "DIMENSIONS" => {
                let mut counts = [0; 3];
                for count in &mut counts {
                    *count = tokens.parsed(COUNT)?;
                }
                content.dimensions = Some((tokens.position(), counts));
                continue;
            }
            // Numbers at points and cells follow the cells.
            "POINT_DATA" | "CELL_DATA" if reading.columns == Columns::Skipped => break,
            "POINT_DATA" => {
                place = Some((ColumnPlace::Vertices, tokens.parsed(COUNT)?));
                continue;
            }
            "CELL_DATA" => {
                place = Some((ColumnPlace::Triangles, tokens.parsed(COUNT)?));
                continue;
            }
            _ => {
                data::read(tokens, word, place, &mut content.columns)?;
                continue;
            }
        };
        content.lists[list] = Some(read_list(tokens)?);
    }
    Ok(content)
}

/// The type of numbers that the next word names.
fn number(tokens: &mut Tokens<'_>) -> Result<Number, ParseError> {
    let word = tokens.word();
    data::named(word).ok_or_else(|| tokens.expected("a type such as float or int", word, None))
}

fn points(
    tokens: &mut Tokens<'_>,
    cells: &mut CellFaces,
    reading: Reading<'_>,
) -> Result<(), ParseError> {
    let count: usize = tokens.parsed("the number of points")?;
    let kind = number(tokens)?;
    tokens.line();
    let positions = &mut cells.builder.positions;
    positions.clear();
    for _ in 0..count {
        let element = super::Element::Vertex(positions.len());
        let mut point = [0.0; 3];
        for (axis, coordinate) in point.iter_mut().enumerate() {
            let value = tokens.float(kind, "a coordinate");
            let value = value.map_err(|error| match tokens.left() {
                0 => {
                    let problem = Problem::truncated("vertices", count, positions.len());
                    problem.at(tokens.position(), None)
                }
                _ => error,
            })?;
            *coordinate = finite(value, axis, reading.unknown, || value.to_string())
                .map_err(|problem| problem.at(tokens.position(), Some(element)))?;
        }
        positions.push(point);
    }
    Ok(())
}

/// Reads the cells behind their keyword.
fn read_list(tokens: &mut Tokens<'_>) -> Result<List, ParseError> {
    const NODE: &str = "the number of a node";
    const END: &str = "the end of a cell";
    let count: usize = tokens.parsed("the number of cells")?;
    let size: usize = tokens.parsed("the size of a list of cells")?;
    let (mut nodes, mut ends) = (Vec::new(), Vec::new());
    if keyword(tokens.peek()) == "OFFSETS" {
        tokens.word();
        let kind = number(tokens)?;
        tokens.line();
        ends = tokens.integers(count, kind, END)?;
        // The first is the start of the first cell.
        if !ends.is_empty() {
            ends.remove(0);
        }
        let word = tokens.word();
        if keyword(word) != "CONNECTIVITY" {
            return Err(tokens.expected("CONNECTIVITY", word, None));
        }
        let kind = number(tokens)?;
        tokens.line();
        let at = tokens.position();
        nodes = tokens.integers(size, kind, NODE)?;
        return Ok(List { at, nodes, ends });
    }
    tokens.line();
    let at = tokens.position();
    for _ in 0..count {
        let own = tokens.integer(Number::Signed(4), "the number of nodes of a cell")?;
        for _ in 0..own {
            nodes.push(tokens.integer(Number::Signed(4), NODE)?);
        }
        ends.push(nodes.len() as i64);
    }
    Ok(List { at, nodes, ends })
}

fn add_cells(content: &Content, cells: &mut CellFaces) -> Result<(), ParseError> {
    let vertices = cells.builder.positions.len();
    if !content.has_points {
        return Err(Problem::Undeclared { missing: "POINTS" }.anywhere());
    }
    let kinds = [Cell::Line, Cell::Line, Cell::Polygon, Cell::Strip];
    for (place, (list, kind)) in content.lists.iter().zip(kinds).enumerate() {
        let Some(List { at, nodes, ends }) = list else {
            continue;
        };
        let types = content.types.as_ref().filter(|_| place == POLYGONS);
        let list = CellList {
            nodes,
            ends,
            kinds: match types {
                Some((_, types)) => Kinds::Types(types),
                None => Kinds::All(kind),
            },
            before: 0,
            vertices,
            is_left_out: &|_| false,
        };
        cells.add_list(&list, &|part| match (part, types) {
            (CellPart::Type(_), Some((at, _))) => *at,
            _ => *at,
        })?;
    }
    let Some((at, counts)) = content.dimensions else {
        return Ok(());
    };
    let all = counts
        .iter()
        .try_fold(1_usize, |all, &count| all.checked_mul(count));
    if all != Some(vertices) {
        let problem = Problem::Expected {
            expected: "as many points as the product of the dimensions",
            found: format!("{vertices}"),
        };
        return Err(problem.at(at, None));
    }
    let layer = Vec::from_iter(counts.into_iter().filter(|&count| count > 1));
    match layer[..] {
        [columns, rows] => {
            for row in 0..rows - 1 {
                for column in 0..columns - 1 {
                    let first = (row * columns + column) as u32;
                    let above = first + columns as u32;
                    cells.add(Cell::Pixel, &[first, first + 1, above, above + 1], at);
                }
            }
        }
        [columns, rows, layers] => {
            let vertex = |x, y, z| ((z * rows + y) * columns + x) as u32;
            for z in 0..layers - 1 {
                for y in 0..rows - 1 {
                    for x in 0..columns - 1 {
                        let corner = |at: usize| {
                            let [right, back, up] = [0, 1, 2].map(|axis| at >> axis & 1);
                            vertex(x + right, y + back, z + up)
                        };
                        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
                        cells.add(Cell::Solid(Solid::Voxel), &corners, at);
                    }
                }
            }
        }
        _ => {}
    }
    Ok(())
}
