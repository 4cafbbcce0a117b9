//! Runs of scenes.

use crate::arrays::{Arrays, arrays, matrix};
use crate::failure::invalid;
use crate::work::{Watch, in_steps};
use helfrich::TriangleMesh;
use helfrich_std::run::{Progress, RunError, Summary};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::{Body, build};
use numpy::PyArray1;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::ops::Range;
use std::path::PathBuf;

/// A surface of a scene: its name, its mesh, and its vertices among those of all surfaces.
struct Part {
    name: String,
    mesh: TriangleMesh,
    vertices: Range<usize>,
}

fn parts(bodies: &[Body]) -> Vec<Part> {
    let part = bodies.iter().map(|body| Part {
        name: body.name().to_owned(),
        mesh: body.mesh().clone(),
        vertices: body.vertices(),
    });
    part.collect()
}

/// Calls the user's function with the progress and the positions of each surface.
fn told(callback: &Py<PyAny>, parts: &[Part], progress: &Progress<'_>) -> PyResult<bool> {
    Python::attach(|py| {
        let surfaces = PyDict::new(py);
        for part in parts {
            let positions = progress.positions[part.vertices.clone()].to_vec();
            surfaces.set_item(&part.name, matrix(py, positions)?)?;
        }
        let arguments = (progress.fraction, progress.message, surfaces);
        let goes_on = callback.bind(py).call1(arguments)?;
        Ok(goes_on.is_none() || goes_on.is_truthy()?)
    })
}

/// The summary of a run as JSON, its series, and the surfaces where it ended.
#[pyfunction]
#[pyo3(signature = (scene, text, settings, folder, resume, callback, threads))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn run<'py>(
    py: Python<'py>,
    scene: PathBuf,
    text: Option<String>,
    settings: Vec<String>,
    folder: PathBuf,
    resume: bool,
    callback: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> PyResult<(String, Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let overrides = Overrides::new(settings).map_err(invalid)?;
    let watch = Watch::default();
    let (outcome, watch) = in_steps(py, threads, || {
        let outcome = ran(
            &scene,
            text.as_deref(),
            &overrides,
            &folder,
            resume,
            |parts, progress| match callback
                .as_ref()
                .map(|callback| told(callback, parts, progress))
            {
                None => watch.ends(),
                Some(Ok(goes_on)) => !goes_on || watch.ends(),
                Some(Err(error)) => {
                    watch.fail(error);
                    true
                }
            },
        );
        (outcome, watch)
    })?;
    if let Some(error) = watch.into_error() {
        return Err(error);
    }
    let (summary, parts, positions) = outcome?;
    let table = SeriesTable::read(&folder.join("series.csv")).map_err(invalid)?;
    let series = PyDict::new(py);
    for (place, column) in table.columns.iter().enumerate() {
        let values = table.rows.iter().map(|row| row[place]);
        series.set_item(column, PyArray1::from_vec(py, values.collect()))?;
    }
    let surfaces = PyDict::new(py);
    for Part {
        name,
        mesh,
        vertices,
    } in &parts
    {
        let ended: Arrays<'_> = arrays(py, positions[vertices.clone()].to_vec(), mesh)?;
        surfaces.set_item(PyString::new(py, name), ended)?;
    }
    let summary = serde_json::to_string(&summary).map_err(invalid)?;
    Ok((summary, series, surfaces))
}

/// Reads and runs a scene. `watch` is called after each step, and returns whether the run has to end.
fn ran(
    path: &std::path::Path,
    text: Option<&str>,
    overrides: &Overrides,
    folder: &std::path::Path,
    resume: bool,
    mut watch: impl FnMut(&[Part], &Progress<'_>) -> bool,
) -> PyResult<(Summary, Vec<Part>, Vec<[f64; 3]>)> {
    let file = match text {
        Some(text) => SceneFile::parse(text, path, overrides),
        None => SceneFile::read(path, overrides),
    };
    let file = file.map_err(invalid)?;
    let (simulation, positions) = build(&file).map_err(invalid)?;
    let mut surfaces = parts(simulation.bodies());
    let mut last = positions.clone();
    let ends = std::cell::Cell::new(false);
    let summary = helfrich_std::run::run(
        &file.scene,
        (simulation, positions),
        folder,
        resume,
        &|| ends.get(),
        &mut |progress| {
            last.clear();
            last.extend_from_slice(progress.positions);
            let meshes = progress.bodies.iter().map(Body::mesh);
            if meshes.ne(surfaces.iter().map(|part| &part.mesh)) {
                surfaces = parts(progress.bodies);
            }
            if !ends.get() {
                ends.set(watch(&surfaces, progress));
            }
        },
    );
    let summary = summary.map_err(|error: RunError| {
        if error.is_output() {
            PyOSError::new_err(error.to_string())
        } else {
            invalid(error)
        }
    })?;
    Ok((summary, surfaces, last))
}
