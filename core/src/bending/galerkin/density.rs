//! The force density: solution of the equations of the mass matrix.

use super::shape::Shape;
use super::{Galerkin, GalerkinMemory};
use crate::element::{Execution, of_vertices};
use crate::lane::Lane;
use crate::method::{ForceDensity, TwoPass, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{dot, scale};
use alloc::vec::Vec;

/// Vectors of the iteration.
#[derive(Clone, Debug, Default)]
pub(super) struct Solver<T> {
    force: Vec<[T; 3]>,
    inverse: Vec<T>,
    solution: Vec<T>,
    residual: Vec<T>,
    direction: Vec<T>,
    image: Vec<T>,
    pub(super) iterations: usize,
}

/// Most iterations.
const MOST: usize = 200;

impl<T: Real> Galerkin<T> {
    /// Solves `M f = F·ν` for the force in `solver.force`.
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
        mass.set(execution, surface, shape, work);
        let Shape { plan, sums, .. } = &*shape;
        let count = sums.len();
        let Solver {
            force,
            inverse,
            solution,
            residual,
            direction,
            image,
            iterations,
        } = solver;
        for vector in [
            &mut *inverse,
            &mut *solution,
            &mut *residual,
            &mut *direction,
            &mut *image,
        ] {
            vector.clear();
            vector.resize(count, T::zero());
        }
        // Relative to the mean: squares of forces over areas leave the range of f32 on small surfaces.
        let area = |i: usize| {
            let is_used = plan.members[i].is_some();
            if is_used { sums[i][3] } else { T::zero() }
        };
        let mean = execution.sum(count, area) / T::constant(count as f64);
        execution.map(&mut inverse[..], |i, inverse| {
            *inverse = mean * area(i).reciprocal_or_zero();
        });
        let jets = &mass.normals;
        execution.map(&mut residual[..], |i, residual| {
            *residual = dot(force[i], jets[i]);
        });
        let weighted =
            |residual: &[T]| execution.sum(count, |i| inverse[i] * (residual[i] * residual[i]));
        let mut squared = weighted(residual);
        let enough = self.tolerance * self.tolerance * squared;
        let mut keep = T::zero();
        *iterations = 0;
        while squared > enough && *iterations < MOST {
            execution.map(&mut direction[..], |i, direction| {
                *direction = inverse[i] * residual[i] + keep * *direction;
            });
            mass.apply(execution, shape, work, direction, image);
            let work_done = execution.sum(count, |i| direction[i] * image[i]);
            let step = squared / work_done;
            if !step.is_finite() {
                break;
            }
            execution.map(&mut solution[..], |i, solution| {
                *solution += step * direction[i];
            });
            execution.map(&mut residual[..], |i, residual| {
                *residual -= step * image[i];
            });
            let next = weighted(residual);
            keep = next / squared;
            squared = next;
            *iterations += 1;
        }
    }
}

/// `f ν` with the jets' normals ν and `M f = F·ν`, M the consistent mass matrix.
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
