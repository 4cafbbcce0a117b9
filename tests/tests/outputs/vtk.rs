//! Surfaces and grids for VTK, and the index of a run.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use super::{TIME, bits};
use helfrich_std::io::{
    Collection, CollectionEntry, Grid, PointField, PointValues, VtkError, write_vti, write_vtp,
};
use helfrich_tests::meshes::{Mesh, bent, icosphere};
use helfrich_tests::tolerance::GRID_POINT;
use roxmltree::{Document, Node};
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};
use tempfile::TempDir;

/// A surface with a field of every kind, and values that text would lose.
struct Example {
    mesh: helfrich::TriangleMesh,
    positions: Vec<[f64; 3]>,
    mean: Vec<f64>,
    single: Vec<f32>,
    force: Vec<[f64; 3]>,
    velocity: Vec<[f32; 3]>,
}

impl Example {
    fn new() -> Self {
        let Mesh {
            positions,
            connectivity: mesh,
        } = icosphere(1).map(bent);
        let count = positions.len();
        let number = |i: usize| (i as f64 + 1.0).sqrt() / 3.0;
        let mut mean: Vec<f64> = (0..count).map(number).collect();
        mean[1] = f64::MIN_POSITIVE / 4.0;
        mean[2] = -0.0;
        mean[3] = f64::INFINITY;
        Self {
            mesh,
            mean,
            single: (0..count).map(|i| number(i) as f32).collect(),
            force: positions.iter().map(|x| x.map(|x| x / 7.0)).collect(),
            velocity: positions.iter().map(|x| x.map(|x| x as f32)).collect(),
            positions,
        }
    }

    fn fields(&self) -> [PointField<'_>; 4] {
        [
            ("H <1/µm> & \"co\"", PointValues::Scalars(&self.mean)),
            ("single", PointValues::Scalars32(&self.single)),
            ("force", PointValues::Vectors(&self.force)),
            ("velocity", PointValues::Vectors32(&self.velocity)),
        ]
        .map(|(name, values)| PointField { name, values })
    }

    fn write(&self, path: &Path) {
        write_vtp(
            path,
            &self.mesh,
            &self.positions,
            Some(TIME),
            &self.fields(),
        )
        .unwrap();
    }
}

/// Every value of a field as an f64, in the order of the file, with VTK's name of the type.
fn flat(values: PointValues<'_>) -> (&'static str, usize, Vec<f64>) {
    let wide = |values: &[f32]| values.iter().map(|&x| f64::from(x)).collect();
    match values {
        PointValues::Scalars(values) => ("Float64", 1, values.to_vec()),
        PointValues::Scalars32(values) => ("Float32", 1, wide(values)),
        PointValues::Vectors(values) => ("Float64", 3, values.as_flattened().to_vec()),
        PointValues::Vectors32(values) => ("Float32", 3, wide(values.as_flattened())),
    }
}

/// The bytes of base64 (RFC 4648, section 4), padded, without a character too many.
fn decoded(text: &str) -> Vec<u8> {
    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    assert_eq!(text.len() % 4, 0);
    let padding = text.len() - text.trim_end_matches('=').len();
    assert!(padding <= 2);
    let mut bytes = Vec::new();
    for four in text.as_bytes().chunks(4) {
        let mut bits = 0_u32;
        for digit in four {
            let value = ALPHABET.iter().position(|known| known == digit);
            bits = bits << 6 | value.unwrap_or_else(|| usize::from(*digit != b'=') * 64) as u32;
            assert!(value.is_some() || *digit == b'=', "{digit}");
        }
        bytes.extend(&bits.to_be_bytes()[1..]);
    }
    bytes.truncate(bytes.len() - padding);
    bytes
}

