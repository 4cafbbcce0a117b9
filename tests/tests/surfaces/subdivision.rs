//! Loop subdivision: its rules, its limit surface, and the exact bases of its patches.

use helfrich::subdivision::{
    Basis, NoPatch, Patch, Subdivision, basis, limit_normals, limit_positions, limit_weight,
    vertex_weight,
};
use helfrich::{MeshError, Serial, TriangleMesh, VertexKind};
use helfrich_tests::meshes::{cross, dot, unit};
use helfrich_tests::tolerance::SPLINE;
use helfrich_tests::tolerance::Tolerance;

/// Derivatives of spline bases against central differences, relative to the largest.
const SPLINE_DIFFERENCE: Tolerance = Tolerance::new(
    1e-8,
    "second-order differences with a step of 1e-5 leave 1e-10 of truncation and 1e-11 of rounding",
);

/// Tangent planes and curvatures of one surface from different patches, relative.
const SPLINE_GEOMETRY: Tolerance = Tolerance::new(
    1e-9,
    "second derivatives of random control points, divided by the squares of tangents of any size",
);

/// Positions of the twelve nodes of a regular patch, in coordinates (v, w).
const LATTICE: [[i32; 2]; 12] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [-1, 1],
    [-1, 0],
    [0, -1],
    [1, -1],
    [2, -1],
    [2, 0],
    [1, 1],
    [0, 2],
    [-1, 2],
];

/// Points of a triangle: inside, on its edges, and close to v0.
const POINTS: [[f64; 2]; 9] = [
    [1.0 / 3.0, 1.0 / 3.0],
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
    [0.25, 0.25],
    [0.5, 0.5],
    [0.3, 0.0],
    [0.01, 0.02],
    [0.1, 0.37],
];

/// Bipyramid: two vertices of valence n over a polygon of n vertices.
fn bipyramid(n: u32) -> TriangleMesh {
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, n], [next, k, n + 1]]
    });
    TriangleMesh::new(n as usize + 2, sides.collect()).unwrap()
}

/// A fan of `triangles` around vertex 0, which lies on the boundary.
fn fan(triangles: u32) -> TriangleMesh {
    let slices = (1..=triangles).map(|k| [0, k, k + 1]);
    TriangleMesh::new(triangles as usize + 2, slices.collect()).unwrap()
}

/// A wheel: vertex 0 inside a polygon of n vertices.
fn wheel(n: u32) -> TriangleMesh {
    let slices = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]);
    TriangleMesh::new(n as usize + 1, slices.collect()).unwrap()
}

/// Deterministic points without symmetry, of size 1.
fn scattered(count: usize) -> Vec<[f64; 3]> {
    let number = |k: usize| (((k + 1) as f64 * 12.9898).sin() * 43758.5453).fract();
    (0..count)
        .map(|i| [0, 1, 2].map(|axis| number(3 * i + axis)))
        .collect()
}

fn meshes() -> Vec<TriangleMesh> {
    let closed = (3..=12).map(bipyramid);
    let open = (1..=7).map(fan).chain((3..=9).map(wheel));
    closed.chain(open).collect()
}

fn assert_close(found: [f64; 3], expected: [f64; 3], what: &str) {
    for axis in 0..3 {
        SPLINE.assert(found[axis], expected[axis], 1.0, what);
    }
}

