//! Smoother positions.

use crate::arrays::{Input, matrix};
use crate::failure::{Fault, invalid};
use crate::work::on_threads;
use helfrich::{Smoothing, Surface, TriangleMesh};
use helfrich_std::noise::NotQuieted;
use helfrich_std::smoothing::{Smoother, smooth as smoothed};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Smoother positions and what was done, by name; and, if noise was not removed, the reason.
#[pyfunction]
#[pyo3(signature = (positions, faces, *, scale, flow, threads))]
pub(crate) fn smooth<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    scale: Option<usize>,
    flow: Option<f64>,
    threads: Option<usize>,
) -> PyResult<(Bound<'py, PyDict>, Option<String>)> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let smoother = match (scale, flow) {
        (Some(neighbours), _) => Smoother::Scale(Smoothing::of_neighbours(neighbours)),
        (_, Some(time)) => Smoother::Flow(time),
        _ => Smoother::Noise,
    };
    let found = on_threads(py, threads, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        let surface = Surface::new(&mesh, &positions[..])?;
        Ok::<_, Fault>(smoothed(surface, smoother, &mut |_| true))
    })??;
    let found = found.map_err(invalid)?;
    let reason = match &found.unmoved {
        None | Some(NotQuieted::NoNoise) => None,
        Some(reason) => Some(reason.to_string()),
    };
    let result = PyDict::new(py);
    result.set_item("vertices", matrix(py, found.positions)?)?;
    result.set_item("noise", found.noise.length)?;
    result.set_item("noise_in_edges", found.noise.edges)?;
    result.set_item("degree", found.fits.map_or(0, |fits| fits.degree))?;
    result.set_item("scale", found.fits.map_or(0, |fits| fits.neighbours))?;
    let [mean, largest] = found.displacements;
    result.set_item("displacement", mean)?;
    result.set_item("largest_displacement", largest)?;
    result.set_item("area", <(f64, f64)>::from(found.areas))?;
    result.set_item("volume", found.volumes.map(<(f64, f64)>::from))?;
    Ok((result, reason))
}
