//! Forces that depend on velocities and take energy away.

use crate::element::Execution;
use crate::energy::{Method, Prepared};
use crate::real::Real;
use crate::surface::Surface;

mod membrane_viscosity;

pub use membrane_viscosity::MembraneViscosity;

/// Forces from the positions and velocities of the vertices: `F_i = −∂R/∂v_i` of a potential R ≥ 0
/// that is quadratic in the velocities.
///
/// Laws: linear and symmetric in the velocities, `Σ F(u)·v = Σ F(v)·u`; F = 0 for the velocities of
/// a rigid body, to rounding, and therefore ΣF = 0 and Σ x × F = 0; the power `−Σ F·v = 2R` is not
/// negative, to rounding.
pub trait Dissipation<T: Real>: Method<T> {
    /// Adds the nodal forces to `force`, one entry a vertex.
    ///
    /// # Panics
    /// If `velocities` or `force` have fewer entries than the surface has vertices.
    fn add_dissipative_force(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        velocities: &[[T; 3]],
        force: &mut [[T; 3]],
    );

    /// The power `−Σ F·v = 2R` that turns into heat, in units of energy per time.
    ///
    /// # Panics
    /// If `velocities` has fewer entries than the surface has vertices.
    fn dissipated_power(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        velocities: &[[T; 3]],
    ) -> T;
}

impl<T: Real, M: Dissipation<T>, X: Execution> Prepared<T, M, X> {
    /// See [`Dissipation::add_dissipative_force`].
    ///
    /// # Panics
    /// If `velocities` or `force` have fewer entries than the surface has vertices.
    pub fn add_dissipative_force(
        &mut self,
        surface: Surface<'_, T>,
        velocities: &[[T; 3]],
        force: &mut [[T; 3]],
    ) {
        self.with(|method, execution, plan, memory| {
            method.add_dissipative_force(execution, plan, surface, memory, velocities, force);
        });
    }

    /// See [`Dissipation::dissipated_power`].
    ///
    /// # Panics
    /// If `velocities` has fewer entries than the surface has vertices.
    pub fn dissipated_power(&mut self, surface: Surface<'_, T>, velocities: &[[T; 3]]) -> T {
        self.with(|method, execution, plan, memory| {
            method.dissipated_power(execution, plan, surface, memory, velocities)
        })
    }
}

impl<T: Real, A: Dissipation<T>, B: Dissipation<T>> Dissipation<T> for (A, B) {
    fn add_dissipative_force(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        velocities: &[[T; 3]],
        force: &mut [[T; 3]],
    ) {
        let (first, second) = (&mut memory.0, &mut memory.1);
        self.0
            .add_dissipative_force(execution, &plan.0, surface, first, velocities, force);
        self.1
            .add_dissipative_force(execution, &plan.1, surface, second, velocities, force);
    }

    fn dissipated_power(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        velocities: &[[T; 3]],
    ) -> T {
        let (first, second) = (&mut memory.0, &mut memory.1);
        self.0
            .dissipated_power(execution, &plan.0, surface, first, velocities)
            + self
                .1
                .dissipated_power(execution, &plan.1, surface, second, velocities)
    }
}
