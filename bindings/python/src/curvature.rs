//! Curvatures and force densities at every vertex.

use crate::arrays::{Input, Numbers, Positions, matrix, rows};
use crate::effects::{checked_material, material};
use crate::failure::{Fault, invalid};
use crate::work::{Watch, on_threads};
use helfrich::{
    AdaptiveJet, Finding, FitExtent, MaterialParameter, Measured, Quality, Surface, TriangleMesh,
    Verdict,
};
use helfrich_std::execute::Parallel;
use helfrich_std::measurement::{
    Column, ColumnValues, Measurement, curvedness_and_shape_index, principal_curvatures,
    verdict_bit,
};
use helfrich_std::method::{AnyMethod, BendingMethod, Compiled, Evaluator, Fields, MethodOptions};
use helfrich_std::orientation::{InsideOut, inside_out};
use numpy::{Element, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ffi::CString;

/// A method with its options.
#[derive(Clone, Copy)]
pub(crate) struct Chosen {
    pub(crate) method: BendingMethod,
    pub(crate) options: MethodOptions,
}

impl Chosen {
    /// The method of this name or letter; `auto` is `jet`.
    pub(crate) fn named(
        method: &str,
        areas: Option<&str>,
        bandwidth: Option<&str>,
    ) -> PyResult<Self> {
        let method = if method == "auto" { "jet" } else { method };
        let method: BendingMethod = method.parse().map_err(invalid)?;
        let options = MethodOptions {
            areas: areas
                .map(MethodOptions::parse_areas)
                .transpose()
                .map_err(invalid)?,
            bandwidth: bandwidth
                .map(MethodOptions::parse_bandwidth)
                .transpose()
                .map_err(invalid)?,
        };
        options.check(method).map_err(invalid)?;
        Ok(Self { method, options })
    }
}

/// A question about curvatures.
struct Question {
    chosen: Chosen,
    /// κ and H0.
    material: [MaterialParameter<f64>; 2],
    jet: AdaptiveJet<f64>,
    /// Whether error bars are asked for.
    errors: bool,
    /// Whether the force density is asked for.
    force: bool,
}

impl Question {
    fn is_measured(&self) -> bool {
        self.chosen.method.has_error_bars()
            && self.material[1] == MaterialParameter::default()
            && !self.material[0].varies()
    }
}

/// The answer, in the number type of the positions.
struct Answer<T> {
    fields: Fields<T>,
    flags: Vec<u32>,
    measured: Option<Measurement>,
    columns: Vec<Column>,
    inside_out: Vec<InsideOut>,
}

type Failed = Option<Fault>;

/// Measures the positions.
fn measure(question: &Question, surface: Surface<'_, f64>, watch: &Watch) -> Option<Measurement> {
    Measurement::new(surface, &question.jet, &mut |_| !watch.ends())
}

/// The kinds of findings that concern each vertex.
fn flags_of(findings: Vec<Finding>, mesh: &TriangleMesh) -> Vec<u32> {
    let gathered = Quality::gather(mesh, |report| findings.into_iter().for_each(report));
    gathered.flags().to_vec()
}

/// The answer of a method, on the positions as they are.
fn evaluated<T: Compiled>(
    question: &Question,
    evaluator: &mut Evaluator<T>,
    surface: Surface<'_, T>,
    measured: Option<Measurement>,
) -> Answer<T> {
    let modulus = question.material[0].at(0);
    let (fields, findings) = if question.force || question.errors {
        evaluator.fields_and_findings(surface)
    } else {
        evaluator.curvatures_and_findings(surface)
    };
    let flags = flags_of(findings, surface.mesh());
    let columns = measured
        .as_ref()
        .map(|measured| measured.columns(&fields, modulus));
    Answer {
        fields,
        flags,
        columns: columns.unwrap_or_default(),
        measured,
        inside_out: Vec::new(),
    }
}

/// The answer in double precision. `None` as the failure if the user has interrupted it.
fn answer(
    question: &Question,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    watch: &Watch,
) -> Result<Answer<f64>, Failed> {
    let surface = Surface::new(mesh, positions).map_err(|error| Some(error.into()))?;
    let [modulus, _] = &question.material;
    let is_measured = question.is_measured();
    let measured = (is_measured || question.errors).then(|| measure(question, surface, watch));
    let measured = match measured {
        Some(None) => return Err(None),
        Some(found) => found,
        None => None,
    };
    if let (true, Some(measured)) = (is_measured, &measured) {
        let modulus = modulus.at(0);
        let fields = measured.fields(modulus);
        let columns = measured.columns(&fields, modulus);
        return Ok(Answer {
            flags: vec![0; fields.area.len()],
            columns,
            fields,
            measured: Some(measured.clone()),
            inside_out: inside_out(surface),
        });
    }
    let Chosen { method, options } = question.chosen;
    let parallel = Parallel::new();
    let is_plain = question.material[1] == MaterialParameter::default() && !modulus.varies();
    let number = modulus.at(0);
    let mut evaluator = if is_plain {
        AnyMethod::from(method).evaluator(&options, number, mesh, parallel)
    } else {
        let material = question.material.clone();
        Evaluator::with_material(method, &options, material, mesh, parallel)
            .map_err(|error| Some(Fault::new(error)))?
    };
    Ok(Answer {
        inside_out: inside_out(surface),
        ..evaluated(question, &mut evaluator, surface, measured)
    })
}

/// The answer in single precision, as the program computes it with `--scalar f32`.
fn single_answer(
    question: &Question,
    mesh: &TriangleMesh,
    positions: &[[f32; 3]],
    watch: &Watch,
) -> Result<Answer<f32>, Failed> {
    let surface = Surface::new(mesh, positions).map_err(|error| Some(error.into()))?;
    let double = Vec::from_iter(positions.iter().map(|x| x.map(f64::from)));
    let exact = Surface::new(mesh, &double).map_err(|error| Some(error.into()))?;
    let mut measured = None;
    if question.errors {
        measured = Some(measure(question, exact, watch).ok_or(None)?);
    }
    let Chosen { method, options } = question.chosen;
    let number = question.material[0].at(0);
    let mut evaluator =
        AnyMethod::from(method).evaluator(&options, number as f32, mesh, Parallel::new());
    Ok(Answer {
        inside_out: inside_out(exact),
        ..evaluated(question, &mut evaluator, surface, measured)
    })
}

/// The largest number of components that are named as inside out.
const MOST_COMPONENTS: usize = 10;

/// Level of the stack to which warnings belong: that of the caller of `helfrich.curvature`.
const CALLER: i32 = 3;

/// A number type of arrays.
trait Number: Element + Compiled {
    fn from_double(value: f64) -> Self;
}

impl Number for f32 {
    fn from_double(value: f64) -> Self {
        value as f32
    }
}

impl Number for f64 {
    fn from_double(value: f64) -> Self {
        value
    }
}

fn list<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}

