//! A membrane: a mesh with the effects on it, for repeated evaluation.

use crate::arrays::{Positions, checked, faces, matrix, rows};
use crate::effects::{Ground, bending_method, part};
use crate::failure::{Fault, invalid};
use crate::work::{on_threads, prepared_for};
use helfrich::{ConstraintError, Constraints, Method, Prepared, Quality, Surface, TriangleMesh};
use helfrich_std::effect::{Effect, MembranePart};
use helfrich_std::held::Geometry;
use helfrich_std::method::BendingMethod;
use helfrich_std::ordered::Ordered;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayMethods, PyReadwriteArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A mesh with the effects on it, for repeated evaluation of their energy and force.
///
/// The triangles F (m, 3), of any integer type or a mesh of another library, are checked once, and so are the
/// effects, values of `helfrich.effects`. Memory is kept from one evaluation to the next. Several threads may
/// use one membrane; they take turns.
///
/// Parameters
/// ----------
/// F : (m, 3) integers
///     Triangles, counter-clockwise seen from outside.
/// *effects
///     Values of `helfrich.effects`.
/// vertices : int, optional
///     Number of vertices, by default the largest in F and one. It is needed where most vertices are in no
///     triangle.
/// threads : int, optional
///     Number of threads, all by default. Results do not depend on it.
///
/// Raises
/// ------
/// MeshError
///     If F is no oriented manifold, or an effect does not fit it.
/// ValueError
///     If a parameter is out of range.
/// TypeError
///     If an effect is none.
///
/// Examples
/// --------
/// >>> import helfrich, numpy
/// >>> from helfrich.effects import Bending, Skalak
/// >>> V, F, _ = helfrich.shape("discocyte", 642)
/// >>> cell = helfrich.Membrane(F, Bending(kappa=0.2), Skalak(5.3, 10.0, reference=V))
/// >>> out = numpy.empty_like(V)
/// >>> cell.force(V, out=out) is out
/// True
/// >>> bool(abs(out.sum(axis=0)).max() < 1e-12)
/// True
#[pyclass(subclass, frozen, module = "helfrich")]
pub(crate) struct Membrane {
    mesh: TriangleMesh,
    /// What it was made of, for copies.
    made_of: MadeOf,
    /// Methods whose energies leave out a part of the surface at its boundary, until somebody was told.
    untold: Mutex<Vec<BendingMethod>>,
    /// Locked without the interpreter's lock only.
    acting: Mutex<Acting>,
}

/// Effects as they were described, and the number of threads.
struct MadeOf {
    effects: Py<PyTuple>,
    threads: Option<usize>,
}

/// Effects prepared for the mesh, in an order that is kind to caches.
struct Acting {
    ordered: Option<Ordered<f64>>,
    effects: Vec<Effect>,
    /// Quantities that are held exactly.
    held: Option<Prepared<f64, Constraints<f64>>>,
    /// Forces in double precision, for arrays in single precision.
    force: Vec<[f64; 3]>,
}

impl Acting {
    /// Sets `force` to the sum of all forces, and returns the sum of all energies.
    fn evaluate(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        let Self {
            ordered,
            effects,
            held,
            ..
        } = self;
        let mut add = |surface: Surface<'_, f64>, force: &mut [[f64; 3]]| {
            force.fill([0.0; 3]);
            let effects = effects.iter_mut();
            let energy = effects.map(|effect| effect.add_force(surface, force)).sum();
            if let Some(held) = held {
                held.with(|held, execution, workspace| {
                    held.project(execution, surface, workspace, force);
                });
            }
            energy
        };
        match ordered {
            None => add(surface, force),
            Some(ordered) => {
                let (surface, own) = ordered.parts(surface);
                let energy = add(surface, own);
                force.fill([0.0; 3]);
                ordered.add_forces_to(force);
                energy
            }
        }
    }

    /// Moves positions onto the exact constraints.
    fn restore(
        &mut self,
        mesh: &TriangleMesh,
        positions: &mut [[f64; 3]],
    ) -> Result<(), ConstraintError> {
        let Some(held) = &mut self.held else {
            return Ok(());
        };
        let mut correct = |mesh: &TriangleMesh, positions: &mut [[f64; 3]]| {
            held.with(|held, execution, workspace| {
                held.correct(execution, mesh, positions, workspace)
            })
        };
        match &mut self.ordered {
            None => correct(mesh, positions)?,
            Some(ordered) => {
                let own = Arc::clone(ordered.mesh());
                ordered.change(positions, |positions| correct(&own, positions))?
            }
        };
        Ok(())
    }

    fn energy(&mut self, surface: Surface<'_, f64>) -> f64 {
        let surface = match &mut self.ordered {
            None => surface,
            Some(ordered) => ordered.parts(surface).0,
        };
        self.effects
            .iter_mut()
            .map(|effect| effect.energy(surface))
            .sum()
    }

    /// The kinds of findings that concern each vertex, of the last evaluation.
    fn flags(&self, surface: Surface<'_, f64>) -> Vec<u32> {
        let gathered = Quality::gather(surface.mesh(), |report| {
            for effect in &self.effects {
                match &self.ordered {
                    None => effect.inspect(surface, report),
                    Some(ordered) => ordered.inspect(
                        surface,
                        |surface, report| effect.inspect(surface, report),
                        report,
                    ),
                }
            }
        });
        gathered.flags().to_vec()
    }
}

