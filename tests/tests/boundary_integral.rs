//! The single layer of Stokes flow against exact solutions and brute force; ambient flows.

use helfrich::TriangleMesh;
use helfrich_std::flow::{Ambient, SingleLayer};
use helfrich_tests::meshes::{
    GENERIC, Mesh, cross, difference, dot, icosphere, norm, rotation, turned,
};
use helfrich_tests::quadrature::gauss_legendre;
use helfrich_tests::tolerance;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

type Field = Vec<[f64; 3]>;

const U: [f64; 3] = [0.3, -0.5, 0.8];
const VISCOSITY: f64 = 1.7;
const ONE: NonZeroUsize = NonZeroUsize::MIN;

fn layer(meshes: &[&Mesh], tractions: &[[f64; 3]]) -> SingleLayer {
    let connectivity = meshes.iter().map(|mesh| &mesh.connectivity);
    let mut layer = SingleLayer::new(connectivity, VISCOSITY, ONE);
    layer.set_tractions(&together(meshes), tractions);
    layer
}

fn together(meshes: &[&Mesh]) -> Field {
    let positions = meshes.iter().flat_map(|mesh| &mesh.positions);
    positions.copied().collect()
}

fn at_vertices(layer: &SingleLayer) -> Field {
    let mut velocity = vec![[0.0; 3]; layer.vertex_count()];
    layer.add_at_vertices(&mut velocity);
    velocity
}

fn at_points(layer: &SingleLayer, points: &[[f64; 3]]) -> Field {
    let mut velocity = vec![[0.0; 3]; points.len()];
    layer.add_at_points(points, &mut velocity);
    velocity
}

fn largest(field: &[[f64; 3]]) -> f64 {
    field.iter().map(|&u| norm(u)).fold(0.0, f64::max)
}

fn largest_error(found: &[[f64; 3]], expected: &[[f64; 3]]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let error = |(&a, &b): (&[f64; 3], &[f64; 3])| norm(difference(a, b));
    found.iter().zip(expected).map(error).fold(0.0, f64::max)
}

fn scaled(factor: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    [factor * x, factor * y, factor * z]
}

/// The order at which errors fall from one refinement to the next.
#[track_caller]
fn assert_second_order(errors: &[f64], what: &str) {
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(
            (1.7..3.3).contains(&order),
            "{what}: order {order} in {errors:?}"
        );
    }
}

/// The force per area on a sphere of radius 1 that moves with U: 6πμaU, spread evenly.
fn drag(mesh: &Mesh) -> Field {
    vec![scaled(1.5 * VISCOSITY, U); mesh.positions.len()]
}

/// The flow around it: a Stokeslet and a source doublet.
fn around_sphere(x: [f64; 3]) -> [f64; 3] {
    let r = norm(x);
    let along = dot(x, U);
    let (near, far) = (0.25 * r.powi(-3), 0.75 / r);
    std::array::from_fn(|k| {
        far * (U[k] + x[k] * along / (r * r)) + near * (U[k] - 3.0 * x[k] * along / (r * r))
    })
}

fn away(mesh: &Mesh, [a, b, c]: [f64; 3]) -> Mesh {
    mesh.map(|[x, y, z]| [x + a, y + b, z + c])
}

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
    // Lengths far from 1: forces per area go with their square.
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
    tolerance::FLOW_ROUNDING.assert(error, 0.0, largest(&expected), "velocity");
}

