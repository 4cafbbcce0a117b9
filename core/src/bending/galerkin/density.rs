//! The force density: solution of the equations of the mass matrix.

use super::fit::Jet;
use super::mass::Mass;
use super::shape::Shape;
use super::smoothing::Smoothing;
use super::start::{Laplacians, mean_beyond};
use super::vertices::Work;
use super::{Galerkin, GalerkinMemory};
use crate::element::{Execution, of_vertices};
use crate::lane::{Lane, Several};
use crate::method::{ForceDensity, TwoPass, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{dot, scale};
use alloc::vec::Vec;

/// Vectors of the iteration.
#[derive(Clone, Debug, Default)]
pub(super) struct Solver<T> {
    force: Vec<[T; 3]>,
    coefficients: Coefficients<T>,
    smoothing: Smoothing<T>,
    solution: Vec<T>,
    residual: Vec<T>,
    improved: Vec<T>,
    direction: Vec<T>,
    image: Vec<T>,
    spare: [Vec<T>; 2],
    laplacians: Vec<Several<T>>,
    pub(super) iterations: usize,
}

/// Most iterations.
const MOST: usize = 200;

/// μ, see [`Equations`]: with larger ones f is less accurate on even meshes and takes longer on random ones.
const PENALTY: f64 = 500.0;

/// Powers of S and Sᵀ in the preconditioner: more of them save few iterations.
const PASSES: usize = 2;

/// Diagonal matrices; 0 where a vertex has no fit.
#[derive(Clone, Debug, Default)]
struct Coefficients<T> {
    /// A third of the triangles around each vertex over the mean, and its inverse. Relative to the mean:
    /// squares of forces over areas leave the range of f32 on small surfaces.
    areas: Vec<T>,
    inverses: Vec<T>,
    mean: T,
    /// Penalties over areas.
    penalties: Vec<T>,
}

/// The matrix `K = M + (I − S)ᵀ P (I − S)` of the force density, symmetric and positive.
///
/// Where vertices are close, the displacements that follow from single ones have integrals far from their
/// areas A, of the other sign even, and M hardly determines the differences of f. Let e be the relative error
/// `(M 1)_i/A_i − 1`, and ⟨·⟩ a mean over neighbours. `P = μ A ⟨e²/(1 + e²)⟩` makes f smooth where e is
/// large. S changes smooth fields by the order h⁹; on even meshes e is small, too.
struct Equations<'a, T, X> {
    execution: &'a X,
    shape: &'a Shape<T>,
    mass: &'a mut Mass<T>,
    smoothing: &'a mut Smoothing<T>,
    coefficients: &'a Coefficients<T>,
    work: &'a mut Vec<Work<T>>,
    spare: [&'a mut Vec<T>; 2],
}

impl<T: Real, X: Execution> Equations<'_, T, X> {
    /// Sets `image` to K times `field`.
    fn apply(&mut self, field: &[T], image: &mut [T]) {
        let Self {
            execution,
            shape,
            mass,
            smoothing,
            coefficients,
            work,
            spare: [rough, spread],
        } = self;
        mass.apply(*execution, shape, work, field, image);
        smoothing.smooth(*execution, &shape.plan, field, rough);
        let areas = &coefficients.areas;
        execution.map(&mut rough[..], |i, rough| {
            let penalty = coefficients.mean * areas[i] * coefficients.penalties[i];
            *rough = penalty * (field[i] - *rough);
        });
        smoothing.spread(*execution, &shape.plan, rough, spread);
        execution.map(image, |i, image| *image += rough[i] - spread[i]);
    }

    /// Adds to the solution the multiple of `direction` that leaves the least error, and updates the
    /// residual; false if the multiple is not finite. `along` is the residual times the direction.
    fn advance(
        &mut self,
        direction: &[T],
        along: T,
        image: &mut [T],
        [solution, residual]: [&mut [T]; 2],
    ) -> bool {
        self.apply(direction, image);
        let execution = self.execution;
        let step = along / execution.sum(direction.len(), |i| direction[i] * image[i]);
        if !step.is_finite() {
            return false;
        }
        execution.map(solution, |i, solution| *solution += step * direction[i]);
        execution.map(residual, |i, residual| *residual -= step * image[i]);
        true
    }

    /// Sets `improved` to about the inverse of K times `residual`, times the mean area: A⁻¹ for smooth
    /// fields, `(A + P)⁻¹` for others.
    fn improve(&mut self, residual: &[T], improved: &mut [T]) {
        let Self {
            execution,
            shape,
            smoothing,
            coefficients,
            spare: [from, to],
            ..
        } = self;
        let Coefficients {
            inverses,
            penalties,
            ..
        } = coefficients;
        from.copy_from_slice(residual);
        for _ in 0..PASSES {
            smoothing.spread(*execution, &shape.plan, from, to);
            core::mem::swap(from, to);
        }
        let one = T::one();
        execution.map(&mut from[..], |i, value| {
            let penalty = penalties[i];
            *value = inverses[i] * (penalty / (one + penalty)) * *value;
        });
        for _ in 0..PASSES {
            smoothing.smooth(*execution, &shape.plan, from, to);
            core::mem::swap(from, to);
        }
        execution.map(improved, |i, improved| {
            *improved = inverses[i] / (one + penalties[i]) * residual[i] + from[i];
        });
    }
}

