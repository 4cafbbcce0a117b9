//! What a run leaves: surfaces for VTK, checkpoints, series, pictures.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use helfrich_std::checkpoint::{self, CheckpointProblem, Fingerprint};
use helfrich_std::io::{
    Collection, CollectionEntry, Grid, PointField, PointValues, VtkError, write_vti, write_vtp,
};
use helfrich_std::picture::{
    Axis, Canvas, ColourMap, Colouring, Curve, Frame, Marks, PaintedSurface, Picture, PictureError,
    Plot, Scale, Shading, View,
};
use helfrich_std::series::{Series, SeriesProblem, SeriesTable};
use helfrich_tests::meshes::{Mesh, bent, cases, icosphere};
use helfrich_tests::tolerance::{GRID_POINT, PICTURE_RADIUS};
use proptest::prelude::*;
use roxmltree::{Document, Node};
use serde::de::DeserializeOwned;
use serde::ser::{Serialize, SerializeTuple, Serializer};
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

const TIME: f64 = 0.1 + 0.2;

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

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
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

/// A state of the kinds that runs have.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct State {
    time: f64,
    steps: u64,
    positions: Vec<[f64; 3]>,
    names: Vec<String>,
    previous: Option<Vec<f64>>,
}

fn state() -> State {
    State {
        time: TIME,
        steps: 1 << 40,
        positions: vec![
            [1.0 / 3.0, -0.0, f64::MIN_POSITIVE / 2.0],
            [1e300, 0.1, -7.0],
        ],
        names: vec!["bending".into(), "Fläche".into()],
        previous: Some(vec![f64::INFINITY, f64::from_bits(0x7ff8_0000_dead_beef)]),
    }
}

#[track_caller]
fn refused<D: DeserializeOwned>(path: &Path, scene: Fingerprint) -> CheckpointProblem {
    let error = checkpoint::read::<D>(path, scene).err().unwrap();
    let message = error.to_string();
    assert!(
        message.starts_with(&path.display().to_string()),
        "{message}"
    );
    assert!(!message.contains('\n'), "{message}");
    error.problem
}

#[test]
fn a_checkpoint_keeps_every_bit() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let scene = Fingerprint::of("scene");
    checkpoint::write(&path, scene, &0_u8).unwrap();
    checkpoint::write(&path, scene, &state()).unwrap();
    let found: State = checkpoint::read(&path, scene).unwrap();
    let number = |state: &State| {
        let previous = state.previous.clone().unwrap();
        let all = [&[state.time], state.positions.as_flattened(), &previous].concat();
        bits(&all)
    };
    assert_eq!(number(&found), number(&state()));
    assert_eq!((found.steps, found.names), (state().steps, state().names));
    // Nothing else is left in the folder.
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn a_checkpoint_that_cannot_be_written_leaves_the_last_one() {
    struct Refuses;
    impl Serialize for Refuses {
        fn serialize<S: Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
            Err(serde::ser::Error::custom("no"))
        }
    }
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let scene = Fingerprint::of("scene");
    checkpoint::write(&path, scene, &17_u8).unwrap();
    let error = checkpoint::write(&path, scene, &Refuses).unwrap_err();
    assert!(matches!(error.problem, CheckpointProblem::NotEncodable(_)));
    assert_eq!(checkpoint::read::<u8>(&path, scene).unwrap(), 17);
    let error = checkpoint::write(&folder.path().join("no/checkpoint"), scene, &1).unwrap_err();
    assert!(matches!(error.problem, CheckpointProblem::Inaccessible(_)));
}

#[test]
fn every_truncation_bit_flip_and_extension_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let scene = Fingerprint::of("scene");
    checkpoint::write(&path, scene, &state()).unwrap();
    let good = fs::read(&path).unwrap();
    for length in 0..good.len() {
        fs::write(&path, &good[..length]).unwrap();
        match refused::<State>(&path, scene) {
            CheckpointProblem::NotACheckpoint => assert_eq!(length, 0),
            CheckpointProblem::Truncated { found, expected } => {
                assert_eq!(found, length as u64);
                assert!(length < 60 || expected == good.len() as u64);
            }
            other => panic!("{length}: {other}"),
        }
    }
    let mut bytes = good.clone();
    for bit in 0..8 * good.len() {
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, &bytes).unwrap();
        refused::<State>(&path, scene);
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    bytes.push(0);
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::Damaged
    ));
    fs::write(&path, &good).unwrap();
    checkpoint::read::<State>(&path, scene).unwrap();
}

