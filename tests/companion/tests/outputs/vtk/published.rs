//! Reader of VTK's XML files according to the published format, independent of the library. Any missing or
//! superfluous element, attribute or byte is an error.
//!
//! Source: *VTK XML file formats* (docs.vtk.org, VTK File Formats), for serial PolyData and ImageData
//! files with arrays in place; the ParaView guide for collections. What is not needed here
//! (compression, appended data, other data sets) is refused.

use roxmltree::{Document, Node};
use std::collections::BTreeSet;

/// An element that a file may contain.
struct Rule {
    name: &'static str,
    /// Elements that may contain it.
    within: &'static [&'static str],
    required: &'static [&'static str],
    optional: &'static [&'static str],
}

const fn rule(
    name: &'static str,
    within: &'static [&'static str],
    required: &'static [&'static str],
    optional: &'static [&'static str],
) -> Rule {
    Rule {
        name,
        within,
        required,
        optional,
    }
}

/// Attributes that count the points and cells of a piece of a surface; cells are numbered in this order.
const COUNTS: [&str; 5] = [
    "NumberOfPoints",
    "NumberOfVerts",
    "NumberOfLines",
    "NumberOfStrips",
    "NumberOfPolys",
];
const ACTIVE: &[&str] = &["Scalars", "Vectors", "Normals", "Tensors", "TCoords"];

const RULES: &[Rule] = &[
    rule("PolyData", &["VTKFile"], &[], &[]),
    rule(
        "ImageData",
        &["VTKFile"],
        &["WholeExtent", "Origin", "Spacing"],
        &["Direction"],
    ),
    rule("Collection", &["VTKFile"], &[], &[]),
    rule(
        "DataSet",
        &["Collection"],
        &["file"],
        &["timestep", "group", "part", "name"],
    ),
    rule("FieldData", &["PolyData", "ImageData"], &[], &[]),
    rule("Piece", &["PolyData"], &COUNTS, &[]),
    rule("Piece", &["ImageData"], &["Extent"], &[]),
    rule("PointData", &["Piece"], &[], ACTIVE),
    rule("CellData", &["Piece"], &[], ACTIVE),
    rule("Points", &["Piece"], &[], &[]),
    rule("Verts", &["Piece"], &[], &[]),
    rule("Lines", &["Piece"], &[], &[]),
    rule("Strips", &["Piece"], &[], &[]),
    rule("Polys", &["Piece"], &[], &[]),
    rule(
        "DataArray",
        &["FieldData"],
        &["type", "Name", "NumberOfTuples", "format"],
        &["NumberOfComponents", "RangeMin", "RangeMax"],
    ),
    rule(
        "DataArray",
        &[
            "PointData",
            "CellData",
            "Points",
            "Verts",
            "Lines",
            "Strips",
            "Polys",
        ],
        &["type", "Name", "format"],
        &["NumberOfComponents", "RangeMin", "RangeMax"],
    ),
];

/// The numbers of an array.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Numbers {
    Single(Vec<f32>),
    Double(Vec<f64>),
    Integers(Vec<i64>),
}

/// A `DataArray`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Array {
    pub(super) name: String,
    pub(super) components: usize,
    pub(super) numbers: Numbers,
}

/// Contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Contents {
    pub(super) time: Option<f64>,
    pub(super) fields: Vec<Array>,
    pub(super) data: Data,
}

/// Data sets that this reader understands.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Data {
    Surface {
        positions: Vec<f64>,
        polygons: Vec<Vec<i64>>,
    },
    Grid {
        counts: [usize; 3],
        origin: Vec<f64>,
        spacings: Vec<f64>,
        /// The matrix of the axes, row by row.
        direction: Vec<f64>,
    },
    Index(Vec<Entry>),
}

/// A file of a collection.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) time: f64,
    pub(super) part: usize,
    pub(super) file: String,
}

type Found<T> = Result<T, String>;

