//! The smooth surface through the vertices of a mesh.

use crate::arrays::{Arrays, Input, Positions, arrays, matrix};
use crate::failure::{Fault, invalid};
use crate::work::on_threads;
use helfrich::{
    Jet, MeshPoint, SmoothPoint, SmoothSurface as Smooth, Surface, TriangleMesh, VertexKind,
};
use helfrich_std::execute::Parallel;
use helfrich_std::remesh::{EdgeLengths, MeshRequest, OfNoise, RemeshError, carried, remeshed};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The surface, with its fits.
#[pyclass(frozen, module = "helfrich._helfrich")]
pub(crate) struct SmoothSurface(Smooth<f64>);

#[pymethods]
impl SmoothSurface {
    #[new]
    fn new(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        method: &str,
    ) -> PyResult<Self> {
        let mut input = Input::new(positions, faces)?;
        let triangles = input.take_faces();
        let positions = input.positions.double();
        let made = on_threads(py, None, || {
            let mesh = TriangleMesh::new(positions.len(), triangles)?;
            let surface = Surface::new(&mesh, &positions[..])?;
            let jet = match method {
                "j4" => Jet::j4(),
                "j6" => Jet::j6(),
                "j8" => Jet::j8(),
                _ => Smooth::jet_for(&mesh),
            };
            Ok::<_, Fault>(Smooth::new(&Parallel::new(), surface, &jet))
        })?;
        Ok(Self(made?))
    }

    /// The points over places of the mesh: columns by name. Where nothing is known, curvatures are 0 and error bars
    /// infinite.
    fn at<'py>(
        &self,
        py: Python<'py>,
        faces: Vec<usize>,
        weights: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let places = self.places(faces, weights)?;
        let points = on_threads(py, None, || self.0.all_at(&Parallel::new(), &places))?;
        columns(py, &points)
    }

    /// The values of a field at places of the mesh, and their error bars.
    fn interpolate<'py>(
        &self,
        py: Python<'py>,
        field: Vec<f64>,
        faces: Vec<usize>,
        weights: &Bound<'py, PyAny>,
    ) -> PyResult<Bars<'py>> {
        let places = self.places(faces, weights)?;
        let count = self.0.surface().positions().len();
        if field.len() != count {
            return Err(invalid(format_args!(
                "field has {} numbers, but {count} are needed, one for each vertex",
                field.len()
            )));
        }
        let points = on_threads(py, None, || {
            let fitted = self.0.fields(&Parallel::new(), &[&field]);
            fitted.all_at(&Parallel::new(), 0, &places)
        })?;
        let values = points.iter().map(|point| point.value);
        let errors = points.iter().map(|point| point.error);
        Ok((
            PyArray1::from_vec(py, values.collect()),
            PyArray1::from_vec(py, errors.collect()),
        ))
    }

    /// The faces and weights of the places that are nearest to points.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyArray1<u32>>, Bound<'py, PyAny>)> {
        let points = Positions::named(points, "points")?;
        let points = points.double();
        if let Some(row) = points.iter().position(|x| !x.iter().all(|x| x.is_finite())) {
            let at = points[row];
            return Err(invalid(format_args!(
                "row {row} of points is {at:?}: finite numbers are needed"
            )));
        }
        let places = on_threads(py, None, || self.0.project_all(&Parallel::new(), &points))?;
        let places = places.into_iter().collect::<Option<Vec<_>>>();
        let places = places.ok_or_else(|| invalid("a mesh without faces has no points"))?;
        let faces = places.iter().map(|place| place.triangle as u32);
        let faces = PyArray1::from_vec(py, faces.collect());
        let weights = places.iter().map(|place| place.barycentric);
        Ok((faces, matrix(py, weights.collect())?.into_any()))
    }
}

impl SmoothSurface {
    /// Places of the mesh, which are checked.
    fn places(
        &self,
        faces: Vec<usize>,
        weights: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<MeshPoint<f64>>> {
        let weights = Positions::named(weights, "weights")?;
        let weights = weights.double();
        if weights.len() != faces.len() {
            let (rows, count) = (weights.len(), faces.len());
            return Err(invalid(format_args!(
                "weights has {rows} rows, but {count} are needed, one for each of faces"
            )));
        }
        let count = self.0.surface().mesh().triangles().len();
        if let Some(face) = faces.iter().find(|&&face| face >= count) {
            return Err(invalid(format_args!(
                "faces names face {face}, but there are {count}, numbered from 0"
            )));
        }
        let off = |weights: &[f64; 3]| {
            // Also for NaN.
            let is_inside = weights.iter().all(|weight| *weight >= 0.0);
            !is_inside || (weights.iter().sum::<f64>() - 1.0).abs() > 1e-6
        };
        if let Some(row) = weights.iter().position(off) {
            return Err(invalid(format_args!(
                "row {row} of weights is {:?}: weights of corners are at least 0, with the sum 1",
                weights[row]
            )));
        }
        let places = faces.iter().zip(weights.iter());
        let places = places.map(|(&triangle, &barycentric)| MeshPoint {
            triangle,
            barycentric,
        });
        Ok(places.collect())
    }
}

/// Values, and their error bars.
type Bars<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Edge lengths of a new mesh.
#[derive(FromPyObject)]
pub(crate) enum Lengths {
    /// One for all, or `None`.
    Uniform(Option<f64>),
    /// One for each vertex.
    AtVertices(Vec<f64>),
}

/// The new mesh; the faces and weights of its vertices on the old one, the error bars of their positions, and fields.
type New<'py> = (
    Arrays<'py>,
    (Bound<'py, PyArray1<u32>>, Bound<'py, PyAny>),
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyDict>,
);

