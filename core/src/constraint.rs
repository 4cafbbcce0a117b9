//! Exact constraints on area, volume and area difference of each component, and energies of these
//! quantities.

use crate::any_functional::AnyFunctional;
use crate::components::Components;
use crate::element::{Execution, Serial};
use crate::functional::{ComponentElements, Functional};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::{Surface, SurfaceError};
use crate::vec3::{add, dot, norm, scale, sub};
use alloc::vec::Vec;

mod area_difference;
mod potential;
mod system;

pub use area_difference::{AreaDifference, AreaDifferenceMemory};
pub use potential::{
    GaussianBending, LineTension, Linear, OsmoticPressure, Penalty, Potential, PotentialMemory,
    PotentialOf, Quadratic, SurfaceTension,
};
use system::System;

/// Target values of a functional, one per connected component or the same for all.
#[derive(Clone, Debug, PartialEq)]
pub enum Targets<T> {
    /// One value for all components.
    Same(T),
    /// One value per component.
    PerComponent(Vec<T>),
}

impl<T> From<T> for Targets<T> {
    fn from(same: T) -> Self {
        Self::Same(same)
    }
}

impl<T: Real> Targets<T> {
    /// The current values of the components of a surface.
    pub fn measured<F: Functional<T>>(functional: &F, surface: Surface<'_, T>) -> Self {
        let mut workspace = functional.workspace(surface.mesh());
        let mut values = alloc::vec![T::zero(); functional.component_count(&workspace)];
        functional.values(&Serial, surface, &mut workspace, &mut values);
        Self::PerComponent(values)
    }

    /// The target of a component.
    ///
    /// # Panics
    /// If there is one value per component, but none for this one.
    #[inline]
    pub fn at(&self, component: usize) -> T {
        match self {
            Self::Same(target) => *target,
            Self::PerComponent(targets) => targets[component],
        }
    }

    /// Returns an error unless all targets are finite.
    fn check(&self, parameter: &'static str) -> Result<(), ParameterError> {
        match self {
            Self::Same(target) => ParameterError::unless_finite(parameter, *target),
            Self::PerComponent(targets) => {
                ParameterError::unless_all_finite(parameter, targets.iter().copied())
            }
        }
    }
}

/// A functional and its target.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint<T, F = AnyFunctional> {
    /// F.
    pub functional: F,
    /// F0 of each component.
    pub targets: Targets<T>,
}

/// Functionals that are held exactly at their targets in each connected component.
///
/// [`Self::correct`] moves positions onto `F = F0`. [`Self::project`] removes the components of
/// forces or velocities that violate it. Both work in the span of the gradients ∂F/∂x and weight
/// all vertices equally (no masses, no areas). The correction is therefore the shortest
/// displacement to first order, and the projected force is the constrained gradient of the energy
/// in the coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraints<T, F = AnyFunctional> {
    /// The constraints. They should be few, because their equations are solved by a dense solver.
    pub constraints: Vec<Constraint<T, F>>,
}

/// Memory of [`Constraints`].
#[derive(Clone, Debug)]
pub struct ConstraintsMemory<T, W> {
    /// The workspace of each constraint's functional.
    functionals: Vec<W>,
    vertices: ComponentElements<1>,
    /// F of each component, constraint by constraint.
    values: Vec<T>,
    ones: Vec<T>,
    /// ∂F/∂x of each vertex, constraint by constraint.
    gradients: Vec<[T; 3]>,
    /// λ of each component, constraint by constraint.
    multipliers: Vec<T>,
    system: System<T>,
    saved: Vec<[T; 3]>,
}

impl<T: Real, W> ConstraintsMemory<T, W> {
    /// The multipliers λ of the constraints on a component in the last [`Constraints::project`],
    /// which removed Σ λ ∂F/∂x from the forces. At equilibrium the multiplier of an area is the
    /// tension that balances the forces, and the multiplier of a volume is minus the pressure
    /// difference.
    ///
    /// # Panics
    /// If there is no such component.
    pub fn multipliers(&self, component: usize) -> &[T] {
        let count = self.functionals.len();
        &self.multipliers[component * count..(component + 1) * count]
    }
}

/// Result of a correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<T> {
    /// The number of steps.
    pub steps: usize,
    /// The largest remaining |F/F0 − 1|; where F0 = 0, |F| over its rounding error.
    pub residual: T,
}

