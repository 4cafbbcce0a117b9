//! Forces that depend on velocities and dissipate energy.

use crate::element::Execution;
use crate::method::{Method, Workspace};
use crate::points::{Points, PointsMut};
use crate::prepared::Prepared;
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
    /// Adds the nodal forces to `force`, one entry per vertex.
    ///
    /// # Panics
    /// If `velocities` or `force` have fewer entries than the surface has vertices, or the surface
    /// another mesh than that of the workspace.
    fn add_dissipative_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        velocities: &[[T; 3]],
        force: &mut [[T; 3]],
    );

    /// The dissipated power `−Σ F·v = 2R`, in units of energy per time.
    ///
    /// # Panics
    /// If `velocities` has fewer entries than the surface has vertices, or the surface another mesh
    /// than that of the workspace.
    fn dissipated_power(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        velocities: &[[T; 3]],
    ) -> T;
}

impl<T: Real, M: Dissipation<T>, X: Execution> Prepared<T, M, X> {
    /// See [`Dissipation::add_dissipative_force`].
    ///
    /// # Panics
    /// If `velocities` or `force` have fewer entries than the surface has vertices, and as
    /// [`Self::energy`].
    #[track_caller]
    pub fn add_dissipative_force(
        &mut self,
        surface: Surface<'_, T>,
        velocities: &(impl Points<Scalar = T> + ?Sized),
        force: &mut (impl PointsMut<Scalar = T> + ?Sized),
    ) {
        self.check(surface);
        let (velocities, force) = (velocities.coordinates(), force.coordinates_mut());
        self.with(|method, execution, workspace| {
            method.add_dissipative_force(execution, surface, workspace, velocities, force);
        });
    }

    /// See [`Dissipation::dissipated_power`].
    ///
    /// # Panics
    /// If `velocities` has fewer entries than the surface has vertices, and as [`Self::energy`].
    #[track_caller]
    pub fn dissipated_power(
        &mut self,
        surface: Surface<'_, T>,
        velocities: &(impl Points<Scalar = T> + ?Sized),
    ) -> T {
        self.check(surface);
        let velocities = velocities.coordinates();
        self.with(|method, execution, workspace| {
            method.dissipated_power(execution, surface, workspace, velocities)
        })
    }
}

impl<T: Real, A: Dissipation<T>, B: Dissipation<T>> Dissipation<T> for (A, B) {
    fn add_dissipative_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        velocities: &[[T; 3]],
        force: &mut [[T; 3]],
    ) {
        let (first, second) = workspace.for_mesh_mut(surface.mesh());
        self.0
            .add_dissipative_force(execution, surface, first, velocities, force);
        self.1
            .add_dissipative_force(execution, surface, second, velocities, force);
    }

    fn dissipated_power(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        velocities: &[[T; 3]],
    ) -> T {
        let (first, second) = workspace.for_mesh_mut(surface.mesh());
        self.0
            .dissipated_power(execution, surface, first, velocities)
            + self
                .1
                .dissipated_power(execution, surface, second, velocities)
    }
}
