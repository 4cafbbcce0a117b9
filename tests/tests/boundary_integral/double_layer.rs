//! Fluids of two viscosities: single and double layer.

use super::{
    Field, ONE, U, VISCOSITY, assert_second_order, at_points, at_vertices, away, in_parts,
    largest_error, largest_norm, layer, scaled, together,
};
use helfrich_std::flow::{Ambient, DoubleLayer, Gmres, SingleLayer};
use helfrich_tests::meshes::{Mesh, cross, difference, dot, icosphere, norm};
use helfrich_tests::tolerance::{self, Tolerance};
use std::num::NonZeroUsize;

/// Pressures around a strained sphere, also within an edge length of it, relative to 5.
const FLOW_PRESSURE: Tolerance = Tolerance::new(
    2e-2,
    "flat triangles bend at edges, near which the pressure has the logarithm of the distance",
);

/// Pressures near a coarse surface whose triangles are halved adaptively, against those of the same surface
/// with edges a sixteenth as long, relative to the pressure two edge lengths away.
const FLOW_NEAR_PRESSURE: Tolerance = Tolerance::new(
    1e-3,
    "the rule of edge midpoints on a triangle at four times its edge length, for the third power of 1/r",
);

/// Velocities on a pancake whose facing triangles are halved adaptively, against those of the same surface
/// with edges a quarter as long, relative.
const FLOW_FACING: Tolerance = Tolerance::new(
    5e-3,
    "seven points on the neighbours of the triangles around a vertex, edge midpoints beyond",
);

/// Rate of strain: symmetric and without trace.
const E: [[f64; 3]; 3] = [[0.6, 0.4, -0.3], [0.4, -0.9, 0.2], [-0.3, 0.2, 0.3]];

fn strained(x: [f64; 3]) -> [f64; 3] {
    E.map(|row| dot(row, x))
}

/// The forces per area `μ (2λ + 3) E·n` on a sphere of radius 1 that strain it, and the fluid
/// inside, by E·x.
fn straining(mesh: &Mesh, ratio: f64) -> Field {
    let factor = VISCOSITY * (2.0 * ratio + 3.0);
    let rows = mesh.positions.iter();
    rows.map(|&x| scaled(factor, strained(x))).collect()
}

/// Velocity inside and around the strained sphere.
fn around_strained(x: [f64; 3]) -> [f64; 3] {
    let r = norm(x).max(1.0);
    let along = 2.5 * dot(x, strained(x)) * (r.powi(-5) - r.powi(-7));
    let isotropic = scaled(r.powi(-5), strained(x));
    std::array::from_fn(|k| isotropic[k] + along * x[k])
}

/// Pressure inside and around the strained sphere.
fn pressure_around_strained(x: [f64; 3]) -> f64 {
    let r = norm(x);
    if r < 1.0 {
        0.0
    } else {
        5.0 * VISCOSITY * dot(x, strained(x)) * r.powi(-5)
    }
}

/// Both layers, and the velocity that solves their equation in fluid that is at rest far away.
fn solved(
    meshes: &[&Mesh],
    ratios: &[f64],
    tractions: &[[f64; 3]],
    threads: NonZeroUsize,
) -> (SingleLayer, DoubleLayer, Field) {
    let mut single = layer(meshes, tractions);
    single.threads = threads;
    let connectivity = meshes.iter().map(|mesh| &mesh.connectivity);
    let mut double = DoubleLayer::new(connectivity, ratios, threads);
    double.set_positions(&together(meshes));
    let right = at_vertices(&single);
    let mut velocity = right.clone();
    let solved = double.solve(&mut Gmres::new(1e-12), &right, &mut velocity);
    assert!(solved.converged, "{solved:?}");
    assert!(solved.products <= 25, "{solved:?}");
    (single, double, velocity)
}

/// Velocity and pressure at points of the fluids.
fn in_fluid(single: &SingleLayer, double: &DoubleLayer, points: &[[f64; 3]]) -> (Field, Vec<f64>) {
    let mut velocity = at_points(single, points);
    double.add_at_points(points, &mut velocity);
    let mut ratios = vec![0.0; points.len()];
    double.viscosity_ratios(points, &mut ratios);
    for (u, ratio) in velocity.iter_mut().zip(ratios) {
        *u = scaled(ratio.recip(), *u);
    }
    let mut pressure = vec![0.0; points.len()];
    single.add_pressure_at_points(points, &mut pressure);
    double.add_pressure_at_points(single.viscosity, points, &mut pressure);
    (velocity, pressure)
}

