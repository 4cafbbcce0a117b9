//! Implicit forces of viscous membranes: at the velocities that they cause.

use crate::flow::Solved;

/// One vector per vertex.
type Field = Vec<[f64; 3]>;
/// A linear map of fields, from the first to the second.
pub(super) type Map<'a> = dyn FnMut(&[[f64; 3]], &mut [[f64; 3]]) + 'a;

/// Residual of velocities, relative to the velocities without viscous forces: far below the errors
/// of a lattice, and of the size of f32 rounding.
const TOLERANCE: f64 = 1e-8;

/// Largest number of evaluations of viscous forces in a step. The number needed grows with the
/// square root of the ratio of the viscosities of membrane and fluid, and is about 60 at η = 20 μa.
const PRODUCTS: usize = 1000;

/// The viscous forces `f = −D v` of membranes in a step, with the velocity v that they have in it:
/// `v = u + M f`, with u the velocity without these forces, and M the response of velocities to
/// forces within the step.
///
/// D and M are symmetric and positive semi-definite, and so is `1 + M D` in the scalar product `x·D
/// y`. Conjugate gradients with this product solve `v + M D v = u`. They compute only D v, so that
/// motions without viscous forces, such as rigid ones, do not slow convergence. Whatever the
/// residual, f is a combination of viscous forces, and therefore without net force and torque.
///
/// A step removes the work `v·D v ≥ 0` from fluid and membranes, and is therefore stable for any
/// viscosity, step and mesh. With forces at the velocities of the previous step, stability would
/// require `η step/(μ spacing) ≲ 1`.
#[derive(Debug, Default)]
pub(super) struct ViscousForces {
    residual: Field,
    /// −D of the residual.
    opposed: Field,
    direction: Field,
    /// −D of the direction.
    resisted: Field,
    product: Field,
}

impl ViscousForces {
    /// Sets `forces` to f. On entry they hold an initial guess, which must be −D of some velocity.
    ///
    /// `resist` sets its second field to −D of the first, `respond` to M of the first; `free` is u.
    pub(super) fn solve(
        &mut self,
        resist: &mut Map<'_>,
        respond: &mut Map<'_>,
        free: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) -> Solved {
        let Self {
            residual,
            opposed,
            direction,
            resisted,
            product,
        } = self;
        for field in [
            &mut *residual,
            &mut *opposed,
            &mut *direction,
            &mut *resisted,
            &mut *product,
        ] {
            field.resize(free.len(), [0.0; 3]);
        }
        let length = dot(free, free).sqrt();
        let mut solved = Solved {
            converged: length == 0.0,
            products: 0,
            residual: 0.0,
        };
        if length == 0.0 {
            forces.fill([0.0; 3]);
            return solved;
        }
        // The initial velocity v = u + M f of the guess.
        respond(forces, product);
        direction.copy_from_slice(free);
        add_scaled(direction, 1.0, product);
        resist(direction, forces);
        respond(forces, residual);
        add_scaled(residual, -1.0, product);
        resist(residual, opposed);
        solved.products = 2;
        let mut size = -dot(residual, opposed);
        direction.copy_from_slice(residual);
        resisted.copy_from_slice(opposed);
        loop {
            solved.residual = dot(residual, residual).sqrt() / length;
            // If the dissipation is at the level of rounding, no further forces can result.
            solved.converged = solved.residual <= TOLERANCE || size <= 0.0;
            if solved.converged || !size.is_finite() || solved.products >= PRODUCTS {
                return solved;
            }
            // (1 + M D) of the direction.
            respond(resisted, product);
            for (product, direction) in product.iter_mut().zip(&*direction) {
                for (product, direction) in product.iter_mut().zip(direction) {
                    *product = direction - *product;
                }
            }
            let step = size / -dot(resisted, product);
            add_scaled(forces, step, resisted);
            add_scaled(residual, -step, product);
            resist(residual, opposed);
            solved.products += 1;
            let before = std::mem::replace(&mut size, -dot(residual, opposed));
            turn(direction, size / before, residual);
            turn(resisted, size / before, opposed);
        }
    }
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let rows = a.iter().zip(b);
    rows.map(|([a, b, c], [x, y, z])| a * x + b * y + c * z)
        .sum()
}

/// `y += factor x`.
fn add_scaled(y: &mut [[f64; 3]], factor: f64, x: &[[f64; 3]]) {
    let rows = y.as_flattened_mut().iter_mut().zip(x.as_flattened());
    rows.for_each(|(y, x)| *y += factor * x);
}