impl<T: Real> Solver<T> {
    /// Sets S and the diagonal matrices.
    fn set(
        &mut self,
        execution: &impl Execution,
        (shape, mass): (&Shape<T>, &mut Mass<T>),
        work: &mut Vec<Work<T>>,
    ) {
        let Shape { plan, sums, .. } = shape;
        let count = sums.len();
        let Self {
            coefficients,
            smoothing,
            direction: ones,
            image: errors,
            ..
        } = self;
        let area = |i: usize| {
            let is_used = plan.members[i].is_some();
            if is_used {
                sums[i][3] / T::constant(3.0)
            } else {
                T::zero()
            }
        };
        let mean = execution.sum(count, area) / T::constant(count as f64);
        coefficients.mean = mean;
        let over = mean.reciprocal_or_zero();
        let Coefficients {
            areas,
            inverses,
            penalties,
            ..
        } = coefficients;
        execution.map(&mut areas[..], |i, share| *share = over * area(i));
        execution.map(&mut inverses[..], |i, inverse| {
            *inverse = areas[i].reciprocal_or_zero();
        });
        execution.map(&mut ones[..], |_, one| *one = T::one());
        mass.integrate(execution, shape, work, ones, errors);
        execution.map(&mut errors[..], |i, error| {
            let relative = over * *error * inverses[i] - T::one();
            let square = relative * relative;
            *error = square / (T::one() + square);
        });
        smoothing.set(
            execution,
            (shape, &mass.neighbours),
            work,
            (areas, mean),
            errors,
        );
        execution.map(&mut penalties[..], |i, penalty| {
            *penalty = T::constant(PENALTY) * smoothing.mean(plan, i);
        });
    }

    /// Makes room, and sets the vectors to 0.
    fn clear(&mut self, count: usize) {
        let Coefficients {
            areas,
            inverses,
            penalties,
            ..
        } = &mut self.coefficients;
        let [first, second] = &mut self.spare;
        for vector in [
            areas,
            inverses,
            penalties,
            &mut self.solution,
            &mut self.residual,
            &mut self.improved,
            &mut self.direction,
            &mut self.image,
            first,
            second,
        ] {
            vector.clear();
            vector.resize(count, T::zero());
        }
    }
}