#[test]
fn check_values() {
    let regular = basis(6, 1.0 / 3.0, 1.0 / 3.0).unwrap();
    let values = [276, 276, 276, 42, 3, 3, 42, 3, 3, 42, 3, 3];
    let second = [-12, -12, -48, 24, 12, 6, -12, 6, 12, 24, 0, 0];
    for k in 0..12 {
        SPLINE.assert(972.0 * regular[k].value, f64::from(values[k]), 972.0, "φ");
        SPLINE.assert(
            54.0 * regular[k].second[0],
            f64::from(second[k]),
            54.0,
            "φ_vv",
        );
    }
    let values = [
        0.418401013220957,
        0.191155831306426,
        0.191155831306426,
        0.077778130689142,
        0.036400815874327,
        0.077778130689142,
        0.000578703703704,
        0.000192901234568,
        0.005787037037037,
        0.000192901234568,
        0.000578703703704,
    ];
    let five = basis(5, 1.0 / 6.0, 1.0 / 6.0).unwrap();
    assert_eq!(five.len(), 11);
    for (found, expected) in five.iter().zip(values) {
        SPLINE.assert(found.value, expected, 1.0, "valence 5");
    }
    SPLINE.assert(vertex_weight(3), 3.0 / 16.0, 1.0, "β of valence 3");
    SPLINE.assert(vertex_weight(6), 1.0 / 16.0, 1.0, "β of valence 6");
    SPLINE.assert(limit_weight(6), 1.0 / 12.0, 1.0, "ω of valence 6");
}

#[test]
fn bases_sum_to_one_and_their_derivatives_to_zero() {
    for valence in 3..=12 {
        for [v, w] in POINTS {
            let basis = basis(valence, v, w).unwrap();
            assert_eq!(basis.len(), valence + 6);
            // Derivatives grow with each refinement up to the point.
            let scale = (v + w).powi(-2);
            let sum = |of: fn(&Basis) -> f64| basis.iter().map(of).sum::<f64>();
            let what = format!("valence {valence} at ({v}, {w})");
            SPLINE.assert(sum(|b| b.value), 1.0, 1.0, &what);
            for of in [
                |b: &Basis| b.first[0],
                |b: &Basis| b.first[1],
                |b: &Basis| b.second[0],
                |b: &Basis| b.second[1],
                |b: &Basis| b.second[2],
            ] {
                SPLINE.assert(sum(of), 0.0, scale, &what);
            }
        }
    }
    assert!(basis(2, 0.1, 0.1).is_none());
    assert!(basis(6, -0.1, 0.1).is_none());
    assert!(basis(6, 0.6, 0.6).is_none());
    assert!(basis(6, f64::NAN, 0.1).is_none());
}

/// The box spline reproduces linear functions, and quadratic ones up to a constant.
#[test]
fn regular_patches_reproduce_linear_functions() {
    for [v, w] in POINTS {
        let basis = basis(6, v, w).unwrap();
        let sum = |of: &dyn Fn(&Basis, f64, f64) -> f64| -> f64 {
            let nodes = basis.iter().zip(LATTICE);
            nodes
                .map(|(b, [x, y])| of(b, f64::from(x), f64::from(y)))
                .sum()
        };
        SPLINE.assert(sum(&|b, x, _| b.value * x), v, 1.0, "v");
        SPLINE.assert(sum(&|b, _, y| b.value * y), w, 1.0, "w");
        SPLINE.assert(sum(&|b, x, _| b.first[0] * x), 1.0, 1.0, "∂v/∂v");
        SPLINE.assert(sum(&|b, x, _| b.first[1] * x), 0.0, 1.0, "∂v/∂w");
        SPLINE.assert(sum(&|b, _, y| b.first[1] * y), 1.0, 1.0, "∂w/∂w");
        for k in 0..3 {
            SPLINE.assert(sum(&|b, x, _| b.second[k] * x), 0.0, 1.0, "second of v");
            SPLINE.assert(sum(&|b, _, y| b.second[k] * y), 0.0, 1.0, "second of w");
        }
        SPLINE.assert(sum(&|b, x, _| b.second[0] * x * x), 2.0, 1.0, "∂²v²/∂v²");
        SPLINE.assert(sum(&|b, x, y| b.second[1] * x * y), 1.0, 1.0, "∂²vw/∂v∂w");
        SPLINE.assert(sum(&|b, _, y| b.second[2] * y * y), 2.0, 1.0, "∂²w²/∂w²");
    }
}

