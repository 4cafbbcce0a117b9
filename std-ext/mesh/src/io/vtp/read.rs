//! The faces of a PolyData or UnstructuredGrid file as a mesh.

use super::super::cells::{Cell, CellFaces, CellList, CellPart, Kinds, at_triangles};
use super::super::xml::{Tag, Tags, line_of};
use super::super::{
    Budget, Column, ColumnPlace, Columns, ParseError, Parsed, Problem, Reading, Unknown, finite,
    without_mark,
};
use super::array::{Array, Storage};
use super::compressor::Compressor;
use super::parts::{self, Parts};

/// The array that marks cells, and its marks of those that are not a part of the piece: copies of cells of other
/// pieces, refined and hidden ones. Source: VTK's `vtkDataSetAttributes.h`.
const GHOSTS: &str = "vtkGhostType";
const NOT_OWN: i64 = 1 | 8 | 32;

/// A piece of the surface.
#[derive(Default)]
struct Piece<'a> {
    at: usize,
    vertices: usize,
    /// Number of single vertices and lines, which precede the polygons in arrays of cells.
    skipped: usize,
    points: Option<Array<'a>>,
    /// Polygons, and strips of triangles; or cells of the types of an unstructured grid.
    sections: [Section<'a>; 2],
    /// Arrays of one component at the points and cells, if columns are read.
    columns: Vec<(ColumnPlace, String, Array<'a>)>,
    /// Marks of cells that other pieces have, too.
    ghosts: Option<Array<'a>>,
}

/// The cells of a piece.
#[derive(Default)]
struct Section<'a> {
    connectivity: Option<Array<'a>>,
    ends: Option<Array<'a>>,
    types: Option<Array<'a>>,
}

/// The structure of a file, without its numbers.
struct Outline<'a> {
    storage: Storage<'a>,
    pieces: Vec<Piece<'a>>,
}

pub(in crate::io) fn parse(bytes: &[u8], reading: Reading<'_>) -> Result<Parsed, ParseError> {
    let Some(Parts { names, are_of_one }) = parts::parts(bytes)? else {
        return assembled(&[outline(bytes, reading)?], reading.unknown, false);
    };
    let files = names.iter().map(|name| parts::part(name, reading));
    let files = files.collect::<Result<Vec<_>, _>>()?;
    let outlines = names.iter().zip(&files).map(|(name, bytes)| {
        let own = Reading {
            length: bytes.len(),
            ..reading
        };
        outline(without_mark(bytes), own).map_err(|error| parts::within(name, &error))
    });
    let outlines = outlines.collect::<Result<Vec<_>, _>>()?;
    assembled(&outlines, reading.unknown, are_of_one)
}