#[test]
fn what_else_is_wrong_with_a_checkpoint_is_said() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let [scene, other] = ["scene", "scene "].map(Fingerprint::of);
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::Inaccessible(error) if error.kind() == io::ErrorKind::NotFound
    ));
    checkpoint::write(&path, other, &state()).unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::OtherScene { found, expected } if (found, expected) == (other, scene)
    ));
    // Of another type, whether too short or too long.
    for (path, problem) in [
        (
            "short",
            checkpoint::write(&folder.path().join("short"), scene, &1_u8),
        ),
        (
            "long",
            checkpoint::write(&folder.path().join("long"), scene, &(state(), 1_u8)),
        ),
    ] {
        problem.unwrap();
        let problem = refused::<State>(&folder.path().join(path), scene);
        assert!(
            matches!(problem, CheckpointProblem::OtherState(_)),
            "{problem}"
        );
    }
    let good = fs::read(&path).unwrap();
    let mut bytes = good.clone();
    bytes[16] = 2;
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::OtherFormat { found: 2 }
    ));
    fs::write(&path, "time,area\n").unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::NotACheckpoint
    ));
}

/// Bytes that become the state of a checkpoint as they are.
struct Raw(Vec<u8>);

impl Serialize for Raw {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

proptest! {
    #![proptest_config(cases(32))]

    /// A list that announces more than there is would exhaust memory, or panic, if it were trusted.
    #[test]
    fn a_state_of_any_bytes_is_read_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        length in any::<u64>(),
    ) {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("checkpoint");
        let scene = Fingerprint::of("");
        checkpoint::write(&path, scene, &Raw(bytes.clone())).unwrap();
        let _ = checkpoint::read::<State>(&path, scene);
        let _ = checkpoint::read::<Vec<Vec<[f64; 3]>>>(&path, scene);
        checkpoint::write(&path, scene, &(length | 1 << 32, Raw(bytes))).unwrap();
        prop_assert!(checkpoint::read::<Vec<f64>>(&path, scene).is_err());
        prop_assert!(checkpoint::read::<Vec<[f64; 3]>>(&path, scene).is_err());
        prop_assert!(checkpoint::read::<String>(&path, scene).is_err());
    }
}

const COLUMNS: [&str; 3] = ["time", "energy_bending", "area"];

/// Numbers of all sizes, and those that are none.
fn row(at: u64) -> [f64; 3] {
    let at = at as f64;
    let odd = [f64::NAN, f64::INFINITY, -0.0, 5e-324, f64::MAX][at as usize % 5];
    [at * 0.1, (at + 1.0) / 3.0, odd]
}

fn written(path: &Path, rows: u64) -> Vec<u8> {
    let mut series = Series::create(path, &COLUMNS).unwrap();
    (0..rows).for_each(|at| series.append(&row(at)).unwrap());
    assert_eq!(series.mark().unwrap(), rows);
    fs::read(path).unwrap()
}

#[test]
fn a_series_reads_back_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    let bytes = written(&path, 9);
    let first = "time,energy_bending,area\n0.0,0.3333333333333333,NaN\n";
    assert!(bytes.starts_with(first.as_bytes()));
    let table = SeriesTable::read(&path).unwrap();
    assert_eq!(table.columns, COLUMNS);
    assert_eq!(table.rows.len(), 9);
    for (at, found) in table.rows.iter().enumerate() {
        assert_eq!(bits(found), bits(&row(at as u64)));
    }
    let expected: Vec<f64> = (0..9).map(|at| row(at)[0]).collect();
    assert_eq!(table.column("time"), Some(expected));
    assert_eq!(table.column("volume"), None);
}

#[test]
fn wherever_a_series_was_torn_the_resumed_one_is_the_same() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    let whole = written(&path, 8);
    let lines = |bytes: &[u8]| bytes.iter().filter(|&&byte| byte == b'\n').count() as u64;
    for length in 0..=whole.len() {
        let torn = &whole[..length];
        for marked in 0..=8 {
            fs::write(&path, torn).unwrap();
            let resumed = Series::resume(&path, &COLUMNS, marked);
            if lines(torn) < marked + 1 {
                resumed.unwrap_err();
                assert_eq!(fs::read(&path).unwrap(), torn);
                continue;
            }
            let mut series = resumed.unwrap();
            assert_eq!(lines(&fs::read(&path).unwrap()), marked + 1);
            (marked..8).for_each(|at| series.append(&row(at)).unwrap());
            assert_eq!(fs::read(&path).unwrap(), whole);
        }
    }
    // A reader does not see the torn line.
    fs::write(&path, &whole[..whole.len() - 2]).unwrap();
    assert_eq!(SeriesTable::read(&path).unwrap().rows.len(), 7);
}

