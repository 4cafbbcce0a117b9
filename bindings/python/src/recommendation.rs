//! The cheapest method for an accuracy.

use crate::arrays::Input;
use crate::failure::{Fault, invalid};
use crate::work::{Watch, on_threads};
use helfrich::TriangleMesh;
use helfrich_std::answer::Norm;
use helfrich_std::method::{AnyMethod, BendingMethod, MethodOptions};
use helfrich_std::recommend::{self as choice, Request};
use helfrich_std::scalar::Scalar;
use helfrich_std::study::Quantity;
use pyo3::prelude::*;

/// The answer as JSON, as the program writes it.
#[pyfunction]
#[pyo3(signature = (positions, faces, *, error, quantity, norm, methods, scalars, threads))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub(crate) fn recommend(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    error: f64,
    quantity: &str,
    norm: &str,
    methods: Option<Vec<String>>,
    scalars: Vec<String>,
    threads: Option<usize>,
) -> PyResult<String> {
    let mut input = Input::new(positions, faces)?;
    let found = |known: &Quantity| known.symbol().eq_ignore_ascii_case(quantity);
    let quantity = Quantity::ALL.into_iter().find(found);
    let norm = Norm::ALL.into_iter().find(|known| known.name() == norm);
    let methods = match methods {
        None => {
            let all = BendingMethod::ALL.into_iter().chain([BendingMethod::Jet]);
            let measures = BendingMethod::CURVATURES;
            all.chain(measures).map(AnyMethod::from).collect()
        }
        Some(names) => {
            let parsed = names.iter().map(|name| name.parse::<BendingMethod>());
            let parsed = parsed.map(|method| method.map(AnyMethod::from));
            parsed.collect::<Result<_, _>>().map_err(invalid)?
        }
    };
    if !(error > 0.0 && error.is_normal()) {
        return Err(invalid(format_args!(
            "error is {error}: a number above 0 is needed"
        )));
    }
    let scalars = scalars.iter().map(|name| name.parse::<Scalar>());
    let request = Request {
        quantity: quantity.ok_or_else(|| invalid("the quantities are H, K, LapH and f"))?,
        norm: norm.ok_or_else(|| invalid("the norms are max and mean"))?,
        target: error,
        methods,
        options: MethodOptions::default(),
        scalars: scalars.collect::<Result<_, _>>().map_err(invalid)?,
    };
    let triangles = input.take_faces();
    let positions = input.positions.double();
    let watch = Watch::default();
    let (found, watch) = on_threads(py, threads, || {
        let found = TriangleMesh::new(positions.len(), triangles)
            .map_err(Fault::from)
            .and_then(|mesh| {
                let ends = || watch.ends();
                choice::recommend(&mesh, &positions, &request, &ends, &mut |_| ())
                    .map_err(Fault::new)
            });
        (found, watch)
    })?;
    if let Some(error) = watch.into_error() {
        return Err(error);
    }
    let found = found?.ok_or_else(|| invalid("interrupted"))?;
    serde_json::to_string(&found).map_err(invalid)
}