/// The number of vertices of a mesh with these faces, where nobody says how many there are.
fn counted_in(faces: &[[u32; 3]]) -> PyResult<usize> {
    let named = faces.as_flattened().iter().max();
    let vertices = named.map_or(0, |&last| last as usize + 1);
    let corners = 3 * faces.len();
    if vertices > corners {
        return Err(Fault::new(format_args!(
            "F names vertex {}, but its {} faces have no more than {corners} corners: with vertices=len(V), so many \
             that are in no face are possible",
            vertices - 1,
            faces.len()
        ))
        .into());
    }
    Ok(vertices)
}

/// An array for results, which nobody else reads or writes.
fn writable<'py, T: Element>(
    array: &Bound<'py, PyArray2<T>>,
    vertices: usize,
) -> PyResult<PyReadwriteArray2<'py, T>> {
    if array.shape() != [vertices, 3] {
        let [rows, columns] = [array.shape()[0], array.shape()[1]];
        return Err(Fault::new(format_args!(
            "out has the shape ({rows}, {columns}): ({vertices}, 3) is needed"
        ))
        .into());
    }
    if !array.is_c_contiguous() || !array.is_aligned() {
        return Err(invalid(
            "out is not one piece of memory in C order: numpy.empty_like(V, order=\"C\") is",
        ));
    }
    array.try_readwrite().map_err(|error| {
        invalid(format_args!(
            "out cannot be written to: {error}: it must be writeable, and share no memory with V"
        ))
    })
}

/// The first and the last byte of an array in one piece of memory.
fn bytes<T: Element>(array: &Bound<'_, PyArray2<T>>) -> [usize; 2] {
    let start = array.data() as usize;
    [start, start + array.len() * size_of::<T>()]
}

fn refuse_overlap<T: Element>(
    out: &Bound<'_, PyArray2<T>>,
    positions: &Bound<'_, PyArray2<T>>,
) -> PyResult<()> {
    let ([start, end], [from, to]) = (bytes(out), bytes(positions));
    if start < to && from < end {
        return Err(invalid("out shares memory with V: another array is needed"));
    }
    Ok(())
}

impl Membrane {
    /// Warns once of each method whose energy leaves out a part of this surface.
    #[expect(non_snake_case, reason = "the name of the positions in Python")]
    fn tell(&self, V: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut untold = self.untold.lock().unwrap_or_else(PoisonError::into_inner);
        let methods = std::mem::take(&mut *untold);
        drop(untold);
        if methods.is_empty() {
            return Ok(());
        }
        let positions = Positions::new(V)?;
        let positions = positions.double();
        let surface = Surface::new(&self.mesh, &positions[..]).map_err(Fault::from)?;
        let warn = V.py().import("helfrich._errors")?.getattr("warn")?;
        for text in methods
            .into_iter()
            .filter_map(|method| method.what_is_left_out(surface))
        {
            warn.call1((text,))?;
        }
        Ok(())
    }