#[test]
fn what_is_no_series_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    let create = |columns: &[&str]| Series::create(&path, columns).unwrap_err().problem;
    assert!(matches!(
        create(&["area", "time"]),
        SeriesProblem::NoTime { .. }
    ));
    assert!(matches!(create(&[]), SeriesProblem::NoTime { .. }));
    for name in ["", "a,b", "a\"", " a", "a\nb"] {
        assert!(matches!(
            create(&["time", name]),
            SeriesProblem::Name { .. }
        ));
    }
    let repeated = create(&["time", "area", "area"]);
    assert!(matches!(repeated, SeriesProblem::RepeatedName { .. }));
    assert!(!path.exists());

    let whole = written(&path, 4);
    let resume = |columns: &[&str], rows| {
        let before = fs::read(&path).unwrap();
        let error = Series::resume(&path, columns, rows).unwrap_err();
        assert_eq!(fs::read(&path).unwrap(), before);
        error.problem
    };
    let other = resume(&["time", "area"], 4);
    assert!(
        matches!(other, SeriesProblem::OtherColumns { .. }),
        "{other}"
    );
    let few = resume(&COLUMNS, 5);
    assert!(
        matches!(
            few,
            SeriesProblem::TooFewRows {
                found: 4,
                expected: 5
            }
        ),
        "{few}"
    );
    for (from, to, message) in [
        (
            "0.1,",
            "0.1,,",
            "line 3: 4 numbers, but there are 3 columns",
        ),
        (
            "0.1,",
            "O.1,",
            "line 3, column `time`: expected a number, found `O.1`",
        ),
        (
            "0.1,",
            "\0\0\0,",
            "line 3, column `time`: expected a number",
        ),
    ] {
        let text = String::from_utf8(whole.clone())
            .unwrap()
            .replacen(from, to, 1);
        fs::write(&path, text).unwrap();
        for problem in [
            resume(&COLUMNS, 4),
            SeriesTable::read(&path).unwrap_err().problem,
        ] {
            assert!(problem.to_string().starts_with(message), "{problem}");
        }
    }
    fs::write(&path, vec![b'1'; 2 << 20]).unwrap();
    assert!(matches!(
        resume(&COLUMNS, 0),
        SeriesProblem::NotARow { line: 1 }
    ));

    let mut series = Series::create(&path, &COLUMNS).unwrap();
    let problem = series.append(&[0.0, 1.0]).unwrap_err().problem;
    assert!(matches!(
        problem,
        SeriesProblem::WrongLength {
            line: 2,
            found: 2,
            columns: 3
        }
    ));
}

/// A ball in the middle of a square picture, seen along y with z upwards; x is to the right.
const AHEAD: View = View {
    direction: [0.0, -1.0, 0.0],
    up: [0.0, 0.0, 1.0],
    frame: Some(Frame {
        centre: [0.0; 3],
        radius: 2.0,
    }),
};

