//! Layers of Stokes flow against exact solutions and brute force; ambient flows.

mod clusters;
mod double_layer;
mod nested;
mod obstacles;
mod panels;
mod pressure;
mod single_layer;

use helfrich_std::flow::SingleLayer;
use helfrich_tests::meshes::{Mesh, difference, dot, norm};
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

fn largest_norm(field: &[[f64; 3]]) -> f64 {
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

/// Checks that errors fall at about second order from one refinement to the next.
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

/// Force per area on a sphere of radius 1 that moves with velocity U: the drag 6πμaU, spread evenly.
fn drag(mesh: &Mesh) -> Field {
    vec![scaled(1.5 * VISCOSITY, U); mesh.positions.len()]
}

/// Flow around this sphere: a Stokeslet and a source doublet.
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

/// The same flat triangles, each halved `halvings` times along its edges, and the linear field on them.
fn in_parts(mesh: &Mesh, field: &[[f64; 3]], halvings: u32) -> (Mesh, Field) {
    let (mut mesh, mut field) = (mesh.clone(), field.to_vec());
    for _ in 0..halvings {
        let divided = mesh.divided();
        // The field is linear on triangles, so that its values at edge midpoints are averages, like
        // positions.
        let values = Mesh {
            positions: field,
            ..mesh
        };
        field = values.divided().positions;
        mesh = divided;
    }
    (mesh, field)
}
