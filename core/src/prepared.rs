//! A method and its workspace together.

use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::{Finding, Quality};
use crate::element::{Execution, Serial};
use crate::laplacian::{LaplaceBeltrami, Rows};
use crate::mesh::TriangleMesh;
use crate::method::{Conservative, Energy, Force, ForceDensity, Method, Workspace};
use crate::noise::Noise;
use crate::points::PointsMut;
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// A method with its workspace, ready for repeated evaluation on surfaces with the mesh for which
/// it was prepared. Nothing is allocated after the first evaluation.
///
/// Forces are written in place to any [`PointsMut`], as positions are read from any
/// [`Points`](crate::Points).
#[derive(Clone, Debug)]
pub struct Prepared<T: Real, M: Method<T>, X = Serial> {
    method: M,
    workspace: Workspace<T, M>,
    execution: X,
    /// Empty until curvatures are measured.
    curvature: Vec<Curvature<T>>,
}

impl<T: Real, M: Method<T>> Prepared<T, M> {
    /// Prepares `method` for a mesh; evaluations are serial.
    ///
    /// # Panics
    /// If a parameter of the method is not finite or too large, see [`Method::check`].
    #[track_caller]
    pub fn new(method: M, mesh: &TriangleMesh) -> Self {
        Self::with_execution(method, mesh, Serial)
    }
}

impl<T: Real, M: Method<T>, X: Execution> Prepared<T, M, X> {
    /// Prepares `method` for a mesh; evaluations run on `execution`.
    ///
    /// # Panics
    /// If a parameter of the method is not finite or too large, see [`Method::check`].
    #[track_caller]
    pub fn with_execution(method: M, mesh: &TriangleMesh, execution: X) -> Self {
        check(&method);
        let workspace = method.workspace(mesh);
        Self {
            method,
            workspace,
            execution,
            curvature: Vec::new(),
        }
    }

    /// Refuses surfaces with another mesh than that of the workspace, and parameters that have been
    /// changed to numbers that are not finite.
    #[track_caller]
    pub(crate) fn check(&self, surface: Surface<'_, T>) {
        self.workspace.for_mesh(surface.mesh());
        check(&self.method);
    }

    /// The method.
    pub fn method(&self) -> &M {
        &self.method
    }

    /// The method, to change a parameter that its workspace does not depend on.
    pub fn method_mut(&mut self) -> &mut M {
        &mut self.method
    }

    /// The results of the last evaluation.
    pub fn memory(&self) -> &M::Memory {
        self.workspace.memory()
    }

    /// Calls `evaluate` with every part, for operations of a method beyond the common traits.
    pub fn with<R>(&mut self, evaluate: impl FnOnce(&M, &X, &mut Workspace<T, M>) -> R) -> R {
        evaluate(&self.method, &self.execution, &mut self.workspace)
    }

