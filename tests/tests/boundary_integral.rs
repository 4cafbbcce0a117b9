//! Layers of Stokes flow against exact solutions and brute force; ambient flows.

use helfrich::TriangleMesh;
use helfrich_std::flow::{Ambient, DoubleLayer, Gmres, SingleLayer};
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

/// The integral of `integrand(r, value)`, r = x − origin, over a triangle with a linear field on it,
/// by the product of two Gauss rules.
fn product_rule<const N: usize>(
    corners: [[f64; 3]; 3],
    values: [[f64; 3]; 3],
    origin: [f64; 3],
    rule: &[(f64, f64)],
    integrand: impl Fn([f64; 3], [f64; 3]) -> [f64; N],
) -> [f64; N] {
    let [a, b, c] = corners;
    let doubled = norm(cross(difference(b, a), difference(c, a)));
    let mut sum = [0.0; N];
    for &(first, w1) in rule {
        for &(second, w2) in rule {
            let (s, t) = (0.5 + 0.5 * first, 0.5 + 0.5 * second);
            let shares = [1.0 - s, s * (1.0 - t), s * t];
            let mean = |values: [[f64; 3]; 3]| -> [f64; 3] {
                std::array::from_fn(|k| (0..3).map(|n| shares[n] * values[n][k]).sum())
            };
            let part = integrand(difference(mean(corners), origin), mean(values));
            for k in 0..N {
                sum[k] += 0.25 * w1 * w2 * s * doubled * part[k];
            }
        }
    }
    sum
}

/// ∫ G(x − origin)·q dS.
fn tensor(
    corners: [[f64; 3]; 3],
    tractions: [[f64; 3]; 3],
    origin: [f64; 3],
    rule: &[(f64, f64)],
) -> [f64; 3] {
    product_rule(corners, tractions, origin, rule, |r, q| {
        let along = dot(r, q) / dot(r, r);
        std::array::from_fn(|k| (q[k] + along * r[k]) / norm(r))
    })
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

/// Far from a surface the sum is that of the middles of edges, three a triangle, whatever the
/// processor's way of adding them.
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
                        0.5 * (values[0][k] + values[1][k] + values[2][k] - values[own][k])
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
    let normal = [0.0, 0.0, 1.0];
    let values = [[1.0, -0.4, 0.2], [-0.3, 0.9, 2.0], [0.5, 0.1, -0.8]];
    let mut layer = SingleLayer::new([&mesh], (8.0 * PI).recip(), ONE);
    layer.set_tractions(&corners, &values);
    let mut double = DoubleLayer::new([&mesh], &[0.0], ONE);
    double.set_positions(&corners);
    double.set_velocities(&values);
    let rule = gauss_legendre(96);
    let points = [
        [0.5, 0.3, 0.4],
        [0.5, 0.3, -0.9],
        [1.3, 0.2, 0.1],
        [0.4, 0.2, 0.1],
    ];
    for point in points {
        let found = at_points(&layer, &[point])[0];
        let expected = tensor(corners, values, point, &rule);
        let error = norm(difference(found, expected));
        tolerance::FLOW_SEVEN_POINTS.assert(error, 0.0, norm(expected), "velocity, single layer");

        let mut found = [[0.0; 3]];
        double.add_at_points(&[point], &mut found);
        let expected = product_rule(corners, values, point, &rule, |r, u| {
            let factor = -6.0 / (8.0 * PI) * dot(r, u) * dot(r, normal) * norm(r).powi(-5);
            scaled(factor, r)
        });
        let error = norm(difference(found[0], expected));
        tolerance::FLOW_SEVEN_STRESSLETS.assert(
            error,
            0.0,
            norm(expected),
            "velocity, double layer",
        );

        let mut found = [0.0; 2];
        layer.add_pressure_at_points(&[point], &mut found[..1]);
        double.add_pressure_at_points(VISCOSITY, &[point], &mut found[1..]);
        let expected = product_rule(corners, values, point, &rule, |r, q| {
            let single = -dot(r, q) / (4.0 * PI) * norm(r).powi(-3);
            let double = 3.0 * dot(r, q) * dot(r, normal) * norm(r).powi(-5);
            let double = double - dot(q, normal) * norm(r).powi(-3);
            [single, VISCOSITY / (2.0 * PI) * double]
        });
        for k in 0..2 {
            let (found, expected) = (found[k], expected[k]);
            tolerance::FLOW_SEVEN_STRESSLETS.assert(found, expected, expected.abs(), "pressure");
        }
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

/// A straining motion.
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

/// The velocity in and around it.
fn around_strained(x: [f64; 3]) -> [f64; 3] {
    let r = norm(x).max(1.0);
    let along = 2.5 * dot(x, strained(x)) * (r.powi(-5) - r.powi(-7));
    let isotropic = scaled(r.powi(-5), strained(x));
    std::array::from_fn(|k| isotropic[k] + along * x[k])
}

/// The pressure.
fn pressure_around_strained(x: [f64; 3]) -> f64 {
    let r = norm(x);
    if r < 1.0 {
        0.0
    } else {
        5.0 * VISCOSITY * dot(x, strained(x)) * r.powi(-5)
    }
}

/// Both layers, and the velocity that solves their equation in fluid that is at rest far off.
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

/// Velocity and pressure in the fluid.
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
    // Inside and outside, within an edge of the surface and well off.
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
        tolerance::FLOW_PRESSURE.assert(pressures[2], 0.0, 1.0, "pressure");
    }
}

/// Rigid motion is free of stress: another viscosity inside changes nothing.
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
    tolerance::FLOW_SEVEN_STRESSLETS.assert(largest(&sum), 0.0, largest(&moving), "what is added");
    let mut velocity = vec![[0.0; 3]; moving.len()];
    let solved = double.solve(&mut Gmres::new(1e-12), &moving, &mut velocity);
    assert!(solved.converged, "{solved:?}");
    let error = largest_error(&velocity, &moving);
    tolerance::FLOW_SEVEN_STRESSLETS.assert(error, 0.0, largest(&moving), "velocity");
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
        // Back in the first order.
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
        tolerance::FLOW_SOLVED.assert(error, 0.0, largest(&expected), "velocity");
        let error = largest_error(&inside, &expected_inside);
        tolerance::FLOW_SOLVED.assert(error, 0.0, largest(&expected), "inside");
        for (p, expected) in pressure.iter().zip(&expected_pressure) {
            tolerance::FLOW_SOLVED.assert(*p, *expected, 1.0, "pressure");
        }
    }
    // Without a contrast there is nothing to solve.
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

/// A uniform velocity on a surface gives nothing outside: only near triangles done well show it.
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
        let error = largest(&sum);
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
            tolerance::FLOW_NEAR_PRESSURE.assert(*p, *expected, 10.0, "pressure");
        }
    }
}

/// Two sides of a pancake a twentieth of an edge apart.
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
        tolerance::FLOW_FACING.assert(error, 0.0, largest(expected), "pancake");
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
