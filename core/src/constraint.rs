//! Energies of the numbers of a component, and constraints on them: area, volume, area difference.
//!
//! Area difference: U. Seifert, L. Miao, H.-G. Döbereiner, M. Wortis, in The Structure and
//! Conformation of Amphiphilic Membranes (Springer 1992) 93; L. Miao, U. Seifert, M. Wortis,
//! H.-G. Döbereiner, Phys. Rev. E 49 (1994) 5389.

use crate::element::{Execution, Serial};
use crate::energy::{Conservative, Energy, Finding, Force, Method};
use crate::functional::{
    ComponentElements, EnclosedVolume, Functional, Quantity, TotalArea, TotalMeanCurvature,
};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::projection::Components;
use crate::real::Real;
use crate::surface::{Surface, SurfaceError};
use crate::vec3::{add, dot, norm, scale, sub};
use alloc::vec::Vec;

/// What a number of each connected component should be.
#[derive(Clone, Debug, PartialEq)]
pub enum Targets<T> {
    /// The same for all.
    Same(T),
    /// One number a component.
    PerComponent(Vec<T>),
}

impl<T> From<T> for Targets<T> {
    fn from(same: T) -> Self {
        Self::Same(same)
    }
}

impl<T: Real> Targets<T> {
    /// What the components of a surface have.
    pub fn measured<F: Functional<T>>(functional: &F, surface: Surface<'_, T>) -> Self {
        let plan = functional.plan(surface.mesh());
        let mut values = alloc::vec![T::zero(); functional.component_count(&plan)];
        let mut memory = F::Memory::default();
        functional.values(&Serial, &plan, surface, &mut memory, &mut values);
        Self::PerComponent(values)
    }

    /// The target of a component.
    ///
    /// # Panics
    /// If there is one number a component, but none for this one.
    #[inline]
    pub fn at(&self, component: usize) -> T {
        match self {
            Self::Same(target) => *target,
            Self::PerComponent(targets) => targets[component],
        }
    }
}

/// An energy φ_c(F) of one number F of each connected component c.
pub trait Potential<T: Real> {
    /// φ_c and its derivative.
    ///
    /// # Panics
    /// If the potential has parameters for each component, but none for this one.
    fn at(&self, component: usize, value: T) -> [T; 2];
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
}

/// `φ = k/2 (F − F0)²/|F0|`; nothing where F0 = 0.
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
pub type Penalty<T, F = Quantity> = PotentialOf<F, Quadratic<T>>;
/// `E = σ A`, σ the surface tension, positive if it contracts.
pub type SurfaceTension<T> = PotentialOf<TotalArea, Linear<T>>;
/// `E = −Δp V`, Δp the pressure inside minus the one outside: positive inflates. Components with
/// boundary feel none.
pub type OsmoticPressure<T> = PotentialOf<EnclosedVolume, Linear<T>>;

impl<T: Real, F> PotentialOf<F, Quadratic<T>> {
    /// With modulus k and targets F0.
    pub fn new(functional: F, modulus: T, targets: impl Into<Targets<T>>) -> Self {
        let targets = targets.into();
        Self {
            functional,
            potential: Quadratic { modulus, targets },
        }
    }
}

impl<T: Real> PotentialOf<TotalArea, Linear<T>> {
    /// With surface tension σ, energy per area.
    pub fn new(tension: T) -> Self {
        Self {
            functional: TotalArea,
            potential: Linear { slope: tension },
        }
    }
}

impl<T: Real> PotentialOf<EnclosedVolume, Linear<T>> {
    /// With pressure difference Δp, inside minus outside, energy per volume.
    pub fn new(difference: T) -> Self {
        Self {
            functional: EnclosedVolume,
            potential: Linear { slope: -difference },
        }
    }
}

/// Memory of [`PotentialOf`].
#[derive(Clone, Debug, Default)]
pub struct PotentialMemory<T, M> {
    functional: M,
    values: Vec<T>,
    /// −φ′.
    weights: Vec<T>,
}

impl<T: Real, M> PotentialMemory<T, M> {
    /// F of each component, as the last evaluation found it.
    pub fn values(&self) -> &[T] {
        &self.values
    }
}