/// The faces and columns of the pieces of all files. If they are of one surface, points at the same place become one.
fn assembled(
    files: &[Outline<'_>],
    unknown: Unknown,
    are_of_one: bool,
) -> Result<Parsed, ParseError> {
    let mut cells = CellFaces::new(0);
    let mut starts = Vec::new();
    let pieces = files.iter().flat_map(|file| {
        let storage = &file.storage;
        file.pieces.iter().map(move |piece| (piece, storage))
    });
    for (piece, storage) in pieces.clone() {
        starts.push(cells.triangles.len());
        piece.add_to(&mut cells, storage, unknown)?;
    }
    if are_of_one {
        cells.merge();
    }
    let (builder, triangles) = cells.faces()?;
    starts.push(triangles.len());
    let own = starts.windows(2).map(|pair| &triangles[pair[0]..pair[1]]);
    Ok((builder, joined(pieces.zip(own))?))
}

/// Columns that every piece with points has, concatenated in the order of pieces.
/// Each piece comes with the number of triangles of each of its cells.
fn joined<'p>(
    pieces: impl Iterator<Item = ((&'p Piece<'p>, &'p Storage<'p>), &'p [u32])>,
) -> Result<Vec<Column>, ParseError> {
    let pieces = Vec::from_iter(pieces.filter(|((piece, _), _)| piece.vertices > 0));
    let first = pieces.first();
    let names = first.map_or(&[][..], |((piece, _), _)| &piece.columns);
    let mut columns = Vec::new();
    for (place, name, _) in names {
        let arrays = pieces.iter().map(|&((piece, storage), triangles)| {
            let mut own = piece.columns.iter();
            let found = own.find(|(of, own, _)| (of, own) == (place, name));
            found.map(|(_, _, array)| (piece, storage, triangles, array))
        });
        let Some(arrays) = arrays.collect::<Option<Vec<_>>>() else {
            continue;
        };
        let mut values = Vec::new();
        for (piece, storage, triangles, array) in arrays {
            values.extend(piece.numbers(*place, array, triangles, storage)?);
        }
        columns.push(Column {
            name: name.clone(),
            place: *place,
            values,
        });
    }
    Ok(columns)
}

fn outline<'a>(bytes: &'a [u8], reading: Reading<'_>) -> Result<Outline<'a>, ParseError> {
    let mut tags = Tags::new(bytes);
    let mut storage = None;
    let mut pieces: Vec<Piece<'_>> = Vec::new();
    let mut section: &[u8] = b"";
    while let Some(tag) = tags.next()? {
        match (tag.name, storage.as_mut()) {
            (b"VTKFile", _) if !tag.closes => storage = Some(stored(bytes, &tag, reading)?),
            (_, None) => {
                return Err(expected(bytes, &tag, "the tag VTKFile", shown(tag.name)));
            }
            (b"AppendedData", Some(storage)) => {
                let base64 = tag.attribute("encoding") == Some("base64");
                let rest = &bytes[tag.end..];
                let start = rest.iter().position(|&byte| byte == b'_');
                storage.appended = start.map(|at| (&rest[at + 1..], base64));
                break;
            }
            (b"Piece", _) if !tag.closes => pieces.push(piece(bytes, &tag)?),
            (
                b"Points" | b"Polys" | b"PointData" | b"CellData" | b"Verts" | b"Lines" | b"Strips"
                | b"Cells",
                _,
            ) => {
                section = if tag.closes { b"" } else { tag.name };
            }
            (b"DataArray", _) if !tag.closes => {
                let Some(piece) = pieces.last_mut() else {
                    continue;
                };
                let name = tag.attribute("Name");
                let of = match section {
                    b"PointData" => Some(ColumnPlace::Vertices),
                    b"CellData" => Some(ColumnPlace::Triangles),
                    _ => None,
                };
                if let (b"CellData", Some(GHOSTS)) = (section, name) {
                    piece.ghosts = Some(Array::new(bytes, &tag)?);
                    continue;
                }
                if let (Some(of), Some(name), Columns::Read) = (of, name, reading.columns) {
                    let components = tag.attribute("NumberOfComponents");
                    // Arrays of texts are skipped.
                    if let (None | Some("1"), Ok(array)) = (components, Array::new(bytes, &tag)) {
                        piece.columns.push((of, name.to_owned(), array));
                    }
                    continue;
                }
                let [polygons, strips] = &mut piece.sections;
                let cells = match section {
                    b"Strips" => strips,
                    _ => polygons,
                };
                let place = match (section, name) {
                    (b"Points", _) => &mut piece.points,
                    (b"Polys" | b"Strips" | b"Cells", Some("connectivity")) => {
                        &mut cells.connectivity
                    }
                    (b"Polys" | b"Strips" | b"Cells", Some("offsets")) => &mut cells.ends,
                    (b"Cells", Some("types")) => &mut cells.types,
                    _ => continue,
                };
                *place = Some(Array::new(bytes, &tag)?);
            }
            _ => {}
        }
    }
    let storage = storage.ok_or_else(|| {
        let problem = Problem::Expected {
            expected: "the tag VTKFile",
            found: "the end of the file".to_owned(),
        };
        problem.anywhere()
    })?;
    Ok(Outline { storage, pieces })
}

/// The storage that the tag `VTKFile` declares.
fn stored<'a>(
    file: &'a [u8],
    tag: &Tag<'_>,
    reading: Reading<'_>,
) -> Result<Storage<'a>, ParseError> {
    let wrong = |what, attribute| {
        let found = tag.attribute(attribute).unwrap_or_default();
        Err(expected(file, tag, what, shown(found.as_bytes())))
    };
    if !matches!(tag.attribute("type"), Some("PolyData" | "UnstructuredGrid")) {
        return wrong("data of the type PolyData or UnstructuredGrid", "type");
    }
    let compressor = match tag.attribute("compressor") {
        None | Some("") => None,
        Some(name) => match Compressor::named(name) {
            None => return wrong("a compressor of zlib, LZ4 or LZMA, or none", "compressor"),
            known => known,
        },
    };
    Ok(Storage {
        file,
        big_endian: match tag.attribute("byte_order") {
            Some("BigEndian") => true,
            Some("LittleEndian") | None => false,
            Some(_) => return wrong("the byte order LittleEndian or BigEndian", "byte_order"),
        },
        header: match tag.attribute("header_type") {
            Some("UInt64") => 8,
            Some("UInt32") | None => 4,
            Some(_) => return wrong("headers of the type UInt32 or UInt64", "header_type"),
        },
        compressor,
        budget: Budget::new(reading.length, compressor.is_some()),
        appended: None,
    })
}

fn piece<'a>(file: &[u8], tag: &Tag<'_>) -> Result<Piece<'a>, ParseError> {
    let count = |name| {
        tag.attribute(name)
            .and_then(|text| text.trim().parse().ok())
    };
    let Some(vertices) = count("NumberOfPoints") else {
        let found = "none".to_owned();
        return Err(expected(file, tag, "a number of points", found));
    };
    Ok(Piece {
        at: tag.start,
        vertices,
        skipped: ["NumberOfVerts", "NumberOfLines"]
            .into_iter()
            .filter_map(count)
            .fold(0, usize::saturating_add),
        ..Piece::default()
    })
}