/// The numbers of a `DataArray`, whose header has to count its bytes.
fn stored(array: Node<'_, '_>, kind: &str) -> Vec<f64> {
    assert_eq!(array.tag_name().name(), "DataArray");
    assert_eq!(array.attribute("format"), Some("binary"));
    assert_eq!(array.attribute("type"), Some(kind));
    let bytes = decoded(array.text().unwrap());
    let (header, bytes) = bytes.split_at(8);
    assert_eq!(
        u64::from_le_bytes(header.try_into().unwrap()),
        bytes.len() as u64
    );
    match kind {
        "Float32" => bytes
            .chunks(4)
            .map(|four| f32::from_le_bytes(four.try_into().unwrap()).into())
            .collect(),
        "Float64" => bytes
            .chunks(8)
            .map(|eight| f64::from_le_bytes(eight.try_into().unwrap()))
            .collect(),
        "Int64" => bytes
            .chunks(8)
            .map(|eight| i64::from_le_bytes(eight.try_into().unwrap()) as f64)
            .collect(),
        other => panic!("{other}"),
    }
}

fn children<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Vec<Node<'a, 'input>> {
    node.children()
        .filter(|child| child.has_tag_name(name))
        .collect()
}

#[track_caller]
fn only_child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Node<'a, 'input> {
    let found = children(node, name);
    assert_eq!(found.len(), 1, "{name}");
    found[0]
}

#[test]
fn a_surface_is_stored_bit_by_bit_as_vtk_documents_it() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("surface.vtp");
    let example = Example::new();
    example.write(&path);
    let text = fs::read_to_string(&path).unwrap();
    let document = Document::parse(&text).unwrap();
    let root = document.root_element();
    assert!(root.has_tag_name("VTKFile"));
    for (attribute, value) in [
        ("type", "PolyData"),
        ("version", "1.0"),
        ("byte_order", "LittleEndian"),
        ("header_type", "UInt64"),
    ] {
        assert_eq!(root.attribute(attribute), Some(value));
    }
    let data = only_child(root, "PolyData");
    let time = only_child(only_child(data, "FieldData"), "DataArray");
    assert_eq!(time.attribute("Name"), Some("TimeValue"));
    assert_eq!(stored(time, "Float64"), [TIME]);
    let piece = only_child(data, "Piece");
    let count = |name: &str| piece.attribute(name).unwrap().parse::<usize>().unwrap();
    let triangles = example.mesh.triangles();
    assert_eq!(count("NumberOfPoints"), example.positions.len());
    assert_eq!(count("NumberOfPolys"), triangles.len());
    for other in ["NumberOfVerts", "NumberOfLines", "NumberOfStrips"] {
        assert_eq!(count(other), 0);
    }
    let points = only_child(only_child(piece, "Points"), "DataArray");
    assert_eq!(points.attribute("NumberOfComponents"), Some("3"));
    let flat_positions = bits(example.positions.as_flattened());
    assert_eq!(bits(&stored(points, "Float64")), flat_positions);
    for array in children(only_child(piece, "Polys"), "DataArray") {
        let expected: Vec<f64> = match array.attribute("Name") {
            Some("connectivity") => triangles.as_flattened().iter().map(|&v| v.into()).collect(),
            Some("offsets") => (1..=triangles.len()).map(|t| 3.0 * t as f64).collect(),
            other => panic!("{other:?}"),
        };
        assert_eq!(stored(array, "Int64"), expected);
    }
    let arrays = children(only_child(piece, "PointData"), "DataArray");
    assert_eq!(arrays.len(), example.fields().len());
    for (array, field) in arrays.into_iter().zip(example.fields()) {
        assert_eq!(array.attribute("Name"), Some(field.name));
        let (kind, components, values) = flat(field.values);
        let found = array.attribute("NumberOfComponents").unwrap_or("1");
        assert_eq!(found, components.to_string());
        assert_eq!(bits(&stored(array, kind)), bits(&values));
    }
}