#[test]
fn spheres_of_any_viscosity_are_strained() {
    // Points inside and outside, within an edge length of the surface and far from it.
    let direction = [0.48, -0.6, 0.64];
    let points = [0.0, 0.5, 0.97, 1.02, 1.5, 4.0].map(|r| scaled(r, direction));
    let expected_points = points.map(around_strained);
    for ratio in [0.2, 1.0, 5.0, 20.0] {
        let (mut on, mut off, mut pressures) = (Vec::new(), Vec::new(), Vec::new());
        for refinement in 2..=4 {
            let sphere = icosphere(refinement);
            let tractions = straining(&sphere, ratio);
            let (single, double, velocity) = solved(&[&sphere], &[ratio], &tractions, ONE);
            let expected = Vec::from_iter(sphere.positions.iter().map(|&x| strained(x)));
            on.push(largest_error(&velocity, &expected));
            let (velocity, pressure) = in_fluid(&single, &double, &points);
            off.push(largest_error(&velocity, &expected_points));
            let errors = points.iter().zip(&pressure);
            let errors = errors.map(|(&x, p)| (p - pressure_around_strained(x)).abs() / VISCOSITY);
            pressures.push(errors.fold(0.0, f64::max));
        }
        assert_second_order(&on, "on the surface");
        tolerance::FLOW_STRAINED.assert(on[2], 0.0, 1.0, "on the surface");
        tolerance::FLOW_STRAINED.assert(off[2], 0.0, 1.0, "off the surface");
        FLOW_PRESSURE.assert(pressures[2], 0.0, 1.0, "pressure");
    }
}

/// Rigid motion is free of stress, so that it solves the equation at any viscosity ratio.
#[test]
fn rigid_motions_hold_at_any_viscosity_ratio() {
    let (a, b) = (icosphere(2), away(&icosphere(1), [0.3, 2.4, 0.1]));
    let mut double = DoubleLayer::new([&a.connectivity, &b.connectivity], &[0.0, 30.0], ONE);
    double.set_positions(&together(&[&a, &b]));
    let spin = [0.4, -1.0, 0.7];
    let moving = Vec::from_iter(together(&[&a, &b]).into_iter().map(|x| {
        let around = cross(spin, x);
        std::array::from_fn(|k| U[k] + around[k])
    }));
    double.set_velocities(&moving);
    let mut sum = vec![[0.0; 3]; moving.len()];
    double.add_at_vertices(&mut sum);
    tolerance::FLOW_SEVEN_STRESSLETS.assert(
        largest_norm(&sum),
        0.0,
        largest_norm(&moving),
        "what is added",
    );
    let mut velocity = vec![[0.0; 3]; moving.len()];
    let solved = double.solve(&mut Gmres::new(1e-12), &moving, &mut velocity);
    assert!(solved.converged, "{solved:?}");
    let error = largest_error(&velocity, &moving);
    tolerance::FLOW_SEVEN_STRESSLETS.assert(error, 0.0, largest_norm(&moving), "velocity");
}