    /// See [`Energy::energy`].
    ///
    /// # Panics
    /// If the surface has another mesh than that of [`Self::new`], or a parameter is not finite or too large.
    #[track_caller]
    pub fn energy(&mut self, surface: Surface<'_, T>) -> T
    where
        M: Energy<T>,
    {
        self.check(surface);
        self.method
            .energy(&self.execution, surface, &mut self.workspace)
    }

    /// See [`Force::add_force`].
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices, and as [`Self::energy`].
    #[track_caller]
    pub fn add_force(
        &mut self,
        surface: Surface<'_, T>,
        force: &mut (impl PointsMut<Scalar = T> + ?Sized),
    ) where
        M: Force<T>,
    {
        self.check(surface);
        let force = force.coordinates_mut();
        self.method
            .add_force(&self.execution, surface, &mut self.workspace, force);
    }

    /// See [`Conservative::add_force_and_energy`].
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices, and as [`Self::energy`].
    #[track_caller]
    pub fn add_force_and_energy(
        &mut self,
        surface: Surface<'_, T>,
        force: &mut (impl PointsMut<Scalar = T> + ?Sized),
    ) -> T
    where
        M: Conservative<T>,
    {
        self.check(surface);
        let force = force.coordinates_mut();
        self.method
            .add_force_and_energy(&self.execution, surface, &mut self.workspace, force)
    }

    /// See [`ForceDensity::force_density`].
    ///
    /// # Panics
    /// If `density` has fewer entries than the surface has vertices, and as [`Self::energy`].
    #[track_caller]
    pub fn force_density(
        &mut self,
        surface: Surface<'_, T>,
        density: &mut (impl PointsMut<Scalar = T> + ?Sized),
    ) where
        M: ForceDensity<T>,
    {
        self.check(surface);
        let density = density.coordinates_mut();
        self.method
            .force_density(&self.execution, surface, &mut self.workspace, density);
    }

    /// Measures the surface: n, H, K and A at each vertex, see [`Curvatures::curvatures`].
    ///
    /// # Panics
    /// As [`Self::energy`].
    #[track_caller]
    pub fn curvatures(&mut self, surface: Surface<'_, T>) -> &[Curvature<T>]
    where
        M: Curvatures<T>,
    {
        self.check(surface);
        let vertices = surface.mesh().vertex_count();
        self.curvature.resize(vertices, Curvature::default());
        let curvature = &mut self.curvature[..];
        self.method
            .curvatures(&self.execution, surface, &mut self.workspace, curvature);
        curvature
    }

    /// Sets `laplacian` to `Δ_S field` on the surface that [`Self::curvatures`] measured last, for a
    /// field of D numbers per vertex, see [`LaplaceBeltrami::apply`].
    ///
    /// # Panics
    /// If `field` or `laplacian` have fewer entries than the surface has vertices, or no surface has
    /// been measured, and as [`Self::energy`].
    #[track_caller]
    pub fn apply<const D: usize>(
        &self,
        surface: Surface<'_, T>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) where
        M: LaplaceBeltrami<T>,
    {
        self.check(surface);
        self.method
            .apply(&self.execution, surface, &self.workspace, field, laplacian);
    }

    /// The same as [`Self::apply`] for a scalar field.
    ///
    /// # Panics
    /// As [`Self::apply`].
    #[track_caller]
    pub fn apply_to_scalar(&self, surface: Surface<'_, T>, field: &[T], laplacian: &mut [T])
    where
        M: LaplaceBeltrami<T>,
    {
        self.check(surface);
        self.method
            .apply_to_scalar(&self.execution, surface, &self.workspace, field, laplacian);
    }

    /// Fills `rows` with the operator of the surface that [`Self::curvatures`] measured last, see
    /// [`LaplaceBeltrami::assemble`].
    ///
    /// # Panics
    /// If no surface has been measured, and as [`Self::energy`].
    #[track_caller]
    pub fn assemble(&self, surface: Surface<'_, T>, rows: &mut Rows<T>)
    where
        M: LaplaceBeltrami<T>,
    {
        self.check(surface);
        self.method.assemble(surface, &self.workspace, rows);
    }

    /// See [`Method::inspect`].
    ///
    /// # Panics
    /// As [`Self::energy`].
    #[track_caller]
    pub fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.check(surface);
        self.method.inspect(surface, &self.workspace, report);
    }

    /// The findings of [`Self::inspect`] and those of [`Noise`] in the positions, with a flag for each
    /// vertex that they concern. The estimate of the noise takes as long as a few thousand fits of
    /// [`Jet`](crate::Jet); [`Self::inspect`] takes almost no time.
    ///
    /// # Panics
    /// As [`Self::energy`].
    #[track_caller]
    pub fn quality(&self, surface: Surface<'_, T>) -> Quality {
        Quality::gather(surface.mesh(), |report| {
            self.inspect(surface, report);
            Noise::of(&self.execution, surface).inspect(surface, report);
        })
    }
}

#[track_caller]
fn check<T: Real>(method: &impl Method<T>) {
    if let Err(error) = method.check() {
        panic!("{error}");
    }
}