/// Derivatives agree with differences in every part of a refined patch, including the inverted middle one.
#[test]
fn derivatives_match_differences() {
    let step = 1e-5;
    for valence in 3..=12 {
        for [v, w] in [
            [0.3, 0.31],
            [0.6, 0.1],
            [0.1, 0.7],
            [0.15, 0.16],
            [0.31, 0.05],
            [0.06, 0.07],
        ] {
            let at = |v: f64, w: f64| basis(valence, v, w).unwrap();
            let centre = at(v, w);
            let along =
                [[step, 0.0], [0.0, step]].map(|[dv, dw]| [at(v - dv, w - dw), at(v + dv, w + dw)]);
            for node in 0..valence + 6 {
                let difference = |axis: usize, of: &dyn Fn(&Basis) -> f64| {
                    let [before, after] = &along[axis];
                    (of(&after[node]) - of(&before[node])) / (2.0 * step)
                };
                let what = format!("valence {valence} node {node} at ({v}, {w})");
                let Basis { first, second, .. } = centre[node];
                for axis in 0..2 {
                    let found = difference(axis, &|b| b.value);
                    SPLINE_DIFFERENCE.assert(found, first[axis], 10.0, &what);
                    let found = difference(axis, &|b| b.first[axis]);
                    SPLINE_DIFFERENCE.assert(found, second[2 * axis], 100.0, &what);
                    let found = difference(axis, &|b| b.first[1 - axis]);
                    SPLINE_DIFFERENCE.assert(found, second[1], 100.0, &what);
                }
            }
        }
    }
}

/// Position and derivatives at a point of a patch.
fn evaluate(patch: &Patch, controls: &[[f64; 3]], [v, w]: [f64; 2]) -> [[f64; 3]; 6] {
    let mut sums = [[0.0; 3]; 6];
    let basis = basis(patch.valence(), v, w).unwrap();
    for (b, &node) in basis.iter().zip(&patch.nodes) {
        let [dv, dw] = b.first;
        let [vv, vw, ww] = b.second;
        for (sum, weight) in sums.iter_mut().zip([b.value, dv, dw, vv, vw, ww]) {
            for axis in 0..3 {
                sum[axis] += weight * controls[node as usize][axis];
            }
        }
    }
    sums
}

/// Unit normal, mean and Gaussian curvature.
fn geometry([_, dv, dw, vv, vw, ww]: [[f64; 3]; 6]) -> ([f64; 3], [f64; 2]) {
    let [e, f, g] = [dot(dv, dv), dot(dv, dw), dot(dw, dw)];
    let area = cross(dv, dw);
    let normal = unit(area);
    let [l, m, n] = [vv, vw, ww].map(|second| dot(second, normal));
    let squared = dot(area, area);
    let mean = -(e * n - 2.0 * f * m + g * l) / (2.0 * squared);
    (normal, [mean, (l * n - m * m) / squared])
}

/// Coordinates in the parent of a point in one of four child triangles, numbered by their corner of the
/// parent, or 3 for the middle one.
fn child_point(child: usize, [v, w]: [f64; 2]) -> [f64; 2] {
    match child {
        0 => [v / 2.0, w / 2.0],
        1 => [(1.0 + v) / 2.0, w / 2.0],
        2 => [v / 2.0, (1.0 + w) / 2.0],
        // The middle child is [ab, bc, ca].
        _ => [(1.0 - w) / 2.0, (v + w) / 2.0],
    }
}

/// Coordinates in a triangle, from those in its patch.
fn in_triangle(patch: &Patch, [v, w]: [f64; 2]) -> [f64; 2] {
    let mut weights = [1.0 - v - w, v, w];
    weights.rotate_right(patch.first_corner);
    [weights[1], weights[2]]
}

/// Coordinates in a patch, from those in its triangle.
fn in_patch(patch: &Patch, [v, w]: [f64; 2]) -> [f64; 2] {
    let mut weights = [1.0 - v - w, v, w];
    weights.rotate_left(patch.first_corner);
    [weights[1], weights[2]]
}

