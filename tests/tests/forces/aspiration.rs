//! Suction into a pipette.

use helfrich::{Aspiration, OsmoticPressure, Real};
use helfrich_tests::laws::{check_work, energy, forces, largest};
use helfrich_tests::meshes::{
    bent, cases, difference, disc, dot, hemisphere, icosphere, norm, rough_any,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Suction on a sphere of 2562 vertices whose middle is in the mouth, relative.
const HALF: Tolerance = Tolerance::new(
    5e-3,
    "second order: edges of 0.07 flatten a sphere by 0.07²/2 of its volume",
);

fn pipette<T: Real>() -> Aspiration<T> {
    Aspiration {
        pressure: T::constant(1.7),
        mouth: [0.1, -0.2, 0.15].map(T::constant),
        axis: [0.48, -0.6, 0.64].map(T::constant),
        width: T::constant(0.2),
    }
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn forces_are_gradients(rough in rough_any()) {
        let mesh = rough.mesh();
        let (connectivity, positions) = (&mesh.connectivity, &mesh.positions);
        let force = forces(pipette(), connectivity, positions);
        let energy = |moved: &[_]| energy(pipette(), connectivity, moved);
        check_work(&force, positions, tolerance::GRADIENT_DUAL, "suction", energy);
    }
}

/// Far behind the mouth there is a uniform pressure, far in front of it none, however far.
#[test]
fn bodies_behind_the_mouth_feel_a_pressure() {
    let mesh = icosphere(2).map(bent);
    let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
    let Aspiration { pressure, axis, .. } = pipette::<f64>();
    let uniform = OsmoticPressure::new(pressure);
    let expected = forces(uniform, connectivity, x);
    for depth in [40.0, 1e3] {
        let moved = |way: f64| mesh.map(|x| [0, 1, 2].map(|k| x[k] + way * axis[k]));
        let behind = moved(depth);
        let found = forces(pipette(), connectivity, &behind.positions);
        for (&found, &expected) in found.iter().zip(&expected) {
            let error = norm(difference(found, expected));
            tolerance::SAME.assert(error, 0.0, depth * largest(&[expected]), "force");
        }
        let work = energy(pipette(), connectivity, &behind.positions);
        let same = energy(uniform, connectivity, x);
        tolerance::SAME.assert(work, same, depth * same.abs(), "energy");
        let before = moved(-depth);
        let found = forces(pipette(), connectivity, &before.positions);
        assert!(largest(&found) < 1e-40, "{found:?}");
    }
}

/// Half of a sphere in the mouth is drawn in by Δp times the area of the mouth.
#[test]
fn suction_acts_on_the_mouth() {
    let mesh = icosphere(4);
    let narrow = Aspiration {
        mouth: [0.0; 3],
        width: 0.02,
        ..pipette()
    };
    let found = forces(narrow, &mesh.connectivity, &mesh.positions);
    let sum = [0, 1, 2].map(|axis| found.iter().map(|f| f[axis]).sum::<f64>());
    let drawn = PI * narrow.pressure;
    HALF.assert(dot(sum, narrow.axis), drawn, drawn, "ΣF");
    let across = [0, 1, 2].map(|k| sum[k] - dot(sum, narrow.axis) * narrow.axis[k]);
    HALF.assert(norm(across), 0.0, drawn, "across");
    let half = energy(narrow, &mesh.connectivity, &mesh.positions);
    // Within λ of the mouth, ∫(S − Θ) A dh with the area A of a section is of order λ².
    let expected = -drawn * 2.0 / 3.0;
    HALF.assert(half, expected, drawn, "E");
}

#[test]
fn open_surfaces_are_not_drawn() {
    for mesh in [disc(3), hemisphere(2)] {
        let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
        assert_eq!(energy(pipette(), connectivity, x), 0.0);
        assert_eq!(largest(&forces(pipette(), connectivity, x)), 0.0);
    }
}
