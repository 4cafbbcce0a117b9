//! Methods: energy, nodal force, force density; the workspace of a method; sums of methods.

use crate::diagnostic::Finding;
use crate::element::Execution;
use crate::mesh::TriangleMesh;
use crate::mesh_identity::MeshIdentity;
pub use crate::parameter::ParameterError;
use crate::real::Real;
use crate::surface::Surface;
use core::fmt;

/// A method or effect: a value with public parameters. Everything that follows from a mesh, and the
/// memory of an evaluation, is in its [`Workspace`].
///
/// [`Prepared`](crate::Prepared) holds the two together.
pub trait Method<T: Real>: Sized {
    /// Results that follow from the connectivity, and memory for one evaluation at a time. It grows
    /// at the first evaluation and is reused by the following ones; after an evaluation it holds
    /// the results of that evaluation.
    type Memory: Clone + fmt::Debug + Send;

    /// Whether triangles without area are missing in the results, so that [`Self::inspect`] reports
    /// them.
    const NEEDS_AREAS: bool = false;

    /// Makes the memory for a mesh: works out what follows from the connectivity.
    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory;

    /// Makes a workspace for surfaces with the mesh `mesh`.
    fn workspace(&self, mesh: &TriangleMesh) -> Workspace<T, Self> {
        Workspace::new(self, mesh)
    }

    /// Checks the parameters: each has to be a finite number. A bending modulus and the square of a
    /// spontaneous curvature are at most the square root of the largest number, because results would
    /// overflow.
    ///
    /// # Errors
    /// The first parameter that is not finite or too large.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    /// Reports everything that made the last evaluation in `workspace` less trustworthy than usual.
    /// Evaluations collect nothing for this report, so it costs nothing unless called.
    ///
    /// # Panics
    /// If the surface has another mesh than that of the workspace.
    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        workspace.for_mesh(surface.mesh());
        if Self::NEEDS_AREAS {
            surface.report_degenerate_triangles(report);
        }
    }
}

/// The data that a method keeps for one mesh: results that follow from the connectivity alone, and
/// memory for one evaluation at a time. Made by [`Method::workspace`]; memory grows at the first
/// evaluation and is reused by the following ones.
///
/// A workspace serves surfaces with the mesh it was made for, or an equal one, and methods that agree in
/// the parameters on which memory depends: most of a [`Jet`](crate::Jet)'s neighbours, control points of
/// a [`LoopSubdivision`](crate::LoopSubdivision), whether a [`Paraboloid`](crate::Paraboloid) is guarded.
/// Every evaluation checks that.
///
/// # Panics
/// An evaluation for a surface with another mesh panics. The message names the method, both meshes,
/// and the remedy: a workspace of that other mesh. So does one by a method with another such parameter.
pub struct Workspace<T: Real, M: Method<T>> {
    mesh: MeshIdentity,
    memory: M::Memory,
}

impl<T: Real, M: Method<T>> Workspace<T, M> {
    pub(crate) fn new(method: &M, mesh: &TriangleMesh) -> Self {
        Self {
            mesh: MeshIdentity::of(mesh),
            memory: method.memory(mesh),
        }
    }

    /// The results of the last evaluation.
    pub fn memory(&self) -> &M::Memory {
        &self.memory
    }

    /// The memory, for an evaluation on the mesh `mesh`: the first line of every implementation.
    ///
    /// # Panics
    /// If the workspace was made for another mesh.
    #[inline]
    #[track_caller]
    pub fn for_mesh(&self, mesh: &TriangleMesh) -> &M::Memory {
        self.mesh.expect::<M>(mesh, REMEDY);
        &self.memory
    }

    /// The memory, to be changed by an evaluation on the mesh `mesh`.
    ///
    /// # Panics
    /// If the workspace was made for another mesh.
    #[inline]
    #[track_caller]
    pub fn for_mesh_mut(&mut self, mesh: &TriangleMesh) -> &mut M::Memory {
        self.mesh.expect::<M>(mesh, REMEDY);
        &mut self.memory
    }
}

impl<T: Real, M: Method<T>> Clone for Workspace<T, M> {
    fn clone(&self) -> Self {
        Self {
            mesh: self.mesh,
            memory: self.memory.clone(),
        }
    }
}

impl<T: Real, M: Method<T>> fmt::Debug for Workspace<T, M> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = formatter.debug_struct("Workspace");
        shown.field("mesh", &self.mesh);
        shown.field("memory", &self.memory).finish()
    }
}

