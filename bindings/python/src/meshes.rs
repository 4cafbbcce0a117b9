//! Meshes: files, shapes, checks, refinement.

use crate::arrays::{Arrays, Input, Positions, arrays, matrix};
use crate::failure::{Fault, invalid, unreadable, unwritable};
use crate::work::on_threads;
use helfrich::{Surface, TriangleMesh};
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::info::{ComponentInfo, MeshInfo, components as measures_of_components};
use helfrich_std::io::{self, MeshFile, PointField, PointValues, Welded};
use helfrich_std::noise::noise_seen;
use helfrich_std::polygon;
use helfrich_std::repair::{self as mending, NEW, RepairError, RepairSettings, Soup};
use helfrich_std::subdivide as refinement;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Reads a mesh file.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Arrays<'_>> {
    let file = on_threads(py, None, || io::read(&path))?;
    let MeshFile {
        positions,
        mesh,
        left_out,
    } = file.map_err(|error| unreadable(&error))?;
    if left_out > 0 {
        let text = format!(
            "left out: {left_out} vertices of no face with a coordinate that is not finite"
        );
        let warn = py.import("helfrich._errors")?.getattr("warn")?;
        warn.call1((text,))?;
    }
    arrays(py, positions, &mesh)
}

/// Numbers or vectors at vertices, for a file.
enum Field<'py> {
    Scalars(PyReadonlyArray1<'py, f64>),
    Vectors(PyReadonlyArray2<'py, f64>),
}

/// Writes a mesh file, with fields of numbers (n,) and vectors (n, 3) in double precision.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    path: PathBuf,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    fields: &Bound<'_, PyDict>,
) -> PyResult<()> {
    let mut input = Input::new(positions, faces)?;
    let mut named = Vec::new();
    for (name, values) in fields.iter() {
        let field = match values.cast::<PyArray2<f64>>() {
            Ok(vectors) => Field::Vectors(vectors.try_readonly().map_err(invalid)?),
            Err(_) => Field::Scalars(
                values
                    .cast::<PyArray1<f64>>()?
                    .try_readonly()
                    .map_err(invalid)?,
            ),
        };
        named.push((name.extract::<String>()?, field));
    }
    let fields = named.iter().map(|(name, field)| PointField {
        name,
        values: match field {
            Field::Scalars(array) => PointValues::Scalars(array.as_slice().unwrap_or(&[])),
            Field::Vectors(array) => PointValues::Vectors(crate::arrays::rows(array)),
        },
    });
    let fields = Vec::from_iter(fields);
    let triangles = input.take_faces();
    let positions = input.positions.double();
    on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles).map_err(Fault::from)?;
        Surface::new(&mesh, &positions[..]).map_err(Fault::from)?;
        if fields.is_empty() {
            return io::write(&path, &positions, &mesh).map_err(|error| unwritable(&error));
        }
        io::write_vtp(&path, &mesh, &positions, None, &fields)
            .map_err(|error| PyOSError::new_err(error.to_string()))
    })?
}

/// A mesh of a family on an exact shape, and its exact values by name.
#[pyfunction]
pub(crate) fn shape<'py>(
    py: Python<'py>,
    spec: &str,
    vertices: usize,
    family: &str,
    seed: u64,
) -> PyResult<(Arrays<'py>, Bound<'py, PyDict>)> {
    let shape: AnyShape = spec.parse().map_err(invalid)?;
    let family: Family = family.parse().map_err(invalid)?;
    let made = on_threads(py, None, || generate(&shape, family, vertices, seed))?;
    let made = made.map_err(Fault::from)?;
    let points = made.exact_points().map_err(Fault::from)?;
    let exact = PyDict::new(py);
    let list = |name: &str, values: Vec<f64>| exact.set_item(name, PyArray1::from_vec(py, values));
    list("H", points.iter().map(|at| at.mean).collect())?;
    list("K", points.iter().map(|at| at.gaussian).collect())?;
    list(
        "laplacian_of_H",
        points.iter().map(|at| at.laplacian_of_mean).collect(),
    )?;
    list("f", points.iter().map(|at| at.force_density(1.0)).collect())?;
    exact.set_item(
        "normal",
        matrix(py, points.iter().map(|at| at.normal).collect())?,
    )?;
    exact.set_item("area", shape.area())?;
    exact.set_item("volume", shape.volume())?;
    Ok((arrays(py, made.positions, &made.mesh)?, exact))
}