/// `y = factor y + x`.
fn turn(y: &mut [[f64; 3]], factor: f64, x: &[[f64; 3]]) {
    let rows = y.as_flattened_mut().iter_mut().zip(x.as_flattened());
    rows.for_each(|(y, x)| *y = factor * *y + x);
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 10;

    /// `BᵀB`: symmetric, not negative, and of this rank.
    fn squared(rank: usize, phase: f64) -> Vec<Vec<f64>> {
        let size = 3 * COUNT;
        let entry = |k: usize, i: usize| (phase + (7 * k * k + 3 * i * (k + 1)) as f64).sin();
        let product = |i, j| (0..rank).map(|k| entry(k, i) * entry(k, j)).sum();
        let row = |i| (0..size).map(|j| product(i, j)).collect();
        (0..size).map(row).collect()
    }

    fn apply(matrix: &[Vec<f64>], factor: f64, x: &[[f64; 3]], y: &mut [[f64; 3]]) {
        for (row, y) in matrix.iter().zip(y.as_flattened_mut()) {
            let row = row.iter().zip(x.as_flattened());
            *y = factor * row.map(|(a, x)| a * x).sum::<f64>();
        }
    }

    fn field(phase: f64) -> Field {
        let row = |k| [1.0, 2.0, 3.0].map(|axis| (phase * axis + 0.7 * f64::from(k)).cos());
        (0..COUNT as i32).map(row).collect()
    }

    fn largest(x: &[[f64; 3]]) -> f64 {
        let entries = x.as_flattened().iter();
        entries.fold(0.0, |most, x| most.max(x.abs()))
    }

    /// The forces at membranes of any viscosity are those at the velocities that they make, whether D
    /// and M see all directions or not.
    #[test]
    fn forces_are_those_at_their_own_velocities() {
        for (rank, other_rank) in [(30, 30), (12, 30), (30, 9), (12, 9), (1, 1)] {
            let [d, m] = [squared(rank, 0.3), squared(other_rank, 1.1)];
            for viscosity in [1e-6, 1e-3, 1.0] {
                let free = field(1.7);
                // −D of some velocity: here of one that is far off.
                let mut forces = vec![[0.0; 3]; COUNT];
                apply(&d, -viscosity, &field(0.4), &mut forces);
                let solved = ViscousForces::default().solve(
                    &mut |v, f| apply(&d, -viscosity, v, f),
                    &mut |f, v| apply(&m, 1.0, f, v),
                    &free,
                    &mut forces,
                );
                let what = format!("{rank} {other_rank} {viscosity}: {solved:?}");
                assert!(solved.converged && solved.residual <= TOLERANCE, "{what}");
                let mut velocity = vec![[0.0; 3]; COUNT];
                apply(&m, 1.0, &forces, &mut velocity);
                add_scaled(&mut velocity, 1.0, &free);
                let mut at_own = vec![[0.0; 3]; COUNT];
                apply(&d, -viscosity, &velocity, &mut at_own);
                // In velocities; a residual r of them makes forces −D r.
                add_scaled(&mut at_own, -1.0, &forces);
                let mut wrong = vec![[0.0; 3]; COUNT];
                apply(&m, 1.0, &at_own, &mut wrong);
                let mut scale = vec![[0.0; 3]; COUNT];
                apply(&d, -viscosity, &free, &mut at_own);
                apply(&m, 1.0, &at_own, &mut scale);
                let scale = largest(&free) + largest(&scale);
                // The residual is a norm of thirty entries, and D of it, of any direction.
                assert!(largest(&wrong) < 1e-6 * scale, "{what}");
            }
        }
    }

    /// Where every direction is by itself, `f = −D u/(1 + M D)`: without end as D grows, but for what M
    /// gives to it, `−u/M`.
    #[test]
    fn stiff_membranes_take_all_of_the_velocity() {
        let scaled = |factor: f64, x: &[[f64; 3]], y: &mut [[f64; 3]]| {
            let rows = y.as_flattened_mut().iter_mut().zip(x.as_flattened());
            for (direction, (y, x)) in rows.enumerate() {
                *y = factor * (1 + direction) as f64 * x;
            }
        };
        for viscosity in [1e-9, 1.0, 1e3, 1e6] {
            let free = field(1.7);
            let mut forces = vec![[0.0; 3]; COUNT];
            let solved = ViscousForces::default().solve(
                &mut |v, f| scaled(-viscosity, v, f),
                &mut |f, v| {
                    v.copy_from_slice(f);
                    v.as_flattened_mut().iter_mut().for_each(|v| *v *= 0.5);
                },
                &free,
                &mut forces,
            );
            assert!(solved.converged, "{viscosity}: {solved:?}");
            let pairs = forces.as_flattened().iter().zip(free.as_flattened());
            for (direction, (force, free)) in pairs.enumerate() {
                let own = viscosity * (1 + direction) as f64;
                let expected = -own * free / (1.0 + 0.5 * own);
                let most = 1e-7 * own / (1.0 + 0.5 * own) * largest(&field(1.7));
                assert!((force - expected).abs() < most, "{viscosity}, {direction}");
            }
        }
    }

    #[test]
    fn what_is_at_rest_or_cannot_be_solved_is_said() {
        let d = squared(30, 0.3);
        let mut resist = |v: &[[f64; 3]], f: &mut [[f64; 3]]| apply(&d, -1.0, v, f);
        let mut viscous = ViscousForces::default();
        let mut forces = field(2.0);
        let rest = vec![[0.0; 3]; COUNT];
        let solved = viscous.solve(
            &mut resist,
            &mut |_, v| v.fill([1.0; 3]),
            &rest,
            &mut forces,
        );
        assert!(solved.converged && solved.products == 0 && forces == rest);
        // A response that grows from call to call is no linear map.
        let mut calls = 0.0;
        let solved = viscous.solve(
            &mut resist,
            &mut |_, v| {
                calls += 1.0;
                v.fill([calls, -calls, 0.5]);
            },
            &field(1.7),
            &mut forces,
        );
        assert!(
            !solved.converged && solved.products <= PRODUCTS,
            "{solved:?}"
        );
        let mut free = field(1.7);
        free[3][1] = f64::NAN;
        let solved = viscous.solve(
            &mut resist,
            &mut |f, v| v.copy_from_slice(f),
            &free,
            &mut forces,
        );
        assert!(!solved.converged && solved.products < 4, "{solved:?}");
    }
}