#[test]
fn pressure_moves_nothing() {
    let (mut on, mut off) = (Vec::new(), Vec::new());
    for refinement in 1..=4 {
        let sphere = icosphere(refinement);
        let layer = layer(&[&sphere], &sphere.positions);
        on.push(largest(&at_vertices(&layer)));
        // Inside, just off the surface on both sides, and outside.
        let points = [0.0, 0.3, 0.7, 1.3, 3.0].map(|r| scaled(r / norm(U), U));
        off.push(largest(&at_points(&layer, &points)));
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
    tolerance::FLOW_MOTION.assert(error, 0.0, largest(&expected), "velocity");
}

/// ∫ G(x − origin)·q dS over a triangle by the product of two Gauss rules.
fn tensor(
    corners: [[f64; 3]; 3],
    tractions: [[f64; 3]; 3],
    origin: [f64; 3],
    rule: &[(f64, f64)],
) -> [f64; 3] {
    let [a, b, c] = corners;
    let doubled = norm(cross(difference(b, a), difference(c, a)));
    let mut sum = [0.0; 3];
    for &(first, w1) in rule {
        for &(second, w2) in rule {
            let (s, t) = (0.5 + 0.5 * first, 0.5 + 0.5 * second);
            let shares = [1.0 - s, s * (1.0 - t), s * t];
            let mean = |values: [[f64; 3]; 3]| -> [f64; 3] {
                std::array::from_fn(|k| (0..3).map(|n| shares[n] * values[n][k]).sum())
            };
            let (r, q) = (difference(mean(corners), origin), mean(tractions));
            let weight = 0.25 * w1 * w2 * s * doubled / norm(r);
            let along = dot(r, q) / dot(r, r);
            for k in 0..3 {
                sum[k] += weight * (q[k] + along * r[k]);
            }
        }
    }
    sum
}

/// ∫ G(x − corners[0])·q dS by triangles that are halved towards the corner.
fn graded(corners: [[f64; 3]; 3], tractions: [[f64; 3]; 3], halvings: u32) -> [f64; 3] {
    let rule = gauss_legendre(96);
    let origin = corners[0];
    let (mut corners, mut tractions) = (corners, tractions);
    let mut sum = [0.0; 3];
    for _ in 0..halvings {
        let middle =
            |[a, b]: [[f64; 3]; 2]| -> [f64; 3] { std::array::from_fn(|k| 0.5 * (a[k] + b[k])) };
        let middles = |[a, b, c]: [[f64; 3]; 3]| [[a, b], [b, c], [c, a]].map(middle);
        let ([ab, bc, ca], [fab, fbc, fca]) = (middles(corners), middles(tractions));
        let ([a, b, c], [fa, fb, fc]) = (corners, tractions);
        let parts = [
            ([ab, b, bc], [fab, fb, fbc]),
            ([ca, bc, c], [fca, fbc, fc]),
            ([ab, bc, ca], [fab, fbc, fca]),
        ];
        for (corners, tractions) in parts {
            let part = tensor(corners, tractions, origin, &rule);
            sum = std::array::from_fn(|k| sum[k] + part[k]);
        }
        (corners, tractions) = ([a, ab, ca], [fa, fab, fca]);
    }
    sum
}

#[test]
fn triangles_are_exact_about_their_corners() {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let shapes = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.8, 0.3]],
        // Obtuse; narrow at one corner; large and far from the origin.
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [-0.7, 0.2, 0.3]],
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.1, 0.0, 0.05]],
        [
            [900.0, 0.0, 50.0],
            [960.0, 10.0, 40.0],
            [930.0, -30.0, 50.0],
        ],
    ];
    let tractions = [[1.0, -0.4, 0.2], [-0.3, 0.9, 2.0], [0.5, 0.1, -0.8]];
    for corners in shapes {
        let mut layer = SingleLayer::new([&mesh], (8.0 * PI).recip(), ONE);
        layer.set_tractions(&corners, &tractions);
        for (first, found) in at_vertices(&layer).into_iter().enumerate() {
            let order = [first, (first + 1) % 3, (first + 2) % 3];
            let expected = graded(order.map(|k| corners[k]), order.map(|k| tractions[k]), 40);
            let error = norm(difference(found, expected));
            tolerance::PANEL.assert(error, 0.0, norm(expected), "about a corner");
        }
    }
}

/// Far from a surface the sum is that of three points a triangle, the middles between corners and
/// centre, whatever the processor's way of adding them.
#[test]
fn far_points_see_three_stokeslets_a_triangle() {
    let sphere = icosphere(2);
    let field = Vec::from_iter(
        sphere
            .positions
            .iter()
            .map(|&[x, y, z]| [1.0 + y, z * x, 0.5 - z]),
    );
    let surface = sphere.surface();
    // More than a lane of them, and not a multiple.
    let points = Vec::from_iter((0..7).map(|k| [3.0, -2.0 + f64::from(k), 1.0]));
    let expected = points.iter().map(|&point| {
        let mut sum = [0.0; 3];
        for (number, &triangle) in sphere.connectivity.triangles().iter().enumerate() {
            let corners = triangle.map(|v| sphere.positions[v as usize]);
            let tractions = triangle.map(|v| field[v as usize]);
            let weight = surface.triangle_area(number) / 3.0 / (8.0 * PI * VISCOSITY);
            for own in 0..3 {
                let mean = |values: [[f64; 3]; 3]| -> [f64; 3] {
                    std::array::from_fn(|k| {
                        (values[0][k] + values[1][k] + values[2][k]) / 6.0 + 0.5 * values[own][k]
                    })
                };
                let (r, q) = (difference(mean(corners), point), mean(tractions));
                let along = dot(r, q) / dot(r, r);
                sum = std::array::from_fn(|k| sum[k] + weight / norm(r) * (q[k] + along * r[k]));
            }
        }
        sum
    });
    let expected = Vec::from_iter(expected);
    let error = largest_error(&at_points(&layer(&[&sphere], &field), &points), &expected);
    tolerance::FLOW_ROUNDING.assert(error, 0.0, largest(&expected), "far off");
}

