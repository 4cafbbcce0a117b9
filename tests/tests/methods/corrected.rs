//! Corrected curvature measures: exact cases, orders of convergence, and vertices without values.

use helfrich::{CorrectedCurvature, Curvature, Finding, Prepared, VertexKind, VertexNormals};
use helfrich_std::generate::{Family, generate};
use helfrich_tests::accuracy::{self, surface};
use helfrich_tests::meshes::{Mesh, icosahedron, octahedron, tetrahedron};
use helfrich_tests::tolerance;

const AVERAGED: CorrectedCurvature = CorrectedCurvature {
    normals: VertexNormals::Averaged,
};
const FITTED: CorrectedCurvature = CorrectedCurvature {
    normals: VertexNormals::Fitted,
};

fn curvatures(method: CorrectedCurvature, mesh: &Mesh) -> Vec<Curvature<f64>> {
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    prepared.curvatures(mesh.surface()).to_vec()
}

/// On regular solids the averaged normals are those of the circumscribed sphere, and the measures of a
/// triangle with normals x/R are exact: H = 1/R, K = 1/R², positive if triangles are counterclockwise from
/// outside.
#[test]
fn regular_solids_have_the_curvature_of_their_sphere() {
    for (name, solid) in [
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("icosahedron", icosahedron()),
    ] {
        let [x, y, z] = solid.positions[0];
        let radius = (x * x + y * y + z * z).sqrt();
        for scale in [1e-3, 1.0, 1e3] {
            let mesh = solid.map(|point| point.map(|x| scale / radius * x));
            for vertex in curvatures(AVERAGED, &mesh) {
                tolerance::SAME.assert(vertex.mean * scale, 1.0, 1.0, name);
                tolerance::SAME.assert(vertex.gaussian * scale * scale, 1.0, 1.0, name);
            }
        }
    }
}

/// Largest relative errors of H and K on two meshes of a shape.
fn errors(
    method: CorrectedCurvature,
    shape: &str,
    family: Family,
    vertices: [usize; 2],
) -> [[f64; 2]; 2] {
    vertices.map(|vertices| {
        let shape = shape.parse().expect("a shape");
        let made = generate(&shape, family, vertices, 1).expect("a mesh");
        let mut prepared = Prepared::new(method, &made.mesh);
        let found = prepared.curvatures(surface(&made));
        let mean = |vertex: usize, exact: f64| (found[vertex].mean - exact).abs();
        let gaussian = |vertex: usize, exact: f64| (found[vertex].gaussian - exact).abs();
        [
            accuracy::errors(&made, |point| point.mean, mean).max,
            accuracy::errors(&made, |point| point.gaussian, gaussian).max,
        ]
    })
}

/// Orders of H and K between two meshes whose edge lengths have the ratio four.
fn orders(errors: [[f64; 2]; 2]) -> [f64; 2] {
    let [coarse, fine] = errors;
    [0, 1].map(|k| (coarse[k] / fine[k]).log2() / 2.0)
}

/// With normals of fourth order, only the interpolation's error remains: second order where triangles are
/// arranged evenly, first order on any mesh.
#[test]
fn fitted_normals_converge_at_every_vertex() {
    for (shape, family, vertices, least) in [
        ("torus", Family::Regular, [800, 12_800], 1.8),
        ("ellipsoid", Family::Irregular, [642, 10_242], 0.7),
    ] {
        let errors = errors(FITTED, shape, family, vertices);
        for order in orders(errors) {
            assert!(
                order > least,
                "{shape}, {family}: order {order}, {errors:?}"
            );
        }
    }
}

/// Averaged normals are of second order on an even lattice, and the measures converge with them.
#[test]
fn averaged_normals_converge_on_an_even_torus() {
    let errors = errors(AVERAGED, "torus", Family::Regular, [800, 12_800]);
    for order in orders(errors) {
        assert!(order > 1.8, "order {order}, {errors:?}");
    }
}

/// Boundary vertices have no curvature, and a finding reports vertices without area.
#[test]
fn what_is_left_out_is_reported() {
    let solid = icosahedron();
    let triangles = solid.connectivity.triangles()[1..].to_vec();
    for vertex in curvatures(AVERAGED, &Mesh::new(solid.positions.clone(), triangles)) {
        let defined = vertex.kind == VertexKind::Interior;
        assert_eq!([vertex.mean != 0.0, vertex.gaussian != 0.0], [defined; 2]);
    }
    let point = solid.map(|_| [1.0; 3]);
    let mut prepared = Prepared::new(AVERAGED, &point.connectivity);
    let curvature = prepared.curvatures(point.surface());
    assert!(curvature.iter().all(|vertex| vertex.mean == 0.0));
    let mut reported = 0;
    prepared.inspect(point.surface(), &mut |finding| {
        reported += usize::from(matches!(finding, Finding::ZeroArea { .. }));
    });
    assert_eq!(reported, 12);
}
