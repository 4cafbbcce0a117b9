//! The energy of the area difference of the leaflets of a bilayer.
//!
//! U. Seifert, L. Miao, H.-G. Döbereiner, M. Wortis, in The Structure and Conformation of Amphiphilic
//! Membranes (Springer 1992) 93; L. Miao, U. Seifert, M. Wortis, H.-G. Döbereiner, Phys. Rev. E 49
//! (1994) 5389.

use super::Targets;
use crate::element::Execution;
use crate::functional::{Functional, TotalArea, TotalMeanCurvature};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// Area difference of the two leaflets of a bilayer, per connected component:
///
/// `E = (κ̄/2) (π/(A D²)) (ΔA − ΔA0)² = 2π κ̄ (M − M0)²/A`,
///
/// with `ΔA = 2 D M` the area of the outer leaflet minus that of the inner one at a distance D, `M
/// = ∫ H dS`, and A the current area of the component. The force is the exact gradient. D drops
/// out: the parameter is `M0 = ΔA0/(2D)`, a length, equal to 4πR for a relaxed sphere of radius R.
/// κ̄ is in units of energy; κ̄ → ∞ is the bilayer-coupling model, in which M is a constraint.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaDifference<T> {
    /// κ̄, the modulus of the area difference.
    pub modulus: T,
    /// M0 = ΔA0/(2D) of each component.
    pub targets: Targets<T>,
}

/// Memory of [`AreaDifference`].
#[derive(Clone, Debug)]
pub struct AreaDifferenceMemory<T: Real> {
    total_mean_curvature: Workspace<T, TotalMeanCurvature>,
    total_area: Workspace<T, TotalArea>,
    means: Vec<T>,
    areas: Vec<T>,
    /// −∂E/∂M, −∂E/∂A.
    weights: [Vec<T>; 2],
}

impl<T: Real> AreaDifference<T> {
    /// The energy with modulus κ̄ and targets M0.
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
}

impl<T: Real> Method<T> for AreaDifference<T> {
    type Memory = AreaDifferenceMemory<T>;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, mesh: &TriangleMesh) -> AreaDifferenceMemory<T> {
        AreaDifferenceMemory {
            total_mean_curvature: TotalMeanCurvature.workspace(mesh),
            total_area: TotalArea.workspace(mesh),
            means: Vec::new(),
            areas: Vec::new(),
            weights: [Vec::new(), Vec::new()],
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("modulus of the area difference", self.modulus)?;
        self.targets.check("target of ∫ H dS")
    }
}

impl<T: Real> TwoPass for AreaDifference<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut AreaDifferenceMemory<T>,
    ) {
        let AreaDifferenceMemory {
            total_mean_curvature,
            total_area,
            means,
            areas,
            ..
        } = memory;
        let count = TotalArea.component_count(total_area);
        means.resize(count, T::zero());
        areas.resize(count, T::zero());
        TotalMeanCurvature.values(execution, surface, total_mean_curvature, means);
        TotalArea.values(execution, surface, total_area, areas);
    }

    fn measured_energy(
        &self,
        _execution: &impl Execution,
        _surface: Surface<'_, T>,
        memory: &mut AreaDifferenceMemory<T>,
    ) -> T {
        let values = memory.means.iter().zip(&memory.areas).enumerate();
        let energy = |(component, (&mean, &area))| self.at(component, mean, area)[0];
        values.map(energy).sum()
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut AreaDifferenceMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let AreaDifferenceMemory {
            total_mean_curvature,
            total_area,
            means,
            areas,
            weights,
        } = memory;
        for (k, weights) in weights.iter_mut().enumerate() {
            let values = means.iter().zip(&*areas).enumerate();
            let weight = |(component, (&mean, &area))| self.at(component, mean, area)[k + 1];
            weights.clear();
            weights.extend(values.map(weight));
        }
        let [by_mean, by_area] = weights;
        TotalMeanCurvature.add_gradient(execution, surface, total_mean_curvature, by_mean, force);
        TotalArea.add_gradient(execution, surface, total_area, by_area, force);
    }
}
