//! glTF 2.0, as text (`.gltf`) or binary (`.glb`).
//!
//! Source: Khronos Group, glTF 2.0 Specification (2021). JSON describes a tree of nodes with their transformations and
//! meshes; numbers are in buffers, which are the second part of a binary file, within the text in base64, or files
//! beside it. The triangles of all nodes of the scene become one mesh, in the order in which the tree is traversed.

mod accessor;
mod document;

use std::collections::HashMap;
use std::io::{self, Write};

use glam::{DMat4, DQuat, DVec3};

use self::accessor::Buffers;
use self::document::{Document, GltfNode, Primitive};
use super::cells::{Cell, CellFaces};
use super::{Element, MeshBuilder, ParseError, Position, Problem, Reading, finite};

pub(super) const MAGIC: &[u8] = b"glTF";
const VERSION: u32 = 2;

/// Header of a binary file, and of each of its parts, in bytes.
const HEADER: usize = 12;
const PART: usize = 8;
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";

pub(super) fn parse(bytes: &[u8], reading: Reading<'_>) -> Result<MeshBuilder, ParseError> {
    let (json, binary) = match bytes.strip_prefix(MAGIC) {
        Some(_) => parts(bytes)?,
        None => (bytes, None),
    };
    let document = Document::parse(json)?;
    let buffers = Buffers::new(&document, (bytes, binary), reading)?;
    let mut scene = Gathered {
        document: &document,
        buffers,
        cells: CellFaces::new(0),
        reading,
    };
    scene.add_nodes()?;
    let (builder, _) = scene.cells.faces()?;
    Ok(builder)
}

fn wrong(expected: &'static str, found: String) -> ParseError {
    Problem::Expected { expected, found }.anywhere()
}

/// The JSON of a binary file, and the first byte of the binary part with its length.
type Parts<'a> = (&'a [u8], Option<(usize, usize)>);

fn parts(bytes: &[u8]) -> Result<Parts<'_>, ParseError> {
    let number = |at: usize| {
        let bytes = bytes.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes))
    };
    let problem = |expected, found: Option<u32>, at| {
        let found = found.map_or("the end of the file".to_owned(), |found| format!("{found}"));
        Problem::Expected { expected, found }.at(Position::Byte(at), None)
    };
    let version = number(4);
    if version != Some(VERSION) {
        return Err(problem("version 2 of glTF", version, 4));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = HEADER;
    // Zeros may follow the last part.
    while let (Some(length), Some(kind)) = (number(at), bytes.get(at + 4..at + PART)) {
        let start = at + PART;
        let end = start.checked_add(length as usize);
        let part = end.and_then(|end| bytes.get(start..end));
        let part = part.ok_or_else(|| {
            let problem =
                Problem::truncated("bytes of a part", length as usize, bytes.len() - start);
            problem.at(Position::Byte(at), None)
        })?;
        match kind {
            JSON if json.is_none() => json = Some(part),
            BINARY if binary.is_none() => binary = Some((start, part.len())),
            _ => {}
        }
        at = start + part.len();
    }
    let json = json.ok_or_else(|| problem("a part of JSON", None, at))?;
    Ok((json, binary))
}

/// The mesh of a scene while its nodes are visited.
struct Gathered<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    cells: CellFaces,
    reading: Reading<'a>,
}

