//! Arrays of positions and faces: read in place where they can be, otherwise as Python makes them ready.

use crate::failure::{Fault, invalid};
use helfrich::TriangleMesh;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::borrow::Cow;
use std::fmt;

/// Positions, read in place.
pub(crate) enum Positions<'py> {
    /// In single precision.
    Single(PyReadonlyArray2<'py, f32>),
    /// In double precision.
    Double(PyReadonlyArray2<'py, f64>),
}

/// An array of triples in one piece of memory, if the object is one.
fn triples<'py, T: Element>(
    object: &Bound<'py, PyAny>,
) -> PyResult<Option<PyReadonlyArray2<'py, T>>> {
    // Arrays of classes of others, such as those with masks, are made ready first.
    let is_plain = object
        .get_type()
        .is(PyUntypedArray::type_object(object.py()));
    let Ok(array) = object.cast::<PyArray2<T>>() else {
        return Ok(None);
    };
    if !is_plain {
        return Ok(None);
    }
    if !array.is_c_contiguous() || !array.is_aligned() || array.shape()[1] != 3 {
        return Ok(None);
    }
    array.try_readonly().map(Some).map_err(invalid)
}

/// The rows of an array of triples.
pub(crate) fn rows<'a, T: Element>(array: &'a PyReadonlyArray2<'_, T>) -> &'a [[T; 3]] {
    array.as_slice().map_or(&[], |flat| flat.as_chunks().0)
}

/// Calls a function of the package that checks an argument that is no array, and returns it.
pub(crate) fn checked<'py>(
    function: &str,
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let module = object.py().import("helfrich._checks")?;
    module.getattr(function)?.call1((object, name))
}

/// Calls a function of the package's module that makes arrays ready.
pub(crate) fn made_ready<'py>(
    function: &str,
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let module = object.py().import("helfrich._arrays")?;
    module.getattr(function)?.call1((object, name))
}

impl<'py> Positions<'py> {
    /// Positions of an object; `name` is its name in messages.
    pub(crate) fn named(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        if let Some(found) = Self::found(object)? {
            return Ok(found);
        }
        let ready = made_ready("positions", object, name)?;
        let found = Self::found(&ready)?;
        found.ok_or_else(|| PyTypeError::new_err(format!("{name} cannot be read")))
    }

    /// The array V.
    pub(crate) fn new(object: &Bound<'py, PyAny>) -> PyResult<Self> {
        Self::named(object, "V")
    }

    fn found(object: &Bound<'py, PyAny>) -> PyResult<Option<Self>> {
        if let Some(array) = triples(object)? {
            return Ok(Some(Self::Double(array)));
        }
        Ok(triples(object)?.map(Self::Single))
    }

    /// Number of positions.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Single(array) => array.shape()[0],
            Self::Double(array) => array.shape()[0],
        }
    }

    /// The positions in double precision; a copy where they are in single precision.
    pub(crate) fn double(&self) -> Cow<'_, [[f64; 3]]> {
        match self {
            Self::Single(array) => {
                Cow::Owned(rows(array).iter().map(|x| x.map(f64::from)).collect())
            }
            Self::Double(array) => Cow::Borrowed(rows(array)),
        }
    }

    /// Whether they are in single precision.
    pub(crate) fn is_single(&self) -> bool {
        matches!(self, Self::Single(_))
    }
}