    fn locked(&self) -> MutexGuard<'_, Acting> {
        // After a panic, too: each evaluation sets all that it reads.
        self.acting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The forces in double precision, written to `force`.
    fn forces_of(&self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Result<f64, Fault> {
        let surface = Surface::new(&self.mesh, positions)?;
        Ok(self.locked().evaluate(surface, force))
    }

    /// The forces in single precision, computed in double precision.
    fn single_forces_of(
        &self,
        positions: &[[f64; 3]],
        force: &mut [[f32; 3]],
    ) -> Result<f64, Fault> {
        let surface = Surface::new(&self.mesh, positions)?;
        let mut prepared = self.locked();
        let mut double = std::mem::take(&mut prepared.force);
        double.resize(positions.len(), [0.0; 3]);
        let energy = prepared.evaluate(surface, &mut double);
        for (single, double) in force.iter_mut().zip(&double) {
            *single = double.map(|component| component as f32);
        }
        prepared.force = double;
        Ok(energy)
    }

    fn evaluate<'py>(
        &self,
        positions: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(f64, Bound<'py, PyAny>)> {
        let py = positions.py();
        let vertices = self.mesh.vertex_count();
        let positions = Positions::new(positions)?;
        let other = |kind| PyTypeError::new_err(format!("out must be an array of {kind}, as V is"));
        match &positions {
            Positions::Double(array) => {
                let out = match out {
                    None => return self.fresh(py, rows(array)),
                    Some(out) => out.cast::<PyArray2<f64>>().map_err(|_| other("float64"))?,
                };
                refuse_overlap(out, array)?;
                let mut written = writable(out, vertices)?;
                let force = written.as_slice_mut().map_err(invalid)?.as_chunks_mut().0;
                let rows = rows(array);
                let energy = on_threads(py, None, || self.forces_of(rows, force))??;
                Ok((energy, out.clone().into_any()))
            }
            Positions::Single(array) => {
                let double = positions.double();
                let fresh;
                let out = match out {
                    None => {
                        fresh = PyArray2::<f32>::zeros(py, [vertices, 3], false);
                        &fresh
                    }
                    Some(out) => out.cast::<PyArray2<f32>>().map_err(|_| other("float32"))?,
                };
                refuse_overlap(out, array)?;
                let mut written = writable(out, vertices)?;
                let force = written.as_slice_mut().map_err(invalid)?.as_chunks_mut().0;
                let work = || self.single_forces_of(&double, force);
                let energy = on_threads(py, None, work)??;
                Ok((energy, out.clone().into_any()))
            }
        }
    }

    /// The forces as a new array.
    fn fresh<'py>(
        &self,
        py: Python<'py>,
        positions: &[[f64; 3]],
    ) -> PyResult<(f64, Bound<'py, PyAny>)> {
        let mut force = vec![[0.0; 3]; self.mesh.vertex_count()];
        let energy = on_threads(py, None, || self.forces_of(positions, &mut force))??;
        Ok((energy, matrix(py, force)?.into_any()))
    }
}

