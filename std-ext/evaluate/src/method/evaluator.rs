//! Evaluation of methods chosen at run time.

mod acts;

pub(super) use acts::Preparing;

use super::fields::Fields;
use super::{AnyMethod, BendingMethod, MethodOptions, OwnMethod, Settings, choose};
use crate::act::Act;
use crate::effect::CannotBend;
use crate::execute::Parallel;
use crate::ordered::Ordered;
use helfrich::{
    Cotangent, DualArea, Execution, Finding, MaterialParameter, Noise, Quality, Real, Serial,
    Surface, TriangleMesh,
};
use std::fmt;

/// A bending method prepared for one mesh.
#[derive(Debug)]
pub struct Evaluator<T: Real> {
    prepared: Box<dyn Act<T>>,
    ordered: Option<Ordered<T>>,
    force: Vec<[T; 3]>,
}

impl<T: Real> Evaluator<T> {
    /// Prepares `method` with bending modulus `modulus` for a mesh, with default options and on all
    /// threads.
    pub fn new(method: BendingMethod, modulus: T, mesh: &TriangleMesh) -> Self
    where
        T: Evaluated,
    {
        let options = MethodOptions::default();
        Self::with_options(method, &options, modulus, mesh, Parallel::new())
    }

    /// Prepares `method` with the options that apply to it, on these threads; no bit of the results depends
    /// on their number.
    pub fn with_options(
        method: BendingMethod,
        options: &MethodOptions,
        modulus: T,
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Self
    where
        T: Evaluated,
    {
        T::evaluator(method, options, modulus, mesh, threads)
    }

    /// Prepares `method` with any execution.
    fn with_execution<X>(
        method: BendingMethod,
        options: &MethodOptions,
        modulus: T,
        mesh: &TriangleMesh,
        execution: X,
    ) -> Self
    where
        X: Execution + Copy + fmt::Debug + Send + 'static,
    {
        Self::made(
            method.into(),
            options,
            [modulus.into(), MaterialParameter::default()],
            mesh,
            execution,
            |settings, preparing| choose(method, settings, preparing),
        )
    }

    /// Prepares a method with the function `make`.
    fn made<X>(
        method: AnyMethod,
        options: &MethodOptions,
        material: [MaterialParameter<T>; 2],
        mesh: &TriangleMesh,
        execution: X,
        make: impl FnOnce(Settings<'_, T>, Preparing<'_, T, X>) -> Box<dyn Act<T>>,
    ) -> Self {
        let ordered = Ordered::of(mesh);
        let vertices = mesh.vertex_count();
        let mesh = ordered.as_ref().map_or(mesh, |ordered| ordered.mesh());
        let in_order = |parameter| match (&ordered, parameter) {
            (Some(ordered), MaterialParameter::PerVertex(values)) => {
                MaterialParameter::PerVertex(ordered.order().apply(&values))
            }
            (_, parameter) => parameter,
        };
        let number = material[0].at(0);
        let [modulus, spontaneous_curvature] = material.map(in_order);
        let settings = Settings {
            modulus,
            spontaneous_curvature,
            options,
            mesh,
        };
        let [_, gaussian, _] = method.description().defines;
        let preparing = Preparing {
            mesh,
            execution,
            modulus: number,
            gaussian,
        };
        Self {
            prepared: make(settings, preparing),
            ordered,
            force: vec![[T::zero(); 3]; vertices],
        }
    }

    /// Performs one evaluation as in a simulation: nodal forces with the energy for conservative methods,
    /// force densities with the curvatures for methods in strong form, and curvatures for methods without a
    /// force.
    pub fn evaluate(&mut self, surface: Surface<'_, T>) {
        self.force.fill([T::zero(); 3]);
        match &mut self.ordered {
            None => {
                self.prepared.add_force(surface, &mut self.force);
            }
            Some(ordered) => {
                let (surface, force) = ordered.parts(surface);
                force.fill([T::zero(); 3]);
                self.prepared.add_force(surface, force);
                ordered.add_forces_to(&mut self.force);
            }
        }
    }

    /// Nodal forces of the last evaluation, or force densities for methods in strong form; 0 for methods
    /// without forces.
    pub fn force(&self) -> &[[T; 3]] {
        &self.force
    }

    /// Energy of a surface; for methods without an energy, `2κ Σ H² A` over interior vertices, by jets over
    /// those of boundaries, too.
    pub fn energy(&mut self, surface: Surface<'_, T>) -> T {
        match &mut self.ordered {
            None => self.prepared.energy(surface),
            Some(ordered) => self.prepared.energy(ordered.parts(surface).0),
        }
    }

    /// Evaluates, and collects all results of the method.
    pub fn fields(&mut self, surface: Surface<'_, T>) -> Fields<T>
    where
        T: Evaluated,
    {
        self.fields_and_findings(surface).0
    }

    /// Evaluates, and collects all results of the method and the findings of [`Self::findings`].
    pub fn fields_and_findings(&mut self, surface: Surface<'_, T>) -> (Fields<T>, Vec<Finding>)
    where
        T: Evaluated,
    {
        // Fields that do not follow from forces are measured as they are collected.
        if self.prepared.has_fields_of_force() {
            self.evaluate(surface);
        }
        T::last_results(self, surface, Wanted::All)
    }

    /// [`Self::fields_and_findings`] without quantities of the force: Δ_S H and f are undefined everywhere. This
    /// takes the time of the curvatures alone.
    pub fn curvatures_and_findings(&mut self, surface: Surface<'_, T>) -> (Fields<T>, Vec<Finding>)
    where
        T: Evaluated,
    {
        T::last_results(self, surface, Wanted::Curvatures)
    }

    /// Collects [`Self::fields`] from the last evaluation, which must have been for this surface, without
    /// another one.
    pub fn last_fields(&mut self, surface: Surface<'_, T>) -> Fields<T>
    where
        T: Evaluated,
    {
        T::last_results(self, surface, Wanted::All).0
    }

    fn collect(&mut self, surface: Surface<'_, T>, wanted: Wanted) -> (Fields<T>, Vec<Finding>) {
        let has_force = matches!(wanted, Wanted::All);
        match &mut self.ordered {
            None => collect(
                &mut *self.prepared,
                surface,
                has_force.then_some(&self.force),
            ),
            Some(ordered) => {
                let (surface, force) = ordered.parts(surface);
                let force = has_force.then_some(&*force);
                let (fields, findings) = collect(&mut *self.prepared, surface, force);
                let order = ordered.order();
                let findings = findings.into_iter();
                let findings = findings.map(|finding| order.undo_finding(finding));
                (fields.undone(order), findings.collect())
            }
        }
    }

    /// Findings about the last evaluation, which must have been for this surface, including noise
    /// of its positions, with a flag for each vertex: see [`quality`](helfrich::Prepared::quality).
    pub fn quality(&self, surface: Surface<'_, T>) -> Quality
    where
        T: Evaluated,
    {
        T::quality(self, surface)
    }

    fn gather(&self, surface: Surface<'_, T>) -> Quality {
        Quality::gather(surface.mesh(), |report| {
            self.inspect(surface, report);
            Noise::of(&Parallel::new(), surface).inspect(surface, report);
        })
    }

    /// Findings about the last evaluation, which must have been for this surface. They do not include noise,
    /// so that they are fast.
    pub fn findings(&self, surface: Surface<'_, T>) -> Vec<Finding> {
        let mut findings = Vec::new();
        self.inspect(surface, &mut |finding| findings.push(finding));
        findings
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        match &self.ordered {
            None => self.prepared.inspect(surface, report),
            Some(ordered) => {
                let inspect = |surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)| {
                    self.prepared.inspect(surface, report);
                };
                ordered.inspect(surface, inspect, report);
            }
        }
    }
}

/// The results that [`Evaluated::last_results`] collects.
#[derive(Clone, Copy, Debug)]
pub enum Wanted {
    /// Curvatures, normals and areas, which are measured for this.
    Curvatures,
    /// These and quantities of the force, of the last evaluation.
    All,
}

/// A number type in which methods are evaluated.
pub trait Evaluated: Real {
    /// Equivalent of [`Evaluator::with_options`] for any number type, on one thread.
    fn evaluator(
        method: BendingMethod,
        options: &MethodOptions,
        modulus: Self,
        mesh: &TriangleMesh,
        _threads: Parallel,
    ) -> Evaluator<Self> {
        Evaluator::with_execution(method, options, modulus, mesh, Serial)
    }

    /// Results of the last evaluation, as [`Evaluator::fields_and_findings`] returns them.
    fn last_results(
        evaluator: &mut Evaluator<Self>,
        surface: Surface<'_, Self>,
        wanted: Wanted,
    ) -> (Fields<Self>, Vec<Finding>) {
        evaluator.collect(surface, wanted)
    }

    /// [`Evaluator::quality`].
    fn quality(evaluator: &Evaluator<Self>, surface: Surface<'_, Self>) -> Quality {
        evaluator.gather(surface)
    }
}

/// A number type for which methods of your own are compiled: f32 or f64.
pub trait Compiled: Evaluated {
    /// Prepares a method of your own, with its default options, on the given threads.
    fn own_evaluator(
        method: OwnMethod,
        modulus: Self,
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Evaluator<Self>;
}

// These functions have no type parameters, so that methods are compiled here and not again in every crate
// that evaluates them.
macro_rules! evaluated {
    ($($number:ty: $made:ident),*) => {$(
        impl Compiled for $number {
            fn own_evaluator(
                method: OwnMethod,
                modulus: $number,
                mesh: &TriangleMesh,
                threads: Parallel,
            ) -> Evaluator<$number> {
                let options = MethodOptions::default();
                let material = [modulus.into(), MaterialParameter::default()];
                Evaluator::made(method.into(), &options, material, mesh, threads, method.$made)
            }
        }

        impl Evaluated for $number {
            fn evaluator(
                method: BendingMethod,
                options: &MethodOptions,
                modulus: $number,
                mesh: &TriangleMesh,
                threads: Parallel,
            ) -> Evaluator<$number> {
                Evaluator::with_execution(method, options, modulus, mesh, threads)
            }

            fn last_results(
                evaluator: &mut Evaluator<$number>,
                surface: Surface<'_, $number>,
                wanted: Wanted,
            ) -> (Fields<$number>, Vec<Finding>) {
                evaluator.collect(surface, wanted)
            }

            fn quality(evaluator: &Evaluator<$number>, surface: Surface<'_, $number>) -> Quality {
                evaluator.gather(surface)
            }
        }
    )*};
}

evaluated!(f32: single, f64: double);

impl Evaluator<f64> {
    /// Prepares `method` with a bending modulus κ and a spontaneous curvature H0, which may vary, on the
    /// given threads.
    ///
    /// # Errors
    /// If the method is an operator for curvatures only, or kantor-nelson (A) and one of these varies.
    ///
    /// # Panics
    /// If a parameter is not finite or too large, see [`helfrich::Method::check`], or one that varies
    /// has not one number for each vertex.
    pub fn with_material(
        method: BendingMethod,
        options: &MethodOptions,
        material: [MaterialParameter<f64>; 2],
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Result<Self, CannotBend> {
        if !method.has_force() {
            return Err(CannotBend::NoForce(method));
        }
        CannotBend::unless_uniform(method, material.each_ref())?;
        let make = |settings: Settings<'_, f64>, preparing: Preparing<'_, f64, Parallel>| {
            choose(method, settings, preparing)
        };
        let method = method.into();
        Ok(Self::made(method, options, material, mesh, threads, make))
    }
}

/// Collects the results of a method and its findings: with the force of its last evaluation on this surface all of
/// them, without it those that [`Wanted::Curvatures`] names.
fn collect<T: Real>(
    prepared: &mut dyn Act<T>,
    surface: Surface<'_, T>,
    force: Option<&[[T; 3]]>,
) -> (Fields<T>, Vec<Finding>) {
    let vertices = surface.mesh().vertex_count();
    let mut area = vec![T::zero(); vertices];
    Cotangent::new(DualArea::Mixed).dual_areas(&Serial, surface, &mut area);
    let mut fields = Fields {
        area,
        normal: Vec::new(),
        mean: vec![None; vertices],
        gaussian: vec![None; vertices],
        laplacian_of_mean: vec![None; vertices],
        force_density: vec![None; vertices],
    };
    prepared.collect(surface, force, &mut fields);
    // The method left out the vertices of these findings; the 0 there is not a curvature.
    let mut findings = Vec::new();
    prepared.inspect(surface, &mut |finding| findings.push(finding));
    for finding in &findings {
        match *finding {
            Finding::ZeroArea { vertex } | Finding::TooFewNeighbours { vertex } => {
                fields.clear(vertex as usize);
                if prepared.is_strong_form() {
                    fields.clear_fourth_derivative(vertex as usize);
                }
            }
            Finding::OutOfRange { vertex } => fields.clear_fourth_derivative(vertex as usize),
            _ => {}
        }
    }
    (fields, findings)
}