#[test]
fn surfaces_of_different_viscosities_may_stand_in_any_order() {
    let meshes = [
        icosphere(2),
        away(&icosphere(1), [0.3, 2.03, 0.1]),
        away(&icosphere(2), [-2.2, 0.1, 0.2]),
    ];
    let ratios = [0.3, 4.0, 1.0];
    let pulls = meshes.each_ref().map(|mesh| {
        let rows = mesh.positions.iter();
        Vec::from_iter(rows.map(|&[x, y, z]| [x * y, 0.3 - z, x + z * z]))
    });
    let points = [
        [0.2, 0.3, -0.1],
        [0.3, 2.2, 0.0],
        [0.2, 1.02, 0.1],
        [-2.0, 0.3, 0.1],
    ];
    let run = |order: [usize; 3]| {
        let meshes = order.map(|k| &meshes[k]);
        let tractions = order.map(|k| pulls[k].clone()).concat();
        let (single, double, velocity) =
            solved(&meshes, &order.map(|k| ratios[k]), &tractions, ONE);
        let (inside, pressure) = in_fluid(&single, &double, &points);
        // The velocities in the order of `meshes`.
        let mut parts = [(); 3].map(|()| Vec::new());
        let mut rest = velocity.as_slice();
        for (mesh, k) in meshes.iter().zip(order) {
            let (part, others) = rest.split_at(mesh.positions.len());
            parts[k] = part.to_vec();
            rest = others;
        }
        (parts.concat(), inside, pressure)
    };
    let (expected, expected_inside, expected_pressure) = run([0, 1, 2]);
    for order in [[1, 0, 2], [2, 1, 0], [1, 2, 0]] {
        let (velocity, inside, pressure) = run(order);
        let error = largest_error(&velocity, &expected);
        tolerance::FLOW_SOLVED.assert(error, 0.0, largest_norm(&expected), "velocity");
        let error = largest_error(&inside, &expected_inside);
        tolerance::FLOW_SOLVED.assert(error, 0.0, largest_norm(&expected), "inside");
        for (p, expected) in pressure.iter().zip(&expected_pressure) {
            tolerance::FLOW_SOLVED.assert(*p, *expected, 1.0, "pressure");
        }
    }
    // Without a viscosity contrast, the velocity is the single layer's.
    let (single, _, velocity) = solved(&[&meshes[0]], &[1.0], &pulls[0], ONE);
    assert_eq!(velocity, at_vertices(&single));
}

#[test]
fn both_layers_do_not_depend_on_the_number_of_threads() {
    let (a, b) = (icosphere(2), away(&icosphere(3), [0.0, 2.03, 0.0]));
    let tractions = together(&[&a, &b]);
    let points = Vec::from_iter((0..23).map(|k| [0.1 * f64::from(k), 1.0, 0.2]));
    let run = |threads| {
        let threads = NonZeroUsize::new(threads).unwrap();
        let (single, double, velocity) = solved(&[&a, &b], &[0.4, 3.0], &tractions, threads);
        (velocity, in_fluid(&single, &double, &points))
    };
    let alone = run(1);
    for threads in [2, 3] {
        assert!(alone == run(threads), "{threads}");
    }
}

/// A uniform velocity on a closed surface has no double-layer velocity outside, and the terms cancel only if
/// near triangles are integrated accurately.
#[test]
fn surfaces_that_almost_touch_see_each_other_whole() {
    let (a, b) = (icosphere(2), icosphere(3));
    for gap in [1e-9, 1e-3, 0.02, 0.3] {
        let moved = away(&b, [0.0, 0.0, 2.0 + gap]);
        let mut double = DoubleLayer::new([&a.connectivity, &moved.connectivity], &[5.0, 5.0], ONE);
        double.set_positions(&together(&[&a, &moved]));
        let mut velocity = vec![[0.0; 3]; a.positions.len()];
        velocity.resize(double.vertex_count(), U);
        double.set_velocities(&velocity);
        let mut sum = vec![[0.0; 3]; double.vertex_count()];
        double.add_at_vertices(&mut sum);
        let error = largest_norm(&sum);
        tolerance::FLOW_NEAR.assert(error, 0.0, 4.0 * norm(U), "from the other surface");
    }
}

#[test]
fn points_know_in_which_surface_they_are() {
    let (a, b) = (icosphere(2), away(&icosphere(3), [2.0, 1.0, 0.0]));
    let ratios = [0.1, 7.0];
    let mut double = DoubleLayer::new([&a.connectivity, &b.connectivity], &ratios, ONE);
    double.set_positions(&together(&[&a, &b]));
    let (mut points, mut expected) = (vec![[0.0, 0.0, 5.0], [30.0, 0.0, 0.0]], vec![1.0; 2]);
    for (mesh, ratio) in [&a, &b].into_iter().zip(ratios) {
        for &triangle in mesh.connectivity.triangles() {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            let normal = cross(difference(b, a), difference(c, a));
            for gap in [1e-12, 1e-6, 1e-2] {
                for (sign, ratio) in [(1.0, 1.0), (-1.0, ratio)] {
                    let step = scaled(sign * gap / norm(normal), normal);
                    points.push(std::array::from_fn(|k| {
                        0.2 * a[k] + 0.5 * b[k] + 0.3 * c[k] + step[k]
                    }));
                    expected.push(ratio);
                }
            }
        }
    }
    let mut found = vec![0.0; points.len()];
    double.viscosity_ratios(&points, &mut found);
    assert!(found == expected);
}

