//! Energies of a functional of each component.

use super::Targets;
use crate::any_functional::AnyFunctional;
use crate::diagnostic::Finding;
use crate::element::Execution;
use crate::functional::{
    BoundaryLength, EnclosedVolume, Functional, TotalArea, TotalGaussianCurvature,
};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// An energy φ_c(F) of a functional F of each connected component c.
pub trait Potential<T: Real> {
    /// φ_c and its derivative.
    ///
    /// # Panics
    /// If the potential has parameters for each component, but none for this one.
    fn at(&self, component: usize, value: T) -> [T; 2];

    /// Checks the parameters, see [`Method::check`].
    ///
    /// # Errors
    /// The first parameter that is not finite.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

/// `φ = slope · F`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<T> {
    /// Energy per unit of F.
    pub slope: T,
}

impl<T: Real> Potential<T> for Linear<T> {
    fn at(&self, _component: usize, value: T) -> [T; 2] {
        [self.slope * value, self.slope]
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite(
            "tension, pressure difference or Gaussian modulus",
            self.slope,
        )
    }
}

/// `φ = k/2 (F − F0)²/|F0|`; 0 where F0 = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadratic<T> {
    /// k, in units of energy per unit of F.
    pub modulus: T,
    /// F0 of each component.
    pub targets: Targets<T>,
}

impl<T: Real> Potential<T> for Quadratic<T> {
    fn at(&self, component: usize, value: T) -> [T; 2] {
        let target = self.targets.at(component);
        let excess = value - target;
        let slope = self.modulus * excess * target.abs().reciprocal_or_zero();
        [T::constant(0.5) * excess * slope, slope]
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("modulus of a penalty", self.modulus)?;
        self.targets.check("target of a penalty")
    }
}

/// The energy `E = Σ_c φ_c(F_c)` of a functional F, and its exact gradient
/// `F_i = −φ_c′(F_c) ∂F_c/∂x_i`: one reduction, one pass over the elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PotentialOf<F, P> {
    /// F.
    pub functional: F,
    /// φ.
    pub potential: P,
}

/// `E = k/2 Σ_c (F_c − F0_c)²/|F0_c|`: of [`TotalArea`] with k in energy per area, of
/// [`EnclosedVolume`] with k a pressure.
pub type Penalty<T, F = AnyFunctional> = PotentialOf<F, Quadratic<T>>;
/// `E = σ A`, σ the surface tension, positive if it contracts.
pub type SurfaceTension<T> = PotentialOf<TotalArea, Linear<T>>;
/// `E = −Δp V`, Δp the pressure inside minus the one outside: positive inflates. It does not act on
/// components with boundary.
pub type OsmoticPressure<T> = PotentialOf<EnclosedVolume, Linear<T>>;
/// `E = Λ L`, Λ the line tension of the boundary and L its length, positive if it contracts: J. D.
/// Litster, Phys. Lett. A 53 (1975) 193. It does not act on components without boundary.
pub type LineTension<T> = PotentialOf<BoundaryLength, Linear<T>>;
/// `E = κ_G ∫ K dS`, κ_G the Gaussian modulus: W. Helfrich, Z. Naturforsch. C 28 (1973) 693. Its forces
/// act at the boundary alone; on a component without boundary the energy is the constant 2πχ κ_G.
pub type GaussianBending<T> = PotentialOf<TotalGaussianCurvature, Linear<T>>;

impl<T: Real, F> PotentialOf<F, Quadratic<T>> {
    /// The penalty with modulus k and targets F0.
    pub fn new(functional: F, modulus: T, targets: impl Into<Targets<T>>) -> Self {
        let targets = targets.into();
        Self {
            functional,
            potential: Quadratic { modulus, targets },
        }
    }
}

impl<T: Real> PotentialOf<TotalArea, Linear<T>> {
    /// The energy with surface tension σ, energy per area.
    pub fn new(tension: T) -> Self {
        Self {
            functional: TotalArea,
            potential: Linear { slope: tension },
        }
    }
}

impl<T: Real> PotentialOf<BoundaryLength, Linear<T>> {
    /// The energy with line tension Λ, energy per length.
    pub fn new(tension: T) -> Self {
        Self {
            functional: BoundaryLength,
            potential: Linear { slope: tension },
        }
    }
}

impl<T: Real> PotentialOf<TotalGaussianCurvature, Linear<T>> {
    /// The energy with Gaussian modulus κ_G, an energy.
    pub fn new(modulus: T) -> Self {
        Self {
            functional: TotalGaussianCurvature,
            potential: Linear { slope: modulus },
        }
    }
}

impl<T: Real> PotentialOf<EnclosedVolume, Linear<T>> {
    /// The energy with pressure difference Δp, inside minus outside, energy per volume.
    pub fn new(difference: T) -> Self {
        Self {
            functional: EnclosedVolume,
            potential: Linear { slope: -difference },
        }
    }
}

/// Memory of [`PotentialOf`].
#[derive(Clone, Debug)]
pub struct PotentialMemory<T, W> {
    /// The functional's workspace.
    functional: W,
    values: Vec<T>,
    /// −φ′.
    weights: Vec<T>,
}

impl<T: Real, W> PotentialMemory<T, W> {
    /// F of each component in the last evaluation.
    pub fn values(&self) -> &[T] {
        &self.values
    }
}

impl<F, P> PotentialOf<F, P> {
    fn measure<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut PotentialMemory<T, Workspace<T, F>>,
    ) where
        F: Functional<T>,
    {
        let functional = &self.functional;
        let PotentialMemory {
            functional: own,
            values,
            ..
        } = memory;
        values.resize(functional.component_count(own), T::zero());
        functional.values(execution, surface, own, values);
    }

    fn energy_of<T: Real>(&self, values: &[T]) -> T
    where
        P: Potential<T>,
    {
        let energy = |(component, &value)| self.potential.at(component, value)[0];
        values.iter().enumerate().map(energy).sum()
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Method<T> for PotentialOf<F, P> {
    type Memory = PotentialMemory<T, Workspace<T, F>>;

    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory {
        PotentialMemory {
            functional: self.functional.workspace(mesh),
            values: Vec::new(),
            weights: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.functional.check()?;
        self.potential.check()
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.functional.inspect(surface, &memory.functional, report);
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Energy<T> for PotentialOf<F, P> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.energy_of(&memory.values)
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Force<T> for PotentialOf<F, P> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        self.add_force_and_energy(execution, surface, workspace, force);
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Conservative<T> for PotentialOf<F, P> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        let PotentialMemory {
            functional,
            values,
            weights,
        } = memory;
        weights.clear();
        let weight = |(component, &value)| -self.potential.at(component, value)[1];
        weights.extend(values.iter().enumerate().map(weight));
        self.functional
            .add_measured_gradient(execution, surface, functional, weights, force);
        self.energy_of(values)
    }
}