/// Contents of a file, or its fault.
pub(super) fn read(text: &str) -> Found<Contents> {
    let document = Document::parse(text).map_err(|error| error.to_string())?;
    let root = document.root_element();
    check_attributes(
        root,
        &["type", "version", "byte_order"],
        &["header_type", "compressor"],
    )?;
    for (attribute, known) in [
        ("version", &["0.1", "1.0"][..]),
        ("byte_order", &["LittleEndian"]),
        ("header_type", &["UInt64"]),
        ("compressor", &[]),
    ] {
        if let Some(value) = root.attribute(attribute)
            && !known.contains(&value)
        {
            return Err(format!("{attribute} is {value}"));
        }
    }
    let kind = attribute(root, "type")?;
    let data = only(root, kind)?;
    for node in root.descendants().filter(|node| *node != root) {
        check_node(node)?;
    }
    if kind == "Collection" {
        let entries = elements(data).map(entry).collect::<Found<_>>()?;
        return Ok(Contents {
            time: None,
            fields: Vec::new(),
            data: Data::Index(entries),
        });
    }
    if root.attribute("header_type").is_none() {
        return Err("no header_type: counts of bytes would be of 32 bits".to_owned());
    }
    let piece = only(data, "Piece")?;
    let (points, cells, data_set) = match kind {
        "PolyData" => surface(piece)?,
        _ => grid(data, piece)?,
    };
    arrays(piece, "CellData", Some(cells))?;
    Ok(Contents {
        time: time(data)?,
        fields: arrays(piece, "PointData", Some(points))?,
        data: data_set,
    })
}

/// The time of a data set.
fn time(data: Node<'_, '_>) -> Found<Option<f64>> {
    let mut time = None;
    for array in arrays(data, "FieldData", None)? {
        match (array.name.as_str(), array.numbers) {
            ("TimeValue", Numbers::Double(values)) if values.len() == 1 => time = Some(values[0]),
            (name, numbers) => return Err(format!("{name} of the whole is {numbers:?}")),
        }
    }
    Ok(time)
}

fn entry(node: Node<'_, '_>) -> Found<Entry> {
    Ok(Entry {
        time: number(attribute(node, "timestep")?)?,
        part: number(attribute(node, "part")?)?,
        file: attribute(node, "file")?.to_owned(),
    })
}

/// Number of points and cells, and the surface.
fn surface(piece: Node<'_, '_>) -> Found<(usize, usize, Data)> {
    let mut counts = [0; 5];
    for (count, name) in counts.iter_mut().zip(COUNTS) {
        *count = number::<usize>(attribute(piece, name)?)?;
    }
    let [points, others @ .., polygons] = counts;
    let mut found = arrays(piece, "Points", Some(points))?;
    let (Some(array), true) = (found.pop(), found.is_empty()) else {
        return Err("Points has not one array".to_owned());
    };
    let (3, Numbers::Double(positions)) = (array.components, array.numbers) else {
        return Err("positions have not three components of 64 bits".to_owned());
    };
    for (name, count) in ["Verts", "Lines", "Strips"].into_iter().zip(others) {
        if elements(piece).any(|node| node.has_tag_name(name)) || count > 0 {
            return Err(format!("{name}: only polygons are known"));
        }
    }
    let polygons = cells(&arrays(piece, "Polys", None)?, points, polygons)?;
    let cells = polygons.len();
    let data = Data::Surface {
        positions,
        polygons,
    };
    Ok((points, cells, data))
}

/// Corners of each cell.
fn cells(arrays: &[Array], points: usize, count: usize) -> Found<Vec<Vec<i64>>> {
    let integers = |wanted: &str| match arrays.iter().find(|array| array.name == wanted) {
        Some(Array {
            components: 1,
            numbers: Numbers::Integers(numbers),
            ..
        }) => Ok(numbers),
        other => Err(format!("{wanted} is {other:?}")),
    };
    let (corners, ends) = (integers("connectivity")?, integers("offsets")?);
    if arrays.len() != 2 || ends.len() != count {
        return Err(format!("{count} cells have {} ends", ends.len()));
    }
    if !corners
        .iter()
        .all(|corner| (0..points as i64).contains(corner))
    {
        return Err("a corner is no point".to_owned());
    }
    let mut cells = Vec::new();
    let mut start = 0;
    for &end in ends {
        let corners = usize::try_from(end)
            .ok()
            .and_then(|end| corners.get(start..end));
        let corners = corners.filter(|corners| corners.len() > 2);
        cells.push(
            corners
                .ok_or("a polygon has fewer than three corners")?
                .to_vec(),
        );
        start = end as usize;
    }
    if start == corners.len() {
        Ok(cells)
    } else {
        Err("corners are left over".to_owned())
    }
}