/// Points on one side of a body a twentieth of an edge thick are near the midpoints of edges on the other side,
/// whose contribution has the opposite sign and is replaced by solid angles.
#[test]
fn points_know_on_which_side_of_a_thin_body_they_are() {
    let sphere = icosphere(2);
    let thin = 0.05 * sphere.edge_length();
    let pancake = sphere.map(|[x, y, z]| [x, y, 0.5 * thin * z]);
    let inside = 0.1;
    let mut double = DoubleLayer::new([&pancake.connectivity], &[inside], ONE);
    double.set_positions(&pancake.positions);
    let (mut points, mut expected) = (Vec::new(), Vec::new());
    for &triangle in pancake.connectivity.triangles() {
        let [a, b, c] = triangle.map(|v| pancake.positions[v as usize]);
        let normal = cross(difference(b, a), difference(c, a));
        for [p, q, r] in [[0.2, 0.5, 0.3], [0.48, 0.48, 0.04]] {
            for (gap, ratio) in [(1e-9, 1.0), (1e-4 * thin, 1.0), (-1e-9, inside)] {
                let step = scaled(gap / norm(normal), normal);
                points.push(std::array::from_fn(|k| {
                    p * a[k] + q * b[k] + r * c[k] + step[k]
                }));
                expected.push(ratio);
            }
        }
    }
    let mut found = vec![0.0; points.len()];
    double.viscosity_ratios(&points, &mut found);
    assert!(found == expected);
}

#[test]
fn a_uniform_pull_is_a_step_of_the_pressure() {
    let points = [0.0, 0.6, 0.95, 1.05, 1.4, 3.0].map(|r| scaled(r / norm(U), U));
    let mut errors = Vec::new();
    for refinement in 2..=4 {
        let sphere = icosphere(refinement);
        let layer = layer(&[&sphere], &sphere.positions);
        let mut pressure = [0.0; 6];
        layer.add_pressure_at_points(&points, &mut pressure);
        let expected = [-1.0, -1.0, -1.0, 0.0, 0.0, 0.0];
        let error = pressure.iter().zip(expected).map(|(p, e)| (p - e).abs());
        errors.push(error.fold(0.0, f64::max));
    }
    assert_second_order(&errors, "pressure");
    tolerance::FLOW_SPHERE.assert(errors[2], 0.0, 1.0, "pressure");
}

#[test]
fn close_points_see_the_double_layer_in_parts() {
    let sphere = icosphere(2);
    let field = Vec::from_iter(
        sphere
            .positions
            .iter()
            .map(|&[x, y, z]| [1.0 + y, z * x, 0.5 - z]),
    );
    let (fine, fine_field) = in_parts(&sphere, &field, 4);
    let edge = sphere.edge_length();
    let [a, b, c] = sphere.connectivity.triangles()[17].map(|v| sphere.positions[v as usize]);
    let run = |mesh: &Mesh, field: &Field, points: &[[f64; 3]]| {
        let mut double = DoubleLayer::new([&mesh.connectivity], &[0.0], ONE);
        double.set_positions(&mesh.positions);
        double.set_velocities(field);
        let mut velocity = vec![[0.0; 3]; points.len()];
        double.add_at_points(points, &mut velocity);
        let mut pressure = vec![0.0; points.len()];
        double.add_pressure_at_points(VISCOSITY, points, &mut pressure);
        layer(&[mesh], field).add_pressure_at_points(points, &mut pressure);
        (velocity, pressure)
    };
    for gap in [0.01, 0.1, 0.3, 1.0, 2.0, -0.1] {
        let shares = [[1.0 / 3.0; 3], [0.5, 0.45, 0.05], [0.15, 0.25, 0.6]];
        let points = shares.map(|[p, q, r]| {
            let on: [f64; 3] = std::array::from_fn(|k| p * a[k] + q * b[k] + r * c[k]);
            scaled(1.0 + gap * edge / norm(on), on)
        });
        let (velocity, pressure) = run(&sphere, &field, &points);
        let (expected, expected_pressure) = run(&fine, &fine_field, &points);
        let error = largest_error(&velocity, &expected);
        tolerance::FLOW_NEAR.assert(error, 0.0, 1.0, "velocity");
        for (p, expected) in pressure.iter().zip(&expected_pressure) {
            FLOW_NEAR_PRESSURE.assert(*p, *expected, 10.0, "pressure");
        }
    }
}

