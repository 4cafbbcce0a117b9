//! n, H, K and f at the vertices: the strong form over jets.
//!
//! Unlike patches, jets may choose their neighbours by position and flatten the surface before a fit, because
//! n, H, K and f need not be smooth functions of the positions. Near borders and where vertices are close they
//! are much more accurate than what follows from patches.

use super::{Galerkin, GalerkinMemory};
use crate::bending::MaterialParameter;
use crate::bending::strong_form::{Formula, StrongFormMemory};
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::Execution;
use crate::laplacian::Jet;
use crate::mesh::TriangleMesh;
use crate::method::{ForceDensity, Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;

type Memory<T> = StrongFormMemory<T, Workspace<T, Jet<T>>>;

/// Jets with their memory.
#[derive(Clone, Debug)]
pub(super) struct Jets<T: Real> {
    jet: Jet<T>,
    memory: Memory<T>,
}

impl<T: Real> Jets<T> {
    fn new(mesh: &TriangleMesh) -> Self {
        let jet = Jet::for_mesh(mesh);
        let memory = StrongFormMemory::new(jet.workspace(mesh));
        Self { jet, memory }
    }

    /// Reports what [`Jet`] reports.
    pub(super) fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.jet.inspect(surface, self.memory.operator(), report);
    }
}

impl<T: Real> Galerkin<T> {
    /// The strong form over jets, and its memory.
    fn strong_form<'a>(
        &'a self,
        mesh: &TriangleMesh,
        memory: &'a mut GalerkinMemory<T>,
    ) -> (Formula<'a, T, Jet<T>>, &'a mut Memory<T>) {
        let Self {
            modulus,
            spontaneous_curvature,
        } = self;
        MaterialParameter::expect(self, modulus, spontaneous_curvature, mesh);
        memory.is_pointwise = true;
        let Jets { jet, memory } = memory.jets.get_or_insert_with(|| Jets::new(mesh));
        let formula = Formula {
            modulus,
            spontaneous_curvature,
            operator: jet,
        };
        (formula, memory)
    }
}

/// n, H, K and A of jets, see [`Galerkin`].
impl<T: Real> Curvatures<T> for Galerkin<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        let (formula, memory) = self.strong_form(surface.mesh(), memory);
        formula.measure(execution, surface, memory);
        let found = memory.curvature();
        curvature[..found.len()].copy_from_slice(found);
    }

    fn reaches_boundary(&self) -> bool {
        true
    }
}

/// The strong form over jets, as in [`StrongForm`](crate::StrongForm), with its tangential part.
impl<T: Real> ForceDensity<T> for Galerkin<T> {
    fn force_density(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        density: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        let (formula, memory) = self.strong_form(surface.mesh(), memory);
        formula.force_density(execution, surface, memory, density);
    }
}
