//! The laws of conservative methods.

use crate::accuracy::force_and_energy;
use crate::tolerance;
use autodiff::F1;
use helfrich::{Conservative, Energy, Prepared, Surface, TriangleMesh};

/// Forces are minus the derivative of the energy by every coordinate, by dual numbers and by
/// central differences of some; they have no sum and no torque. `dual` is the same method with
/// dual numbers.
///
/// # Panics
/// If a law is broken.
pub fn check_gradient<M, D>(method: &M, dual: D, mesh: &TriangleMesh, positions: &[[f64; 3]])
where
    M: Conservative<f64> + Clone,
    D: Energy<F1>,
{
    let energy = |positions: &[[f64; 3]]| {
        let surface = Surface::new(mesh, positions).expect("finite positions");
        Prepared::new(method.clone(), mesh).energy(surface)
    };
    let surface = Surface::new(mesh, positions).expect("finite positions");
    let (force, total) = force_and_energy(method.clone(), surface);
    assert!(total.is_finite());
    let largest = force.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));

    let mut dual = Prepared::new(dual, mesh);
    let constant = |x: &[f64; 3]| x.map(F1::cst);
    let mut variable: Vec<[F1; 3]> = positions.iter().map(constant).collect();
    let mut moved = positions.to_vec();
    for vertex in 0..positions.len() {
        for axis in 0..3 {
            let x = positions[vertex][axis];
            variable[vertex][axis] = F1::var(x);
            let surface = Surface::new(mesh, &variable).expect("finite positions");
            let derivative = dual.energy(surface).deriv();
            variable[vertex][axis] = F1::cst(x);
            let found = force[vertex][axis];
            tolerance::GRADIENT_DUAL.assert(found, -derivative, largest, "force");
            if vertex % 7 == 0 {
                let mut at = |x: f64| {
                    moved[vertex][axis] = x;
                    energy(&moved)
                };
                let step = 1e-5;
                let difference = (at(x + step) - at(x - step)) / (2.0 * step);
                at(x);
                tolerance::GRADIENT_DIFFERENCE.assert(found, -difference, largest, "force");
            }
        }
    }
    let [sum, torque] = net(&force, positions);
    for axis in 0..3 {
        tolerance::NO_NET_FORCE.assert(sum[axis], 0.0, largest, "net force");
        tolerance::NO_NET_FORCE.assert(torque[axis], 0.0, largest, "net torque");
    }
}

/// Sum and torque of nodal forces.
pub fn net(force: &[[f64; 3]], positions: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let mut net = [[0.0; 3]; 2];
    for (f, x) in force.iter().zip(positions) {
        for k in 0..3 {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            net[0][k] += f[k];
            net[1][k] += x[l] * f[m] - x[m] * f[l];
        }
    }
    net
}
