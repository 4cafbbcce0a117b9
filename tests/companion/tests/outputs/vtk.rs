//! Surfaces and grids for VTK, and the index file of a run.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

mod by_vtk;
mod published;

use super::{TIME, bits};
use helfrich_std::io::{
    Collection, CollectionEntry, Grid, PointField, PointValues, VtkError, write_vti, write_vtp,
};
use helfrich_tests::meshes::{Mesh, bent, icosphere};
use helfrich_tests::tolerance::GRID_POINT;
use published::{Array, Data, Entry, Numbers, read};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A surface with a field of every kind, with values that short texts would not preserve.
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

/// VTK's name of the type of a field, its number of components, and all values as f64 in the order of the
/// file.
fn flat(values: PointValues<'_>) -> (&'static str, usize, Vec<f64>) {
    let wide = |values: &[f32]| values.iter().map(|&x| f64::from(x)).collect();
    match values {
        PointValues::Scalars(values) => ("Float64", 1, values.to_vec()),
        PointValues::Scalars32(values) => ("Float32", 1, wide(values)),
        PointValues::Vectors(values) => ("Float64", 3, values.as_flattened().to_vec()),
        PointValues::Vectors32(values) => ("Float32", 3, wide(values.as_flattened())),
        PointValues::Colours(values) => {
            let wide = values.as_flattened().iter().map(|&x| f64::from(x));
            ("UInt8", 3, wide.collect())
        }
    }
}

/// The same of an array, for comparison with [`flat`].
fn numbers(array: &Array) -> (&'static str, usize, Vec<f64>) {
    let components = array.components;
    match &array.numbers {
        Numbers::Double(values) => ("Float64", components, values.clone()),
        Numbers::Single(values) => {
            let wide = values.iter().map(|&x| f64::from(x)).collect();
            ("Float32", components, wide)
        }
        Numbers::Integers(values) => panic!("{}: {values:?}", array.name),
    }
}

/// Data of a file that conforms to the published format and has these fields.
#[track_caller]
fn published(path: &Path, fields: &[PointField<'_>]) -> Data {
    let contents = read(&fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(contents.time.map(f64::to_bits), Some(TIME.to_bits()));
    assert_eq!(contents.fields.len(), fields.len());
    for (array, field) in contents.fields.iter().zip(fields) {
        assert_eq!(array.name, field.name);
        let (kind, components, values) = flat(field.values);
        let found = numbers(array);
        assert_eq!((found.0, found.1), (kind, components), "{}", field.name);
        assert_eq!(bits(&found.2), bits(&values), "{}", field.name);
    }
    contents.data
}

#[test]
fn a_surface_is_stored_bit_by_bit_as_vtk_documents_it() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("surface.vtp");
    let example = Example::new();
    example.write(&path);
    let Data::Surface {
        positions,
        polygons,
    } = published(&path, &example.fields())
    else {
        panic!("no surface");
    };
    assert_eq!(bits(&positions), bits(example.positions.as_flattened()));
    let triangles = example.mesh.triangles().iter();
    let triangles = Vec::from_iter(triangles.map(|corners| corners.map(i64::from).to_vec()));
    assert_eq!(polygons, triangles);
}

/// Grid whose axes do not form a symmetric matrix, so that confusing rows and columns shows.
fn oblique_grid() -> Grid {
    let [first, second, third] = [[0.6, 0.8, 0.0], [0.0, 0.0, 1.0], [0.8, -0.6, 0.0]];
    Grid {
        origin: [0.1, -2.0, 1.0 / 3.0],
        axes: [first, second, third],
        spacings: [0.5, 0.25, 0.1],
        counts: [4, 3, 2],
    }
}

/// The grid's points, and values at them that short texts would not preserve.
struct OnGrid {
    points: Vec<[f64; 3]>,
    pressure: Vec<f64>,
    single: Vec<f32>,
}

impl OnGrid {
    fn new() -> Self {
        let points = Vec::from_iter(oblique_grid().points());
        let pressure = Vec::from_iter(points.iter().map(|point| point[0] / 7.0));
        let single = Vec::from_iter(pressure.iter().map(|&x| x as f32));
        Self {
            points,
            pressure,
            single,
        }
    }

    fn fields(&self) -> [PointField<'_>; 3] {
        [
            ("velocity", PointValues::Vectors(&self.points)),
            ("pressure", PointValues::Scalars(&self.pressure)),
            ("density", PointValues::Scalars32(&self.single)),
        ]
        .map(|(name, values)| PointField { name, values })
    }

    fn write(&self, path: &Path) {
        write_vti(path, &oblique_grid(), Some(TIME), &self.fields()).unwrap();
    }
}

/// The positions of the points follow from the attributes by VTK's documentation: the origin plus the matrix
/// of directions times the spacings times the indices of the point.
#[test]
fn a_grid_is_stored_as_vtk_documents_it() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("slice.vti");
    let example = OnGrid::new();
    example.write(&path);
    let Data::Grid {
        counts,
        origin,
        spacings,
        direction,
    } = published(&path, &example.fields())
    else {
        panic!("no grid");
    };
    assert_eq!(counts, oblique_grid().counts);
    for (at, point) in example.points.iter().enumerate() {
        let numbers = [
            at % counts[0],
            at / counts[0] % counts[1],
            at / counts[0] / counts[1],
        ];
        for axis in 0..3 {
            let steps = (0..3).map(|k| direction[3 * axis + k] * spacings[k] * numbers[k] as f64);
            let found = origin[axis] + steps.sum::<f64>();
            GRID_POINT.assert(found, point[axis], 1.0, "where a point is");
        }
    }
}