/// The faces of an array of any integer type, if the object is one in one piece of memory.
fn of_integers<T>(object: &Bound<'_, PyAny>) -> PyResult<Option<Vec<[u32; 3]>>>
where
    T: Element + Copy + TryInto<u32> + fmt::Display,
{
    let Some(array) = triples::<T>(object)? else {
        return Ok(None);
    };
    let corner = |face: usize, corner: T| {
        corner.try_into().map_err(|_| {
            Fault::of_face(
                face,
                format_args!(
                    "face {face} of F names vertex {corner}: vertices are numbered from 0, and at most {} are possible",
                    TriangleMesh::LIMIT
                ),
            )
        })
    };
    let mut faces = Vec::with_capacity(rows(&array).len());
    for (face, &[a, b, c]) in rows(&array).iter().enumerate() {
        faces.push([corner(face, a)?, corner(face, b)?, corner(face, c)?]);
    }
    Ok(Some(faces))
}

fn found_faces(object: &Bound<'_, PyAny>) -> PyResult<Option<Vec<[u32; 3]>>> {
    type Reader = fn(&Bound<'_, PyAny>) -> PyResult<Option<Vec<[u32; 3]>>>;
    const READERS: [Reader; 8] = [
        of_integers::<i64>,
        of_integers::<i32>,
        of_integers::<u32>,
        of_integers::<u64>,
        of_integers::<i16>,
        of_integers::<u16>,
        of_integers::<i8>,
        of_integers::<u8>,
    ];
    for reader in READERS {
        if let Some(faces) = reader(object)? {
            return Ok(Some(faces));
        }
    }
    Ok(None)
}

/// The faces of an object.
pub(crate) fn faces(object: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    if let Some(faces) = found_faces(object)? {
        return Ok(faces);
    }
    let ready = made_ready("faces", object, "F")?;
    found_faces(&ready)?.ok_or_else(|| PyTypeError::new_err("F cannot be read"))
}

/// The address of the numbers of V as the module reads them: that of V where nothing is copied.
#[pyfunction]
pub(crate) fn address(positions: &Bound<'_, PyAny>) -> PyResult<usize> {
    Ok(match Positions::new(positions)? {
        Positions::Single(array) => rows(&array).as_ptr() as usize,
        Positions::Double(array) => rows(&array).as_ptr() as usize,
    })
}

/// A mesh of arrays.
pub(crate) struct Input<'py> {
    pub(crate) positions: Positions<'py>,
    faces: Vec<[u32; 3]>,
}

impl<'py> Input<'py> {
    /// The mesh of V and F.
    pub(crate) fn new(
        positions: &Bound<'py, PyAny>,
        triangles: &Bound<'py, PyAny>,
    ) -> PyResult<Self> {
        Ok(Self {
            positions: Positions::new(positions)?,
            faces: faces(triangles)?,
        })
    }

    /// Takes the faces.
    pub(crate) fn take_faces(&mut self) -> Vec<[u32; 3]> {
        std::mem::take(&mut self.faces)
    }
}

/// Numbers for each vertex or triangle, or one for all.
pub(crate) enum Numbers<'py> {
    /// One for all.
    Same(f64),
    /// One for each.
    Each(PyReadonlyArray1<'py, f64>),
}

impl<'py> Numbers<'py> {
    /// The numbers of an object, which is called `name` in messages.
    pub(crate) fn named(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let dimensions = object
            .cast::<PyUntypedArray>()
            .map_or(0, |array| array.ndim());
        if dimensions == 0
            && let Ok(same) = object.extract::<f64>()
        {
            return Ok(Self::Same(same));
        }
        let ready = made_ready("numbers", object, name)?;
        let array = ready.cast::<PyArray1<f64>>()?;
        array.try_readonly().map(Self::Each).map_err(invalid)
    }

    /// The numbers, if there is one for each of `count` vertices.
    pub(crate) fn each(&self, count: usize, name: &str) -> PyResult<Option<&[f64]>> {
        let Self::Each(array) = self else {
            return Ok(None);
        };
        let values = array.as_slice().map_err(invalid)?;
        if values.len() != count {
            return Err(Fault::new(format_args!(
                "{name} has {} numbers, but {count} are needed, or one for all",
                values.len()
            ))
            .into());
        }
        Ok(Some(values))
    }
}

/// An array of triples, without a copy.
pub(crate) fn matrix<T: Element>(
    py: Python<'_>,
    values: Vec<[T; 3]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let shape = [values.len(), 3];
    PyArray1::from_vec(py, values.into_flattened()).reshape(shape)
}

/// The arrays V and F of a mesh.
pub(crate) type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// Positions and triangles as arrays.
pub(crate) fn arrays<'py>(
    py: Python<'py>,
    positions: Vec<[f64; 3]>,
    mesh: &TriangleMesh,
) -> PyResult<Arrays<'py>> {
    let triangles = mesh.triangles().to_vec();
    Ok((matrix(py, positions)?, matrix(py, triangles)?))
}