fn picture<'a>(surfaces: &'a [PaintedSurface<'a>], map: ColourMap) -> Picture<'a> {
    Picture {
        size: [400, 400],
        title: "",
        surfaces,
        colours: Colouring {
            label: "x [µm]",
            range: None,
            map,
        },
        view: AHEAD,
        length_unit: None,
    }
}

fn painted<'a>(mesh: &'a Mesh, field: Option<&'a [f64]>) -> PaintedSurface<'a> {
    PaintedSurface {
        surface: mesh.surface(),
        field,
        shading: Shading::Smooth,
        edges: false,
    }
}

/// Red, green and blue of the pixel at shares of the width and the height.
fn pixel(canvas: &Canvas, x: f64, y: f64) -> [u8; 3] {
    let [width, height] = canvas.size();
    let at = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
    let start = 3 * (at(y, height) * width + at(x, width));
    canvas.rgb()[start..start + 3].try_into().unwrap()
}

const WHITE: [u8; 3] = [255; 3];

/// The parallel projection of a ball is a disc.
#[test]
fn a_sphere_covers_a_disc_of_the_right_size() {
    let mesh = icosphere(4);
    let surfaces = [painted(&mesh, None)];
    let canvas = picture(&surfaces, ColourMap::Sequential).draw().unwrap();
    let [width, height] = canvas.size();
    let rgb = canvas.rgb();
    let seen: Vec<[f64; 2]> = (0..width * height)
        .filter(|at| rgb[3 * at..3 * at + 3] != WHITE)
        .map(|at| [(at % width) as f64 + 0.5, (at / width) as f64 + 0.5])
        .collect();
    let count = seen.len() as f64;
    let radius = (count / std::f64::consts::PI).sqrt();
    // The frame's radius of 2 is half of what the margins leave of 400 pixels.
    let letters = 12.0 * (400.0_f64 / 900.0).sqrt();
    let expected = (400.0 - 4.0 * letters) / 4.0;
    PICTURE_RADIUS.assert(radius, expected, expected, "radius in pixels");
    for axis in 0..2 {
        let centre = seen.iter().map(|at| at[axis]).sum::<f64>() / count;
        PICTURE_RADIUS.assert(centre, 200.0, expected, "centre in pixels");
    }
}

#[test]
fn fields_become_colours_where_they_are_and_the_nearer_surface_is_seen() {
    let ball = icosphere(3);
    let x: Vec<f64> = ball.positions.iter().map(|x| x[0]).collect();
    let surfaces = [painted(&ball, Some(&x))];
    let mut diverging = picture(&surfaces, ColourMap::Diverging);
    diverging.view.frame = None;
    diverging.size = [520, 400];
    let canvas = diverging.draw().unwrap();
    // Left of the colour bar the ball fills the height: blue, light, red from left to right.
    let [left, middle, right] = [0.2, 0.42, 0.65].map(|x| pixel(&canvas, x, 0.5));
    assert!(left[2] > left[0] + 60, "{left:?}");
    assert!(right[0] > right[2] + 60, "{right:?}");
    assert!(middle[0].abs_diff(middle[2]) < 40, "{middle:?}");
    assert_eq!(pixel(&canvas, 0.01, 0.01), WHITE);

    // The viewer is at y = −∞: of two balls, the one with the smaller y is seen.
    let moved = |y: f64| ball.map(|[a, b, c]| [a, b + y, c]);
    let (near, far) = (moved(-3.0), moved(3.0));
    let [low, high] = [0.0, 1.0].map(|value| vec![value; ball.positions.len()]);
    for order in [[0, 1], [1, 0]] {
        let both = [painted(&near, Some(&low)), painted(&far, Some(&high))];
        let both = order.map(|at| both[at]);
        let canvas = picture(&both, ColourMap::Diverging).draw().unwrap();
        let seen = pixel(&canvas, 0.4, 0.5);
        assert!(seen[0].abs_diff(seen[2]) < 40, "{seen:?}");
        let both = [painted(&near, Some(&high)), painted(&far, Some(&low))];
        let both = order.map(|at| both[at]);
        let canvas = picture(&both, ColourMap::Diverging).draw().unwrap();
        let seen = pixel(&canvas, 0.4, 0.5);
        assert!(seen[0] > seen[2] + 60, "{seen:?}");
    }
}

#[test]
fn a_png_file_holds_the_canvas() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("picture.png");
    let ball = icosphere(2);
    let z: Vec<f64> = ball.positions.iter().map(|x| x[2]).collect();
    let surfaces = [painted(&ball, Some(&z))];
    let picture = Picture {
        title: "t = 0.1 s, κ − 1",
        length_unit: Some("µm"),
        ..picture(&surfaces, ColourMap::Sequential)
    };
    let canvas = picture.draw().unwrap();
    canvas.write_png(&path).unwrap();
    let file = io::BufReader::new(fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!([frame.width, frame.height], [400, 400]);
    assert_eq!(bytes, canvas.rgb());
    assert_eq!(picture.draw().unwrap(), canvas);
}

#[test]
fn impossible_pictures_are_refused() {
    let ball = icosphere(0);
    let surfaces = [painted(&ball, Some(&[0.0; 3]))];
    let error = picture(&surfaces, ColourMap::Diverging).draw().unwrap_err();
    assert_eq!(
        error.to_string(),
        "surface 0: the field has 3 values, the mesh 12 vertices"
    );
    let surfaces = [painted(&ball, None)];
    let good = picture(&surfaces, ColourMap::Sequential);
    for size in [[100, 400], [400, 1 << 20]] {
        let error = Picture {
            size,
            ..good.clone()
        }
        .draw()
        .unwrap_err();
        assert!(matches!(error, PictureError::Size { .. }), "{error}");
    }
    for direction in [[0.0; 3], [0.0, 0.0, -2.0], [f64::NAN, 1.0, 0.0]] {
        let view = View { direction, ..AHEAD };
        let error = Picture {
            view,
            ..good.clone()
        }
        .draw()
        .unwrap_err();
        assert!(matches!(error, PictureError::View { .. }), "{error}");
    }
    for range in [
        [1.0, 1.0],
        [2.0, 1.0],
        [0.0, f64::NAN],
        [f64::MIN, f64::MAX],
    ] {
        let colours = Colouring {
            range: Some(range),
            ..good.colours
        };
        let error = Picture {
            colours,
            ..good.clone()
        }
        .draw()
        .unwrap_err();
        assert!(matches!(error, PictureError::Range { .. }), "{error}");
        let x = Axis {
            range: Some(range),
            ..Axis::default()
        };
        assert!(matches!(
            plot(x, &[]).draw(),
            Err(PictureError::Range { .. })
        ));
    }
    let x = Axis {
        range: Some([0.0, 1.0]),
        scale: Scale::Logarithmic,
        ..Axis::default()
    };
    assert!(matches!(
        plot(x, &[]).draw(),
        Err(PictureError::Range { .. })
    ));
}

fn plot<'a>(x: Axis<'a>, curves: &'a [Curve<'a>]) -> Plot<'a> {
    Plot {
        size: [450, 350],
        title: "",
        x,
        y: Axis::default(),
        curves,
    }
}

