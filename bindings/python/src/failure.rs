//! Errors of a mesh, as the exception `MeshError` with the place.

use helfrich::{MeshError, SurfaceError};
use helfrich_std::generate::GenerateError;
use helfrich_std::io::{Problem, ReadError, WriteError};
use helfrich_std::repair::is_repairable;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fmt;

/// The reason why arrays are no mesh.
#[derive(Debug, Default)]
pub(crate) struct Fault {
    message: String,
    face: Option<u64>,
    edge: Option<[u32; 2]>,
    vertex: Option<u64>,
}

impl Fault {
    /// A fault of a whole array.
    pub(crate) fn new(message: impl fmt::Display) -> Self {
        Self {
            message: message.to_string(),
            ..Self::default()
        }
    }

    /// A fault of a face.
    pub(crate) fn of_face(face: usize, message: impl fmt::Display) -> Self {
        Self {
            face: Some(face as u64),
            ..Self::new(message)
        }
    }

    /// A fault of a vertex.
    pub(crate) fn of_vertex(vertex: usize, message: impl fmt::Display) -> Self {
        Self {
            vertex: Some(vertex as u64),
            ..Self::new(message)
        }
    }

    /// The fault of an argument.
    pub(crate) fn of_argument(self, name: &str) -> Self {
        Self {
            message: format!("{name}: {}", self.message),
            ..self
        }
    }

    /// The message and the attributes.
    pub(crate) fn describe<'py>(&self, py: Python<'py>) -> PyResult<(&str, Bound<'py, PyDict>)> {
        let places = PyDict::new(py);
        places.set_item("face", self.face)?;
        places.set_item("edge", self.edge.map(|[from, to]| (from, to)))?;
        places.set_item("vertex", self.vertex)?;
        Ok((&self.message, places))
    }
}

impl From<MeshError> for Fault {
    fn from(error: MeshError) -> Self {
        let mut fault = if is_repairable(&error) {
            Self::new(format_args!("{error}: helfrich.repair(V, F) mends it"))
        } else {
            Self::new(error)
        };
        match error {
            MeshError::VertexOutOfRange {
                triangle, vertex, ..
            }
            | MeshError::RepeatedVertex { triangle, vertex } => {
                fault.face = Some(triangle.into());
                fault.vertex = Some(vertex.into());
            }
            MeshError::DuplicateTriangle { second, .. } => fault.face = Some(second.into()),
            MeshError::NonManifoldEdge { edge, triangle, .. } => {
                fault.face = Some(triangle.into());
                fault.edge = Some(edge);
            }
            MeshError::InconsistentOrientation { edge, triangles } => {
                fault.face = Some(triangles[1].into());
                fault.edge = Some(edge);
            }
            MeshError::NonManifoldVertex {
                vertex, triangles, ..
            } => {
                fault.face = Some(triangles[1].into());
                fault.vertex = Some(vertex.into());
            }
            _ => {}
        }
        fault
    }
}

impl From<SurfaceError> for Fault {
    fn from(error: SurfaceError) -> Self {
        let vertex = match error {
            SurfaceError::NotFinite { vertex, .. } | SurfaceError::TooLarge { vertex, .. } => {
                Some(vertex as u64)
            }
            _ => None,
        };
        let fault = match error {
            SurfaceError::NotFinite { .. } => Self::new(format_args!(
                "{error}: helfrich.repair(V, F) leaves its faces out"
            )),
            _ => Self::new(error),
        };
        Self { vertex, ..fault }
    }
}

impl From<GenerateError> for Fault {
    fn from(error: GenerateError) -> Self {
        Self::new(error)
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        Python::attach(|py| {
            let made = || {
                let class = py.import("helfrich._errors")?.getattr("MeshError")?;
                let (message, places) = fault.describe(py)?;
                class.call((message,), Some(&places))
            };
            made().map_or_else(|error| error, Self::from_value)
        })
    }
}

/// A value that is out of range.
pub(crate) fn invalid(error: impl fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The exception for a file that cannot be read: an `OSError`, or a `MeshError` if its content is wrong.
pub(crate) fn unreadable(error: &ReadError) -> PyErr {
    match error {
        ReadError::Missing { .. } => {
            pyo3::exceptions::PyFileNotFoundError::new_err(error.to_string())
        }
        ReadError::Directory { .. } => {
            pyo3::exceptions::PyIsADirectoryError::new_err(error.to_string())
        }
        ReadError::Unreadable { .. } => PyOSError::new_err(error.to_string()),
        ReadError::Parse {
            path,
            error: parsed,
        } => {
            let place = match parsed.problem {
                Problem::Mesh { error } => Fault::from(error),
                _ => Fault::default(),
            };
            let path = path.display();
            let message = if parsed.is_repairable() {
                format!("{path}: {parsed}: helfrich.repair(path) mends it")
            } else {
                error.to_string()
            };
            Fault { message, ..place }.into()
        }
        _ => invalid(error),
    }
}

/// The exception for a file that cannot be written.
pub(crate) fn unwritable(error: &WriteError) -> PyErr {
    match error {
        WriteError::Unwritable { .. } => PyOSError::new_err(error.to_string()),
        _ => invalid(error),
    }
}
