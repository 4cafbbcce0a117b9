//! A functional chosen at run time.

use super::{EnclosedVolume, Functional, TotalArea, TotalMeanCurvature};
use crate::components::Components;
use crate::element::Execution;
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;

/// A functional that is chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// [`TotalArea`].
    Area,
    /// [`EnclosedVolume`].
    Volume,
    /// [`TotalMeanCurvature`].
    MeanCurvature,
}

/// Memory of a [`Quantity`]: the workspace of the functional it stands for.
#[derive(Clone, Debug)]
pub enum QuantityMemory<T: Real> {
    /// The workspace of [`TotalArea`].
    Area(Workspace<T, TotalArea>),
    /// The workspace of [`EnclosedVolume`].
    Volume(Workspace<T, EnclosedVolume>),
    /// The workspace of [`TotalMeanCurvature`].
    MeanCurvature(Workspace<T, TotalMeanCurvature>),
}

impl<T: Real> Method<T> for Quantity {
    type Memory = QuantityMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> QuantityMemory<T> {
        match self {
            Self::Area => QuantityMemory::Area(TotalArea.workspace(mesh)),
            Self::Volume => QuantityMemory::Volume(EnclosedVolume.workspace(mesh)),
            Self::MeanCurvature => {
                QuantityMemory::MeanCurvature(TotalMeanCurvature.workspace(mesh))
            }
        }
    }
}

impl Quantity {
    /// Refuses a workspace that was made for another quantity.
    fn expect<T: Real>(self, memory: &QuantityMemory<T>) {
        let of_memory = match memory {
            QuantityMemory::Area(_) => Self::Area,
            QuantityMemory::Volume(_) => Self::Volume,
            QuantityMemory::MeanCurvature(_) => Self::MeanCurvature,
        };
        assert!(
            self == of_memory,
            "Quantity::{self:?} was given a workspace of Quantity::{of_memory:?}: make one by \
             Method::workspace of this quantity"
        );
    }
}

impl<T: Real> Functional<T> for Quantity {
    fn components<'a>(&self, workspace: &'a Workspace<T, Self>) -> &'a Components {
        match workspace.memory() {
            QuantityMemory::Area(workspace) => TotalArea.components(workspace),
            QuantityMemory::Volume(workspace) => EnclosedVolume.components(workspace),
            QuantityMemory::MeanCurvature(workspace) => TotalMeanCurvature.components(workspace),
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
            QuantityMemory::Area(workspace) => {
                TotalArea.values(execution, surface, workspace, values);
            }
            QuantityMemory::Volume(workspace) => {
                EnclosedVolume.values(execution, surface, workspace, values);
            }
            QuantityMemory::MeanCurvature(workspace) => {
                TotalMeanCurvature.values(execution, surface, workspace, values);
            }
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
            QuantityMemory::Area(workspace) => {
                TotalArea.add_gradient(execution, surface, workspace, weights, gradient);
            }
            QuantityMemory::Volume(workspace) => {
                EnclosedVolume.add_gradient(execution, surface, workspace, weights, gradient);
            }
            QuantityMemory::MeanCurvature(workspace) => {
                TotalMeanCurvature.add_gradient(execution, surface, workspace, weights, gradient);
            }
        }
    }
}
