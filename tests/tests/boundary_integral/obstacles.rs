//! Rigid bodies at rest in the fluid.

use super::{ONE, largest_norm};
use helfrich::TriangleMesh;
use helfrich_std::flow::{Ambient, Membranes, Suspension};
use helfrich_tests::meshes::{Mesh, difference, dot, icosphere, norm};
use std::sync::Arc;

/// Membranes with constant forces.
struct Pushed(Vec<[f64; 3]>);

impl Membranes for Pushed {
    fn set_forces(&mut self, _: &[[f64; 3]], forces: &mut [[f64; 3]]) -> Result<(), String> {
        forces.copy_from_slice(&self.0);
        Ok(())
    }
}

/// The gradient of a general linear flow: u_i = Σ G_ij x_j.
const GRADIENT: [[f64; 3]; 3] = [[0.3, 1.0, -0.2], [0.4, -0.5, 0.6], [0.1, -0.7, 0.2]];

/// The flow around a fixed sphere of radius 1 in this linear flow (G. K. Batchelor, An Introduction to Fluid Dynamics 1967,
/// section 4.11, and the Stokes flow around a rotating sphere): with E and W the symmetric and antisymmetric part,
/// `u = W·x (1 − r⁻³) + E·x (1 − r⁻⁵) − 5/2 x (x·E·x) (r⁻⁵ − r⁻⁷)`.
fn around_a_sphere(x: [f64; 3]) -> [f64; 3] {
    let part = |sign: f64| {
        [0, 1, 2].map(|i| {
            let entries = [0, 1, 2].map(|j| 0.5 * (GRADIENT[i][j] + sign * GRADIENT[j][i]));
            dot(entries, x)
        })
    };
    let (strain, spin) = (part(1.0), part(-1.0));
    let r = norm(x);
    let radial = 2.5 * dot(x, strain) * (r.powi(-5) - r.powi(-7));
    [0, 1, 2].map(|i| spin[i] * (1.0 - r.powi(-3)) + strain[i] * (1.0 - r.powi(-5)) - radial * x[i])
}

/// Points of the fluid around the sphere.
fn points() -> Vec<[f64; 3]> {
    let directions = icosphere(0).positions;
    let at = |radius: f64| directions.iter().map(move |x| x.map(|x| radius * x));
    at(1.1).chain(at(1.5)).chain(at(3.0)).collect()
}

/// The fluid does not slip on a fixed sphere in a linear flow, and flows around it as it should, with errors of second order.
#[test]
fn a_fixed_sphere_is_flowed_around() {
    let error = |refinement: u32| {
        let Mesh {
            connectivity,
            positions,
            ..
        } = icosphere(refinement);
        let flow = Some(Ambient::Linear { gradient: GRADIENT });
        let mut suspension = Suspension::new(&[], 1.0, &[], flow, ONE);
        suspension.set_obstacles(&[], &[(&connectivity, &positions)]);
        let nothing = &mut Pushed(Vec::new());
        let found = suspension
            .fluid_at(nothing, &[], &points())
            .expect("a flow");
        let errors = points().into_iter().zip(found.velocity);
        let errors = errors.map(|(x, u)| difference(u, around_a_sphere(x)));
        largest_norm(&Vec::from_iter(errors))
    };
    let (coarse, fine) = (error(1), error(2));
    // The largest velocity there is 3.
    assert!(fine < 0.03, "{coarse:e}, {fine:e}");
    assert!((coarse / fine).log2() > 1.5, "{coarse:e}, {fine:e}");
}

/// Membranes of any viscosity ratio beside two obstacles: the velocity at vertices of the obstacles is 0, and that of the
/// membrane that of the fluid beside it.
#[test]
fn the_fluid_does_not_slip_on_obstacles_beside_membranes() {
    let drop = icosphere(1);
    let mesh = Arc::new(drop.connectivity.clone());
    let ball = |x: f64| icosphere(1).map(|[a, b, c]| [a + x, 0.8 * b, c]);
    let [left, right] = [ball(-2.3), ball(2.4)];
    let solids: [(&TriangleMesh, &[[f64; 3]]); 2] =
        [&left, &right].map(|ball| (&ball.connectivity, &ball.positions[..]));
    for ratio in [1.0, 5.0] {
        let meshes = [Arc::clone(&mesh)];
        let flow = Some(Ambient::Linear { gradient: GRADIENT });
        let mut suspension = Suspension::new(&meshes, 2.0, &[ratio], flow, ONE);
        suspension.set_obstacles(&meshes, &solids);
        let pushed = &mut Pushed(vec![[0.1, 0.05, -0.2]; drop.positions.len()]);
        let mut velocities = vec![[0.0; 3]; drop.positions.len()];
        let set = suspension.set_velocities(pushed, &drop.positions, &mut velocities);
        set.expect("velocities");
        let free = {
            let mut free = Suspension::new(&meshes, 2.0, &[ratio], flow, ONE);
            let mut velocities = velocities.clone();
            let set = free.set_velocities(pushed, &drop.positions, &mut velocities);
            set.expect("velocities");
            velocities
        };
        let change = free
            .iter()
            .zip(&velocities)
            .map(|(a, b)| difference(*a, *b));
        assert!(largest_norm(&Vec::from_iter(change)) > 0.1 * largest_norm(&free));
        for ball in [&left, &right] {
            let fluid = suspension.fluid_at(pushed, &drop.positions, &ball.positions);
            // Points at vertices stop after eight halvings, where vertices are integrated exactly.
            let slip = largest_norm(&fluid.expect("a fluid").velocity);
            assert!(slip < 0.02 * largest_norm(&velocities), "{slip}");
        }
    }
}