/// Files with one fault each, which a careless reader would let pass.
#[test]
fn what_is_not_as_published_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("surface.vtp");
    Example::new().write(&path);
    let surface = fs::read_to_string(&path).unwrap();
    OnGrid::new().write(&path);
    let grid = fs::read_to_string(&path).unwrap();
    for (text, old, new) in [
        (&surface, "NumberOfPolys=\"80\"", "NumberOfPolys=\"79\""),
        (&surface, "NumberOfPoints=\"42\"", "NumberOfPoints=\"41\""),
        (&surface, "NumberOfVerts=\"0\"", ""),
        (&surface, "NumberOfLines=\"0\"", "NumberOfLines=\"1\""),
        (&surface, "NumberOfStrips", "NumberOfStripes"),
        (&surface, "Name=\"offsets\"", "Name=\"ends\""),
        (&surface, "Name=\"single\"", "Name=\"force\""),
        (&surface, "type=\"Float32\" Name", "type=\"Float64\" Name"),
        (&surface, "type=\"Int64\"", "type=\"Int32\""),
        (
            &surface,
            "NumberOfComponents=\"3\"",
            "NumberOfComponents=\"2\"",
        ),
        (&surface, "UInt64", "UInt32"),
        (&surface, "LittleEndian", "BigEndian"),
        (&surface, "format=\"binary\"", "format=\"ascii\""),
        (&surface, "NumberOfTuples=\"1\"", "NumberOfTuples=\"2\""),
        (&surface, "NumberOfTuples=\"1\"", ""),
        (&surface, "<PointData>", "<PointData Scalars=\"none\">"),
        (&surface, "<Polys>", "<Polys>1 2 3"),
        (&surface, "Polys>", "Polygons>"),
        (&surface, "Points>", "PointData>"),
        (&surface, "</PolyData>", "</PolyData><PolyData/>"),
        (&surface, "==</DataArray>", "</DataArray>"),
        (&grid, "Extent=\"0 3 0 2 0 1\"", "Extent=\"0 3 0 2 0 2\""),
        (
            &grid,
            "<Piece Extent=\"0 3 0 2 0 1\"",
            "<Piece Extent=\"0 3 0 2 1 1\"",
        ),
        (&grid, " Spacing=", " Spacings="),
        (&grid, "Direction=\"0.6 ", "Direction=\""),
        (&grid, "ImageData", "RectilinearGrid"),
    ] {
        assert!(text.contains(old), "{old} is not in the file");
        let found = read(&text.replace(old, new));
        assert!(found.is_err(), "{old} as {new}: {found:?}");
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
        let contents = read(&fs::read_to_string(&path).unwrap()).unwrap();
        let entries = collection.entries.iter().map(|entry| Entry {
            time: entry.time,
            part: entry.part,
            file: entry.file.clone(),
        });
        assert_eq!(contents.data, Data::Index(entries.collect()));
    }
}
