//! 3MF: models for printers.
//!
//! Source: 3MF Consortium, 3MF Core Specification 1.3 and Production Extension 1.1. A ZIP archive has XML files of
//! objects: meshes, or other objects with transformations. The items to be built become one mesh.

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DAffine3, DMat3, DVec3};

use super::xml::{Tag, Tags};
use super::zip::Archive;
use super::{
    Budget, Element, MeshBuilder, ParseError, Position, Problem, Reading, Unknown, finite,
};

/// The usual name of the first file.
const MODEL: &str = "3D/3dmodel.model";

/// An object: its mesh, and the objects of which it is made.
#[derive(Default)]
struct Object {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The places of the triangles in the unpacked file.
    places: Vec<usize>,
    parts: Vec<Part>,
}

/// An object at a place.
#[derive(Clone)]
struct Part {
    file: Rc<str>,
    object: Rc<str>,
    placed: DAffine3,
}

/// The objects of a file by their numbers, and the items to be built.
#[derive(Default)]
struct Model {
    objects: HashMap<Rc<str>, Object>,
    items: Vec<Part>,
}

pub(super) fn parse(bytes: &[u8], reading: Reading<'_>) -> Result<MeshBuilder, ParseError> {
    let archive = Archive::new(bytes)?;
    let budget = Budget::new(reading.length, true);
    let root: Rc<str> = root(&archive, &budget)?.into();
    let mut models = HashMap::new();
    let mut builder = MeshBuilder::new(0);
    models.insert(
        root.clone(),
        model(&archive, &root, &budget, reading.unknown)?,
    );
    let mut next = models[&root].items.clone();
    next.reverse();
    while let Some(Part {
        file,
        object,
        placed,
    }) = next.pop()
    {
        if !models.contains_key(&file) {
            models.insert(
                file.clone(),
                model(&archive, &file, &budget, reading.unknown)?,
            );
        }
        let own = models[&file].objects.get(&object);
        let own = own.ok_or_else(|| wrong("the number of an object", &object, None))?;
        // Objects may be used again and again.
        let numbers = own.positions.len() + own.triangles.len() + 32 * (1 + own.parts.len());
        budget.take(3 * numbers).map_err(Problem::anywhere)?;
        add(own, placed, reading.unknown, &mut builder)?;
        next.extend(own.parts.iter().rev().map(|part| Part {
            placed: placed * part.placed,
            ..part.clone()
        }));
    }
    Ok(builder)
}

fn wrong(expected: &'static str, found: &str, at: Option<usize>) -> ParseError {
    let shown = String::from_iter(found.chars().take(40));
    let found = format!("`{}`", shown.escape_debug());
    let problem = Problem::Expected { expected, found };
    match at {
        Some(at) => problem.at(Position::Byte(at), None),
        None => problem.anywhere(),
    }
}

/// The name of the first file, which the relations of the archive name.
fn root(archive: &Archive<'_>, budget: &Budget) -> Result<String, ParseError> {
    let relations = archive.file("_rels/.rels", budget)?.unwrap_or_default();
    let mut tags = Tags::new(&relations);
    while let Some(tag) = tags.next()? {
        let is_model = |kind: &str| kind.ends_with("/3dmodel");
        if let (true, Some(target)) = (
            tag.attribute("Type").is_some_and(is_model),
            tag.attribute("Target"),
        ) {
            return Ok(target.trim_start_matches('/').to_owned());
        }
    }
    Ok(MODEL.to_owned())
}

