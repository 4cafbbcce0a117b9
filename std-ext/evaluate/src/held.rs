//! Functionals of the components of one membrane: their values, gradients, and exact constraints.

use crate::execute::Parallel;
use helfrich::{
    AnyFunctional, ConstraintError, Constraints, Correction, Functional, Prepared, Surface,
    Targets, TriangleMesh,
};
use std::sync::Arc;

/// A functional of each connected component, prepared for one mesh.
#[derive(Debug)]
pub struct Quantity {
    prepared: Prepared<f64, AnyFunctional, Parallel>,
    values: Vec<f64>,
    ones: Vec<f64>,
}

impl Quantity {
    /// Prepares a functional for a mesh.
    pub fn new(functional: AnyFunctional, mesh: &TriangleMesh) -> Self {
        let (_, count) = mesh.components();
        Self {
            prepared: Prepared::with_execution(functional, mesh, Parallel::new()),
            values: vec![0.0; count],
            ones: vec![1.0; count],
        }
    }

    /// The values of a functional on a surface, as targets.
    pub fn targets(functional: AnyFunctional, surface: Surface<'_, f64>) -> Targets<f64> {
        let mut quantity = Self::new(functional, surface.mesh());
        quantity.values(surface);
        Targets::PerComponent(quantity.values)
    }

    /// The value of each component.
    ///
    /// # Panics
    /// If the surface has another mesh.
    pub fn values(&mut self, surface: Surface<'_, f64>) -> &[f64] {
        let values = &mut self.values;
        self.prepared.with(|functional, execution, workspace| {
            functional.values(execution, surface, workspace, values);
        });
        values
    }

    /// Adds the gradient, a vector per vertex, to `gradient`.
    ///
    /// # Panics
    /// If the surface has another mesh, or `gradient` has fewer entries than it has vertices.
    pub fn add_gradient(&mut self, surface: Surface<'_, f64>, gradient: &mut [[f64; 3]]) {
        let ones = &self.ones;
        self.prepared.with(|functional, execution, workspace| {
            functional.add_gradient(execution, surface, workspace, ones, gradient);
        });
    }
}

/// The exact constraints of one membrane, with the memory of their evaluation.
#[derive(Debug)]
pub struct Held {
    mesh: Arc<TriangleMesh>,
    constraints: Prepared<f64, Constraints<f64>, Parallel>,
    quantities: Vec<Quantity>,
    groups: Vec<u32>,
}

impl Held {
    /// Prepares constraints for a mesh.
    pub fn new(mesh: Arc<TriangleMesh>, constraints: Constraints<f64>) -> Self {
        let quantities = constraints.constraints.iter();
        let quantities = quantities.map(|constraint| Quantity::new(constraint.functional, &mesh));
        Self {
            quantities: quantities.collect(),
            constraints: Prepared::with_execution(constraints, &mesh, Parallel::new()),
            groups: mesh.components().0,
            mesh,
        }
    }

    /// Number of constrained functionals.
    pub fn count(&self) -> usize {
        self.quantities.len()
    }

    /// The connected component of each vertex; every component has its own values.
    pub fn groups(&self) -> &[u32] {
        &self.groups
    }

    /// The constraints, mutable, to change their targets.
    pub fn constraints_mut(&mut self) -> &mut Constraints<f64> {
        self.constraints.method_mut()
    }

    /// Moves positions so that every functional has its target.
    ///
    /// # Errors
    /// If this fails: see [`Constraints::correct`].
    pub fn restore(
        &mut self,
        positions: &mut [[f64; 3]],
    ) -> Result<Correction<f64>, ConstraintError> {
        let mesh = &self.mesh;
        self.constraints.with(|method, execution, workspace| {
            method.correct(execution, mesh, positions, workspace)
        })
    }

    /// Sets `gradient` to the gradient of one of the functionals; 0 where positions do not fit the mesh
    /// or are not finite.
    ///
    /// # Panics
    /// If there is no such functional, or `gradient` has fewer entries than the mesh has vertices.
    pub fn gradient(&mut self, index: usize, positions: &[[f64; 3]], gradient: &mut [[f64; 3]]) {
        gradient.fill([0.0; 3]);
        if let Ok(surface) = Surface::new(&self.mesh, positions) {
            self.quantities[index].add_gradient(surface, gradient);
        }
    }
}
