//! Adhesion to a wall.

use helfrich::{Real, WallAdhesion};
use helfrich_tests::laws::{check_work, energy, forces};
use helfrich_tests::meshes::{Mesh, cases, disc, icosphere, rough_any};
use helfrich_tests::tolerance;
use proptest::prelude::*;

fn sticky<T: Real>() -> WallAdhesion<T> {
    WallAdhesion {
        strength: T::constant(1.7),
        distance: T::constant(0.4),
        range: T::constant(0.6),
        wall: [0.1, 0.2, -2.5].map(T::constant),
        normal: [0.0, 0.6, 0.8].map(T::constant),
    }
}

fn check_gradient(mesh: &Mesh) {
    let Mesh {
        connectivity,
        positions,
    } = mesh;
    let force = forces(sticky(), connectivity, positions);
    let energy = |moved: &[_]| energy(sticky(), connectivity, moved);
    check_work(
        &force,
        positions,
        tolerance::GRADIENT_DUAL,
        "adhesion",
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

/// By Archimedes, the area of a sphere between two heights is 2πR times their difference, so that `E = 2πRW
/// [λ/2 (q₁² − q₂²) − 2λ (q₁ − q₂)]` with q at the lowest and the highest point. The error is of second order
/// in the edge length.
#[test]
fn a_sphere_above_a_wall_has_its_energy() {
    let wall = WallAdhesion {
        strength: 1.7,
        distance: 0.4,
        range: 0.6,
        wall: [0.0, 0.0, -1.3],
        normal: [0.0, 0.0, 1.0],
    };
    let q = |height: f64| ((wall.distance - height) / wall.range).exp();
    let [near, far] = [q(0.3), q(2.3)];
    let squares = 0.5 * (near * near - far * far);
    let exact =
        2.0 * std::f64::consts::PI * wall.strength * wall.range * (squares - 2.0 * (near - far));
    let error = |level| {
        let mesh = icosphere(level);
        (energy(wall, &mesh.connectivity, &mesh.positions) - exact).abs()
    };
    let [coarse, fine] = [error(3), error(4)];
    let order = (coarse / fine).log2();
    assert!(
        (1.9..2.1).contains(&order),
        "order {order}, errors {coarse} and {fine}"
    );
    assert!(fine < 0.01 * exact.abs(), "error {fine} of {exact}");
}

/// At the height of the minimum, a flat membrane has the energy −W A and feels no force along the normal;
/// closer to the wall it is repelled, farther away attracted.
#[test]
fn a_flat_membrane_rests_at_the_minimum() {
    let flat = disc(3);
    let wall = |height: f64| WallAdhesion {
        strength: 2.0,
        distance: 0.5,
        range: 0.1,
        wall: [0.0, 0.0, -height],
        normal: [0.0, 0.0, 1.0],
    };
    let (mesh, positions) = (&flat.connectivity, &flat.positions);
    let area = flat.surface().area();
    let expected = -2.0 * area;
    tolerance::SAME.assert(energy(wall(0.5), mesh, positions), expected, area, "E");
    let lift = |height| {
        forces(wall(height), mesh, positions)
            .iter()
            .map(|f| f[2])
            .sum::<f64>()
    };
    tolerance::SAME.assert(lift(0.5), 0.0, 2.0 * area / 0.1, "ΣF");
    assert!(lift(0.45) > 0.0 && lift(0.55) < 0.0);
}
