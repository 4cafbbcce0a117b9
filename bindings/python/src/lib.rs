//! The compiled module of the Python package `helfrich`. What users see, and its documentation, is in
//! `python/helfrich`: the functions here take arrays that are ready to be read, and return arrays.
//!
//! Work is done without the interpreter's lock.

mod arrays;
mod curvature;
mod effects;
mod failure;
mod membrane;
mod meshes;
mod operators;
mod pictures;
mod recommendation;
mod scenes;
mod smooth_surface;
mod smoothing;
mod work;

use helfrich::Finding;
use helfrich_std::measurement::VERDICT_BITS;
use helfrich_std::method::BendingMethod;
use helfrich_std::scene::{Effects, SHIPPED};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The methods, each with its name, letter, title and idea, the quantities that it defines, and whether
/// it has a force and an energy.
fn methods(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let described = BendingMethod::NAMED.iter().map(|method| {
        let description = method.description();
        let entry = PyDict::new(py);
        entry.set_item("name", description.name)?;
        entry.set_item("letter", description.letter)?;
        entry.set_item("title", description.title)?;
        entry.set_item("idea", description.idea)?;
        entry.set_item("defines", description.defines)?;
        entry.set_item("has_force", method.has_force())?;
        entry.set_item("is_conservative", method.is_conservative())?;
        Ok(entry)
    });
    described.collect()
}

/// The names of flags with their bits: kinds of findings, then verdicts that are none.
fn flags() -> Vec<(String, u32)> {
    let findings = Finding::KINDS.iter().enumerate();
    let findings = findings.map(|(kind, name)| (name.to_uppercase(), 1 << kind));
    let verdicts = VERDICT_BITS.iter();
    let verdicts = verdicts.map(|&(name, bit)| (name.replace('-', "_").to_uppercase(), bit));
    let mut flags = Vec::from_iter(findings.chain(verdicts));
    flags.sort_by_key(|&(_, bit)| bit);
    flags.dedup();
    flags
}

#[pymodule]
mod _helfrich {
    use super::*;

    #[pymodule_export]
    use super::arrays::address;
    #[pymodule_export]
    use super::curvature::curvature;
    #[pymodule_export]
    use super::membrane::Membrane;
    #[pymodule_export]
    use super::meshes::{
        components, divided, inspect, read, repair, repair_file, shape, subdivide, weld, write,
    };
    #[pymodule_export]
    use super::operators::{gradient, laplacian, stiffness};
    #[pymodule_export]
    use super::pictures::picture;
    #[pymodule_export]
    use super::recommendation::recommend;
    #[pymodule_export]
    use super::scenes::run;
    #[pymodule_export]
    use super::smooth_surface::{SmoothSurface, remesh};
    #[pymodule_export]
    use super::smoothing::smooth;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("METHODS", methods(module.py())?)?;
        module.add("FLAGS", flags())?;
        module.add("EFFECTS", Effects::NAMES.to_vec())?;
        module.add(
            "SCENES",
            Vec::from_iter(SHIPPED.iter().map(|scene| scene.name)),
        )?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