impl<F, P> PotentialOf<F, P> {
    fn measure<T: Real>(
        &self,
        execution: &impl Execution,
        plan: &F::Plan,
        surface: Surface<'_, T>,
        memory: &mut PotentialMemory<T, F::Memory>,
    ) where
        F: Functional<T>,
    {
        let functional = &self.functional;
        let PotentialMemory {
            functional: own,
            values,
            ..
        } = memory;
        values.resize(functional.component_count(plan), T::zero());
        functional.values(execution, plan, surface, own, values);
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
    type Plan = F::Plan;
    type Memory = PotentialMemory<T, F::Memory>;

    fn plan(&self, mesh: &TriangleMesh) -> F::Plan {
        self.functional.plan(mesh)
    }

    fn inspect(
        &self,
        plan: &F::Plan,
        surface: Surface<'_, T>,
        memory: &Self::Memory,
        report: &mut dyn FnMut(Finding),
    ) {
        self.functional
            .inspect(plan, surface, &memory.functional, report);
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Energy<T> for PotentialOf<F, P> {
    fn energy(
        &self,
        execution: &impl Execution,
        plan: &F::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
    ) -> T {
        self.measure(execution, plan, surface, memory);
        self.energy_of(&memory.values)
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Force<T> for PotentialOf<F, P> {
    fn add_force(
        &self,
        execution: &impl Execution,
        plan: &F::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) {
        self.add_force_and_energy(execution, plan, surface, memory, force);
    }
}

impl<T: Real, F: Functional<T>, P: Potential<T>> Conservative<T> for PotentialOf<F, P> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        plan: &F::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) -> T {
        self.measure(execution, plan, surface, memory);
        let PotentialMemory {
            functional,
            values,
            weights,
        } = memory;
        weights.clear();
        let weight = |(component, &value)| -self.potential.at(component, value)[1];
        weights.extend(values.iter().enumerate().map(weight));
        self.functional
            .add_gradient(execution, plan, surface, functional, weights, force);
        self.energy_of(values)
    }
}

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

/// A functional and what it is held at.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint<T, F = Quantity> {
    /// F.
    pub functional: F,
    /// F0 of each component.
    pub targets: Targets<T>,
}

/// Functionals that are held at their targets, exactly, in each connected component.
///
/// [`Self::correct`] moves positions onto `F = F0`, [`Self::project`] takes from forces or
/// velocities what would leave it. Both work in the span of the gradients ∂F/∂x with all vertices
/// weighted alike (no masses, no areas): the correction is the shortest displacement to first
/// order, and a projected force is the one a minimiser in the coordinates sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraints<T, F = Quantity> {
    /// The constraints; a handful, for their equations are solved densely.
    pub constraints: Vec<Constraint<T, F>>,
}

/// Plan of [`Constraints`].
#[derive(Clone, Debug)]
pub struct ConstraintsPlan<P> {
    functionals: Vec<P>,
    vertices: ComponentElements<1>,
}

/// Memory of [`Constraints`].
#[derive(Clone, Debug, Default)]
pub struct ConstraintsMemory<T, M> {
    functionals: Vec<M>,
    /// F of each component, one constraint after the other.
    values: Vec<T>,
    ones: Vec<T>,
    /// ∂F/∂x of each vertex, one constraint after the other.
    gradients: Vec<[T; 3]>,
    /// Of each component, one constraint after the other.
    multipliers: Vec<T>,
    system: System<T>,
    saved: Vec<[T; 3]>,
}

impl<T: Real, M> ConstraintsMemory<T, M> {
    /// The multipliers λ of the constraints on a component in the last [`Constraints::project`]:
    /// what was taken from the forces is Σ λ ∂F/∂x. At equilibrium that of an area is the tension
    /// that balances the forces, that of a volume minus the pressure difference.
    ///
    /// # Panics
    /// If there is no such component.
    pub fn multipliers(&self, component: usize) -> &[T] {
        let count = self.functionals.len();
        &self.multipliers[component * count..(component + 1) * count]
    }
}

/// What a correction reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<T> {
    /// The number of steps it took.
    pub steps: usize,
    /// The largest |F/F0 − 1| left; |F| over what rounding can tell apart where F0 = 0.
    pub residual: T,
}

/// Why positions could not be moved onto the constraints. They are as they were.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// Positions do not fit the mesh, or are not finite.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// A gradient is zero, or as near to the span of the others as an uneven mesh leaves it where
    /// they are one: sin² of the angle between them is below 1/(3N), N the number of vertices.
    #[error(
        "constraint {constraint} of component {component} cannot be met apart from the others: \
         its gradient is zero or along theirs, as that of the area along that of the volume on a \
         sphere"
    )]
    Dependent {
        /// The component.
        component: usize,
        /// The constraint, counted from 0.
        constraint: usize,
    },
    /// The steps did not lead there.
    #[error(
        "constraint {constraint} of component {component} is still off by a part of {residual:e} \
         after {steps} steps: its target is out of reach from here"
    )]
    NotReached {
        /// The component.
        component: usize,
        /// The constraint, counted from 0.
        constraint: usize,
        /// |F/F0 − 1|.
        residual: f64,
        /// The number of steps.
        steps: usize,
    },
}