/// Where the pixels of a colour as strong as a mark's are on average, as shares of the picture.
fn coloured(canvas: &Canvas) -> [f64; 2] {
    let [width, height] = canvas.size();
    let rgb = canvas.rgb();
    let strong = |at: &usize| {
        let part = &rgb[3 * at..3 * at + 3];
        part.iter().max().unwrap() - part.iter().min().unwrap() > 100
    };
    let found: Vec<usize> = (0..width * height).filter(strong).collect();
    assert!(!found.is_empty());
    let mean = |part: fn(usize, usize) -> usize, count: usize| {
        let sum: usize = found.iter().map(|&at| part(at, width)).sum();
        (sum as f64 / found.len() as f64 + 0.5) / count as f64
    };
    [
        mean(|at, width| at % width, width),
        mean(|at, width| at / width, height),
    ]
}

/// Equal steps on an axis, linear or logarithmic, are equal steps in the picture.
#[test]
fn points_are_where_their_axes_have_them() {
    for (scale, range, values) in [
        (Scale::Linear, [-1.0, 3.0], [0.0, 1.0, 2.0]),
        (Scale::Logarithmic, [1e-6, 1e2], [1e-4, 1e-2, 1.0]),
    ] {
        let axis = Axis {
            label: "",
            range: Some(range),
            scale,
        };
        let places = values.map(|value| {
            let points = [[value, value]];
            let curves = [Curve {
                name: "",
                points: &points,
                bounds: &[],
                marks: Marks::Points,
                colour: None,
            }];
            let plot = Plot {
                y: axis,
                ..plot(axis, &curves)
            };
            coloured(&plot.draw().unwrap())
        });
        // To the right, and upwards.
        for (axis, direction) in [(0, 1.0), (1, -1.0)] {
            let [a, b, c] = places.map(|place| direction * place[axis]);
            assert!(b > a);
            PICTURE_RADIUS.assert(c - b, b - a, b - a, "step");
        }
    }
}

proptest! {
    #![proptest_config(cases(24))]

    /// Whatever is to be shown, it is drawn or refused. Surfaces beyond 2²⁵² are none.
    #[test]
    fn no_number_breaks_a_picture(
        exponent in -308_i32..76,
        values in prop::collection::vec(any::<f64>(), 12),
        diverging: bool,
        logarithmic: bool,
    ) {
        let size = 10.0_f64.powi(exponent);
        let ball = icosphere(0).map(|x| x.map(|x| size * x));
        for field in [&values, &vec![values[0]; 12]] {
            let map = if diverging { ColourMap::Diverging } else { ColourMap::Sequential };
            let surfaces = [PaintedSurface { edges: diverging, ..painted(&ball, Some(field)) }];
            let mut picture = picture(&surfaces, map);
            picture.view = View::default();
            picture.length_unit = Some("m");
            picture.draw().unwrap();
        }
        let points: Vec<[f64; 2]> = values.chunks(2).map(|pair| [pair[0], pair[1]]).collect();
        let curve = Curve {
            name: "all",
            points: &points,
            bounds: &points,
            marks: Marks::LineAndPoints,
            colour: None,
        };
        let scale = if logarithmic { Scale::Logarithmic } else { Scale::Linear };
        let axis = Axis { scale, ..Axis::default() };
        for curves in [&[][..], &[curve], &[Curve { marks: Marks::Dashes, ..curve }]] {
            Plot { y: axis, ..plot(axis, curves) }.draw().unwrap();
        }
    }
}