impl Gathered<'_> {
    /// Adds the meshes of the default scene, or of all root nodes if there is no scene.
    fn add_nodes(&mut self) -> Result<(), ParseError> {
        let document = self.document;
        let scene = document.scenes.get(document.scene.unwrap_or(0));
        let roots = match scene {
            Some(scene) => scene.nodes.clone(),
            None => {
                let mut is_child = vec![false; document.nodes.len()];
                for &child in document.nodes.iter().flat_map(|node| &node.children) {
                    if let Some(is_child) = is_child.get_mut(child) {
                        *is_child = true;
                    }
                }
                let nodes = (0..).zip(&is_child);
                nodes
                    .filter_map(|(node, &is_child)| (!is_child).then_some(node))
                    .collect()
            }
        };
        let mut tree = Tree {
            is_known: vec![false; document.nodes.len()],
            next: Vec::new(),
        };
        tree.push(&roots, DMat4::IDENTITY)?;
        while let Some((node, parent)) = tree.next.pop() {
            let node = &document.nodes[node];
            let placed = parent * local(node);
            if let Some(mesh) = node.mesh {
                self.add_mesh(mesh, placed)?;
            }
            tree.push(&node.children, placed)?;
        }
        if document.nodes.is_empty() {
            for mesh in 0..document.meshes.len() {
                self.add_mesh(mesh, DMat4::IDENTITY)?;
            }
        }
        Ok(())
    }

    fn add_mesh(&mut self, mesh: usize, placed: DMat4) -> Result<(), ParseError> {
        let meshes = &self.document.meshes;
        let own = meshes.get(mesh);
        let own = own.ok_or_else(|| wrong("the number of a mesh", format!("{mesh}")))?;
        // Parts of a mesh may share vertices.
        let mut starts = HashMap::new();
        for primitive in &own.primitives {
            let kind = match primitive.mode.unwrap_or(4) {
                0..=3 => continue,
                4 => None,
                5 => Some(Cell::Strip),
                6 => Some(Cell::Fan),
                mode => return Err(wrong("a mode from 0 to 6", format!("{mode}"))),
            };
            let Some(accessor) = primitive.attributes.position else {
                continue;
            };
            let range = match starts.get(&accessor) {
                Some(&range) => range,
                None => {
                    let range = self.add_positions(accessor, placed)?;
                    starts.insert(accessor, range);
                    range
                }
            };
            let before = self.cells.builder.triangle_count();
            self.add_triangles(primitive, kind, range)?;
            // Mirrored surfaces keep their outside.
            if placed.determinant() < 0.0 {
                self.cells.builder.reverse_from(before);
            }
        }
        Ok(())
    }

    /// Adds vertices, and returns the first and their number.
    fn add_positions(
        &mut self,
        accessor: usize,
        placed: DMat4,
    ) -> Result<(usize, usize), ParseError> {
        let numbers = self.buffers.numbers(accessor, "VEC3")?;
        let positions = &mut self.cells.builder.positions;
        let before = positions.len();
        for (at, &[x, y, z]) in numbers.values.as_chunks::<3>().0.iter().enumerate() {
            let mut point = placed.transform_point3(DVec3::new(x, y, z)).to_array();
            for (axis, coordinate) in point.iter_mut().enumerate() {
                let value = *coordinate;
                *coordinate = finite(value, axis, self.reading.unknown, || value.to_string())
                    .map_err(|problem| {
                        let element = Element::Vertex(before + at);
                        problem.at(numbers.position(3 * at), Some(element))
                    })?;
            }
            positions.push(point);
        }
        Ok((before, positions.len() - before))
    }

    /// Adds the triangles of a primitive: a list of triangles if it has no kind.
    fn add_triangles(
        &mut self,
        primitive: &Primitive,
        kind: Option<Cell>,
        (before, vertices): (usize, usize),
    ) -> Result<(), ParseError> {
        let numbers = match primitive.indices {
            Some(accessor) => Some(self.buffers.numbers(accessor, "SCALAR")?),
            None => None,
        };
        let count = numbers
            .as_ref()
            .map_or(vertices, |numbers| numbers.values.len());
        let position = |at| match &numbers {
            Some(numbers) => numbers.position(at),
            None => Position::Byte(0),
        };
        let mut corners = Vec::with_capacity(count);
        for at in 0..count {
            let vertex = numbers
                .as_ref()
                .map_or(at as f64, |numbers| numbers.values[at]);
            if vertex >= vertices as f64 || vertex < 0.0 {
                let problem = Problem::VertexOutOfRange {
                    vertex: vertex as i64,
                    vertices,
                    first: 0,
                };
                let face = Element::Face(self.cells.builder.triangle_count() + at / 3);
                return Err(problem.at(position(at), Some(face)));
            }
            corners.push((before + vertex as usize) as u32);
        }
        if let Some(kind) = kind {
            self.cells.add(kind, &corners, position(0));
            return Ok(());
        }
        let (triangles, rest) = corners.as_chunks::<3>();
        if !rest.is_empty() {
            let found = format!("{count}");
            return Err(wrong("three corners for each triangle", found));
        }
        for (at, triangle) in triangles.iter().enumerate() {
            self.cells.builder.add_face(triangle, position(3 * at));
        }
        Ok(())
    }
}