fn converted<T: Compiled, U: Number>(values: &[T]) -> Vec<U> {
    let double = |value: &T| value.to_f64().unwrap_or(0.0);
    values
        .iter()
        .map(|value| U::from_double(double(value)))
        .collect()
}

impl<T: Number> Answer<T> {
    /// The arrays by name: 0 where a value is unknown, and flagged. Their number type is U.
    fn arrays<'py, U: Number>(
        mut self,
        py: Python<'py>,
        question: &Question,
    ) -> PyResult<Bound<'py, PyDict>> {
        for component in self.inside_out.iter().take(MOST_COMPONENTS) {
            let message = CString::new(component.to_string())?;
            let category = py.import("helfrich")?.getattr("MeshWarning")?;
            PyErr::warn(py, &category, &message, CALLER)?;
        }
        let arrays = PyDict::new(py);
        let Fields {
            area,
            normal,
            mean,
            gaussian,
            force_density,
            ..
        } = &self.fields;
        let method = question.chosen.method;
        let [has_mean, has_gaussian, _] = method.description().defines;
        let unknown = verdict_bit(Verdict::Unknown);
        for (name, values, is_defined) in [("H", mean, has_mean), ("K", gaussian, has_gaussian)] {
            if !is_defined {
                arrays.set_item(name, py.None())?;
                continue;
            }
            for (flags, value) in self.flags.iter_mut().zip(values) {
                *flags |= if value.is_none() { unknown } else { 0 };
            }
            let values = values.iter().map(|value| value.unwrap_or(T::zero()));
            arrays.set_item(name, list(py, converted::<T, U>(&Vec::from_iter(values))))?;
        }
        let double = |value: T| value.to_f64().unwrap_or(0.0);
        let vector = |value: &[T; 3]| value.map(|component| U::from_double(double(component)));
        let zero = [T::zero(); 3];
        if question.force {
            let density = force_density.iter().map(|f| vector(&f.unwrap_or(zero)));
            arrays.set_item("f", matrix(py, density.collect())?)?;
        }
        arrays.set_item("normal", matrix(py, normal.iter().map(vector).collect())?)?;
        arrays.set_item("area", list(py, converted::<T, U>(area)))?;
        let column = |name: &str| {
            let found = self.columns.iter().find(|column| column.name == name);
            found.map(|column| match &column.values {
                ColumnValues::Scalars(values) => values.as_slice(),
                _ => &[],
            })
        };
        let finite = |values: &[f64], or: f64| {
            let or_known = |&value: &f64| if value.is_nan() { or } else { value };
            list(
                py,
                values.iter().map(or_known).map(U::from_double).collect(),
            )
        };
        if has_gaussian {
            let shape = |(mean, gaussian): (&Option<T>, &Option<T>)| match (mean, gaussian) {
                (Some(mean), Some(gaussian)) => {
                    let both = principal_curvatures(double(*mean), double(*gaussian));
                    let [curvedness, index] = curvedness_and_shape_index(both);
                    [both[0], both[1], curvedness, index]
                }
                _ => [0.0; 4],
            };
            let shapes = match &self.measured {
                Some(_) => Vec::new(),
                None => Vec::from_iter(mean.iter().zip(gaussian).map(shape)),
            };
            let names = ["k1", "k2", "curvedness", "shape_index"];
            for (which, name) in names.into_iter().enumerate() {
                let values = match column(name) {
                    Some(known) => finite(known, 0.0),
                    None => finite(&Vec::from_iter(shapes.iter().map(|of| of[which])), 0.0),
                };
                arrays.set_item(name, values)?;
            }
        }
        for name in [
            "H_error",
            "K_error",
            "k1_error",
            "k2_error",
            "f_error",
            "curvedness_error",
            "shape_index_error",
            "sigma",
        ] {
            let values = column(name).map(|values| finite(values, f64::INFINITY));
            arrays.set_item(name, values)?;
        }
        if let Some(measured) = &self.measured {
            for (flags, at) in self.flags.iter_mut().zip(&measured.vertices) {
                let finding = at.cause.and_then(|cause| cause.finding(0));
                *flags |= verdict_bit(at.verdict) | finding.map_or(0, Finding::bit);
            }
            let none = [U::zero(); 3];
            for (which, name) in ["d1", "d2"].into_iter().enumerate() {
                let of = |at: &Measured<f64>| {
                    at.directions
                        .map_or(none, |both| both[which].map(U::from_double))
                };
                let directions = measured.vertices.iter().map(of).collect();
                arrays.set_item(name, matrix(py, directions)?)?;
            }
        }
        arrays.set_item("flags", list(py, self.flags))?;
        Ok(arrays)
    }
}