/// A Python that has VTK: `HELFRICH_PYTHON`, or else what is called `python3`.
fn python_with_vtk() -> Option<PathBuf> {
    let python = env::var_os("HELFRICH_PYTHON").unwrap_or_else(|| "python3".into());
    let mut import = Command::new(&python);
    import.args(["-c", "import vtk"]).stderr(Stdio::null());
    import.status().ok()?.success().then(|| python.into())
}

/// What VTK reads from a file; none, said aloud, where there is no VTK.
fn read_by_vtk(path: &Path) -> Option<Value> {
    let Some(python) = python_with_vtk() else {
        // Past the harness, which keeps what passing tests print to itself.
        let message = "files read by VTK: SKIPPED, there is no Python with the package vtk \
                       (HELFRICH_PYTHON names one)\n";
        io::stderr().write_all(message.as_bytes()).unwrap();
        return None;
    };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/data/read_vtk.py");
    let mut read = Command::new(python);
    let output = read.arg(script).arg(path).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.is_empty(), "{errors}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["complaints"], serde_json::json!([]));
    Some(found)
}

/// Fields as VTK has read them.
fn assert_same_fields(found: &Value, expected: &[PointField<'_>]) {
    let arrays = found["point_data"].as_object().unwrap();
    assert_eq!(arrays.len(), expected.len());
    for field in expected {
        let (kind, components, values) = flat(field.values);
        let array = &arrays[field.name];
        let kind = if kind == "Float64" { "double" } else { "float" };
        assert_eq!(array["type"], kind);
        assert_eq!(array["components"], components);
        assert_eq!(array["values"], serde_json::json!(bits(&values)));
    }
    let time = &found["field_data"]["TimeValue"]["values"];
    assert_eq!(time, &serde_json::json!([TIME.to_bits()]));
}

#[test]
fn vtk_reads_a_surface_back() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("surface.vtp");
    let example = Example::new();
    example.write(&path);
    let Some(found) = read_by_vtk(&path) else {
        return;
    };
    assert_eq!(found["other_cells"], 0);
    assert_eq!(
        found["triangles"],
        serde_json::json!(example.mesh.triangles())
    );
    let positions = bits(example.positions.as_flattened());
    assert_eq!(found["positions"], serde_json::json!(positions));
    assert_same_fields(&found, &example.fields());
}

/// Axes that are no rows of a symmetric matrix: rows and columns must not be confused.
fn oblique_grid() -> Grid {
    let [first, second, third] = [[0.6, 0.8, 0.0], [0.0, 0.0, 1.0], [0.8, -0.6, 0.0]];
    Grid {
        origin: [0.1, -2.0, 1.0 / 3.0],
        axes: [first, second, third],
        spacings: [0.5, 0.25, 0.1],
        counts: [4, 3, 2],
    }
}

#[test]
fn vtk_reads_a_grid_back() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("slice.vti");
    let grid = oblique_grid();
    let points = Vec::from_iter(grid.points());
    assert_eq!(points.len(), grid.point_count());
    let pressure = Vec::from_iter(points.iter().map(|point| point[0] / 7.0));
    let single = Vec::from_iter(pressure.iter().map(|&x| x as f32));
    let fields = [
        ("velocity", PointValues::Vectors(&points)),
        ("pressure", PointValues::Scalars(&pressure)),
        ("density", PointValues::Scalars32(&single)),
    ]
    .map(|(name, values)| PointField { name, values });
    write_vti(&path, &grid, Some(TIME), &fields).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let document = Document::parse(&text).unwrap();
    let data = only_child(document.root_element(), "ImageData");
    assert_eq!(data.attribute("WholeExtent"), Some("0 3 0 2 0 1"));
    let piece = only_child(data, "Piece");
    assert_eq!(piece.attribute("Extent"), Some("0 3 0 2 0 1"));
    let array = children(only_child(piece, "PointData"), "DataArray")[1];
    assert_eq!(bits(&stored(array, "Float64")), bits(&pressure));
    let Some(found) = read_by_vtk(&path) else {
        return;
    };
    assert_same_fields(&found, &fields);
    assert_eq!(found["counts"], serde_json::json!(grid.counts));
    assert_eq!(found["origin"], serde_json::json!(bits(&grid.origin)));
    assert_eq!(found["spacings"], serde_json::json!(bits(&grid.spacings)));
    for (found, point) in found["points"].as_array().unwrap().iter().zip(points) {
        for (found, expected) in found.as_array().unwrap().iter().zip(point) {
            GRID_POINT.assert(found.as_f64().unwrap(), expected, 1.0, "where a point is");
        }
    }
}

