//! Newton steps for forces without an energy.
//!
//! Secants assume a symmetric and positive definite stiffness. The stiffness of a method in strong
//! form is neither on some meshes, and steps by secants then circle the equilibrium. Newton's
//! method makes no such assumption: D. A. Knoll and D. E. Keyes, J. Comput. Phys. 193 (2004) 357.
//! Its accuracy is limited by the continuity of forces: methods that choose neighbours by distance
//! have forces that jump where the choice changes.

use super::point::RelaxationPoint;
use super::search::Trial;
use super::{Failure, Relaxation};
use crate::dynamics::Problem;
use crate::dynamics::vector::{self, Vector};
use crate::flow::Gmres;

/// Number of steps without a lower residual before Newton steps are tried for the first time, and
/// before they are tried again: an attempt takes as many evaluations as a hundred steps.
const IDLE: [usize; 2] = [20, 100];

/// The relative residual of a linear solution: the fraction of the force that a Newton step may
/// leave.
const LINEAR_TOLERANCE: f64 = 1e-2;

/// Largest numbers of directions and of evaluations of a linear solution.
const DIRECTIONS: usize = 150;
const PRODUCTS: usize = 300;

/// Displacements for difference quotients, root mean square, in mean edges: the square root of the
/// rounding.
const DISPLACEMENT: f64 = 1e-7;

/// The part of a linear decrease of the residual that a step has to achieve.
const SUFFICIENT: f64 = 1e-4;

/// Largest number of halvings of a step.
const HALVINGS: usize = 8;

impl Relaxation {
    /// Whether to try Newton steps, or to continue with them.
    pub(super) fn newton_is_due(&self, problem: &dyn Problem) -> bool {
        if problem.is_conservative() || !self.settings.preconditioned {
            return false;
        }
        let best = self.state.progress;
        if best.is_some_and(|best| best.residual > self.settings.newton) {
            return false;
        }
        let idle = best.map_or(0, |best| self.state.iteration - best.iteration);
        self.state.newton || IDLE.contains(&idle)
    }

    /// The next point by a Newton step; `None` if none has a lower residual.
    pub(super) fn newton(
        &mut self,
        problem: &mut dyn Problem,
        here: &RelaxationPoint,
    ) -> Option<Trial> {
        self.state.secants.clear();
        let right = packed(&here.force);
        let mut solution = vec![[0.0; 3]; right.len()];
        let mut solver = Gmres::new(LINEAR_TOLERANCE);
        (solver.restart, solver.products) = (DIRECTIONS, PRODUCTS);
        let mut failed = false;
        let mut apply = |y: &[Vector], product: &mut [Vector]| {
            product.fill([0.0; 3]);
            if failed {
                return;
            }
            let force = &y.as_flattened()[..here.force.len()];
            match self.softening(problem, here, force) {
                Ok(found) => product.as_flattened_mut()[..found.len()].copy_from_slice(&found),
                Err(_) => failed = true,
            }
        };
        let solved = solver.solve(&mut apply, &right, &mut solution);
        if failed || !solved.residual.is_finite() {
            return None;
        }
        let force = &solution.as_flattened()[..here.force.len()];
        let direction = self.preconditioned(problem, here, force);
        let displacement = self.frame.expand(&self.places, &here.positions, &direction);
        let mut step = self.longest_step(&here.positions, &displacement).min(1.0);
        for _ in 0..HALVINGS {
            let positions = moved(&here.positions, &displacement, step);
            if let Ok(point) = self.evaluate(problem, positions, true)
                && point.residual <= (1.0 - SUFFICIENT * step) * here.residual
            {
                return Some(Trial {
                    point,
                    step,
                    crawls: false,
                });
            }
            step *= 0.5;
        }
        None
    }

    /// The decrease of the force along the displacement with which the preconditioner responds to a
    /// force.
    fn softening(
        &mut self,
        problem: &mut dyn Problem,
        here: &RelaxationPoint,
        force: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let direction = self.preconditioned(problem, here, force);
        let displacement = self.frame.expand(&self.places, &here.positions, &direction);
        let squares: f64 = displacement.iter().map(|d| vector::dot(*d, *d)).sum();
        let area: f64 = here.coordinates.areas.iter().sum();
        if squares == 0.0 {
            return Ok(vec![0.0; force.len()]);
        }
        // Sums over vertices of squared displacements and of squared edges.
        let step = DISPLACEMENT * (area / squares).sqrt();
        let positions = moved(&here.positions, &displacement, step);
        let there = self.evaluate(problem, positions, false);
        let there = there.map_err(|(failure, _)| failure)?;
        let falls = here.force.iter().zip(&there.force);
        Ok(falls.map(|(here, there)| (here - there) / step).collect())
    }
}

fn moved(positions: &[Vector], displacement: &[Vector], step: f64) -> Vec<Vector> {
    let pairs = positions.iter().zip(displacement);
    pairs
        .map(|(x, d)| vector::add(*x, vector::scale(step, *d)))
        .collect()
}

/// Numbers in groups of three, padded with 0.
fn packed(numbers: &[f64]) -> Vec<Vector> {
    let mut fields = vec![[0.0; 3]; numbers.len().div_ceil(3)];
    fields.as_flattened_mut()[..numbers.len()].copy_from_slice(numbers);
    fields
}