/// Newton's method doubles the digits with each step: this many are never needed near a solution.
const STEPS: usize = 32;
/// Bound on what [`least_squared_sine`] gives on coarse meshes.
const LARGEST_LEAST: f64 = 0.01;
/// Roundings of a value that count as reached.
const ROUNDINGS: f64 = 8.0;

impl<T: Real, F: Functional<T>> Method<T> for Constraints<T, F> {
    type Plan = ConstraintsPlan<F::Plan>;
    type Memory = ConstraintsMemory<T, F::Memory>;

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        let functionals = self.constraints.iter();
        let vertices = (0..mesh.vertex_count() as u32).map(|vertex| [vertex]);
        ConstraintsPlan {
            functionals: functionals.map(|c| c.functional.plan(mesh)).collect(),
            vertices: ComponentElements::new(Components::new(mesh), vertices),
        }
    }
}

impl<T: Real, F: Functional<T>> Constraints<T, F> {
    fn measure(
        &self,
        execution: &impl Execution,
        plan: &ConstraintsPlan<F::Plan>,
        surface: Surface<'_, T>,
        memory: &mut ConstraintsMemory<T, F::Memory>,
    ) {
        let components = plan.vertices.components().count();
        let count = self.constraints.len();
        memory.functionals.resize_with(count, F::Memory::default);
        memory.values.resize(count * components, T::zero());
        for (k, constraint) in self.constraints.iter().enumerate() {
            let values = &mut memory.values[k * components..(k + 1) * components];
            let (plan, own) = (&plan.functionals[k], &mut memory.functionals[k]);
            let functional = &constraint.functional;
            functional.values(execution, plan, surface, own, values);
        }
    }

    fn differentiate(
        &self,
        execution: &impl Execution,
        plan: &ConstraintsPlan<F::Plan>,
        surface: Surface<'_, T>,
        memory: &mut ConstraintsMemory<T, F::Memory>,
    ) {
        let vertices = surface.mesh().vertex_count();
        let count = self.constraints.len();
        memory.functionals.resize_with(count, F::Memory::default);
        memory.gradients.clear();
        memory.gradients.resize(count * vertices, [T::zero(); 3]);
        let ones = &mut memory.ones;
        ones.resize(plan.vertices.components().count(), T::one());
        for (k, constraint) in self.constraints.iter().enumerate() {
            let gradient = &mut memory.gradients[k * vertices..(k + 1) * vertices];
            let (plan, own) = (&plan.functionals[k], &mut memory.functionals[k]);
            let functional = &constraint.functional;
            functional.add_gradient(execution, plan, surface, own, ones, gradient);
        }
    }

    /// Moves `positions` onto the constraints: steps `x += Σ λ ∂F/∂x`, with λ such that each F
    /// comes to its F0 to first order, until it is there within some roundings of what it is made
    /// of: `|F − F0| ≤ 8 ε (|F0| + Σ |∂F/∂x| |x|)`. Components that are there are left alone.
    ///
    /// # Errors
    /// If positions do not fit the mesh, gradients depend on each other, or the steps do not lead
    /// there. Positions are then as they were.
    ///
    /// # Panics
    /// If there is one target a component, but none for one.
    pub fn correct(
        &self,
        execution: &impl Execution,
        plan: &ConstraintsPlan<F::Plan>,
        mesh: &TriangleMesh,
        positions: &mut [[T; 3]],
        memory: &mut ConstraintsMemory<T, F::Memory>,
    ) -> Result<Correction<T>, ConstraintError> {
        memory.saved.clear();
        memory.saved.extend_from_slice(positions);
        let result = self.move_onto(execution, plan, mesh, positions, memory);
        if result.is_err() {
            positions.copy_from_slice(&memory.saved);
        }
        result
    }