/// The reason why positions could not be moved onto the constraints. The positions are unchanged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// Positions do not fit the mesh, or are not finite.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// A gradient is zero or depends on the others: sin² of its angle with their span is below
    /// 1/(3N), N the number of vertices. Discretisation errors of an uneven mesh alone cause such
    /// an angle.
    #[error(
        "constraint {constraint} of component {component} cannot be met independently of the others: \
         its gradient is zero or parallel to theirs, as those of area and volume are on a \
         sphere"
    )]
    Dependent {
        /// The component.
        component: usize,
        /// The constraint, counted from 0.
        constraint: usize,
    },
    /// A target is NaN or infinite.
    #[error(
        "the target of constraint {constraint} of component {component} is not a finite number"
    )]
    Target {
        /// The component.
        component: usize,
        /// The constraint, counted from 0.
        constraint: usize,
    },
    /// The iteration did not converge.
    #[error(
        "constraint {constraint} of component {component} still has a relative error of {residual:e} \
         after {steps} steps: its target cannot be reached from here"
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

/// Maximal number of steps. Newton's method doubles the correct digits with each step, so fewer are
/// enough near a solution.
const STEPS: usize = 32;
/// Bound on what [`least_squared_sine`] gives on coarse meshes.
const LARGEST_LEAST: f64 = 0.01;
/// Error, in roundings of a value, below which a target counts as reached.
const ROUNDINGS: f64 = 8.0;

impl<T: Real, F: Functional<T>> Method<T> for Constraints<T, F> {
    type Memory = ConstraintsMemory<T, Workspace<T, F>>;

    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory {
        let functionals = self.constraints.iter();
        let vertices = (0..mesh.vertex_count() as u32).map(|vertex| [vertex]);
        ConstraintsMemory {
            functionals: functionals.map(|c| c.functional.workspace(mesh)).collect(),
            vertices: ComponentElements::new(Components::new(mesh), vertices),
            values: Vec::new(),
            ones: Vec::new(),
            gradients: Vec::new(),
            multipliers: Vec::new(),
            system: System::default(),
            saved: Vec::new(),
        }
    }
}