#[test]
fn what_is_no_grid_is_refused_and_leaves_no_file() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("slice.vti");
    let write = |change: fn(&mut Grid)| {
        let mut grid = oblique_grid();
        change(&mut grid);
        let error = write_vti(&path, &grid, None, &[]).unwrap_err();
        assert!(!path.exists());
        error
    };
    for error in [
        write(|grid| grid.counts[1] = 0),
        write(|grid| grid.spacings[2] = 0.0),
        write(|grid| grid.spacings[0] = f64::NAN),
        write(|grid| grid.axes[1][2] = f64::INFINITY),
    ] {
        assert!(matches!(error, VtkError::Grid { .. }), "{error}");
        assert!(error.to_string().contains("above 0"), "{error}");
    }
    let short = [PointField {
        name: "p",
        values: PointValues::Scalars(&[1.0]),
    }];
    let error = write_vti(&path, &oblique_grid(), None, &short).unwrap_err();
    let expected = "field `p` has 1 entries: there are 24 points";
    assert!(error.to_string().ends_with(expected), "{error}");
}

#[test]
fn what_is_no_field_is_refused_and_leaves_no_file() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("surface.vtp");
    let Example {
        mesh,
        positions,
        mean,
        ..
    } = Example::new();
    let field = |name, values| PointField {
        name,
        values: PointValues::Scalars(values),
    };
    let write = |positions: &[[f64; 3]], fields: &[PointField<'_>]| {
        let error = write_vtp(&path, &mesh, positions, None, fields).unwrap_err();
        assert!(!path.exists());
        assert!(error.to_string().starts_with(&path.display().to_string()));
        error
    };
    let error = write(&positions[1..], &[]);
    assert!(matches!(error, VtkError::CountMismatch { .. }), "{error}");
    let error = write(&positions, &[field("H", &mean[1..])]);
    let expected = "field `H` has 41 entries: there are 42 vertices";
    assert!(error.to_string().ends_with(expected), "{error}");
    for name in ["", " ", "a\nb", "\u{0}", "\u{ffff}"] {
        let error = write(&positions, &[field(name, &mean)]);
        assert!(matches!(error, VtkError::Name { .. }), "{error}");
    }
    let error = write(&positions, &[field("H", &mean), field("H", &mean)]);
    assert!(matches!(error, VtkError::RepeatedName { .. }), "{error}");
}

#[test]
fn the_index_of_a_run_names_every_file_at_its_time() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("run.pvd");
    let mut collection = Collection::default();
    for step in 0..3 {
        for part in 0..2 {
            collection.entries.push(CollectionEntry {
                time: TIME * f64::from(step),
                part,
                file: format!("surfaces/a&b-{part}-{step}.vtp"),
            });
        }
        collection.write(&path).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let document = Document::parse(&text).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("type"), Some("Collection"));
        let found: Vec<CollectionEntry> = children(only_child(root, "Collection"), "DataSet")
            .iter()
            .map(|set| CollectionEntry {
                time: set.attribute("timestep").unwrap().parse().unwrap(),
                part: set.attribute("part").unwrap().parse().unwrap(),
                file: set.attribute("file").unwrap().to_owned(),
            })
            .collect();
        assert_eq!(found, collection.entries);
    }
}
