//! Membrane viscosity: forces are derivatives of a quadratic potential, and agree with exactly known flows.

use autodiff::F1;
use helfrich::{Dissipation, Finding, MembraneViscosity, Prepared, Real, Surface};
use helfrich_tests::laws::{imbalance, largest, with_derivatives};
use helfrich_tests::meshes::{
    GENERIC, Mesh, SplitMix64, cases, cross, difference, disc, dot, icosphere, norm, rotation,
    rough_any, turned,
};
use helfrich_tests::tolerance;
use proptest::prelude::*;

/// Shear alone, dilation alone, and both.
const VISCOSITIES: [MembraneViscosity<f64>; 3] = [
    viscosity(1.0, 0.0),
    viscosity(0.0, 1.0),
    viscosity(0.7, 2.9),
];

const fn viscosity(shear: f64, dilational: f64) -> MembraneViscosity<f64> {
    MembraneViscosity { shear, dilational }
}

/// Dissipative forces, and dissipated power.
fn evaluate(
    method: impl Dissipation<f64>,
    mesh: &Mesh,
    velocities: &[[f64; 3]],
) -> (Vec<[f64; 3]>, f64) {
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    let mut force = vec![[0.0; 3]; velocities.len()];
    prepared.add_dissipative_force(mesh.surface(), velocities, &mut force);
    (force, prepared.dissipated_power(mesh.surface(), velocities))
}

/// Σ F·v.
fn work(force: &[[f64; 3]], velocities: &[[f64; 3]]) -> f64 {
    let work = |(&f, &v): (&[f64; 3], &[f64; 3])| dot(f, v);
    force.iter().zip(velocities).map(work).sum()
}

/// Σ |F||v|, which bounds every term of the work.
fn bound(force: &[[f64; 3]], velocities: &[[f64; 3]]) -> f64 {
    let bound = |(&f, &v): (&[f64; 3], &[f64; 3])| norm(f) * norm(v);
    force.iter().zip(velocities).map(bound).sum()
}

/// 2R, in any scalar.
fn power<T: Real>(method: MembraneViscosity<T>, mesh: &Mesh, velocities: &[[T; 3]]) -> T {
    let positions = mesh.positions_in::<T>();
    let surface = Surface::new(&mesh.connectivity, &positions).expect("finite positions");
    Prepared::new(method, &mesh.connectivity).dissipated_power(surface, velocities)
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn forces_are_the_derivative_of_the_potential(rough in rough_any(), seed in 0..1_000_000_u64) {
        let mesh = &rough.mesh();
        let mut random = SplitMix64::new(seed);
        let velocities = random.directions(mesh.positions.len());
        for method in VISCOSITIES {
            let (force, found) = evaluate(method, mesh, &velocities);
            prop_assert!(found > 0.0);
            let scale = bound(&force, &velocities);
            tolerance::SAME.assert(-work(&force, &velocities), found, scale, "−F·v = 2R");
            let (net, torque) = imbalance(&mesh.positions, &force);
            tolerance::BALANCE.assert(net, 0.0, 1.0, "Σ F");
            tolerance::BALANCE.assert(torque, 0.0, 1.0, "Σ x × F");

            let direction = random.directions(velocities.len());
            let moved = with_derivatives(&velocities, &direction);
            let dual = MembraneViscosity {
                shear: F1::cst(method.shear),
                dilational: F1::cst(method.dilational),
            };
            let derivative = 0.5 * power(dual, mesh, &moved).dx;
            let scale = bound(&force, &direction);
            tolerance::SAME.assert(-work(&force, &direction), derivative, scale, "−∂R/∂v");

            // Forces are linear in the velocities, and their matrix is symmetric.
            let (other, _) = evaluate(method, mesh, &direction);
            let scale = scale + bound(&other, &velocities);
            let crossed = work(&other, &velocities);
            tolerance::SAME.assert(work(&force, &direction), crossed, scale, "F(u)·v");
            let sum = velocities.iter().zip(&direction);
            let sum = sum.map(|(v, d)| [0, 1, 2].map(|k| 3.0 * v[k] - d[k]));
            let (found, _) = evaluate(method, mesh, &Vec::from_iter(sum));
            let scale = largest(&force) + largest(&other);
            for (found, (force, other)) in found.iter().zip(force.iter().zip(&other)) {
                let expected = [0, 1, 2].map(|k| 3.0 * force[k] - other[k]);
                let error = norm(difference(*found, expected));
                tolerance::SAME.assert(error, 0.0, scale, "linear");
            }
        }
    }

    #[test]
    fn rigid_bodies_feel_nothing(rough in rough_any()) {
        let mesh = &rough.mesh();
        let count = mesh.positions.len();
        for method in VISCOSITIES {
            let (force, power) = evaluate(method, mesh, &vec![[3.1, -0.7, 1e3]; count]);
            prop_assert!(power == 0.0 && force.iter().flatten().all(|&f| f == 0.0));
            let (unit, _) = evaluate(method, mesh, &SplitMix64::new(1).directions(count));
            let spin = |&x: &[f64; 3]| cross([0.3, -1.0, 0.4], x);
            let velocities = Vec::from_iter(mesh.positions.iter().map(spin));
            let (force, power) = evaluate(method, mesh, &velocities);
            tolerance::BALANCE.assert(largest(&force), 0.0, largest(&unit), "rotation");
            tolerance::BALANCE.assert(power, 0.0, 1.0, "rotation");
        }
    }
}