/// Curvatures and force densities by name: `None` for quantities that the method does not define.
#[pyfunction]
#[pyo3(signature = (positions, faces, *, method, areas, bandwidth, modulus, spontaneous_curvature, scale, radius, sigma, errors, force, threads))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn curvature<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    faces: &Bound<'py, PyAny>,
    method: &str,
    areas: Option<&str>,
    bandwidth: Option<&str>,
    modulus: &Bound<'py, PyAny>,
    spontaneous_curvature: &Bound<'py, PyAny>,
    scale: Option<usize>,
    radius: Option<f64>,
    sigma: f64,
    errors: bool,
    force: bool,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut input = Input::new(positions, faces)?;
    let count = input.positions.len();
    let material = [
        material(&Numbers::named(modulus, "kappa")?, count, "kappa")?,
        material(&Numbers::named(spontaneous_curvature, "H0")?, count, "H0")?,
    ];
    let question = Question {
        chosen: Chosen::named(method, areas, bandwidth)?,
        material,
        jet: AdaptiveJet {
            deviation: sigma,
            extent: match (scale, radius) {
                (Some(neighbours), _) => Some(FitExtent::Neighbours(neighbours)),
                (None, Some(radius)) => Some(FitExtent::Radius(radius)),
                (None, None) => None,
            },
        },
        errors,
        force,
    };
    checked_material(question.chosen.method, &question.material)?;
    let is_plain =
        question.material[1] == MaterialParameter::default() && !question.material[0].varies();
    let triangles = input.take_faces();
    let is_single = input.positions.is_single() && is_plain && !question.is_measured();
    let made = move || TriangleMesh::new(count, triangles).map_err(|error| Some(error.into()));
    let watch = Watch::default();
    if let (true, Positions::Single(array)) = (is_single, &input.positions) {
        let rows = rows(array);
        let (found, watch) = on_threads(py, threads, || {
            let found = made().and_then(|mesh| single_answer(&question, &mesh, rows, &watch));
            (found, watch)
        })?;
        return ended(found, watch)?.arrays::<f32>(py, &question);
    }
    let double = input.positions.double();
    let (found, watch) = on_threads(py, threads, || {
        let found = made().and_then(|mesh| answer(&question, &mesh, &double, &watch));
        (found, watch)
    })?;
    let answer = ended(found, watch)?;
    if input.positions.is_single() {
        answer.arrays::<f32>(py, &question)
    } else {
        answer.arrays::<f64>(py, &question)
    }
}

/// The answer, unless a signal has come or something has failed.
fn ended<A>(found: Result<A, Failed>, watch: Watch) -> PyResult<A> {
    if let Some(error) = watch.into_error() {
        return Err(error);
    }
    found.map_err(|fault| fault.unwrap_or_else(|| Fault::new("interrupted")).into())
}