impl Piece<'_> {
    /// Numbers of an array at the vertices or triangles.
    fn numbers(
        &self,
        place: ColumnPlace,
        array: &Array<'_>,
        triangles: &[u32],
        storage: &Storage<'_>,
    ) -> Result<Vec<f64>, ParseError> {
        let own = array.floats(storage)?;
        let found = own.values.len();
        let wrong = |section, places| {
            let problem = Problem::ColumnLength {
                section,
                found,
                places,
            };
            problem.at(own.first_position(storage.file), None)
        };
        if place == ColumnPlace::Vertices {
            return match self.vertices {
                vertices if vertices == found => Ok(own.values),
                vertices => Err(wrong("PointData", format!("{vertices} points"))),
            };
        }
        let cells = self.skipped.saturating_add(triangles.len());
        if found != cells {
            return Err(wrong("CellData", format!("{cells} cells")));
        }
        Ok(at_triangles(&own.values[self.skipped..], triangles))
    }

    fn add_to(
        &self,
        cells: &mut CellFaces,
        storage: &Storage<'_>,
        unknown: Unknown,
    ) -> Result<(), ParseError> {
        let file = storage.file;
        let missing = |missing| Problem::Undeclared { missing }.at(line_of(file, self.at), None);
        if self.vertices == 0 {
            return Ok(());
        }
        let points = self.points.as_ref().ok_or_else(|| missing("points"))?;
        let coordinates = points.floats(storage)?;
        let found = coordinates.values.len() / 3;
        if found < self.vertices {
            let problem = Problem::truncated("vertices", self.vertices, found);
            return Err(problem.at(line_of(file, self.at), None));
        }
        let builder = &mut cells.builder;
        let before = builder.positions.len();
        for (index, &value) in coordinates.values[..3 * self.vertices].iter().enumerate() {
            if index % 3 == 0 {
                builder.positions.push([0.0; 3]);
            }
            let vertex = before + index / 3;
            let checked =
                finite(value, index % 3, unknown, || value.to_string()).map_err(|problem| {
                    let element = super::super::Element::Vertex(vertex);
                    problem.at(coordinates.position(file, index), Some(element))
                })?;
            builder.positions[vertex][index % 3] = checked;
        }
        let ghosts = self.ghosts.as_ref().map(|ghosts| ghosts.indices(storage));
        let ghosts = ghosts.transpose()?;
        let marks = ghosts
            .as_ref()
            .and_then(|own| own.values.get(self.skipped..));
        let first = cells.triangles.len();
        let [polygons, strips] = &self.sections;
        for (section, kind) in [(polygons, Cell::Polygon), (strips, Cell::Strip)] {
            let done = cells.triangles.len() - first;
            let marks = marks
                .and_then(|marks| marks.get(done..))
                .unwrap_or_default();
            let is_left_out = |cell: usize| marks.get(cell).is_some_and(|mark| mark & NOT_OWN != 0);
            let own = (before, self.vertices);
            section.add_to(cells, kind, own, &is_left_out, storage)?;
        }
        Ok(())
    }
}

impl Section<'_> {
    /// Adds the cells, which are all of one kind if they have no types, without those that are left out. Their nodes
    /// count from `before`.
    fn add_to(
        &self,
        cells: &mut CellFaces,
        kind: Cell,
        (before, vertices): (usize, usize),
        is_left_out: &dyn Fn(usize) -> bool,
        storage: &Storage<'_>,
    ) -> Result<(), ParseError> {
        let file = storage.file;
        // A piece may have no such cells.
        let (Some(connectivity), Some(ends)) = (&self.connectivity, &self.ends) else {
            return Ok(());
        };
        let (corners, ends) = (connectivity.indices(storage)?, ends.indices(storage)?);
        let types = match &self.types {
            Some(types) => Some(types.indices(storage)?),
            None => None,
        };
        let list = CellList {
            nodes: &corners.values,
            ends: &ends.values,
            kinds: match &types {
                Some(types) => Kinds::Types(&types.values),
                None => Kinds::All(kind),
            },
            before,
            vertices,
            is_left_out,
        };
        cells.add_list(&list, &|part| match (part, &types) {
            (CellPart::Node(index), _) => corners.position(file, index),
            (CellPart::End(index), _) => ends.position(file, index),
            (CellPart::Type(index), Some(types)) => types.position(file, index),
            (CellPart::All | CellPart::Type(_), _) => corners.first_position(file),
        })
    }
}

fn expected(file: &[u8], tag: &Tag<'_>, expected: &'static str, found: String) -> ParseError {
    Problem::Expected { expected, found }.at(line_of(file, tag.start), None)
}

/// A name for an error message.
fn shown(name: &[u8]) -> String {
    let name = String::from_utf8_lossy(&name[..name.len().min(40)]);
    format!("`{}`", name.escape_debug())
}