/// The measurements of a mesh by name; of one that is none, the fault.
#[pyfunction]
pub(crate) fn inspect<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let found = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        let surface = Surface::new(&mesh, &positions[..])?;
        let file = MeshFile::new(positions.to_vec(), mesh.clone());
        Ok::<_, Fault>((
            MeshInfo::new(surface),
            measures_of_components(surface),
            noise_seen(surface),
            file.split_vertices(),
        ))
    })?;
    let (info, components, noise, split) = found?;
    let parts = Vec::from_iter(components.iter().map(|part| measures(py, part)));
    let report = PyDict::new(py);
    report.set_item("vertices", info.vertices)?;
    report.set_item("isolated_vertices", info.isolated_vertices)?;
    report.set_item("split_vertices", split)?;
    report.set_item("edges", info.edges)?;
    report.set_item("boundary_edges", info.boundary_edges)?;
    report.set_item("faces", info.triangles)?;
    report.set_item("components", info.components)?;
    report.set_item("euler_characteristic", info.euler_characteristic)?;
    report.set_item("area", info.area)?;
    report.set_item("volume", info.volume)?;
    report.set_item("angles", (info.angles[0], info.angles[1]))?;
    report.set_item("valences", (info.valences[0], info.valences[1]))?;
    report.set_item("edge_lengths", (info.edge_lengths[0], info.edge_lengths[1]))?;
    report.set_item("noise", noise.length)?;
    report.set_item("noise_in_edges", noise.edges)?;
    report.set_item("degenerate_faces", info.degenerate_triangles)?;
    let total = components.iter().map(|part| part.total_mean_curvature);
    report.set_item("total_mean_curvature", total.sum::<f64>())?;
    report.set_item("by_component", Result::<Vec<_>, _>::from_iter(parts)?)?;
    Ok(report)
}

/// The measures of a component by name.
fn measures<'py>(py: Python<'py>, part: &ComponentInfo) -> PyResult<Bound<'py, PyDict>> {
    let measures = PyDict::new(py);
    measures.set_item("first_vertex", part.first)?;
    measures.set_item("vertices", part.vertices)?;
    measures.set_item("faces", part.triangles)?;
    measures.set_item("boundary_edges", part.boundary_edges)?;
    measures.set_item("euler_characteristic", part.euler_characteristic)?;
    measures.set_item("genus", part.genus)?;
    measures.set_item("area", part.area)?;
    measures.set_item("volume", part.volume)?;
    measures.set_item("total_mean_curvature", part.total_mean_curvature)?;
    Ok(measures)
}

/// The connected component of each vertex, from 0 in the order of their first vertices.
#[pyfunction]
pub(crate) fn components<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let found = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        Surface::new(&mesh, &positions[..])?;
        Ok::<_, Fault>(mesh.components().0)
    })?;
    let signed = found?.into_iter().map(i64::from);
    Ok(PyArray1::from_vec(py, signed.collect()))
}

/// Merges vertices; the last array has the new vertex of each old one.
#[pyfunction]
pub(crate) fn weld<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    distance: f64,
) -> PyResult<(Arrays<'py>, Bound<'py, PyArray1<u32>>)> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let finite = |position: &[f64; 3]| position.iter().all(|coordinate| coordinate.is_finite());
    if let Some(vertex) = positions.iter().position(|position| !finite(position)) {
        return Err(Fault::of_vertex(
            vertex,
            format_args!(
                "V[{vertex}] is {:?}, not finite: leave the vertex and its faces out",
                positions[vertex]
            ),
        )
        .into());
    }
    let welded = on_threads(py, None, || io::weld(&positions, &triangles, distance))?;
    let Welded { file, vertices } = welded.map_err(Fault::from)?;
    let merged = arrays(py, file.positions, &file.mesh)?;
    Ok((merged, PyArray1::from_vec(py, vertices)))
}

/// The arrays of a repaired mesh, their vertices and faces before it, and the report: the actions with their names,
/// words and counts, and what is left.
type Mended<'py> = (
    Arrays<'py>,
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>),
    Vec<(&'static str, usize)>,
    (usize, usize, String),
);

/// Repairs triangles that need not form a mesh.
#[pyfunction]
#[pyo3(signature = (positions, faces, *, weld, sheets, fill, slivers, outward, drop_unused))]
#[expect(
    clippy::too_many_arguments,
    reason = "the arguments of the function in Python"
)]
pub(crate) fn repair<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    weld: Option<f64>,
    sheets: &str,
    fill: usize,
    slivers: f64,
    outward: bool,
    drop_unused: bool,
) -> PyResult<Mended<'py>> {
    let settings = RepairSettings {
        weld,
        sheets: sheets.parse().map_err(invalid)?,
        fill,
        slivers,
        outward,
        drop_unused,
    };
    let mut input = Input::new(positions, faces)?;
    let soup = Soup {
        triangles: input.take_faces(),
        positions: input.positions.double().into_owned(),
        short_faces: 0,
    };
    mended(py, soup, settings)
}