    fn move_onto(
        &self,
        execution: &impl Execution,
        plan: &ConstraintsPlan<F::Plan>,
        mesh: &TriangleMesh,
        positions: &mut [[T; 3]],
        memory: &mut ConstraintsMemory<T, F::Memory>,
    ) -> Result<Correction<T>, ConstraintError> {
        let count = self.constraints.len();
        let components = plan.vertices.components().count();
        let roundings = T::constant(ROUNDINGS) * T::epsilon();
        let mut steps = 0;
        let mut worst = Worst::default();
        loop {
            let surface = match Surface::new(mesh, positions) {
                Err(SurfaceError::NotFinite { .. }) if steps > 0 => {
                    return Err(worst.not_reached(steps));
                }
                surface => surface?,
            };
            self.measure(execution, plan, surface, memory);
            worst = Worst::default();
            let mut there = true;
            for component in 0..components {
                for (k, constraint) in self.constraints.iter().enumerate() {
                    let target = constraint.targets.at(component);
                    let off = memory.values[k * components + component] - target;
                    worst.see(component, k, off.abs() * target.abs().reciprocal_or_zero());
                    there &= off.abs() <= roundings * target.abs();
                }
            }
            if there {
                let residual = worst.residual;
                return Ok(Correction { steps, residual });
            }

            self.differentiate(execution, plan, surface, memory);
            memory.multipliers.clear();
            memory.multipliers.resize(count * components, T::zero());
            worst = Worst::default();
            there = true;
            for component in 0..components {
                let vertices = plan.vertices.of(component);
                let ConstraintsMemory {
                    values,
                    gradients,
                    multipliers,
                    system,
                    ..
                } = &mut *memory;
                system.set_matrix(execution, vertices, gradients, count);
                let mut here = true;
                for (k, constraint) in self.constraints.iter().enumerate() {
                    let target = constraint.targets.at(component);
                    let off = target - values[k * components + component];
                    let gradient = &gradients[k * positions.len()..];
                    let reach = execution.sum(vertices.len(), |at| {
                        let vertex = vertices[at][0] as usize;
                        norm(gradient[vertex]) * norm(positions[vertex])
                    });
                    let allowed = roundings * (target.abs() + reach);
                    here &= off.abs() <= allowed;
                    let size = if target == T::zero() {
                        reach
                    } else {
                        target.abs()
                    };
                    worst.see(component, k, off.abs() * size.reciprocal_or_zero());
                    system.right[k] = off * system.over_norms[k];
                }
                if here {
                    continue;
                }
                there = false;
                let least = least_squared_sine(vertices.len());
                if let Some(constraint) = system.solve(least) {
                    return Err(ConstraintError::Dependent {
                        component,
                        constraint,
                    });
                }
                for k in 0..count {
                    let multiplier = system.right[k] * system.over_norms[k];
                    multipliers[component * count + k] = multiplier;
                }
            }
            if there {
                let residual = worst.residual;
                return Ok(Correction { steps, residual });
            }
            if steps == STEPS {
                return Err(worst.not_reached(steps));
            }
            let (gradients, multipliers) = (&memory.gradients, &memory.multipliers);
            let of_vertex = plan.vertices.components().of_vertex();
            let vertices = positions.len();
            execution.map(&mut *positions, |vertex, position| {
                let component = of_vertex[vertex] as usize;
                for k in 0..count {
                    let multiplier = multipliers[component * count + k];
                    let gradient = gradients[k * vertices + vertex];
                    *position = add(*position, scale(multiplier, gradient));
                }
            });
            steps += 1;
        }
    }

    /// Takes from `field`, nodal forces or velocities, its part in the span of the constraints'
    /// gradients: afterwards `Σ_i ∂F/∂x_i · field_i = 0` for each F and component, to rounding.
    /// Where gradients depend on each other to rounding, their span is what is left. The
    /// multipliers stay in [`ConstraintsMemory::multipliers`].
    ///
    /// # Panics
    /// If `field` has fewer entries than the surface has vertices.
    pub fn project(
        &self,
        execution: &impl Execution,
        plan: &ConstraintsPlan<F::Plan>,
        surface: Surface<'_, T>,
        memory: &mut ConstraintsMemory<T, F::Memory>,
        field: &mut [[T; 3]],
    ) {
        self.differentiate(execution, plan, surface, memory);
        let count = self.constraints.len();
        let components = plan.vertices.components().count();
        let all = surface.mesh().vertex_count();
        let field = &mut field[..all];
        let ConstraintsMemory {
            gradients,
            multipliers,
            system,
            ..
        } = memory;
        multipliers.clear();
        multipliers.resize(count * components, T::zero());
        let least = T::constant(ROUNDINGS) * T::epsilon();
        for component in 0..components {
            let vertices = plan.vertices.of(component);
            system.set_matrix(execution, vertices, gradients, count);
            // The second pass takes what the first left by rounding.
            for _ in 0..2 {
                for k in 0..count {
                    let gradient = &gradients[k * all..];
                    let work = execution.sum(vertices.len(), |at| {
                        let vertex = vertices[at][0] as usize;
                        dot(gradient[vertex], field[vertex])
                    });
                    system.right[k] = work * system.over_norms[k];
                }
                // Gradients that depend on others have no part of their own.
                system.solve(least);
                for k in 0..count {
                    let multiplier = system.right[k] * system.over_norms[k];
                    multipliers[component * count + k] += multiplier;
                    for &[vertex] in vertices {
                        let vertex = vertex as usize;
                        let part = scale(multiplier, gradients[k * all + vertex]);
                        field[vertex] = sub(field[vertex], part);
                    }
                }
            }
        }
    }
}

