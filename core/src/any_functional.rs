//! A functional chosen at run time.

use crate::bending::PatchFunctional;
use crate::components::Components;
use crate::element::Execution;
use crate::functional::{EnclosedVolume, Functional, TotalArea, TotalMeanCurvature};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use alloc::boxed::Box;

/// A functional that is chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AnyFunctional {
    /// [`TotalArea`].
    Area,
    /// [`EnclosedVolume`].
    Volume,
    /// [`TotalMeanCurvature`].
    MeanCurvature,
    /// [`PatchFunctional`].
    OfPatches(PatchFunctional),
}

/// Memory of a [`AnyFunctional`]: the workspace of the functional it stands for.
#[derive(Clone, Debug)]
pub enum AnyFunctionalMemory<T: Real> {
    /// The workspace of [`TotalArea`].
    Area(Workspace<T, TotalArea>),
    /// The workspace of [`EnclosedVolume`].
    Volume(Workspace<T, EnclosedVolume>),
    /// The workspace of [`TotalMeanCurvature`].
    MeanCurvature(Workspace<T, TotalMeanCurvature>),
    /// The workspace of [`PatchFunctional`].
    OfPatches(PatchFunctional, Box<Workspace<T, PatchFunctional>>),
}

impl<T: Real> Method<T> for AnyFunctional {
    type Memory = AnyFunctionalMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> AnyFunctionalMemory<T> {
        match self {
            Self::Area => AnyFunctionalMemory::Area(TotalArea.workspace(mesh)),
            Self::Volume => AnyFunctionalMemory::Volume(EnclosedVolume.workspace(mesh)),
            Self::MeanCurvature => {
                AnyFunctionalMemory::MeanCurvature(TotalMeanCurvature.workspace(mesh))
            }
            Self::OfPatches(functional) => {
                AnyFunctionalMemory::OfPatches(*functional, Box::new(functional.workspace(mesh)))
            }
        }
    }
}

impl AnyFunctional {
    /// Refuses a workspace that was made for another quantity.
    fn expect<T: Real>(self, memory: &AnyFunctionalMemory<T>) {
        let of_memory = match memory {
            AnyFunctionalMemory::Area(_) => Self::Area,
            AnyFunctionalMemory::Volume(_) => Self::Volume,
            AnyFunctionalMemory::MeanCurvature(_) => Self::MeanCurvature,
            AnyFunctionalMemory::OfPatches(functional, _) => Self::OfPatches(*functional),
        };
        assert!(
            self == of_memory,
            "AnyFunctional::{self:?} was given a workspace of AnyFunctional::{of_memory:?}: make one by \
             Method::workspace of this quantity"
        );
    }
}

impl<T: Real> Functional<T> for AnyFunctional {
    fn components<'a>(&self, workspace: &'a Workspace<T, Self>) -> &'a Components {
        match workspace.memory() {
            AnyFunctionalMemory::Area(workspace) => TotalArea.components(workspace),
            AnyFunctionalMemory::Volume(workspace) => EnclosedVolume.components(workspace),
            AnyFunctionalMemory::MeanCurvature(workspace) => {
                TotalMeanCurvature.components(workspace)
            }
            AnyFunctionalMemory::OfPatches(functional, workspace) => {
                functional.components(workspace)
            }
        }
    }

    fn values(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        values: &mut [T],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.expect(memory);
        match memory {
            AnyFunctionalMemory::Area(workspace) => {
                TotalArea.values(execution, surface, workspace, values);
            }
            AnyFunctionalMemory::Volume(workspace) => {
                EnclosedVolume.values(execution, surface, workspace, values);
            }
            AnyFunctionalMemory::MeanCurvature(workspace) => {
                TotalMeanCurvature.values(execution, surface, workspace, values);
            }
            AnyFunctionalMemory::OfPatches(functional, workspace) => {
                functional.values(execution, surface, workspace, values);
            }
        }
    }

    fn add_measured_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        if let (Self::OfPatches(own), AnyFunctionalMemory::OfPatches(functional, workspace)) =
            (self, memory)
            && own == functional
        {
            own.add_measured_gradient(execution, surface, workspace, weights, gradient);
        } else {
            self.add_gradient(execution, surface, workspace, weights, gradient);
        }
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.expect(memory);
        match memory {
            AnyFunctionalMemory::Area(workspace) => {
                TotalArea.add_gradient(execution, surface, workspace, weights, gradient);
            }
            AnyFunctionalMemory::Volume(workspace) => {
                EnclosedVolume.add_gradient(execution, surface, workspace, weights, gradient);
            }
            AnyFunctionalMemory::MeanCurvature(workspace) => {
                TotalMeanCurvature.add_gradient(execution, surface, workspace, weights, gradient);
            }
            AnyFunctionalMemory::OfPatches(functional, workspace) => {
                functional.add_gradient(execution, surface, workspace, weights, gradient);
            }
        }
    }
}