/// Refinement of the control points does not change the surface over a triangle.
#[test]
fn patches_are_refinable() {
    for n in 3..=12 {
        let mesh = Subdivision::new(&bipyramid(n), 1).unwrap().into_mesh();
        let controls = scattered(mesh.vertex_count());
        let fine = Subdivision::new(&mesh, 1).unwrap();
        let fine_controls = fine.refine(&controls);
        for triangle in 0..mesh.triangles().len() {
            let patch = Patch::new(&mesh, triangle).unwrap();
            for child in 0..4 {
                let part = Patch::new(fine.mesh(), 4 * triangle + child).unwrap();
                for point in [[0.2, 0.3], [0.55, 0.2], [0.05, 0.03]] {
                    let found = evaluate(&part, &fine_controls, point);
                    let in_parent = child_point(child, in_triangle(&part, point));
                    let expected = evaluate(&patch, &controls, in_patch(&patch, in_parent));
                    assert_close(found[0], expected[0], "position");
                    let ((n1, h1), (n2, h2)) = (geometry(found), geometry(expected));
                    for axis in 0..3 {
                        SPLINE_GEOMETRY.assert(n1[axis], n2[axis], 1.0, "normal");
                    }
                    for k in 0..2 {
                        SPLINE_GEOMETRY.assert(
                            h1[k],
                            h2[k],
                            1.0 + h2[0] * h2[0] + h2[1].abs(),
                            "curvature",
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn curvature_is_continuous_across_edges() {
    for n in 3..=12 {
        let mesh = Subdivision::new(&bipyramid(n), 1).unwrap().into_mesh();
        let controls = scattered(mesh.vertex_count());
        for (edge, ends) in mesh.edges().iter().enumerate() {
            let (left, right) = mesh.edge_triangles(edge);
            let sides = [left, right.unwrap()].map(|triangle| {
                let corners = mesh.triangles()[triangle as usize];
                let mut weights = [0.0; 3];
                for (corner, weight) in corners.iter().zip(&mut weights) {
                    *weight = match corner {
                        corner if *corner == ends[0] => 0.4,
                        corner if *corner == ends[1] => 0.6,
                        _ => 0.0,
                    };
                }
                let patch = Patch::new(&mesh, triangle as usize).unwrap();
                let point = in_patch(&patch, [weights[1], weights[2]]);
                evaluate(&patch, &controls, point)
            });
            assert_close(sides[0][0], sides[1][0], "position");
            let [(n1, h1), (n2, h2)] = sides.map(geometry);
            for axis in 0..3 {
                SPLINE_GEOMETRY.assert(n1[axis], n2[axis], 1.0, "normal");
            }
            for k in 0..2 {
                let scale = 1.0 + h2[0] * h2[0] + h2[1].abs();
                SPLINE_GEOMETRY.assert(h1[k], h2[k], scale, "curvature");
            }
        }
    }
}

#[test]
fn limit_positions_and_normals_are_those_of_the_patches() {
    for n in 3..=12 {
        let mesh = Subdivision::new(&bipyramid(n), 1).unwrap().into_mesh();
        let controls = scattered(mesh.vertex_count());
        let limit = limit_of(&mesh, &controls);
        let normals = normals_of(&mesh, &controls);
        for triangle in 0..mesh.triangles().len() {
            let patch = Patch::new(&mesh, triangle).unwrap();
            for (corner, point) in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
                let vertex = mesh.triangles()[triangle][(patch.first_corner + corner) % 3] as usize;
                let found = evaluate(&patch, &controls, point);
                assert_close(found[0], limit[vertex], "position");
                if corner > 0 || patch.valence() == 6 {
                    let (normal, _) = geometry(found);
                    for axis in 0..3 {
                        SPLINE_GEOMETRY.assert(normal[axis], normals[vertex][axis], 1.0, "normal");
                    }
                }
            }
        }
    }
}

fn limit_of(mesh: &TriangleMesh, controls: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut limit = vec![[0.0; 3]; mesh.vertex_count()];
    limit_positions(mesh).apply(&Serial, controls, &mut limit);
    limit
}

fn normals_of(mesh: &TriangleMesh, controls: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.vertex_count()];
    limit_normals(&Serial, mesh, controls, &mut normals);
    normals
}

/// Refinement does not move the limit positions of the vertices.
#[test]
fn refinement_does_not_move_the_limit() {
    for mesh in meshes() {
        let controls = scattered(mesh.vertex_count());
        let fine = Subdivision::new(&mesh, 2).unwrap();
        let fine_controls = fine.refine(&controls);
        let (limit, fine_limit) = (
            limit_of(&mesh, &controls),
            limit_of(fine.mesh(), &fine_controls),
        );
        let normals = normals_of(&mesh, &controls);
        let fine_normals = normals_of(fine.mesh(), &fine_controls);
        for vertex in 0..mesh.vertex_count() {
            assert_close(fine_limit[vertex], limit[vertex], "limit position");
            for axis in 0..3 {
                let [found, expected] = [fine_normals[vertex][axis], normals[vertex][axis]];
                SPLINE_GEOMETRY.assert(found, expected, 1.0, "limit normal");
            }
        }
    }
}

#[test]
fn normals_point_outward() {
    let around = |k: usize, n: usize, z: f64| {
        let (sine, cosine) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
        [cosine, sine, z]
    };
    for n in 3..=12 {
        let mut controls = Vec::from_iter((0..n).map(|k| around(k, n, 0.0)));
        controls.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        let mesh = bipyramid(n as u32);
        let normals = normals_of(&mesh, &controls);
        for (normal, outward) in normals.iter().zip(limit_of(&mesh, &controls)) {
            assert!(dot(*normal, unit(outward)) > 0.5, "bipyramid of {n}");
        }

        let mut controls = vec![[0.0, 0.0, 0.1]];
        controls.extend((0..n).map(|k| around(k, n, 0.0)));
        for normal in normals_of(&wheel(n as u32), &controls) {
            assert!(normal[2] > 0.5, "wheel of {n}");
        }

        let mut controls = vec![[0.0, 0.0, 0.1]];
        controls.extend((0..n).map(|k| around(k, 2 * n, 0.0)));
        for normal in normals_of(&fan(n as u32 - 1), &controls) {
            assert!(normal[2] > 0.5, "fan of {}", n - 1);
        }
    }
}

#[test]
fn refined_meshes_have_the_expected_connectivity() {
    for mesh in meshes() {
        for levels in 0..3 {
            let fine = Subdivision::new(&mesh, levels).unwrap();
            let [vertices, triangles] = Subdivision::sizes(&mesh, levels).unwrap();
            assert_eq!(fine.mesh().vertex_count(), vertices);
            assert_eq!(fine.mesh().triangles().len(), triangles);
            assert_eq!(fine.stencils().len(), vertices);
            assert_eq!(
                fine.mesh().euler_characteristic(),
                mesh.euler_characteristic()
            );
            assert_eq!(
                fine.mesh().boundary_edge_count(),
                mesh.boundary_edge_count() << levels
            );
            for vertex in 0..mesh.vertex_count() {
                let kind = mesh.vertex_kind(vertex);
                assert_eq!(fine.mesh().vertex_kind(vertex), kind);
                if kind == VertexKind::Interior {
                    assert_eq!(fine.mesh().valence(vertex), mesh.valence(vertex));
                }
            }
            for vertex in mesh.vertex_count()..vertices {
                if fine.mesh().vertex_kind(vertex) == VertexKind::Interior {
                    assert_eq!(fine.mesh().valence(vertex), 6);
                }
            }
        }
    }
}

/// Refinement derives the same lists of neighbours as a search over the refined triangles.
#[test]
fn refined_meshes_are_those_of_their_triangles() {
    let (disc, _) = helfrich_tests::meshes::disc(3).relabelled(4);
    let (torus, _) = helfrich_tests::meshes::torus(7, 5).relabelled(5);
    let mut lonely = disc.connectivity.triangles().to_vec();
    lonely.extend([[60, 62, 61], [62, 60, 63]]);
    let more = [
        disc.connectivity,
        torus.connectivity,
        TriangleMesh::new(65, lonely).unwrap(),
    ];
    for mesh in meshes().into_iter().chain(more) {
        for levels in 1..3 {
            let fine = Subdivision::new(&mesh, levels).unwrap().into_mesh();
            let triangles = fine.triangles().to_vec();
            let found = TriangleMesh::new(fine.vertex_count(), triangles).unwrap();
            assert_eq!(fine, found);
        }
    }
}

#[test]
fn maps_compose_and_transpose() {
    for mesh in meshes() {
        let controls = scattered(mesh.vertex_count());
        let once = Subdivision::new(&mesh, 1).unwrap();
        let again = Subdivision::new(once.mesh(), 1).unwrap();
        let twice = Subdivision::new(&mesh, 2).unwrap();
        assert_eq!(twice.mesh(), again.mesh());
        let step_by_step = again.refine(&once.refine(&controls));
        let at_once = twice.refine(&controls);
        for (found, expected) in at_once.iter().zip(&step_by_step) {
            assert_close(*found, *expected, "composition");
        }

        let forces = scattered(at_once.len());
        let transpose = twice.stencils().transpose();
        let mut pulled = vec![[0.0; 3]; mesh.vertex_count()];
        transpose.apply(&Serial, &forces, &mut pulled);
        let product =
            |a: &[[f64; 3]], b: &[[f64; 3]]| a.iter().zip(b).map(|(a, b)| dot(*a, *b)).sum::<f64>();
        let count = forces.len() as f64;
        SPLINE.assert(
            product(&pulled, &controls),
            product(&forces, &at_once),
            count,
            "work",
        );
        assert_eq!(transpose.transpose().transpose(), transpose);
    }
}

/// The boundary is the cubic B-spline of its polygon, including corners.
#[test]
fn boundaries_follow_their_own_polygon() {
    let square = TriangleMesh::new(4, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let corners: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let limit = limit_of(&square, &corners);
    assert_close(limit[0], [1.0 / 6.0, 1.0 / 6.0, 0.0], "in two triangles");
    assert_close(limit[1], [5.0 / 6.0, 1.0 / 6.0, 0.0], "in one triangle");
    let normals = normals_of(&square, &corners);
    for normal in normals {
        assert_close(normal, [0.0, 0.0, 1.0], "normal");
    }
}

#[test]
fn triangles_without_a_patch_say_why() {
    let tetrahedron =
        TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
    assert_eq!(
        Patch::new(&tetrahedron, 0),
        Err(NoPatch::SeveralExtraordinary { corners: 3 })
    );
    assert_eq!(Patch::new(&wheel(5), 0), Err(NoPatch::Boundary));
}

#[test]
fn what_would_be_too_large_is_refused_before_it_is_made() {
    for levels in [20, 64, u32::MAX] {
        let refused = Subdivision::new(&bipyramid(5), levels);
        assert!(
            matches!(refused, Err(MeshError::TooLarge { .. })),
            "{levels}"
        );
    }
}

#[test]
fn isolated_vertices_stay() {
    let mesh = TriangleMesh::new(5, vec![[0, 1, 2]]).unwrap();
    let controls = scattered(5);
    let fine = Subdivision::new(&mesh, 3).unwrap();
    let refined = fine.refine(&controls);
    assert_eq!(refined[3..5], controls[3..5]);
    assert_eq!(limit_of(&mesh, &controls)[4], controls[4]);
    assert_eq!(normals_of(&mesh, &controls)[4], [0.0; 3]);
}