/// With parts that are near throughout, what is left is the error of seven points.
#[test]
fn near_triangles_are_integrated_to_degree_five() {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 0.9, 0.0]];
    let tractions = [[1.0, -0.4, 0.2], [-0.3, 0.9, 2.0], [0.5, 0.1, -0.8]];
    let mut layer = SingleLayer::new([&mesh], (8.0 * PI).recip(), ONE);
    layer.set_tractions(&corners, &tractions);
    for point in [[0.5, 0.3, 0.4], [0.5, 0.3, -0.9], [1.3, 0.2, 0.1]] {
        let found = at_points(&layer, &[point])[0];
        let expected = tensor(corners, tractions, point, &gauss_legendre(96));
        let error = norm(difference(found, expected));
        tolerance::FLOW_SEVEN_POINTS.assert(error, 0.0, norm(expected), "near a triangle");
    }
}

/// A mesh of the same flat triangles in parts, and a linear field on it.
fn in_parts(mesh: &Mesh, field: &[[f64; 3]], halvings: u32) -> (Mesh, Field) {
    let (mut mesh, mut field) = (mesh.clone(), field.to_vec());
    for _ in 0..halvings {
        let divided = mesh.divided();
        // The values halve like positions do.
        let values = Mesh {
            positions: field,
            ..mesh
        };
        field = values.divided().positions;
        mesh = divided;
    }
    (mesh, field)
}

#[test]
fn close_points_see_triangles_in_parts() {
    let sphere = icosphere(2);
    let field = Vec::from_iter(
        sphere
            .positions
            .iter()
            .map(|&[x, y, z]| [1.0 + y, z * x, 0.5 - z]),
    );
    let (fine, fine_field) = in_parts(&sphere, &field, 4);
    let edge = sphere.edge_length();
    // Above a triangle's middle, above an edge, above a vertex; at several distances.
    let [a, b, c] = sphere.connectivity.triangles()[17].map(|v| sphere.positions[v as usize]);
    let shares = [
        [1.0 / 3.0; 3],
        [0.5, 0.5, 0.0],
        [1.0, 0.0, 0.0],
        [0.15, 0.25, 0.6],
    ];
    let mut points = Vec::new();
    for gap in [0.01, 0.1, 0.3, 1.0, 2.0, -0.1] {
        for [p, q, r] in shares {
            let on: [f64; 3] = std::array::from_fn(|k| p * a[k] + q * b[k] + r * c[k]);
            points.push(scaled(1.0 + gap * edge / norm(on), on));
        }
    }
    let found = at_points(&layer(&[&sphere], &field), &points);
    let expected = at_points(&layer(&[&fine], &fine_field), &points);
    let error = largest_error(&found, &expected);
    tolerance::FLOW_NEAR.assert(error, 0.0, largest(&expected), "near a surface");

    // The same on the vertices of a surface that touches nothing but is as near.
    let other = Mesh::new(
        points,
        (0..8).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
    );
    let mut tractions = field.clone();
    tractions.resize(field.len() + other.positions.len(), [0.0; 3]);
    let velocity = at_vertices(&layer(&[&sphere, &other], &tractions));
    let same = largest_error(&velocity[field.len()..], &found);
    tolerance::FLOW_ROUNDING.assert(same, 0.0, largest(&found), "on another surface");
}

#[test]
fn points_on_a_surface_and_surfaces_without_extent_give_finite_velocities() {
    let sphere = icosphere(1);
    let layer_of = layer(&[&sphere], &sphere.positions);
    let found = at_points(&layer_of, &sphere.positions);
    let expected = at_vertices(&layer_of);
    let error = largest_error(&found, &expected);
    tolerance::FLOW_SPHERE.assert(error, 0.0, largest(&sphere.positions), "at a vertex");
    let point = sphere.map(|_| [2.0, 3.0, 4.0]);
    let velocity = at_vertices(&layer(&[&point], &sphere.positions));
    assert!(velocity.iter().flatten().all(|&u| u == 0.0));
    let mut empty = SingleLayer::new([], VISCOSITY, ONE);
    empty.set_forces(&[], &[]);
    assert_eq!(at_points(&empty, &[U]), [[0.0; 3]]);
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
    }
}