#[pymethods]
impl Membrane {
    #[new]
    #[pyo3(signature = (F, *effects, vertices=None, threads=None))]
    #[expect(non_snake_case, reason = "the name of the faces in Python")]
    fn new(
        F: &Bound<'_, PyAny>,
        effects: &Bound<'_, PyTuple>,
        vertices: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let counted = |value: Option<&Bound<'_, PyAny>>, function, name| match value {
            None => Ok(None),
            Some(value) => checked(function, value, name)?.extract::<Option<usize>>(),
        };
        let threads = counted(threads, "threads", "threads")?;
        let vertices = counted(vertices, "count", "vertices")?;
        let faces = faces(F)?;
        let vertices = match vertices {
            Some(vertices) => vertices,
            None => counted_in(&faces)?,
        };
        let made = F.py().detach(|| {
            let mesh = TriangleMesh::new(vertices, faces)?;
            let ordered = Ordered::of(&mesh);
            Ok::<_, Fault>((mesh, ordered))
        });
        let (mesh, ordered) = made?;
        let methods = Vec::from_iter(effects.iter().filter_map(|effect| bending_method(&effect)));
        let ground = Ground {
            mesh: &mesh,
            own: ordered.as_ref().map_or(&mesh, |ordered| ordered.mesh()),
            order: ordered.as_ref().map(Ordered::order),
            geometry: Geometry::new(methods.iter().copied()),
        };
        let mut untold = methods;
        untold.retain(|method| !(mesh.is_closed() || method.reaches_boundary()));
        let (mut acting, mut constraints) = (Vec::new(), Vec::new());
        prepared_for(threads, || {
            for described in effects {
                match part(&described, &ground)? {
                    MembranePart::Acting(effect) => acting.push(effect),
                    MembranePart::Held(constraint) => constraints.push(constraint),
                }
            }
            Ok(())
        })?;
        let held = (!constraints.is_empty()).then_some(Constraints { constraints });
        let held = held.map(|held| {
            Method::check(&held).map_err(invalid)?;
            Ok::<_, PyErr>(Prepared::new(held, ground.own))
        });
        let acting = Mutex::new(Acting {
            held: held.transpose()?,
            ordered,
            effects: acting,
            force: Vec::new(),
        });
        let copied = F
            .py()
            .import("copy")?
            .call_method1("deepcopy", (effects,))?;
        Ok(Self {
            mesh,
            made_of: MadeOf {
                effects: copied.cast_into::<PyTuple>()?.unbind(),
                threads,
            },
            untold: Mutex::new(untold),
            acting,
        })
    }

    /// What copies are made of, as by `pickle` and `copy`: the arguments and the keywords.
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let faces = matrix(py, self.mesh.triangles().to_vec())?.into_any();
        let effects = self.made_of.effects.bind(py).iter();
        let arguments = PyTuple::new(py, Vec::from_iter(std::iter::once(faces).chain(effects)))?;
        let keywords = PyDict::new(py);
        keywords.set_item("vertices", self.mesh.vertex_count())?;
        keywords.set_item("threads", self.made_of.threads)?;
        Ok((arguments, keywords))
    }

    /// The sum of the energies (float) at the positions V (n, 3).
    ///
    /// On an open mesh, a `helfrich.MeshWarning` says if that of bending leaves out a part at the border.
    ///
    /// Computed in double precision, without the interpreter's lock.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If V does not fit the mesh, or is not finite.
    #[expect(non_snake_case, reason = "the name of the positions in Python")]
    fn energy(&self, V: &Bound<'_, PyAny>) -> PyResult<f64> {
        let positions = Positions::new(V)?;
        let double = positions.double();
        let energy = on_threads(V.py(), None, || {
            let surface = Surface::new(&self.mesh, &double[..])?;
            Ok::<_, Fault>(self.locked().energy(surface))
        })?;
        self.tell(V)?;
        Ok(energy?)
    }

    /// The sum of the nodal forces (n, 3) at the positions V (n, 3), with the number type of V.
    ///
    /// Where quantities are held exactly, the parts along their gradients are removed.
    ///
    /// `out` is an array for the result, which is also returned: writeable, in C order, with the shape and
    /// the number type of V, and without memory in common with it. Forces are computed in double precision,
    /// without the interpreter's lock.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If V does not fit the mesh, or is not finite.
    /// ValueError, TypeError
    ///     If out is no such array.
    #[pyo3(signature = (V, out=None))]
    #[expect(non_snake_case, reason = "the name of the positions in Python")]
    fn force<'py>(
        &self,
        V: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.evaluate(V, out)?.1)
    }

    /// The energy and the forces of one evaluation, as `energy` and `force` return them.
    #[pyo3(signature = (V, out=None))]
    #[expect(non_snake_case, reason = "the name of the positions in Python")]
    fn energy_and_force<'py>(
        &self,
        V: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(f64, Bound<'py, PyAny>)> {
        let found = self.evaluate(V, out)?;
        self.tell(V)?;
        Ok(found)
    }

    /// The positions V (n, 3), moved so that every exact quantity has its target: a new array.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If V does not fit the mesh, or is not finite.
    /// ValueError
    ///     If a target cannot be reached.
    #[expect(non_snake_case, reason = "the name of the positions in Python")]
    fn restore<'py>(&self, V: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let positions = Positions::new(V)?;
        let is_single = positions.is_single();
        let mut moved = positions.double().into_owned();
        let restored = on_threads(V.py(), None, || {
            Surface::new(&self.mesh, &moved[..])?;
            Ok::<_, Fault>(self.locked().restore(&self.mesh, &mut moved))
        })?;
        restored?.map_err(invalid)?;
        if is_single {
            let moved = moved.iter().map(|x| x.map(|component| component as f32));
            return Ok(matrix(V.py(), moved.collect())?.into_any());
        }
        Ok(matrix(V.py(), moved)?.into_any())
    }

    /// Reasons to distrust forces at the positions V (n, 3): sums of `helfrich.Flag` (n,), uint32.
    #[expect(non_snake_case, reason = "the name of the positions in Python")]
    fn flags<'py>(&self, V: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let positions = Positions::new(V)?;
        let double = positions.double();
        let flags = on_threads(V.py(), None, || {
            let surface = Surface::new(&self.mesh, &double[..])?;
            let mut prepared = self.locked();
            let mut force = vec![[0.0; 3]; double.len()];
            prepared.evaluate(surface, &mut force);
            Ok::<_, Fault>(prepared.flags(surface))
        })?;
        Ok(PyArray1::from_vec(V.py(), flags?))
    }

    /// The name of each effect, the number of its evaluations so far and their time in seconds.
    #[getter]
    fn costs(&self, py: Python<'_>) -> Vec<(&'static str, u64, f64)> {
        py.detach(|| {
            let prepared = self.locked();
            let of = |effect: &Effect| {
                let (evaluations, time) = effect.cost();
                (effect.name(), evaluations, time.as_secs_f64())
            };
            prepared.effects.iter().map(of).collect()
        })
    }
}