/// v = ẋ r̂: `tr d = 2Ṙ/R` and no shear, in every triangle.
#[test]
fn a_growing_sphere_dilates() {
    let sphere = icosphere(3).map(|x| x.map(|x| 2.0 * x));
    let velocities = Vec::from_iter(sphere.positions.iter().map(|x| x.map(|x| 0.3 * x)));
    let area = sphere.surface().area();
    for method in VISCOSITIES {
        let (force, power) = evaluate(method, &sphere, &velocities);
        let expected = method.dilational * 0.6 * 0.6 * area;
        let scale = 0.6 * 0.6 * area;
        tolerance::SAME.assert(power, expected, scale, "η_d (2Ṙ/R)² A");
        // The surface tension −η_d tr d pulls inwards: F = −τ ∂A/∂x, and Σ x·∂A/∂x = 2A.
        let pull = work(&force, &sphere.positions);
        let expected = -2.0 * area * method.dilational * 0.6;
        tolerance::SAME.assert(pull, expected, area, "Σ F·x");
    }
}

/// In a flat sheet under a homogeneous rate of strain, rotated in space, the surface stress `τ = (η_d − η_s)
/// tr d P + 2 η_s d` gives the dissipated power and the forces at the edge: `Σ x F = −A τ`.
#[test]
fn flat_sheets_have_the_stress_of_boussinesq_and_scriven() {
    let (flat, turn) = (disc(3), rotation(GENERIC));
    let sheet = flat.map(|x| turned(turn, x));
    let area = flat.surface().area();
    let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|x| turned(turn, x));
    for gradient in [
        [[0.0, 1.7], [0.0, 0.0]],
        [[1.0, 0.0], [0.0, -1.0]],
        [[1.0, 0.0], [0.0, 0.0]],
        [[0.3, 0.8], [-0.5, 1.1]],
    ] {
        let velocity = |x: &[f64; 3]| {
            let v = gradient.map(|row| row[0] * x[0] + row[1] * x[1]);
            turned(turn, [v[0], v[1], 0.0])
        };
        let velocities = Vec::from_iter(flat.positions.iter().map(velocity));
        for method in VISCOSITIES {
            let (force, power) = evaluate(method, &sheet, &velocities);
            let rate = |i: usize, j: usize| 0.5 * (gradient[i][j] + gradient[j][i]);
            let trace = rate(0, 0) + rate(1, 1);
            let mut expected = 0.0;
            for i in 0..2 {
                for j in 0..2 {
                    let isotropic = if i == j { trace } else { 0.0 };
                    let stress = (method.dilational - method.shear) * isotropic
                        + 2.0 * method.shear * rate(i, j);
                    expected += area * stress * rate(i, j);
                    let moment = sheet.positions.iter().zip(&force);
                    let moment = moment.map(|(&x, &f)| dot(x, axis[i]) * dot(f, axis[j]));
                    let moment: f64 = moment.sum();
                    tolerance::SAME.assert(moment, -area * stress, area, "Σ x F");
                }
            }
            tolerance::SAME.assert(power, expected, area, "A τ:d");
        }
    }
    // η_s γ̇² A.
    let shear = Vec::from_iter(flat.positions.iter().map(|x| [1.7 * x[1], 0.0, 0.0]));
    let (_, power) = evaluate(viscosity(0.4, 9.0), &flat, &shear);
    tolerance::SAME.assert(power, 0.4 * 1.7 * 1.7 * area, area, "η_s γ̇² A");
}

#[test]
fn sums_degenerate_triangles_and_single_precision() {
    let sphere = icosphere(2);
    let velocities = SplitMix64::new(5).directions(sphere.positions.len());
    let [shear, dilation, _] = VISCOSITIES;
    let both = evaluate((shear, dilation), &sphere, &velocities);
    let one = evaluate(viscosity(1.0, 1.0), &sphere, &velocities);
    tolerance::SAME.assert(both.1, one.1, one.1, "power of a sum");
    for (both, one) in both.0.iter().zip(&one.0) {
        tolerance::SAME.assert(norm(difference(*both, *one)), 0.0, 1.0, "force of a sum");
    }

    let single = sphere.positions_in::<f32>();
    let surface = Surface::new(&sphere.connectivity, &single).unwrap();
    let slow = Vec::from_iter(velocities.iter().map(|v| v.map(|v| v as f32)));
    let method = MembraneViscosity {
        shear: 1.0_f32,
        dilational: 1.0,
    };
    let mut force = vec![[0.0_f32; 3]; single.len()];
    let mut prepared = Prepared::new(method, &sphere.connectivity);
    prepared.add_dissipative_force(surface, &slow, &mut force);
    let scale = largest(&one.0);
    for (found, expected) in force.iter().zip(&one.0) {
        let error = norm(difference(found.map(f64::from), *expected));
        tolerance::SINGLE_STRAIN.assert(error, 0.0, scale, "f32");
    }

    let mut pinched = sphere.clone();
    let neighbour = pinched.connectivity.one_ring(0)[0] as usize;
    pinched.positions[0] = pinched.positions[neighbour];
    let flat = sphere.map(|[x, ..]| [x, 0.0, 0.0]);
    for mesh in [&pinched, &flat, &sphere.map(|_| [1.0; 3])] {
        let (force, power) = evaluate(viscosity(1.0, 1.0), mesh, &velocities);
        assert!(power.is_finite() && force.iter().flatten().all(|f| f.is_finite()));
    }
    let mut found = 0;
    let viscosity = Prepared::new(VISCOSITIES[0], &pinched.connectivity);
    viscosity.inspect(pinched.surface(), &mut |finding| {
        found += usize::from(matches!(finding, Finding::DegenerateTriangle { .. }));
    });
    assert_eq!(found, 2);
}
