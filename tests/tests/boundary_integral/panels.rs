//! Integrals over single triangles, near and far.

use super::{
    ONE, U, VISCOSITY, at_points, at_vertices, in_parts, largest_error, largest_norm, layer, scaled,
};
use helfrich::TriangleMesh;
use helfrich_std::flow::{DoubleLayer, SingleLayer};
use helfrich_tests::meshes::{Mesh, cross, difference, dot, icosphere, norm};
use helfrich_tests::quadrature::gauss_legendre;
use helfrich_tests::tolerance::{self, Tolerance};
use std::f64::consts::PI;

/// Integrals over a triangle with the singularity at a corner, against graded subdivision, relative.
const PANEL: Tolerance = Tolerance::new(
    1e-10,
    "forty halvings leave 1e-12; Gauss rules of 96 points on triangles of aspect up to ten the rest",
);

/// Velocity near a single triangle against Gauss rules of 96 points, relative.
const FLOW_SEVEN_POINTS: Tolerance = Tolerance::new(
    1e-6,
    "corners are at most 0.29 distances from the centre, 6e-4 in the sixth power, times the rule's \
     constant; most parts are farther away, and signs differ",
);

/// Integral of `integrand(r, value)` with r = x − origin over a triangle on which the values are linear, by a
/// product of two Gauss rules.
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

/// ∫ G(x − corners[0])·q dS, by repeated halving of the triangle towards the singular corner.
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
        // An obtuse triangle, one narrow at a corner, and a large one far from the origin.
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
            PANEL.assert(error, 0.0, norm(expected), "about a corner");
        }
    }
}

/// Far from a surface, velocities are sums over edge midpoints, three per triangle, on processors with any
/// vector width.
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
    // The number of points exceeds the vector width and is not a multiple of it.
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
    tolerance::FLOW_ROUNDING.assert(error, 0.0, largest_norm(&expected), "far off");
}

/// If every triangle is near, the remaining error is that of the seven-point rule of degree five.
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
        FLOW_SEVEN_POINTS.assert(error, 0.0, norm(expected), "velocity, single layer");

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
    // Points above a triangle's centre, an edge, a vertex and a general point, at several distances.
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
    tolerance::FLOW_NEAR.assert(error, 0.0, largest_norm(&expected), "near a surface");

    // The vertices of another surface at these points have the same velocities.
    let other = Mesh::new(
        points,
        (0..8).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
    );
    let mut tractions = field.clone();
    tractions.resize(field.len() + other.positions.len(), [0.0; 3]);
    let velocity = at_vertices(&layer(&[&sphere, &other], &tractions));
    let same = largest_error(&velocity[field.len()..], &found);
    tolerance::FLOW_ROUNDING.assert(same, 0.0, largest_norm(&found), "on another surface");
}

#[test]
fn points_on_a_surface_and_surfaces_without_extent_give_finite_velocities() {
    let sphere = icosphere(1);
    let layer_of = layer(&[&sphere], &sphere.positions);
    let found = at_points(&layer_of, &sphere.positions);
    let expected = at_vertices(&layer_of);
    let error = largest_error(&found, &expected);
    tolerance::FLOW_SPHERE.assert(error, 0.0, largest_norm(&sphere.positions), "at a vertex");
    let point = sphere.map(|_| [2.0, 3.0, 4.0]);
    let velocity = at_vertices(&layer(&[&point], &sphere.positions));
    assert!(velocity.iter().flatten().all(|&u| u == 0.0));
    let mut empty = SingleLayer::new([], VISCOSITY, ONE);
    empty.set_forces(&[], &[]);
    assert_eq!(at_points(&empty, &[U]), [[0.0; 3]]);
}