impl<T: Real> Galerkin<T> {
    /// Sets the direction to the strong form over the jets,
    /// `2 [Δ_S(κ(H − H0)) + 2κ(H − H0)(H² − K + H0 H)]`.
    fn set_strong_form(
        &self,
        execution: &impl Execution,
        (shape, mass): (&Shape<T>, &Mass<T>),
        work: &mut Vec<Work<T>>,
        solver: &mut Solver<T>,
    ) {
        let Solver {
            direction,
            improved: moments,
            laplacians,
            ..
        } = solver;
        let Shape { plan, fits, .. } = shape;
        execution.map(&mut moments[..], |vertex, moment| {
            let mean = match shape.jet(vertex) {
                Some(jet) => jet.mean,
                None => mean_beyond(plan, &mass.neighbours, fits, vertex),
            };
            *moment = self.modulus.at(vertex) * (mean - self.spontaneous_curvature.at(vertex));
        });
        laplacians.resize(plan.blocks.len(), Several::zero());
        let kernel = Laplacians {
            plan,
            neighbours: &mass.neighbours,
            fits,
            values: moments,
        };
        execution.run(work, &mut laplacians[..], &kernel);
        let two = T::constant(2.0);
        execution.map(&mut direction[..], |vertex, direction| {
            let Some((jet, (block, lane))) = shape.jet(vertex).zip(plan.members[vertex]) else {
                *direction = T::zero();
                return;
            };
            let Jet { mean, gaussian, .. } = jet;
            let spontaneous = self.spontaneous_curvature.at(vertex);
            let factor = mean * mean - gaussian + spontaneous * mean;
            let laplacian = laplacians[block as usize].0[usize::from(lane)];
            let density = two * (laplacian + two * moments[vertex] * factor);
            [*direction] = finite_or_zero([density]);
        });
    }

    /// Solves `K f = F·ν` for the force in `solver.force` on closed components. On components with a boundary f is
    /// the strong form: F has the natural boundary conditions, too, which K spreads over the surface.
    fn solve(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GalerkinMemory<T>,
    ) {
        let GalerkinMemory {
            shape,
            mass,
            solver,
            work,
            ..
        } = memory;
        shape.set_jets(execution);
        mass.set(execution, surface, shape, work);
        let count = shape.sums.len();
        solver.clear(count);
        solver.iterations = 0;
        let is_open = &shape.plan.is_open;
        let members = &shape.plan.members;
        let is_solved = (0..count).any(|i| !is_open[i] && members[i].is_some());
        if is_solved {
            solver.set(execution, (shape, mass), work);
        }
        self.set_strong_form(execution, (shape, mass), work, solver);
        let Solver {
            force,
            coefficients,
            smoothing,
            solution,
            residual,
            improved,
            direction,
            image,
            spare: [first, second],
            iterations,
            ..
        } = solver;
        execution.map(&mut solution[..], |i, solution| {
            if is_open[i] {
                *solution = direction[i];
            }
        });
        if !is_solved {
            return;
        }
        let (jets, mean) = (&mass.normals, coefficients.mean);
        execution.map(&mut residual[..], |i, residual| {
            if !is_open[i] {
                *residual = dot(force[i], jets[i]);
            }
        });
        execution.map(&mut direction[..], |i, direction| {
            *direction = if is_open[i] {
                T::zero()
            } else {
                mean * *direction
            };
        });
        let mut equations = Equations {
            execution,
            shape,
            mass,
            smoothing,
            coefficients,
            work,
            spare: [first, second],
        };
        let product = |a: &[T], b: &[T]| execution.sum(count, |i| a[i] * b[i]);
        let along = product(residual, direction);
        equations.advance(direction, along, image, [solution, residual]);
        equations.improve(residual, improved);
        let mut squared = product(residual, improved);
        let enough = self.tolerance * self.tolerance * squared;
        direction.fill(T::zero());
        let mut keep = T::zero();
        while squared > enough && *iterations < MOST {
            execution.map(&mut direction[..], |i, direction| {
                *direction = improved[i] + keep * *direction;
            });
            if !equations.advance(direction, squared, image, [solution, residual]) {
                break;
            }
            equations.improve(residual, improved);
            let next = product(residual, improved);
            keep = next / squared;
            squared = next;
            *iterations += 1;
        }
    }
}

/// `f ν` with the jets' normals ν. On closed components `K f = F·ν`, K the consistent mass matrix, which is made
/// smooth where vertices are close; on those with a boundary f is the strong form.
impl<T: Real> ForceDensity<T> for Galerkin<T> {
    fn force_density(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        density: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        let mut force = core::mem::take(&mut memory.solver.force);
        force.clear();
        force.resize(surface.mesh().vertex_count(), [T::zero(); 3]);
        self.add_measured_force(execution, surface, memory, &mut force);
        memory.solver.force = force;
        self.solve(execution, surface, memory);
        let (solution, normals) = (&memory.solver.solution, &memory.mass.normals);
        execution.map(of_vertices(surface, density), |vertex, density| {
            *density = finite_or_zero(scale(solution[vertex], normals[vertex]));
        });
    }
}