impl<T: Real, F: Functional<T>> Constraints<T, F> {
    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut ConstraintsMemory<T, Workspace<T, F>>,
    ) {
        let components = memory.vertices.components().count();
        let count = self.constraints.len();
        memory.values.resize(count * components, T::zero());
        for (k, constraint) in self.constraints.iter().enumerate() {
            let values = &mut memory.values[k * components..(k + 1) * components];
            let own = &mut memory.functionals[k];
            constraint
                .functional
                .values(execution, surface, own, values);
        }
    }

    /// Sets the gradients on a surface, which may be the one that was measured last.
    fn differentiate(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut ConstraintsMemory<T, Workspace<T, F>>,
        is_measured: bool,
    ) {
        let vertices = surface.mesh().vertex_count();
        let count = self.constraints.len();
        memory.gradients.clear();
        memory.gradients.resize(count * vertices, [T::zero(); 3]);
        let ones = &mut memory.ones;
        ones.resize(memory.vertices.components().count(), T::one());
        for (k, constraint) in self.constraints.iter().enumerate() {
            let gradient = &mut memory.gradients[k * vertices..(k + 1) * vertices];
            let (functional, own) = (&constraint.functional, &mut memory.functionals[k]);
            if is_measured {
                functional.add_measured_gradient(execution, surface, own, ones, gradient);
            } else {
                functional.add_gradient(execution, surface, own, ones, gradient);
            }
        }
    }

    /// Moves `positions` onto the constraints by steps `x += Σ λ ∂F/∂x`, with λ such that each F
    /// reaches its F0 to first order. The steps end when each F is exact within the rounding of its
    /// terms: `|F − F0| ≤ 8 ε (|F0| + Σ |∂F/∂x| |x|)`. Components that satisfy this at the start
    /// are not moved.
    ///
    /// # Errors
    /// If positions do not fit the mesh, a target is not finite, gradients depend on each other, or
    /// the iteration does not converge. Positions are then unchanged.
    ///
    /// # Panics
    /// If there is one target per component, but none for one, or the mesh is another than that of
    /// the workspace.
    pub fn correct(
        &self,
        execution: &impl Execution,
        mesh: &TriangleMesh,
        positions: &mut [[T; 3]],
        workspace: &mut Workspace<T, Self>,
    ) -> Result<Correction<T>, ConstraintError> {
        let memory = workspace.for_mesh_mut(mesh);
        memory.saved.clear();
        memory.saved.extend_from_slice(positions);
        let result = self.move_onto(execution, mesh, positions, memory);
        if result.is_err() {
            positions.copy_from_slice(&memory.saved);
        }
        result
    }

    fn move_onto(
        &self,
        execution: &impl Execution,
        mesh: &TriangleMesh,
        positions: &mut [[T; 3]],
        memory: &mut ConstraintsMemory<T, Workspace<T, F>>,
    ) -> Result<Correction<T>, ConstraintError> {
        let count = self.constraints.len();
        let components = memory.vertices.components().count();
        self.refuse_targets(components)?;
        let mut steps = 0;
        let mut worst = Worst::default();
        loop {
            let surface = match Surface::new(mesh, positions) {
                // Positions were in range at the start: the steps have left it.
                Err(SurfaceError::NotFinite { .. } | SurfaceError::TooLarge { .. })
                    if steps > 0 =>
                {
                    return Err(worst.not_reached(steps));
                }
                surface => surface?,
            };
            self.measure(execution, surface, memory);
            worst = Worst::default();
            if self.is_met(&memory.values, components, &mut worst) {
                let residual = worst.residual;
                return Ok(Correction { steps, residual });
            }

            self.differentiate(execution, surface, memory, true);
            memory.multipliers.clear();
            memory.multipliers.resize(count * components, T::zero());
            worst = Worst::default();
            let mut there = true;
            for component in 0..components {
                there &= self.approach(execution, component, positions, memory, &mut worst)?;
            }
            if there {
                let residual = worst.residual;
                return Ok(Correction { steps, residual });
            }
            if steps == STEPS {
                return Err(worst.not_reached(steps));
            }
            let (gradients, multipliers) = (&memory.gradients, &memory.multipliers);
            let of_vertex = memory.vertices.components().of_vertex();
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

    /// Refuses targets that are not finite.
    fn refuse_targets(&self, components: usize) -> Result<(), ConstraintError> {
        for component in 0..components {
            for (k, constraint) in self.constraints.iter().enumerate() {
                if !constraint.targets.at(component).is_finite() {
                    return Err(ConstraintError::Target {
                        component,
                        constraint: k,
                    });
                }
            }
        }
        Ok(())
    }

    /// Whether every value is its target to rounding.
    fn is_met(&self, values: &[T], components: usize, worst: &mut Worst<T>) -> bool {
        let roundings = T::constant(ROUNDINGS) * T::epsilon();
        let mut met = true;
        for component in 0..components {
            for (k, constraint) in self.constraints.iter().enumerate() {
                let target = constraint.targets.at(component);
                let off = values[k * components + component] - target;
                worst.see(component, k, off.abs() * target.abs().reciprocal_or_zero());
                met &= off.abs() <= roundings * target.abs();
            }
        }
        met
    }

    /// Sets the multipliers that bring a component nearer to its targets, unless it is there to the
    /// rounding of its values: then the result is true.
    fn approach(
        &self,
        execution: &impl Execution,
        component: usize,
        positions: &[[T; 3]],
        memory: &mut ConstraintsMemory<T, Workspace<T, F>>,
        worst: &mut Worst<T>,
    ) -> Result<bool, ConstraintError> {
        let roundings = T::constant(ROUNDINGS) * T::epsilon();
        let count = self.constraints.len();
        let components = memory.vertices.components().count();
        let ConstraintsMemory {
            vertices,
            values,
            gradients,
            multipliers,
            system,
            ..
        } = &mut *memory;
        let vertices = vertices.of(component);
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
            return Ok(true);
        }
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
        Ok(false)
    }

    /// Removes from `field` (nodal forces or velocities) its component in the span of the
    /// constraints' gradients. Afterwards `Σ_i ∂F/∂x_i · field_i = 0` for each F and component, to
    /// rounding. Gradients that depend on others to rounding do not add to the span. The
    /// multipliers stay in [`ConstraintsMemory::multipliers`].
    ///
    /// # Panics
    /// If `field` has fewer entries than the surface has vertices, or the surface another mesh than
    /// that of the workspace.
    pub fn project(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        field: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.differentiate(execution, surface, memory, false);
        let count = self.constraints.len();
        let all = surface.mesh().vertex_count();
        let field = &mut field[..all];
        let ConstraintsMemory {
            vertices: all_vertices,
            gradients,
            multipliers,
            system,
            ..
        } = memory;
        let components = all_vertices.components().count();
        multipliers.clear();
        multipliers.resize(count * components, T::zero());
        let least = T::constant(ROUNDINGS) * T::epsilon();
        for component in 0..components {
            let vertices = all_vertices.of(component);
            system.set_matrix(execution, vertices, gradients, count);
            // The second pass removes the rounding error of the first.
            for _ in 0..2 {
                for k in 0..count {
                    let gradient = &gradients[k * all..];
                    let work = execution.sum(vertices.len(), |at| {
                        let vertex = vertices[at][0] as usize;
                        dot(gradient[vertex], field[vertex])
                    });
                    system.right[k] = work * system.over_norms[k];
                }
                // Gradients that depend on others have no independent component.
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
/// On a sphere the gradients of area and volume are parallel. On meshes of a sphere they differ
/// only because the mesh is uneven (on icospheres by sin² = 0.155/N), and a correction along that
/// difference would be noise. On a sphere that is slightly deformed to reduced volume v, sin² = 4/3
/// (1 − v).
pub fn least_squared_sine<T: Real>(vertices: usize) -> T {
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
        // NaN counts as the largest residual.
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