/// A new mesh of the smooth surface through the vertices.
#[pyfunction]
#[pyo3(signature = (positions, faces, *, vertices, edge, curvature, error, creases, smooth, fields))]
#[expect(
    clippy::too_many_arguments,
    reason = "the arguments of the function of Python"
)]
pub(crate) fn remesh<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    vertices: Option<usize>,
    edge: Lengths,
    curvature: Option<f64>,
    error: Option<f64>,
    creases: f64,
    smooth: bool,
    fields: Vec<(String, Vec<f64>)>,
) -> PyResult<New<'py>> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let count = positions.len();
    let is_same = matches!(edge, Lengths::Uniform(None))
        && [curvature, error] == [None; 2]
        && vertices.is_none();
    let lengths = match (edge, curvature, error) {
        (_, Some(angle), _) => EdgeLengths::ByCurvature(angle.to_radians()),
        (_, _, Some(part)) => EdgeLengths::ByError(part),
        (Lengths::AtVertices(lengths), ..) => EdgeLengths::AtVertices(lengths),
        (Lengths::Uniform(length), ..) => EdgeLengths::Uniform(length.unwrap_or(1.0)),
    };
    let of_fields = fields
        .iter()
        .map(|(name, values)| (name.as_str(), values.len()));
    let of_lengths = match &lengths {
        EdgeLengths::AtVertices(lengths) => Some(("edge", lengths.len())),
        _ => None,
    };
    for (name, found) in of_fields.chain(of_lengths) {
        if found != count {
            return Err(invalid(format_args!(
                "{name} has {found} numbers, but {count} are needed, one for each vertex"
            )));
        }
    }
    let mut request = MeshRequest {
        lengths,
        vertices,
        creases: creases.to_radians(),
        noise: OfNoise::removed_if(smooth),
    };
    let made = on_threads(py, None, || {
        let mesh = TriangleMesh::new(count, triangles)?;
        let surface = Surface::new(&mesh, &positions[..])?;
        if is_same {
            let kinds = mesh.vertex_kinds().iter();
            let used = kinds.filter(|kind| **kind != VertexKind::Isolated);
            request.vertices = Some(used.count());
        }
        let made = remeshed(surface, &request, &mut |_| true);
        Ok::<_, Fault>(made.map(|made| {
            let fields = Vec::from_iter(fields.iter().map(|(_, values)| &values[..]));
            let carried = carried(&made.smooth, &made.made.places, &fields);
            (made.made, carried)
        }))
    })??;
    let (made, carried) = made.map_err(|error| match error {
        RemeshError::Noise(_) => invalid(format_args!("{error}: smooth=True removes it first")),
        _ => invalid(error),
    })?;
    let found = PyDict::new(py);
    for ((name, _), values) in fields.iter().zip(carried) {
        found.set_item(name, PyArray1::from_vec(py, values))?;
    }
    let new = made.points.iter().map(|point| point.position);
    let faces = made.places.iter().map(|place| place.triangle as u32);
    let weights = made.places.iter().map(|place| place.barycentric);
    let errors = made.points.iter().map(|point| point.position_error);
    Ok((
        arrays(py, new.collect(), &made.mesh)?,
        (
            PyArray1::from_vec(py, faces.collect()),
            matrix(py, weights.collect())?.into_any(),
        ),
        PyArray1::from_vec(py, errors.collect()),
        found,
    ))
}

fn columns<'py>(py: Python<'py>, points: &[SmoothPoint<f64>]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    type Vector = fn(&SmoothPoint<f64>) -> [f64; 3];
    let vectors: [(&str, Vector); 3] = [
        ("position", |point| point.position),
        ("normal", |point| point.normal),
        ("d1", |point| point.direction),
    ];
    for (name, of) in vectors {
        columns.set_item(name, matrix(py, points.iter().map(of).collect())?)?;
    }
    type Number = fn(&SmoothPoint<f64>) -> f64;
    let numbers: [(&str, Number); 7] = [
        ("H", |point| point.mean),
        ("K", |point| point.gaussian),
        ("k1", |point| point.principal()[0]),
        ("k2", |point| point.principal()[1]),
        ("position_error", |point| point.position_error),
        ("H_error", |point| point.curvature_errors[0]),
        ("K_error", |point| point.curvature_errors[1]),
    ];
    for (name, of) in numbers {
        let known = |x: f64| if x.is_nan() { 0.0 } else { x };
        let values = points.iter().map(|point| known(of(point)));
        columns.set_item(name, PyArray1::from_vec(py, values.collect()))?;
    }
    Ok(columns)
}