/// sin² of the smallest angle between a gradient and the span of the others that a correction
/// accepts: 1/(3N), N the number of vertices, and at most 0.01.
///
/// On meshes of a sphere the gradients of area and volume differ by what the mesh is uneven, on
/// icospheres by sin² = 0.155/N, and a correction along that would be all noise. On a sphere that is
/// slightly deformed to reduced volume v, sin² = 4/3 (1 − v).
fn least_squared_sine<T: Real>(vertices: usize) -> T {
    let bound = (1.0 / (3.0 * vertices as f64)).min(LARGEST_LEAST);
    T::constant(bound).max(T::constant(ROUNDINGS) * T::epsilon())
}

/// The constraint that is farthest from its target.
#[derive(Clone, Copy, Debug, Default)]
struct Worst<T> {
    component: usize,
    constraint: usize,
    residual: T,
}

impl<T: Real> Worst<T> {
    fn see(&mut self, component: usize, constraint: usize, residual: T) {
        // A residual that is not a number is the worst.
        if residual > self.residual || residual.is_nan() {
            *self = Self {
                component,
                constraint,
                residual,
            };
        }
    }

    fn not_reached(self, steps: usize) -> ConstraintError {
        ConstraintError::NotReached {
            component: self.component,
            constraint: self.constraint,
            residual: self.residual.to_f64().unwrap_or(f64::NAN),
            steps,
        }
    }
}

/// The equations of one component, for unit gradients: their scalar products on the left.
#[derive(Clone, Debug, Default)]
struct System<T> {
    matrix: Vec<T>,
    /// What elimination makes of it.
    reduced: Vec<T>,
    /// The right-hand side, then the solution.
    right: Vec<T>,
    /// One over the gradients' lengths; 0 for one without.
    over_norms: Vec<T>,
    solved: Vec<bool>,
}

impl<T: Real> System<T> {
    /// Sets the matrix, and makes room for the right-hand side.
    fn set_matrix(
        &mut self,
        execution: &impl Execution,
        vertices: &[[u32; 1]],
        gradients: &[[T; 3]],
        count: usize,
    ) {
        let all = gradients.len() / count.max(1);
        let product = |j: usize, k: usize| {
            execution.sum(vertices.len(), |at| {
                let vertex = vertices[at][0] as usize;
                dot(gradients[j * all + vertex], gradients[k * all + vertex])
            })
        };
        self.right.resize(count, T::zero());
        self.over_norms.clear();
        let over = |k| product(k, k).sqrt().reciprocal_or_zero();
        self.over_norms.extend((0..count).map(over));
        self.matrix.resize(count * count, T::zero());
        for j in 0..count {
            for k in 0..=j {
                let cosine = product(j, k) * self.over_norms[j] * self.over_norms[k];
                self.matrix[j * count + k] = cosine;
                self.matrix[k * count + j] = cosine;
            }
        }
    }

    /// Solves by elimination in rows and columns, the largest pivot first; a pivot is sin² of the
    /// angle between a gradient and the span of those before. Unknowns whose pivot is not above
    /// `least` are 0; the first of them is returned.
    fn solve(&mut self, least: T) -> Option<usize> {
        let count = self.right.len();
        let Self {
            matrix,
            reduced,
            right,
            solved,
            ..
        } = self;
        reduced.clone_from(matrix);
        solved.clear();
        solved.resize(count, false);
        let mut lost = None;
        for _ in 0..count {
            let left = (0..count).filter(|&k| !solved[k]);
            let larger = |best: usize, k: usize| {
                if reduced[k * count + k] > reduced[best * count + best] {
                    k
                } else {
                    best
                }
            };
            let Some(pivot) = left.reduce(larger) else {
                break;
            };
            let over = reduced[pivot * count + pivot];
            if over <= least || over.is_nan() {
                lost = Some(pivot);
                break;
            }
            solved[pivot] = true;
            for row in (0..count).filter(|&row| row != pivot) {
                let factor = reduced[row * count + pivot] / over;
                for column in 0..count {
                    let part = factor * reduced[pivot * count + column];
                    reduced[row * count + column] -= part;
                }
                let part = factor * right[pivot];
                right[row] -= part;
            }
        }
        for k in 0..count {
            right[k] = if solved[k] {
                right[k] / reduced[k * count + k]
            } else {
                T::zero()
            };
        }
        lost
    }
}
