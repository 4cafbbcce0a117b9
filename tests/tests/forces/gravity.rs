//! Weight of the fluid inside a surface.

use helfrich::{Gravity, Prepared, Real, Surface};
use helfrich_tests::laws::{check_work, energy, forces, largest};
use helfrich_tests::meshes::{
    Mesh, bent, cases, difference, disc, dot, hemisphere, icosphere, norm, rough_any,
};
use helfrich_tests::tolerance;
use proptest::prelude::*;

fn gravity<T: Real>() -> Gravity<T> {
    Gravity {
        weight: [0.3, -0.7, 2.0].map(T::constant),
        level: [0.5, -4.0, 1.0].map(T::constant),
    }
}

fn check_gradient(mesh: &Mesh) {
    let Mesh {
        connectivity,
        positions,
    } = mesh;
    let force = forces(gravity(), connectivity, positions);
    let energy = |moved: &[_]| energy(gravity(), connectivity, moved);
    check_work(
        &force,
        positions,
        tolerance::GRADIENT_DUAL,
        "gravity",
        energy,
    );
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn forces_are_gradients(rough in rough_any()) {
        check_gradient(&rough.mesh());
    }
}

/// `E = −Δρ g·(x_centre − x_level) V` for a body with this centre of volume; the forces sum to Δρ V g and
/// have no torque about the centre.
#[test]
fn bodies_have_their_weight() {
    let centre = [2.0, 1.0, -3.0];
    let mesh = icosphere(2).map(|[x, y, z]| [1.3 * x + centre[0], y + centre[1], z + centre[2]]);
    let volume = mesh.surface().volume().unwrap();
    let Gravity { weight, level } = gravity::<f64>();
    let expected = -volume * dot(weight, difference(centre, level));
    let found = energy(gravity(), &mesh.connectivity, &mesh.positions);
    tolerance::SAME.assert(found, expected, expected.abs(), "E");
    let (mut sum, mut torque) = ([0.0; 3], [0.0; 3]);
    let force = forces(gravity(), &mesh.connectivity, &mesh.positions);
    for (&f, &x) in force.iter().zip(&mesh.positions) {
        let turn = helfrich_tests::meshes::cross(difference(x, centre), f);
        for axis in 0..3 {
            sum[axis] += f[axis];
            torque[axis] += turn[axis];
        }
    }
    let expected = weight.map(|w| w * volume);
    let error = norm(difference(sum, expected));
    tolerance::SAME.assert(error, 0.0, norm(expected), "ΣF");
    tolerance::SAME.assert(norm(torque), 0.0, norm(expected), "Σ (x − x_c) × F");
}

/// A heavy body sinks: the net force points along g.
#[test]
fn the_heavy_sinks() {
    let mesh = icosphere(1).map(bent);
    let heavy = Gravity {
        weight: [0.0, 0.0, -9.81],
        level: [0.0; 3],
    };
    let force = forces(heavy, &mesh.connectivity, &mesh.positions);
    assert!(force.iter().map(|f| f[2]).sum::<f64>() < 0.0);
    let lower = mesh.map(|[x, y, z]| [x, y, z - 1.0]);
    let at = |mesh: &Mesh| energy(heavy, &mesh.connectivity, &mesh.positions);
    assert!(at(&lower) < at(&mesh));
}

#[test]
fn open_surfaces_weigh_nothing() {
    for mesh in [disc(3), hemisphere(2)] {
        let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
        assert_eq!(energy(gravity(), connectivity, x), 0.0);
        assert_eq!(largest(&forces(gravity(), connectivity, x)), 0.0);
    }
}

/// The remainders of positions contribute to the energy.
#[test]
fn remainders_count() {
    let far = 2.0_f64.powi(40);
    let mesh = icosphere(1).map(bent);
    let rounded = mesh.map(|x| x.map(|x| (x + far) - far));
    let pairs = mesh.positions.iter().zip(&rounded.positions);
    let remainders = Vec::from_iter(pairs.map(|(&x, &near)| difference(x, near)));
    assert!(largest(&remainders) > 1e-5);
    let there = rounded.map(|x| x.map(|x| x + far));
    let heavy = Gravity {
        weight: [0.3, -0.7, 2.0],
        level: [far; 3],
    };
    let pair = Surface::with_remainders(&mesh.connectivity, &there.positions, &remainders).unwrap();
    let found = Prepared::new(heavy, &mesh.connectivity).energy(pair);
    let near = Gravity {
        level: [0.0; 3],
        ..heavy
    };
    let expected = energy(near, &mesh.connectivity, &mesh.positions);
    tolerance::SAME.assert(found, expected, 10.0, "E");
}
