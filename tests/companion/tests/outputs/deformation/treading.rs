//! Tank-treading of known bodies.

use super::{SEMI_AXES, assert_close, inclined, moved, of, plane, stretched};
use helfrich_std::checkpoint::{self, Fingerprint};
use helfrich_std::deformation::TankTreading;
use helfrich_tests::meshes::{Mesh, icosphere, octahedron, unit};
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::TAU;
use tempfile::TempDir;

/// Turns and period of a tank-treading ellipsoid of 162 vertices.
const TANK_TREADING: Tolerance = Tolerance::new(
    1e-2,
    "some thirty vertices are unevenly spread in phase; whole turns are interpolated over 0.09",
);

/// Tank-treading state of a body that is followed through time.
fn followed(times: usize, step: f64, body: impl Fn(f64) -> Mesh) -> TankTreading {
    let start = body(0.0);
    let mut state = TankTreading::new(start.surface(), &of(&start), plane(), 0.0);
    for count in 1..=times {
        let time = count as f64 * step;
        let now = body(time);
        state.update(time, now.surface(), &of(&now));
    }
    state
}

/// A sphere that rotates from y to x, as in a shear flow, has the period of its rotation.
#[test]
fn a_sphere_that_rotates_takes_its_period() {
    let omega = 1.3;
    let ball = icosphere(2);
    let spun = |time: f64| ball.map(|x| moved(inclined((-omega * time).to_degrees())(x)));
    let before = followed(40, 0.12, spun);
    assert_close(before.turns(), omega * 4.8 / TAU, 1.0, "turns");
    assert!(before.period().is_nan());
    let state = followed(100, 0.12, spun);
    assert_close(state.turns(), omega * 12.0 / TAU, 3.0, "turns");
    assert_close(state.period(), TAU / omega, 5.0, "period");
    assert_eq!(state.axis_turns(), 0.0);
    let back = followed(100, 0.12, |time| spun(-time));
    assert_close(back.turns(), -omega * 12.0 / TAU, 3.0, "turns backwards");
    assert_close(back.period(), TAU / omega, 5.0, "period backwards");
}

/// A body with dimples that lies in the shear plane: the bottoms of the dimples are near the plane but on the
/// axis, where nothing turns; the outer parts of the rims are far from the plane.
#[test]
fn what_is_on_the_axis_or_far_from_the_plane_does_not_count() {
    let omega = 1.1;
    // The mesh has vertices at the poles.
    let ball = octahedron().divided().divided().divided().map(unit);
    let disc = ball.map(|[x, y, z]| [x, y, 0.4 * z * (x * x + y * y + 0.05)]);
    let spun = |time: f64| {
        disc.map(|[x, y, z]| match z.abs() {
            // Far from the plane the material rests.
            0.05.. => [x, y, z],
            _ => inclined((-omega * time).to_degrees())([x, y, z]),
        })
    };
    let pole = disc.positions.iter().map(|&[x, y, _]| x.hypot(y));
    assert_eq!(pole.fold(1.0, f64::min), 0.0);
    let state = followed(30, 0.1, spun);
    assert_close(
        state.turns() + state.axis_turns(),
        omega * 3.0 / TAU,
        1.0,
        "turns",
    );
}

/// Keller and Skalak's membrane: the ellipsoid stays and its points circulate.
#[test]
fn a_membrane_that_treads_takes_its_period() {
    let ball = icosphere(2);
    let [a, b, c] = SEMI_AXES;
    let treading = |time: f64| {
        ball.map(|x| {
            let [x, y, z] = inclined(-time.to_degrees())(x);
            moved(inclined(20.0)([a * x, b * y, c * z]))
        })
    };
    let state = followed(200, 0.09, treading);
    // Between whole turns, the vertices of this mesh are not quite evenly spread in phase.
    TANK_TREADING.assert(state.turns(), 18.0 / TAU, 1.0, "turns");
    TANK_TREADING.assert(state.period(), TAU, 1.0, "period");
    assert_close(state.axis_turns(), 0.0, 1.0, "the axis stays");
}

/// The same membrane with a mesh that stays while the material moves past it and the body drifts.
#[test]
fn material_that_goes_by_takes_its_period() {
    let ball = icosphere(2);
    let [a, b, c] = SEMI_AXES;
    let drift = [0.4, -0.1, 0.2];
    let stays = ball.map(|[x, y, z]| [a * x, b * y, c * z]);
    let at = |time: f64| {
        stays.map(|x| {
            let x = moved(inclined(20.0)(x));
            std::array::from_fn(|axis| x[axis] + time * drift[axis])
        })
    };
    let velocities = Vec::from_iter(stays.positions.iter().map(|&[x, y, _]| {
        let going = inclined(20.0)([a / b * y, -b / a * x, 0.0]);
        std::array::from_fn(|axis| going[axis] + drift[axis])
    }));
    let start = at(0.0);
    let mut state = TankTreading::new(start.surface(), &of(&start), plane(), 0.0);
    for count in 1..=200 {
        let time = f64::from(count) * 0.09;
        let now = at(time);
        state.update_by_velocities(time, now.surface(), &of(&now), &velocities);
    }
    TANK_TREADING.assert(state.turns(), 18.0 / TAU, 1.0, "turns");
    TANK_TREADING.assert(state.period(), TAU, 1.0, "period");
    assert_close(state.axis_turns(), 0.0, 1.0, "the axis stays");
}