/// The two sides of a pancake are a twentieth of an edge length apart.
#[test]
fn sides_of_one_surface_that_are_close_see_each_other_in_parts() {
    let sphere = icosphere(2);
    let thin = 0.05 * sphere.edge_length();
    let pancake = sphere.map(|[x, y, z]| [x, y, 0.5 * thin * z]);
    let field = Vec::from_iter(
        sphere
            .positions
            .iter()
            .map(|&[x, y, z]| [1.0 + y, z * x, 0.5 - z]),
    );
    let (fine, fine_field) = in_parts(&pancake, &field, 2);
    let count = pancake.positions.len();
    let run = |mesh: &Mesh, field: &Field| {
        let single = at_vertices(&layer(&[mesh], field));
        let mut double = DoubleLayer::new([&mesh.connectivity], &[0.0], ONE);
        double.set_positions(&mesh.positions);
        double.set_velocities(field);
        let mut sum = vec![[0.0; 3]; field.len()];
        double.add_at_vertices(&mut sum);
        [single[..count].to_vec(), sum[..count].to_vec()]
    };
    let found = run(&pancake, &field);
    let expected = run(&fine, &fine_field);
    for (found, expected) in found.iter().zip(&expected) {
        let error = largest_error(found, expected);
        FLOW_FACING.assert(error, 0.0, largest_norm(expected), "pancake");
    }
}

#[test]
fn ambient_flows_are_what_they_are_called() {
    let x = [2.0, -3.0, 5.0];
    assert_eq!(Ambient::shear(0.5).velocity(x), [-1.5, 0.0, 0.0]);
    assert_eq!(Ambient::extension(0.5).velocity(x), [1.0, 0.75, -1.25]);
    assert_eq!(Ambient::plane_extension(0.5).velocity(x), [1.0, 1.5, 0.0]);
    let tube = Ambient::Poiseuille {
        centre_velocity: 3.0,
        radius: 2.0,
        direction: [0.0, 0.0, 4.0],
        through: [1.0, 1.0, 9.0],
    };
    assert_eq!(tube.velocity([1.0, 1.0, -7.0]), [0.0, 0.0, 3.0]);
    assert_eq!(tube.velocity([2.0, 1.0, 0.0]), [0.0, 0.0, 2.25]);
    assert_eq!(tube.velocity([1.0, 3.0, 1.0]), [0.0; 3]);
    let mut velocity = [[1.0; 3], U];
    tube.add_velocity(&[[1.0, 1.0, 0.0]], &mut velocity);
    assert_eq!(velocity, [[1.0, 1.0, 4.0], U]);
    for flow in [
        Ambient::shear(0.7),
        Ambient::extension(0.7),
        Ambient::plane_extension(0.7),
        tube,
    ] {
        let step = 1e-3;
        let slope = |axis: usize| {
            let at = |sign: f64| {
                let mut y = x;
                y[axis] += sign * step;
                flow.velocity(y)[axis]
            };
            (at(1.0) - at(-1.0)) / (2.0 * step)
        };
        let divergence: f64 = (0..3).map(slope).sum();
        tolerance::TANGENT.assert(divergence, 0.0, 1.0, "divergence");

        // ∇p = μ ∇²u: both are polynomials of degree two or less.
        let moved = |axis: usize, by: f64| {
            let mut y = x;
            y[axis] += by;
            y
        };
        for axis in 0..3 {
            let pressure = |by: f64| flow.pressure(moved(axis, by), VISCOSITY);
            let second = |along: usize| {
                let velocity = |by: f64| flow.velocity(moved(along, by))[axis];
                velocity(1.0) - 2.0 * velocity(0.0) + velocity(-1.0)
            };
            let friction = VISCOSITY * (0..3).map(second).sum::<f64>();
            let slope = pressure(1.0) - pressure(0.0);
            tolerance::TANGENT.assert(slope, friction, 1.0, "pressure");
        }
    }
    assert_eq!(tube.pressure([2.0, 1.0, 10.0], 2.0), -6.0);
}
