//! The energy of the area difference of a bilayer's leaves.
//!
//! U. Seifert, L. Miao, H.-G. Döbereiner, M. Wortis, in The Structure and Conformation of Amphiphilic
//! Membranes (Springer 1992) 93; L. Miao, U. Seifert, M. Wortis, H.-G. Döbereiner, Phys. Rev. E 49
//! (1994) 5389.

use super::Targets;
use crate::element::Execution;
use crate::energy::{Conservative, Energy, Finding, Force, Method};
use crate::functional::{ComponentElements, Functional, TotalArea, TotalMeanCurvature};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// Area difference of the two leaves of a bilayer, per connected component:
///
/// `E = (κ̄/2) (π/(A D²)) (ΔA − ΔA0)² = 2π κ̄ (M − M0)²/A`,
///
/// with `ΔA = 2 D M` the area of the outer leaf less that of the inner one at a distance D,
/// `M = ∫ H dS` and A the area of the component as it is; the force is its exact gradient. D drops
/// out: given is `M0 = ΔA0/(2D)`, a length, 4πR of the sphere that would be free of it. κ̄ is in
/// units of energy; κ̄ → ∞ is the bilayer-coupling model, in which M is a constraint.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaDifference<T> {
    /// κ̄, the modulus of the area difference.
    pub modulus: T,
    /// M0 = ΔA0/(2D) of each component.
    pub targets: Targets<T>,
}

/// Memory of [`AreaDifference`].
#[derive(Clone, Debug, Default)]
pub struct AreaDifferenceMemory<T> {
    means: Vec<T>,
    areas: Vec<T>,
    /// −∂E/∂M, −∂E/∂A.
    weights: [Vec<T>; 2],
}

impl<T: Real> AreaDifference<T> {
    /// With modulus κ̄ and targets M0.
    pub fn new(modulus: T, targets: impl Into<Targets<T>>) -> Self {
        let targets = targets.into();
        Self { modulus, targets }
    }

    /// E, −∂E/∂M and −∂E/∂A of a component.
    fn at(&self, component: usize, mean: T, area: T) -> [T; 3] {
        let excess = mean - self.targets.at(component);
        let density = excess * area.reciprocal_or_zero();
        let slope = T::constant(2.0) * T::PI() * self.modulus * density;
        [excess * slope, -(slope + slope), density * slope]
    }

    fn measure(
        &self,
        execution: &impl Execution,
        plan: &(ComponentElements<4>, ComponentElements<3>),
        surface: Surface<'_, T>,
        memory: &mut AreaDifferenceMemory<T>,
    ) {
        let count = plan.0.components().count();
        let AreaDifferenceMemory { means, areas, .. } = memory;
        means.resize(count, T::zero());
        areas.resize(count, T::zero());
        TotalMeanCurvature.values(execution, &plan.0, surface, &mut (), means);
        TotalArea.values(execution, &plan.1, surface, &mut (), areas);
    }

    fn energy_of(&self, memory: &AreaDifferenceMemory<T>) -> T {
        let values = memory.means.iter().zip(&memory.areas).enumerate();
        let energy = |(component, (&mean, &area))| self.at(component, mean, area)[0];
        values.map(energy).sum()
    }
}

impl<T: Real> Method<T> for AreaDifference<T> {
    type Plan = (ComponentElements<4>, ComponentElements<3>);
    type Memory = AreaDifferenceMemory<T>;

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        (
            Method::<T>::plan(&TotalMeanCurvature, mesh),
            Method::<T>::plan(&TotalArea, mesh),
        )
    }

    fn inspect(
        &self,
        _plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &Self::Memory,
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_degenerate_triangles(report);
    }
}

impl<T: Real> Energy<T> for AreaDifference<T> {
    fn energy(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
    ) -> T {
        self.measure(execution, plan, surface, memory);
        self.energy_of(memory)
    }
}

impl<T: Real> Force<T> for AreaDifference<T> {
    fn add_force(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) {
        self.add_force_and_energy(execution, plan, surface, memory, force);
    }
}

impl<T: Real> Conservative<T> for AreaDifference<T> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) -> T {
        self.measure(execution, plan, surface, memory);
        let AreaDifferenceMemory {
            means,
            areas,
            weights,
        } = &mut *memory;
        for (k, weights) in weights.iter_mut().enumerate() {
            let values = means.iter().zip(&*areas).enumerate();
            let weight = |(component, (&mean, &area))| self.at(component, mean, area)[k + 1];
            weights.clear();
            weights.extend(values.map(weight));
        }
        let [by_mean, by_area] = weights;
        TotalMeanCurvature.add_gradient(execution, &plan.0, surface, &mut (), by_mean, force);
        TotalArea.add_gradient(execution, &plan.1, surface, &mut (), by_area, force);
        self.energy_of(memory)
    }
}
