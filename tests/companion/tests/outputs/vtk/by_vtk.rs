//! Files read by VTK itself. The tests are ignored because they need VTK:
//! `cargo test -p helfrich-companion-tests --test outputs vtk_itself -- --ignored`

use super::{Example, OnGrid, flat, oblique_grid};
use crate::{TIME, bits};
use helfrich_std::io::PointField;
use helfrich_tests::tolerance::GRID_POINT;
use serde_json::Value;
use std::env;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// Contents of a file as read by VTK in the Python that `HELFRICH_PYTHON` names, or else `python3`.
fn read_by_vtk(path: &Path) -> Value {
    let python = env::var_os("HELFRICH_PYTHON").unwrap_or_else(|| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/read_vtk.py");
    let mut read = Command::new(python);
    let output = read.arg(script).arg(path).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && errors.is_empty(),
        "HELFRICH_PYTHON has to name a Python with the package vtk: {errors}"
    );
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["complaints"], serde_json::json!([]));
    found
}

/// Checks the fields that VTK has read.
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
#[ignore = "needs the Python package vtk: .ci/run runs it where there is one"]
fn vtk_itself_reads_a_surface_back() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("surface.vtp");
    let example = Example::new();
    example.write(&path);
    let found = read_by_vtk(&path);
    assert_eq!(found["other_cells"], 0);
    assert_eq!(
        found["triangles"],
        serde_json::json!(example.mesh.triangles())
    );
    let positions = bits(example.positions.as_flattened());
    assert_eq!(found["positions"], serde_json::json!(positions));
    assert_same_fields(&found, &example.fields());
}

#[test]
#[ignore = "needs the Python package vtk: .ci/run runs it where there is one"]
fn vtk_itself_reads_a_grid_back() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("slice.vti");
    let example = OnGrid::new();
    example.write(&path);
    let (found, grid) = (read_by_vtk(&path), oblique_grid());
    assert_same_fields(&found, &example.fields());
    assert_eq!(found["counts"], serde_json::json!(grid.counts));
    assert_eq!(found["origin"], serde_json::json!(bits(&grid.origin)));
    assert_eq!(found["spacings"], serde_json::json!(bits(&grid.spacings)));
    let points = found["points"].as_array().unwrap();
    assert_eq!(points.len(), example.points.len());
    for (found, point) in points.iter().zip(&example.points) {
        for (found, &expected) in found.as_array().unwrap().iter().zip(point) {
            GRID_POINT.assert(found.as_f64().unwrap(), expected, 1.0, "where a point is");
        }
    }
}
