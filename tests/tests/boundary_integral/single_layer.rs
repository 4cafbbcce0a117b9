//! Velocities of the single layer.

use super::{
    U, VISCOSITY, around_sphere, assert_second_order, at_points, at_vertices, away, drag,
    largest_error, largest_norm, layer, scaled, together,
};
use helfrich_tests::meshes::{GENERIC, icosphere, norm, rotation, turned};
use helfrich_tests::tolerance::{self, Tolerance};
use std::num::NonZeroUsize;

/// Velocities of moved and turned surfaces, relative to the largest.
const FLOW_MOTION: Tolerance = Tolerance::new(
    1e-11,
    "positions are rounded at 1e-15 of a distance some hundred times that between near vertices",
);

#[test]
fn spheres_feel_the_drag_of_stokes() {
    let mut errors = Vec::new();
    for refinement in 1..=4 {
        let sphere = icosphere(refinement);
        let velocity = at_vertices(&layer(&[&sphere], &drag(&sphere)));
        errors.push(largest_error(&velocity, &vec![U; velocity.len()]) / norm(U));
    }
    assert_second_order(&errors, "drag");
    tolerance::FLOW_SPHERE.assert(errors[3], 0.0, 1.0, "drag");
}

#[test]
fn nodal_forces_are_spread_over_barycentric_areas() {
    // Lengths are far from 1, so that a wrong power of length in the forces per area shows.
    let sphere = icosphere(2).map(|x| scaled(3e-6, x));
    let surface = sphere.surface();
    let tractions = Vec::from_iter(
        sphere
            .positions
            .iter()
            .map(|&[x, y, z]| [y, 2.0 * z, x - y]),
    );
    let mut areas = vec![0.0; sphere.positions.len()];
    for (number, triangle) in sphere.connectivity.triangles().iter().enumerate() {
        for &corner in triangle {
            areas[corner as usize] += surface.triangle_area(number) / 3.0;
        }
    }
    let forces = tractions
        .iter()
        .zip(&areas)
        .map(|(&q, &area)| scaled(area, q));
    let mut layer = layer(&[&sphere], &tractions);
    let expected = at_vertices(&layer);
    layer.set_forces(&sphere.positions, &Vec::from_iter(forces));
    let error = largest_error(&at_vertices(&layer), &expected);
    tolerance::FLOW_ROUNDING.assert(error, 0.0, largest_norm(&expected), "velocity");
}

#[test]
fn pressure_moves_nothing() {
    let (mut on, mut off) = (Vec::new(), Vec::new());
    for refinement in 1..=4 {
        let sphere = icosphere(refinement);
        let layer = layer(&[&sphere], &sphere.positions);
        on.push(largest_norm(&at_vertices(&layer)));
        // Points inside and outside the sphere.
        let points = [0.0, 0.3, 0.7, 1.3, 3.0].map(|r| scaled(r / norm(U), U));
        off.push(largest_norm(&at_points(&layer, &points)));
    }
    assert_second_order(&on, "∫ G·n dS on the surface");
    assert_second_order(&off[1..], "∫ G·n dS off the surface");
    tolerance::FLOW_SPHERE.assert(on[3] * VISCOSITY, 0.0, 1.0, "on the surface");
    tolerance::FLOW_SPHERE.assert(off[3] * VISCOSITY, 0.0, 1.0, "off the surface");
}

#[test]
fn spheres_move_what_is_around_them() {
    let mut errors = Vec::new();
    for refinement in 1..=4 {
        let (sphere, other) = (icosphere(refinement), away(&icosphere(2), [0.6, 2.1, -0.4]));
        let mut tractions = drag(&sphere);
        tractions.resize(sphere.positions.len() + other.positions.len(), [0.0; 3]);
        let layer = layer(&[&sphere, &other], &tractions);
        let velocity = at_vertices(&layer);
        let velocity = &velocity[sphere.positions.len()..];
        let expected = Vec::from_iter(other.positions.iter().map(|&x| around_sphere(x)));
        errors.push(largest_error(velocity, &expected) / norm(U));
        let same = largest_error(velocity, &at_points(&layer, &other.positions));
        tolerance::FLOW_ROUNDING.assert(same, 0.0, norm(U), "at points without force");
    }
    assert_second_order(&errors, "flow around a sphere");
    tolerance::FLOW_SPHERE.assert(errors[3], 0.0, 1.0, "flow around a sphere");
}

#[test]
fn the_fluid_inside_moves_along() {
    let sphere = icosphere(4);
    let points = [0.0, 0.5, 0.97].map(|r| scaled(r, [0.6, 0.0, -0.8]));
    let velocity = at_points(&layer(&[&sphere], &drag(&sphere)), &points);
    let error = largest_error(&velocity, &[U; 3]);
    tolerance::FLOW_SPHERE.assert(error, 0.0, norm(U), "inside");
}

#[test]
fn velocities_do_not_depend_on_the_number_of_threads() {
    let (a, b) = (icosphere(2), away(&icosphere(3), [0.0, 2.03, 0.0]));
    let tractions = together(&[&a, &b]);
    let mut layer = layer(&[&a, &b], &tractions);
    let points = Vec::from_iter((0..23).map(|k| [0.1 * f64::from(k), 1.0, 0.2]));
    let alone = (at_vertices(&layer), at_points(&layer, &points));
    for threads in [2, 3, 7] {
        layer.threads = NonZeroUsize::new(threads).unwrap();
        assert!(
            alone == (at_vertices(&layer), at_points(&layer, &points)),
            "{threads}"
        );
    }
}

#[test]
fn velocities_move_with_the_surfaces() {
    let (a, b) = (icosphere(2), away(&icosphere(1), [0.2, 2.05, 0.1]));
    let tractions = Vec::from_iter(
        together(&[&a, &b])
            .iter()
            .map(|&[x, y, z]| [x * y, 0.3 - z, x + z * z]),
    );
    let turn = rotation(GENERIC);
    let place = |x| {
        let [x, y, z] = turned(turn, x);
        [x + 30.0, y - 7.0, z + 2.0]
    };
    let (c, d) = (a.map(place), b.map(place));
    let turned_tractions = Vec::from_iter(tractions.iter().map(|&q| turned(turn, q)));
    let expected = at_vertices(&layer(&[&a, &b], &tractions));
    let expected = Vec::from_iter(expected.into_iter().map(|u| turned(turn, u)));
    let found = at_vertices(&layer(&[&c, &d], &turned_tractions));
    let error = largest_error(&found, &expected);
    FLOW_MOTION.assert(error, 0.0, largest_norm(&expected), "velocity");
}