/// Repairs the triangles of a file.
#[pyfunction]
#[pyo3(signature = (path, *, weld, sheets, fill, slivers, outward, drop_unused))]
#[expect(
    clippy::too_many_arguments,
    reason = "the arguments of the function in Python"
)]
pub(crate) fn repair_file<'py>(
    py: Python<'py>,
    path: PathBuf,
    weld: Option<f64>,
    sheets: &str,
    fill: usize,
    slivers: f64,
    outward: bool,
    drop_unused: bool,
) -> PyResult<Mended<'py>> {
    let settings = RepairSettings {
        weld,
        sheets: sheets.parse().map_err(invalid)?,
        fill,
        slivers,
        outward,
        drop_unused,
    };
    let soup = on_threads(py, None, || io::read_soup(&path))?;
    let (soup, _) = soup.map_err(|error| unreadable(&error))?;
    mended(py, soup, settings)
}

fn mended(py: Python<'_>, soup: Soup, settings: RepairSettings) -> PyResult<Mended<'_>> {
    let repaired = on_threads(py, None, || mending::repair(soup, &settings))?;
    let repaired = repaired.map_err(|error| match error {
        RepairError::Mesh(error) => Fault::from(error),
        error => Fault::new(error),
    })?;
    let numbers = |origins: &[u32]| {
        let number = |&origin: &u32| match origin {
            NEW => -1,
            origin => i64::from(origin),
        };
        PyArray1::from_vec(py, origins.iter().map(number).collect())
    };
    let origins = (numbers(&repaired.vertex_of), numbers(&repaired.triangle_of));
    let report = repaired.report;
    let taken = report.taken().map(|(action, count)| (action.key(), count));
    let taken = Vec::from_iter(taken);
    let left = (report.holes_left, report.slivers_left, report.to_string());
    let file = repaired.file;
    let arrays = arrays(py, file.positions, &file.mesh)?;
    Ok((arrays, origins, taken, left))
}

/// The triangles (m, 3) into which polygons are divided: `corners` has those of all, one polygon after the other,
/// and `sizes` the number of corners of each.
#[pyfunction]
pub(crate) fn divided<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    corners: PyReadonlyArray1<'py, i64>,
    sizes: PyReadonlyArray1<'py, i64>,
) -> PyResult<Bound<'py, PyArray2<u32>>> {
    let positions = Positions::new(positions)?;
    let positions = positions.double();
    let mut rest = corners.as_slice().map_err(invalid)?;
    let mut triangles = Vec::new();
    for (cell, &size) in sizes.as_slice().map_err(invalid)?.iter().enumerate() {
        let (own, after) = rest
            .split_at_checked(usize::try_from(size).unwrap_or(usize::MAX))
            .ok_or_else(|| {
                Fault::of_face(cell, format_args!("polygon {cell} has {size} corners"))
            })?;
        rest = after;
        let mut places = Vec::with_capacity(own.len());
        for &corner in own {
            let place = usize::try_from(corner).ok();
            let place = place.and_then(|corner| positions.get(corner)).copied();
            places.push(place.ok_or_else(|| {
                Fault::of_face(
                    cell,
                    format_args!(
                        "polygon {cell} names vertex {corner}, but there are {} vertices, numbered from 0",
                        positions.len()
                    ),
                )
            })?);
        }
        let divided = polygon::triangulate(&places)
            .map_err(|error| Fault::of_face(cell, format_args!("polygon {cell}: {error}")))?;
        let numbered = divided.iter();
        triangles.extend(numbered.map(|three| three.map(|at| own[at as usize] as u32)));
    }
    matrix(py, triangles)
}

/// Refines a mesh by Loop's rules.
#[pyfunction]
pub(crate) fn subdivide<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    levels: u32,
    limit: bool,
) -> PyResult<Arrays<'py>> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let target = if limit {
        refinement::Target::Limit
    } else {
        refinement::Target::Controls
    };
    let fine = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        Surface::new(&mesh, &positions[..])?;
        let positions = positions.to_vec();
        refinement::subdivide(MeshFile::new(positions, mesh), levels, target).map_err(Fault::new)
    })?;
    let MeshFile {
        positions, mesh, ..
    } = fine?;
    arrays(py, positions, &mesh)
}
