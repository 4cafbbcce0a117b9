//! Constraints of one membrane, as [`Problem`](super::Problem)s need them.

use helfrich::{
    AnyFunctional, ConstraintError, Constraints, Correction, Functional, Prepared, Surface,
    TriangleMesh,
};
use std::sync::Arc;

/// The exact constraints of one membrane, with the memory of their evaluation.
#[derive(Debug)]
pub struct Held {
    mesh: Arc<TriangleMesh>,
    constraints: Prepared<f64, Constraints<f64>>,
    quantities: Vec<Prepared<f64, AnyFunctional>>,
    groups: Vec<u32>,
    ones: Vec<f64>,
}

impl Held {
    /// Prepares constraints for a mesh.
    pub fn new(mesh: Arc<TriangleMesh>, constraints: Constraints<f64>) -> Self {
        let prepare = |quantity: AnyFunctional| Prepared::new(quantity, &mesh);
        let quantities = constraints.constraints.iter().map(|c| c.functional);
        let quantities = quantities.map(prepare).collect();
        let (groups, count) = mesh.components();
        Self {
            constraints: Prepared::new(constraints, &mesh),
            quantities,
            groups,
            ones: vec![1.0; count],
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
            let ones = &self.ones;
            self.quantities[index].with(|quantity, execution, workspace| {
                quantity.add_gradient(execution, surface, workspace, ones, gradient);
            });
        }
    }
}
