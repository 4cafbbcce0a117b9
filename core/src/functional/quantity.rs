//! A functional chosen at run time.

use super::{ComponentElements, EnclosedVolume, Functional, TotalArea, TotalMeanCurvature};
use crate::element::Execution;
use crate::energy::Method;
use crate::mesh::TriangleMesh;
use crate::projection::Components;
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

/// The plan of a [`Quantity`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum QuantityPlan {
    /// For sums over triangles.
    Triangles(ComponentElements<3>),
    /// For sums over hinges.
    Hinges(ComponentElements<4>),
}

impl<T: Real> Method<T> for Quantity {
    type Plan = QuantityPlan;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        let triangles = QuantityPlan::Triangles;
        match self {
            Self::Area => triangles(Method::<T>::plan(&TotalArea, mesh)),
            Self::Volume => triangles(Method::<T>::plan(&EnclosedVolume, mesh)),
            Self::MeanCurvature => {
                QuantityPlan::Hinges(Method::<T>::plan(&TotalMeanCurvature, mesh))
            }
        }
    }
}

/// What [`Quantity`] panics with when its plan is another's.
const FOREIGN_PLAN: &str = "the plan was made by another quantity";

impl<T: Real> Functional<T> for Quantity {
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components {
        match plan {
            QuantityPlan::Triangles(plan) => plan.components(),
            QuantityPlan::Hinges(plan) => plan.components(),
        }
    }

    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut (),
        values: &mut [T],
    ) {
        match (self, plan) {
            (Self::Area, QuantityPlan::Triangles(plan)) => {
                TotalArea.values(execution, plan, surface, memory, values);
            }
            (Self::Volume, QuantityPlan::Triangles(plan)) => {
                EnclosedVolume.values(execution, plan, surface, memory, values);
            }
            (Self::MeanCurvature, QuantityPlan::Hinges(plan)) => {
                TotalMeanCurvature.values(execution, plan, surface, memory, values);
            }
            _ => panic!("{FOREIGN_PLAN}"),
        }
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut (),
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        match (self, plan) {
            (Self::Area, QuantityPlan::Triangles(plan)) => {
                TotalArea.add_gradient(execution, plan, surface, memory, weights, gradient);
            }
            (Self::Volume, QuantityPlan::Triangles(plan)) => {
                EnclosedVolume.add_gradient(execution, plan, surface, memory, weights, gradient);
            }
            (Self::MeanCurvature, QuantityPlan::Hinges(plan)) => {
                let quantity = TotalMeanCurvature;
                quantity.add_gradient(execution, plan, surface, memory, weights, gradient);
            }
            _ => panic!("{FOREIGN_PLAN}"),
        }
    }
}