/// The end of the message about a workspace.
const REMEDY: &str = "make a workspace of that mesh, by Method::workspace or Prepared::new";

/// An energy of a surface.
///
/// Laws: invariant under translation, rotation and relabelling of the surface, to rounding.
pub trait Energy<T: Real>: Method<T> {
    /// The energy E.
    ///
    /// # Panics
    /// If the surface has another mesh than that of the workspace.
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T;
}

/// Nodal forces F_i: the force that the membrane exerts on its surroundings at vertex i.
///
/// Laws: rotate with the surface, do not change under its translation, follow a relabelling.
pub trait Force<T: Real>: Method<T> {
    /// Adds the nodal forces to `force`, one entry per vertex.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices, or the surface another mesh than
    /// that of the workspace.
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    );
}

/// Force density f: force per area of membrane, computed by methods in strong form.
///
/// Its integral over the area of a vertex is the nodal force.
pub trait ForceDensity<T: Real>: Method<T> {
    /// Sets `density`, one entry per vertex.
    ///
    /// # Panics
    /// If `density` has fewer entries than the surface has vertices, or the surface another mesh
    /// than that of the workspace.
    fn force_density(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        density: &mut [[T; 3]],
    );
}

/// A force that is the exact negative gradient of its own discrete energy.
///
/// Laws: F_i = −∂E/∂x_i to rounding. Therefore ΣF = 0 and Σ x × F = 0, unless the energy is
/// external, as that of gravity and loads.
pub trait Conservative<T: Real>: Energy<T> + Force<T> {
    /// Adds the nodal forces to `force` and returns the energy, in one evaluation.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices, or the surface another mesh than
    /// that of the workspace.
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        self.add_force(execution, surface, workspace, force);
        self.energy(execution, surface, workspace)
    }
}

/// A conservative method that measures a surface first, and finds its energy and the gradient of that
/// from the results: most are of this kind. Gives [`Energy`], [`Force`] and [`Conservative`].
pub trait TwoPass: Method<<Self as TwoPass>::Scalar> {
    /// The scalar T for which the type is a [`Method`].
    type Scalar: Real;

    /// First pass: sets in `memory` whatever energy and forces are made of.
    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, Self::Scalar>,
        memory: &mut Self::Memory,
    );

    /// The energy of the surface that was measured.
    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, Self::Scalar>,
        memory: &mut Self::Memory,
    ) -> Self::Scalar;

    /// Second pass: adds the nodal forces of the surface that was measured.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, Self::Scalar>,
        memory: &mut Self::Memory,
        force: &mut [[Self::Scalar; 3]],
    );
}

impl<T: Real, M: Method<T> + TwoPass<Scalar = T>> Energy<T> for M {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.measured_energy(execution, surface, memory)
    }
}

impl<T: Real, M: Method<T> + TwoPass<Scalar = T>> Force<T> for M {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.add_measured_force(execution, surface, memory, force);
    }
}

impl<T: Real, M: Method<T> + TwoPass<Scalar = T>> Conservative<T> for M {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.add_measured_force(execution, surface, memory, force);
        self.measured_energy(execution, surface, memory)
    }
}

/// The sum of two methods; longer sums nest: `(a, (b, c))`.
impl<T: Real, A: Method<T>, B: Method<T>> Method<T> for (A, B) {
    type Memory = (Workspace<T, A>, Workspace<T, B>);

    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory {
        (self.0.workspace(mesh), self.1.workspace(mesh))
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.0.check()?;
        self.1.check()
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let (first, second) = workspace.for_mesh(surface.mesh());
        self.0.inspect(surface, first, report);
        self.1.inspect(surface, second, report);
    }
}

impl<T: Real, A: Energy<T>, B: Energy<T>> Energy<T> for (A, B) {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let (first, second) = workspace.for_mesh_mut(surface.mesh());
        self.0.energy(execution, surface, first) + self.1.energy(execution, surface, second)
    }
}

impl<T: Real, A: Force<T>, B: Force<T>> Force<T> for (A, B) {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let (first, second) = workspace.for_mesh_mut(surface.mesh());
        self.0.add_force(execution, surface, first, force);
        self.1.add_force(execution, surface, second, force);
    }
}

impl<T: Real, A: Conservative<T>, B: Conservative<T>> Conservative<T> for (A, B) {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let (first, second) = workspace.for_mesh_mut(surface.mesh());
        self.0
            .add_force_and_energy(execution, surface, first, force)
            + self
                .1
                .add_force_and_energy(execution, surface, second, force)
    }
}
