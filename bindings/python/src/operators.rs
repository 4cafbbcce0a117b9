//! Operators as sparse matrices.

use crate::arrays::{Input, matrix};
use crate::curvature::Chosen;
use crate::failure::{Fault, invalid};
use crate::work::on_threads;
use helfrich::{Cotangent, DualArea, SparseMatrix, Surface, TriangleMesh};
use helfrich_std::execute::Parallel;
use helfrich_std::method::{MethodOptions, OperatorMatrix};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

/// Values, columns and row offsets of a matrix.
type Parts<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
);

fn parts(py: Python<'_>, matrix: SparseMatrix<f64>) -> Parts<'_> {
    let (offsets, columns, values) = matrix.into_parts();
    let signed = |numbers: Vec<usize>| Vec::from_iter(numbers.iter().map(|&n| n as i64));
    (
        PyArray1::from_vec(py, values),
        PyArray1::from_vec(py, signed(columns)),
        PyArray1::from_vec(py, signed(offsets)),
    )
}

/// A matrix, and the areas of vertices or the consistent mass matrix.
type Operator<'py> = (
    Parts<'py>,
    Option<Bound<'py, PyArray1<f64>>>,
    Option<Parts<'py>>,
);

/// The stiffness matrix of linear finite elements, with the areas of vertices, or the consistent mass
/// matrix.
#[pyfunction]
pub(crate) fn stiffness<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    areas: &str,
) -> PyResult<Operator<'py>> {
    let is_consistent = areas == "consistent";
    let areas = match areas {
        "consistent" => DualArea::Mixed,
        areas => MethodOptions::parse_areas(areas).map_err(invalid)?,
    };
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let found = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        let surface = Surface::new(&mesh, &positions[..])?;
        let cotangent = Cotangent::new(areas);
        let stiffness = cotangent.stiffness(surface);
        let mass = is_consistent.then(|| cotangent.mass(surface));
        let mut areas = vec![0.0; positions.len()];
        cotangent.dual_areas(&Parallel::new(), surface, &mut areas);
        Ok::<_, Fault>((stiffness, mass, areas))
    })?;
    let (stiffness, mass, areas) = found?;
    let areas = mass.is_none().then(|| PyArray1::from_vec(py, areas));
    let mass = mass.map(|mass| parts(py, mass));
    Ok((parts(py, stiffness), areas, mass))
}

/// The operator Δ_S of a method, and the areas of vertices.
#[pyfunction]
pub(crate) fn laplacian<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    method: &str,
) -> PyResult<Operator<'py>> {
    let Chosen { method, options } = Chosen::named(method, None, None)?;
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let found = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles).map_err(Fault::from)?;
        let surface = Surface::new(&mesh, &positions[..]).map_err(Fault::from)?;
        method.operator(&options, surface).map_err(invalid)
    })?;
    let OperatorMatrix { matrix, areas } = found?;
    let areas = PyArray1::from_vec(py, areas);
    Ok((parts(py, matrix), Some(areas), None))
}

/// The gradients of the fields that are 1 at one corner of a triangle, (3 m, 3): the columns of row 3 t + k
/// are the corners of triangle t, in its order.
#[pyfunction]
pub(crate) fn gradient<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let found = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        let surface = Surface::new(&mesh, &positions[..])?;
        let cotangent = Cotangent::default();
        let all = 0..mesh.triangles().len();
        let rows = all.flat_map(|triangle| {
            let corners = cotangent.corner_gradients(surface, triangle);
            [0, 1, 2].map(|axis| corners.map(|gradient| gradient[axis]))
        });
        Ok::<_, Fault>(Vec::from_iter(rows))
    })?;
    matrix(py, found?)
}