/// Adds the triangles of an object at its place.
fn add(
    object: &Object,
    placed: DAffine3,
    unknown: Unknown,
    builder: &mut MeshBuilder,
) -> Result<(), ParseError> {
    let before = builder.positions.len();
    for &point in &object.positions {
        let vertex = builder.positions.len();
        let mut point = placed.transform_point3(point.into()).to_array();
        for (axis, coordinate) in point.iter_mut().enumerate() {
            let value = *coordinate;
            *coordinate = finite(value, axis, unknown, || value.to_string())
                .map_err(|problem| problem.at(Position::Byte(0), Some(Element::Vertex(vertex))))?;
        }
        builder.positions.push(point);
    }
    let first = builder.triangle_count();
    for (triangle, &place) in object.triangles.iter().zip(&object.places) {
        let vertices = object.positions.len();
        if let Some(&vertex) = triangle.iter().find(|&&v| v as usize >= vertices) {
            let problem = Problem::VertexOutOfRange {
                vertex: vertex.into(),
                vertices,
                first: 0,
            };
            return Err(problem.at(Position::Byte(place), Some(builder.next_face())));
        }
        let triangle = triangle.map(|vertex| (before + vertex as usize) as u32);
        builder.add_face(&triangle, Position::Byte(place));
    }
    // Mirrored surfaces keep their outside.
    if placed.matrix3.determinant() < 0.0 {
        builder.reverse_from(first);
    }
    Ok(())
}

/// Reads the objects and items of a file of the archive.
fn model(
    archive: &Archive<'_>,
    name: &Rc<str>,
    budget: &Budget,
    unknown: Unknown,
) -> Result<Model, ParseError> {
    let bytes = archive.file(name, budget)?;
    let bytes = bytes.ok_or_else(|| wrong("a file of the archive", name, None))?;
    let mut tags = Tags::new(&bytes);
    let mut model = Model::default();
    let (mut id, mut object) = (None, Object::default());
    while let Some(tag) = tags.next()? {
        match (tag.name, tag.closes) {
            (b"object", false) => {
                id = tag.attribute("id").map(Rc::from);
                object = Object::default();
            }
            (b"object", true) => {
                if let Some(id) = id.take() {
                    model.objects.insert(id, std::mem::take(&mut object));
                }
            }
            (b"vertex", false) => {
                let vertex = Element::Vertex(object.positions.len());
                let mut point = [0.0; 3];
                for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                    let value = number(&tag, name, "a coordinate")?;
                    point[axis] = finite(value, axis, unknown, || value.to_string())
                        .map_err(|problem| problem.at(Position::Byte(tag.start), Some(vertex)))?;
                }
                object.positions.push(point);
            }
            (b"triangle", false) => {
                let mut corners = [0; 3];
                for (corner, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
                    *corner = number(&tag, name, super::CORNER)?;
                }
                object.triangles.push(corners);
                object.places.push(tag.start);
            }
            (b"component", false) => object.parts.push(part(&tag, name)?),
            (b"item", false) => model.items.push(part(&tag, name)?),
            _ => {}
        }
    }
    Ok(model)
}

fn number<N: std::str::FromStr>(
    tag: &Tag<'_>,
    name: &str,
    expected: &'static str,
) -> Result<N, ParseError> {
    let text = tag.attribute(name).unwrap_or("none");
    let parsed = text.trim().parse();
    parsed.map_err(|_| wrong(expected, text, Some(tag.start)))
}

/// An object at a place: the rows of its matrix are those of three axes and of the origin.
fn part(tag: &Tag<'_>, file: &Rc<str>) -> Result<Part, ParseError> {
    let mut placed = DAffine3::IDENTITY;
    if let Some(text) = tag.attribute("transform") {
        let numbers = text.split_whitespace().map(str::parse::<f64>);
        let rows = numbers.collect::<Result<Vec<_>, _>>().ok();
        let rows = rows.and_then(|rows| <[f64; 12]>::try_from(rows).ok());
        let [a, b, c, d, e, f, g, h, i, x, y, z] =
            rows.ok_or_else(|| wrong("twelve numbers of a matrix", text, Some(tag.start)))?;
        let axes = DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]);
        placed = DAffine3::from_mat3_translation(axes, DVec3::new(x, y, z));
    }
    let object = tag.attribute("objectid");
    let object = object.ok_or_else(|| wrong("the number of an object", "none", Some(tag.start)))?;
    let other = tag.attribute("p:path");
    Ok(Part {
        file: match other {
            Some(other) => other.trim_start_matches('/').into(),
            None => Rc::clone(file),
        },
        object: object.into(),
        placed,
    })
}
