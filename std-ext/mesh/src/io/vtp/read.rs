//! The polygons of a PolyData file as a mesh.

use super::super::xml::{Tag, Tags, line_of};
use super::super::{
    Budget, Column, ColumnPlace, Columns, MeshBuilder, ParseError, Problem, Unknown, finite,
};
use super::array::{Array, Storage};

/// A piece of the surface.
#[derive(Default)]
struct Piece<'a> {
    at: usize,
    vertices: usize,
    /// Number of single vertices and lines, which precede the polygons in arrays of cells.
    skipped: usize,
    points: Option<Array<'a>>,
    connectivity: Option<Array<'a>>,
    ends: Option<Array<'a>>,
    /// Arrays of one component at the points and cells, if columns are read.
    columns: Vec<(ColumnPlace, String, Array<'a>)>,
}

/// The structure of a file, without its numbers.
struct Outline<'a> {
    storage: Storage<'a>,
    pieces: Vec<Piece<'a>>,
}

pub(in crate::io) fn parse(
    bytes: &[u8],
    columns: Columns,
    unknown: Unknown,
) -> Result<(MeshBuilder, Vec<Column>), ParseError> {
    let Outline { storage, pieces } = outline(bytes, columns)?;
    let mut builder = MeshBuilder::new(0);
    for piece in &pieces {
        piece.add_to(&mut builder, &storage, unknown)?;
    }
    Ok((builder, joined(&pieces, &storage)?))
}

/// Columns that every piece with points has, concatenated in the order of pieces.
fn joined(pieces: &[Piece<'_>], storage: &Storage<'_>) -> Result<Vec<Column>, ParseError> {
    let pieces = Vec::from_iter(pieces.iter().filter(|piece| piece.vertices > 0));
    let names = pieces.first().map_or(&[][..], |piece| &piece.columns);
    let mut columns = Vec::new();
    for (place, name, _) in names {
        let arrays = pieces.iter().map(|piece| {
            let mut own = piece.columns.iter();
            let found = own.find(|(of, own, _)| (of, own) == (place, name));
            found.map(|(_, _, array)| (piece, array))
        });
        let Some(arrays) = arrays.collect::<Option<Vec<_>>>() else {
            continue;
        };
        let mut values = Vec::new();
        for (piece, array) in arrays {
            values.extend(piece.numbers(*place, array, storage)?);
        }
        columns.push(Column {
            name: name.clone(),
            place: *place,
            values,
        });
    }
    Ok(columns)
}

fn outline(bytes: &[u8], columns: Columns) -> Result<Outline<'_>, ParseError> {
    let mut tags = Tags::new(bytes);
    let mut storage = None;
    let mut pieces: Vec<Piece<'_>> = Vec::new();
    let mut section: &[u8] = b"";
    while let Some(tag) = tags.next()? {
        match (tag.name, storage.as_mut()) {
            (b"VTKFile", _) if !tag.closes => storage = Some(stored(bytes, &tag)?),
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
                b"Points" | b"Polys" | b"PointData" | b"CellData" | b"Verts" | b"Lines" | b"Strips",
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
                if let (Some(of), Some(name), Columns::Read) = (of, name, columns) {
                    let components = tag.attribute("NumberOfComponents");
                    // Arrays of texts are skipped.
                    if let (None | Some("1"), Ok(array)) = (components, Array::new(bytes, &tag)) {
                        piece.columns.push((of, name.to_owned(), array));
                    }
                    continue;
                }
                let place = match (section, name) {
                    (b"Points", _) => &mut piece.points,
                    (b"Polys", Some("connectivity")) => &mut piece.connectivity,
                    (b"Polys", Some("offsets")) => &mut piece.ends,
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
fn stored<'a>(file: &'a [u8], tag: &Tag<'_>) -> Result<Storage<'a>, ParseError> {
    let wrong = |what, attribute| {
        let found = tag.attribute(attribute).unwrap_or_default();
        Err(expected(file, tag, what, shown(found.as_bytes())))
    };
    if tag.attribute("type") != Some("PolyData") {
        return wrong("data of the type PolyData", "type");
    }
    let compressed = match tag.attribute("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(_) => {
            return wrong(
                "the compressor vtkZLibDataCompressor, or none",
                "compressor",
            );
        }
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
        compressed,
        budget: Budget::new(file.len(), compressed),
        appended: None,
    })
}

fn piece<'a>(file: &[u8], tag: &Tag<'_>) -> Result<Piece<'a>, ParseError> {
    let count = |name| {
        tag.attribute(name)
            .and_then(|text| text.trim().parse().ok())
    };
    if count("NumberOfStrips").is_some_and(|strips: usize| strips > 0) {
        let found = "strips of triangles".to_owned();
        return Err(expected(file, tag, "polygons only", found));
    }
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
        // Without corners there are no faces, and the ends have not been checked.
        let ends = match (&self.connectivity, &self.ends) {
            (Some(_), Some(ends)) => ends.indices(storage)?.values,
            _ => Vec::new(),
        };
        let cells = self.skipped.saturating_add(ends.len());
        if found != cells {
            return Err(wrong("CellData", format!("{cells} cells")));
        }
        let starts = std::iter::once(&0).chain(&ends);
        let faces = own.values[self.skipped..]
            .iter()
            .zip(ends.iter().zip(starts));
        // Faces with fewer than three corners have no triangle.
        let repeated = faces.map(|(&value, (end, start))| {
            std::iter::repeat_n(value, usize::try_from(end - start - 2).unwrap_or(0))
        });
        Ok(repeated.flatten().collect())
    }

    fn add_to(
        &self,
        builder: &mut MeshBuilder,
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
        // A piece may have no polygons.
        let (Some(connectivity), Some(ends)) = (&self.connectivity, &self.ends) else {
            return Ok(());
        };
        let (corners, ends) = (connectivity.indices(storage)?, ends.indices(storage)?);
        // All faces get the line of the first, because counting lines for each would take too long.
        let here = corners.first_position(file);
        let mut start = 0;
        let mut face = Vec::new();
        for (index, &end) in ends.values.iter().enumerate() {
            let element = builder.next_face();
            let own = usize::try_from(end).ok();
            let own = own.and_then(|end| Some((end, corners.values.get(start..end)?)));
            let Some((end, own)) = own else {
                let problem = Problem::Expected {
                    expected: "ends of polygons that rise, and are no larger than the connectivity",
                    found: format!("`{end}`"),
                };
                return Err(problem.at(ends.position(file, index), Some(element)));
            };
            face.clear();
            for (place, &vertex) in own.iter().enumerate() {
                let known = usize::try_from(vertex).ok().filter(|&v| v < self.vertices);
                let known = known.and_then(|v| u32::try_from(before + v).ok());
                face.push(known.ok_or_else(|| {
                    let problem = Problem::VertexOutOfRange {
                        vertex,
                        vertices: self.vertices,
                        first: 0,
                    };
                    problem.at(corners.position(file, start + place), Some(element))
                })?);
            }
            builder.add_face(&face, here);
            start = end;
        }
        Ok(())
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