/// Number of points and cells, and the grid.
fn grid(data: Node<'_, '_>, piece: Node<'_, '_>) -> Found<(usize, usize, Data)> {
    let extent = numbers::<usize>(attribute(data, "WholeExtent")?, 6)?;
    if numbers::<usize>(attribute(piece, "Extent")?, 6)? != extent {
        return Err("the one piece is not the whole".to_owned());
    }
    let mut counts = [0; 3];
    for (count, ends) in counts.iter_mut().zip(extent.chunks(2)) {
        *count = (ends[1] + 1)
            .checked_sub(ends[0])
            .ok_or("an extent below 0")?;
    }
    if elements(piece).any(|node| !["PointData", "CellData"].contains(&node.tag_name().name())) {
        return Err("a grid has no points or polygons of its own".to_owned());
    }
    let direction = data.attribute("Direction").unwrap_or("1 0 0 0 1 0 0 0 1");
    let cells = counts
        .iter()
        .map(|count| count.saturating_sub(1).max(1))
        .product();
    let grid = Data::Grid {
        counts,
        origin: numbers(attribute(data, "Origin")?, 3)?,
        spacings: numbers(attribute(data, "Spacing")?, 3)?,
        direction: numbers(direction, 9)?,
    };
    Ok((counts.iter().product(), cells, grid))
}

/// Arrays of an element, each with this number of tuples; empty if there is no such element.
fn arrays(node: Node<'_, '_>, name: &str, tuples: Option<usize>) -> Found<Vec<Array>> {
    if !elements(node).any(|child| child.has_tag_name(name)) {
        return Ok(Vec::new());
    }
    let node = only(node, name)?;
    let arrays = elements(node).map(|node| array(node, tuples));
    let arrays = arrays.collect::<Found<Vec<_>>>()?;
    let names = BTreeSet::from_iter(arrays.iter().map(|array| &array.name));
    if names.len() < arrays.len() {
        return Err(format!("two arrays of {name} have the same name"));
    }
    for active in ACTIVE {
        if let Some(array) = node.attribute(*active)
            && !names.contains(&array.to_owned())
        {
            return Err(format!("{active} is no array: {array}"));
        }
    }
    Ok(arrays)
}

fn array(node: Node<'_, '_>, tuples: Option<usize>) -> Found<Array> {
    let name = attribute(node, "Name")?.to_owned();
    let components = node.attribute("NumberOfComponents").unwrap_or("1");
    let components = number::<usize>(components)?;
    let own = node.attribute("NumberOfTuples").map(number::<usize>);
    let tuples = own.transpose()?.or(tuples);
    if attribute(node, "format")? != "binary" {
        return Err(format!("{name} is not binary"));
    }
    let bytes = decoded(node.text().unwrap_or_default().trim())?;
    let Some((header, bytes)) = bytes.split_first_chunk() else {
        return Err(format!("{name} has no count of its bytes"));
    };
    if u64::from_le_bytes(*header) != bytes.len() as u64 {
        return Err(format!("{name} does not count its bytes"));
    }
    let (numbers, count) = match attribute(node, "type")? {
        "Float32" => {
            let values = chunks(bytes, f32::from_le_bytes)?;
            let count = values.len();
            (Numbers::Single(values), count)
        }
        "Float64" => {
            let values = chunks(bytes, f64::from_le_bytes)?;
            let count = values.len();
            (Numbers::Double(values), count)
        }
        "Int64" => {
            let values = chunks(bytes, i64::from_le_bytes)?;
            let count = values.len();
            (Numbers::Integers(values), count)
        }
        other => return Err(format!("{name} is of type {other}")),
    };
    if components == 0 || tuples.is_some_and(|tuples| tuples * components != count) {
        return Err(format!("{name} has {count} numbers"));
    }
    Ok(Array {
        name,
        components,
        numbers,
    })
}