/// A body rotates rigidly, with a mesh that follows it and an angular velocity that changes from step to
/// step.
#[test]
fn material_that_turns_with_its_body_does_not_tread() {
    let omega = |time: f64| 1.0 + 0.5 * time.cos();
    let angle = |time: f64| time + 0.5 * time.sin();
    let long = stretched(2, [1.0, 3.0, 1.0]);
    let at = |time: f64| long.map(inclined(-angle(time).to_degrees()));
    let start = at(0.0);
    let mut state = TankTreading::new(start.surface(), &of(&start), plane(), 0.0);
    for count in 1..=100 {
        let time = f64::from(count) * 0.1;
        let now = at(time);
        let turning = now
            .positions
            .iter()
            .map(|&[x, y, _]| [omega(time) * y, -omega(time) * x, 0.0]);
        let velocities = Vec::from_iter(turning);
        state.update_by_velocities(time, now.surface(), &of(&now), &velocities);
    }
    assert_close(state.axis_turns(), angle(10.0) / TAU, 1.0, "tumbling");
    // The error is of second order in steps of a tenth; the first step has no earlier rate.
    TANK_TREADING.assert(state.turns(), 0.0, 1.0, "treading");
}

/// A rigid body tumbles in shear: G. B. Jeffery, Proc. R. Soc. A 102 (1922) 161.
#[test]
fn a_body_that_tumbles_does_not_tread() {
    let (rate, ratio) = (0.7, 3.0);
    let orbit = TAU / rate * (ratio + 1.0 / ratio);
    let from_gradient = |time: f64| {
        let phase = TAU * time / orbit;
        // Arc tangent of r tan φ, continued beyond its branch.
        (ratio * phase.sin()).atan2(phase.cos())
    };
    let long = stretched(2, [1.0, ratio, 1.0]);
    let tumbling = |time: f64| long.map(inclined(-from_gradient(time).to_degrees()));
    for part in 1..20 {
        let time = orbit * f64::from(part) / 20.0;
        let found = of(&tumbling(time)).in_plane(plane()).inclination;
        let expected = 90.0 - from_gradient(time).to_degrees();
        let away = (found - expected).rem_euclid(180.0);
        assert_close(away.min(180.0 - away), 0.0, 90.0, "inclination");
    }
    let state = followed(150, orbit / 100.0, tumbling);
    assert_close(state.axis_turns(), 1.5, 1.0, "tumbling");
    assert_close(state.turns(), 0.0, 1.0, "treading");
    assert!(state.period().is_nan());
}

/// The long axis of a nearly spherical body is an artefact of its mesh, and its turns do not count.
#[test]
fn the_axis_counts_from_when_there_is_one() {
    let ball = icosphere(1);
    let growing = |time: f64| {
        let (stretch, angle) = match time {
            0.0..0.45 => (1.0 + 1e-3, 170.0),
            _ => (1.5, 40.0 - 10.0 * time),
        };
        ball.map(|[x, y, z]| inclined(angle)([stretch * x, y, z]))
    };
    let state = followed(9, 0.2, growing);
    // The axis turns from 34° at t = 0.6 to 22° at 1.8.
    assert_close(state.axis_turns(), 12.0 / 360.0, 1.0, "turns of the axis");
    // After a spherical phase, the count continues from the last axis.
    let waning = |time: f64| {
        let stretch = if (0.5..1.1).contains(&time) { 1.0 } else { 1.5 };
        ball.map(|[x, y, z]| inclined(40.0 - 10.0 * time)([stretch * x, y, z]))
    };
    let state = followed(9, 0.2, waning);
    assert_close(state.axis_turns(), 18.0 / 360.0, 1.0, "turns in all");
}

#[test]
fn treading_goes_on_from_its_stored_bits() {
    let ball = icosphere(1);
    let body = |time: f64| {
        ball.map(|x| {
            let [x, y, z] = inclined(-30.0 * time)(x);
            inclined(10.0 * time.sin())([1.4 * x, y, z])
        })
    };
    let whole = followed(60, 0.3, body);
    let half = followed(37, 0.3, body);
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let fingerprint = Fingerprint::of("treading");
    checkpoint::write(&path, fingerprint, &half).unwrap();
    let mut resumed: TankTreading = checkpoint::read(&path, fingerprint).unwrap();
    assert_eq!(resumed, half);
    for count in 38..=60 {
        let time = f64::from(count) * 0.3;
        let now = body(time);
        resumed.update(time, now.surface(), &of(&now));
    }
    assert_eq!(resumed, whole);
}
