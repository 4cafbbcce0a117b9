//! Pictures of surfaces.

use crate::arrays::{Input, rows};
use crate::failure::{Fault, invalid};
use crate::work::on_threads;
use helfrich::{Surface, TriangleMesh};
use helfrich_std::painting::Painting;
use helfrich_std::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Draws a surface in the colours of values at its vertices: red, green and blue (height, width, 3), and a PNG file
/// if a path is given.
#[pyfunction]
#[pyo3(signature = (positions, faces, *, values, error, directions, limits, diverging, label, title, edges, view, up, unit, size, path))]
#[expect(
    clippy::too_many_arguments,
    reason = "the arguments of the function in Python"
)]
pub(crate) fn picture<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    values: Option<PyReadonlyArray1<'py, f64>>,
    error: Option<PyReadonlyArray1<'py, f64>>,
    directions: Option<(PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>)>,
    limits: Option<[f64; 2]>,
    diverging: Option<bool>,
    label: String,
    title: String,
    edges: bool,
    view: [f64; 3],
    up: [f64; 3],
    unit: Option<String>,
    size: [u32; 2],
    path: Option<PathBuf>,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let mut input = Input::new(positions, faces)?;
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let painting = match &values {
        None => None,
        Some(values) => {
            let errors = error.as_ref().map(|error| error.as_slice()).transpose()?;
            let painting = Painting::new(values.as_slice()?.to_vec(), errors.unwrap_or(&[]));
            Some(painting.ok_or_else(|| invalid("values has no finite number: leave it out"))?)
        }
    };
    let strokes = directions.as_ref().map(|(first, second)| {
        let known = |vector: &[f64; 3]| vector.iter().any(|&component| component != 0.0);
        let pairs = rows(first).iter().zip(rows(second));
        let pair = |(&first, &second)| (known(&first) && known(&second)).then_some([first, second]);
        Vec::from_iter(pairs.map(pair))
    });
    let canvas = on_threads(py, None, || {
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        let colours = painting.as_ref().map(|painting| painting.colouring(&label));
        let colours = colours.unwrap_or_default();
        let picture = Picture {
            size,
            title: &title,
            surfaces: &[PaintedSurface {
                surface: Surface::new(&mesh, &positions[..])?,
                field: painting.as_ref().map(|painting| &painting.values[..]),
                shading: Shading::Smooth,
                edges,
                strokes: strokes.as_deref(),
            }],
            colours: Colouring {
                range: limits.or(colours.range),
                map: match diverging {
                    None => colours.map,
                    Some(true) => ColourMap::Diverging,
                    Some(false) => ColourMap::Sequential,
                },
                ..colours
            },
            view: View {
                direction: view,
                up,
                frame: None,
            },
            length_unit: unit.as_deref(),
        };
        Ok::<_, Fault>(picture.draw())
    })??;
    let canvas = canvas.map_err(invalid)?;
    if let Some(path) = path {
        let written = canvas.write_png(&path);
        written.map_err(|error| PyOSError::new_err(format!("{}: {error}", path.display())))?;
    }
    let [width, height] = canvas.size();
    PyArray1::from_vec(py, canvas.rgb()).reshape([height, width, 3])
}