/// The nodes to be visited next, the first last, with the transformations of their parents.
struct Tree {
    is_known: Vec<bool>,
    next: Vec<(usize, DMat4)>,
}

impl Tree {
    fn push(&mut self, nodes: &[usize], placed: DMat4) -> Result<(), ParseError> {
        for &node in nodes.iter().rev() {
            let is_known = self.is_known.get_mut(node);
            let is_known =
                is_known.ok_or_else(|| wrong("the number of a node", format!("{node}")))?;
            if std::mem::replace(is_known, true) {
                let found = format!("node {node} twice");
                return Err(wrong("a tree, in which each node has one parent", found));
            }
            self.next.push((node, placed));
        }
        Ok(())
    }
}

/// The transformation from the coordinates of a node to those of its parent.
fn local(node: &GltfNode) -> DMat4 {
    match &node.matrix {
        Some(matrix) => DMat4::from_cols_array(matrix),
        None => DMat4::from_scale_rotation_translation(
            node.scale
                .as_deref()
                .map_or(DVec3::ONE, |&scale| scale.into()),
            node.rotation
                .as_deref()
                .map_or(DQuat::IDENTITY, |&rotation| DQuat::from_array(rotation)),
            node.translation
                .as_deref()
                .map_or(DVec3::ZERO, |&place| place.into()),
        ),
    }
}

/// Writes a binary file of one mesh, with coordinates of 32 bits, and colours of the vertices if there are any.
pub(super) fn write(
    out: &mut dyn Write,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    colours: Option<&[[u8; 3]]>,
) -> io::Result<()> {
    let single = positions.iter().map(|point| point.map(|x| x as f32));
    let of_all = |start: f32, choose: fn(f32, f32) -> f32| {
        let all = single.clone();
        all.fold([start; 3], |so_far, point| {
            [0, 1, 2].map(|axis| choose(so_far[axis], point[axis]))
        })
    };
    let (least, most) = (
        of_all(f32::INFINITY, f32::min),
        of_all(f32::NEG_INFINITY, f32::max),
    );
    let (points, corners) = (12 * positions.len(), 12 * triangles.len());
    let (colour, view, accessor) = match colours {
        None => ("", String::new(), String::new()),
        Some(_) => (
            r#","COLOR_0":2"#,
            format!(
                r#",{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
                points + corners,
                4 * positions.len()
            ),
            format!(
                r#",{{"bufferView":2,"componentType":5121,"normalized":true,"count":{},"type":"VEC4"}}"#,
                positions.len()
            ),
        ),
    };
    let length = points + corners + colours.map_or(0, |colours| 4 * colours.len());
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{colour}}},"indices":1}}]}}],"buffers":[{{"byteLength":{length}}}],"bufferViews":[{{"buffer":0,"byteLength":{points}}},{{"buffer":0,"byteOffset":{points},"byteLength":{corners}}}{view}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":{least:?},"max":{most:?}}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}{accessor}]}}"#,
        positions.len(),
        3 * triangles.len(),
    );
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let whole = HEADER + 2 * PART + json.len() + length;
    let whole = u32::try_from(whole)
        .map_err(|_| io::Error::other("a .glb file has less than 4 GiB: choose .ply"))?;
    out.write_all(MAGIC)?;
    for number in [VERSION, whole, json.len() as u32] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(JSON)?;
    out.write_all(json.as_bytes())?;
    out.write_all(&(length as u32).to_le_bytes())?;
    out.write_all(BINARY)?;
    super::write::write_blocks(out, single.flatten().map(f32::to_le_bytes))?;
    super::write::write_blocks(
        out,
        triangles
            .iter()
            .flatten()
            .map(|vertex| vertex.to_le_bytes()),
    )?;
    let colours = colours.unwrap_or_default().iter();
    super::write::write_blocks(out, colours.map(|&[r, g, b]| [r, g, b, u8::MAX]))
}