fn chunks<const N: usize, T>(bytes: &[u8], number: fn([u8; N]) -> T) -> Found<Vec<T>> {
    match bytes.as_chunks() {
        (whole, []) => Ok(whole.iter().copied().map(number).collect()),
        _ => Err("a number is cut off".to_owned()),
    }
}

/// Bytes of padded base64 text (RFC 4648, section 4), without superfluous characters.
fn decoded(text: &str) -> Found<Vec<u8>> {
    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = text.trim_end_matches('=');
    let padding = text.len() - digits.len();
    if !text.len().is_multiple_of(4) || padding > 2 {
        return Err("base64 is cut off".to_owned());
    }
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for four in digits.as_bytes().chunks(4) {
        let mut bits = 0_u32;
        for digit in four {
            let value = ALPHABET.iter().position(|known| known == digit);
            bits = bits << 6 | value.ok_or("no digit of base64")? as u32;
        }
        let whole = (bits << (6 * (4 - four.len()))).to_be_bytes();
        bytes.extend(&whole[1..four.len()]);
        if whole[four.len()..].iter().any(|&byte| byte != 0) {
            return Err("bits of base64 are left over".to_owned());
        }
    }
    Ok(bytes)
}

/// Checks that a node is allowed at its place, with all required attributes and no unknown ones.
fn check_node(node: Node<'_, '_>) -> Found<()> {
    let parent = node
        .parent_element()
        .map_or("", |node| node.tag_name().name());
    if node.is_text() {
        let blank = node.text().unwrap_or_default().trim().is_empty();
        return match blank || parent == "DataArray" {
            true => Ok(()),
            false => Err(format!("text in {parent}")),
        };
    }
    let name = node.tag_name().name();
    let rule = RULES
        .iter()
        .find(|rule| rule.name == name && rule.within.contains(&parent));
    let rule = rule.ok_or_else(|| format!("{name} in {parent}"))?;
    check_attributes(node, rule.required, rule.optional)
}

fn check_attributes(node: Node<'_, '_>, required: &[&str], optional: &[&str]) -> Found<()> {
    let name = node.tag_name().name();
    if let Some(missing) = required.iter().find(|name| !node.has_attribute(**name)) {
        return Err(format!("{name} has no {missing}"));
    }
    let unknown = node
        .attributes()
        .map(|attribute| attribute.name())
        .find(|name| !required.contains(name) && !optional.contains(name));
    unknown.map_or(Ok(()), |attribute| Err(format!("{name} has {attribute}")))
}

fn elements<'a, 'input>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(Node::is_element)
}

fn only<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Found<Node<'a, 'input>> {
    let mut found = elements(node).filter(|child| child.has_tag_name(name));
    match (found.next(), found.next()) {
        (Some(child), None) => Ok(child),
        _ => Err(format!("{} has not one {name}", node.tag_name().name())),
    }
}

fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Found<&'a str> {
    let missing = || format!("{} has no {name}", node.tag_name().name());
    node.attribute(name).ok_or_else(missing)
}

fn number<T: std::str::FromStr>(text: &str) -> Found<T> {
    text.parse()
        .map_err(|_| format!("{text} is no number here"))
}

fn numbers<T: std::str::FromStr>(text: &str, count: usize) -> Found<Vec<T>> {
    let found = text.split_ascii_whitespace().map(number);
    let found = found.collect::<Found<Vec<T>>>()?;
    match found.len() == count {
        true => Ok(found),
        false => Err(format!("{text:?} are not {count} numbers")),
    }
}
