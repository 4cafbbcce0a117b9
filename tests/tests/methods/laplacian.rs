//! Laws of operators, applied to every operator, and laws of the cotangent operator.

use helfrich::{Cotangent, DualArea, GompperKroll, Jet, Prepared, Rows, Serial, VertexKind};
use helfrich_tests::laws::{
    ConstantsVanish, CurvatureFollows, MatrixAgrees, Measured, RowsAgree, for_each_curvatures,
    for_each_operator,
};
use helfrich_tests::meshes::{
    Inscribed, Mesh, Rough, SplitMix64, bent, cases, difference, disc, dot, hemisphere,
    icosahedron, icosphere, inscribed, norm, octahedron, rough_any, rough_closed, tetrahedron,
    torus, unit,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;

/// H R on inscribed meshes, relative to ε R² Σ|cot|/|A|.
const SPHERE_EXACT: Tolerance = Tolerance::new(
    4.0,
    "positions lie on the sphere up to ε R, and each cotangent multiplies the error of a difference",
);

/// Δ_S x against −2 n on the icosphere of 2562 vertices, largest error.
const EIGENFUNCTION_MAX: Tolerance = Tolerance::new(
    1e-2,
    "first order: along n the operator is exact, tangentially it is not",
);

/// Δ_S of the second zonal harmonic on the same mesh, mean error.
const EIGENFUNCTION_MEAN: Tolerance = Tolerance::new(
    2e-2,
    "nearly second order in the mean; at the twelve vertices of valence 5 there is no convergence",
);

const KINDS: [DualArea; 3] = [DualArea::Mixed, DualArea::Voronoi, DualArea::Barycentric];

fn dual_areas(kind: DualArea, mesh: &Mesh) -> Vec<f64> {
    let mut areas = vec![f64::NAN; mesh.positions.len()];
    Cotangent::new(kind).dual_areas(&Serial, mesh.surface(), &mut areas);
    areas
}

/// Σ |cot| of the angles that the operator uses at each vertex, computed from the angles, independently of
/// the library.
fn cotangent_sums(mesh: &Mesh) -> Vec<f64> {
    let mut sums = vec![0.0; mesh.positions.len()];
    for &triangle in mesh.connectivity.triangles() {
        let x = triangle.map(|vertex| mesh.positions[vertex as usize]);
        for corner in 0..3 {
            let (i, j) = ((corner + 1) % 3, (corner + 2) % 3);
            let (e, f) = (difference(x[i], x[corner]), difference(x[j], x[corner]));
            let product = dot(unit(e), unit(f));
            let cotangent = product.abs() / norm(helfrich_tests::meshes::cross(unit(e), unit(f)));
            sums[triangle[i] as usize] += cotangent;
            sums[triangle[j] as usize] += cotangent;
        }
    }
    sums
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn constants_vanish(rough in rough_any()) {
        for_each_operator(&mut ConstantsVanish(&rough.mesh()));
    }

    #[test]
    fn rows_are_the_operator(rough in rough_any()) {
        for_each_operator(&mut RowsAgree(&rough.mesh()));
    }

    #[test]
    fn matrices_are_the_rows(rough in rough_any()) {
        for_each_operator(&mut MatrixAgrees(&rough.mesh()));
    }

    #[test]
    fn curvatures_follow_motions(rough in rough_any()) {
        for_each_curvatures(&mut CurvatureFollows(&rough.mesh()));
    }

    #[test]
    fn operator_is_symmetric_in_the_product_of_its_areas(rough in rough_any(), seed in 0..1_000_000_u64) {
        let mesh = rough.mesh();
        let vertices = mesh.positions.len();
        let mut random = SplitMix64::new(seed);
        let fields = Vec::from_iter((0..vertices).map(|_| [random.symmetric(), random.symmetric()]));
        for kind in KINDS {
            let measured = Measured::new(Cotangent::new(kind), &mesh);
            let laplacian = measured.apply(&fields);
            let areas = dual_areas(kind, &mesh);
            let (mut forth, mut back, mut scale) = (0.0, 0.0, 0.0);
            for vertex in 0..vertices {
                let ([f, g], [lf, lg], area) = (fields[vertex], laplacian[vertex], areas[vertex]);
                prop_assert_eq!(area, measured.curvature[vertex].area);
                forth += f * lg * area;
                back += g * lf * area;
                scale += (lg * area).abs() + (lf * area).abs();
            }
            tolerance::OPERATOR_ROUNDING.assert(forth, back, scale, "⟨f, Δg⟩ and ⟨Δf, g⟩");
        }
    }

    #[test]
    fn dual_areas_sum_to_the_area(rough in rough_any()) {
        let mesh = rough.mesh();
        for kind in KINDS {
            let areas = dual_areas(kind, &mesh);
            let scale = areas.iter().map(|area| area.abs()).sum();
            let what = format!("{kind:?} areas");
            tolerance::AREA_SUM.assert(areas.iter().sum(), mesh.surface().area(), scale, &what);
        }
    }

    #[test]
    fn gauss_bonnet(rough in rough_closed()) {
        assert_gauss_bonnet(&rough.mesh());
    }

    #[test]
    fn spheres_are_exact(inscribed in inscribed()) {
        assert_sphere_exact(inscribed);
    }
}

/// Checks Σ K_i A_i = 2πχ.
fn assert_gauss_bonnet(mesh: &Mesh) {
    let expected = std::f64::consts::TAU * mesh.connectivity.euler_characteristic() as f64;
    for kind in KINDS {
        let curvature = Measured::new(Cotangent::new(kind), mesh).curvature;
        let total = curvature.iter().map(|c| c.gaussian * c.area).sum();
        let scale = std::f64::consts::TAU * mesh.positions.len() as f64;
        tolerance::GAUSS_BONNET.assert(total, expected, scale, &format!("Σ K A, {kind:?}"));
    }
}

#[test]
fn curvatures_follow_rotations() {
    for_each_curvatures(&mut CurvatureFollows(&icosphere(3).map(bent)));
    for_each_curvatures(&mut CurvatureFollows(&hemisphere(4).map(bent)));
}

#[test]
fn gauss_bonnet_on_known_meshes() {
    for mesh in [
        tetrahedron(),
        octahedron(),
        icosahedron(),
        icosphere(3),
        torus(12, 8),
    ] {
        assert_gauss_bonnet(&mesh);
    }
    let fold = icosphere(3).map(|[x, y, z]| [x, y, z * (0.1 + x * x + y * y)]);
    assert_gauss_bonnet(&fold);
}

/// Checks that methods B and C with Voronoi areas give H = 1/R along x/R on any mesh inscribed in a sphere.
///
/// The rounding of positions alone changes H R by ε R² Σ|cot|/|A|; the tolerance is a few times that. Vertices
/// where it exceeds one half have an area within rounding of zero and are left out. Returns the number of
/// vertices compared, and of those with a negative area.
fn assert_sphere_exact(inscribed: Inscribed) -> (usize, usize) {
    let (mesh, radius) = (inscribed.mesh(), inscribed.radius());
    let vertices = mesh.positions.len();
    let normals = Vec::from_iter(mesh.positions.iter().map(|&x| unit(x)));
    let areas = dual_areas(DualArea::Voronoi, &mesh);
    let sums = cotangent_sums(&mesh);

    let mut of_b = vec![f64::NAN; vertices];
    Prepared::new(
        GompperKroll::with_areas(1.0, DualArea::Voronoi),
        &mesh.connectivity,
    )
    .with(|method, execution, workspace| {
        method.mean_curvature_along(execution, mesh.surface(), workspace, &normals, &mut of_b);
    });
    let laplacian = Measured::new(Cotangent::new(DualArea::Voronoi), &mesh).apply(&mesh.positions);

    let (mut compared, mut negative) = (0, 0);
    for vertex in 0..vertices {
        let scale = f64::EPSILON * radius * radius * sums[vertex] / areas[vertex].abs();
        if scale.is_nan() || SPHERE_EXACT.value * scale >= 0.5 {
            continue;
        }
        compared += 1;
        negative += usize::from(areas[vertex] < 0.0);
        let of_c = -0.5 * dot(laplacian[vertex], normals[vertex]);
        for (name, mean) in [("B", of_b[vertex]), ("C", of_c)] {
            let what = format!("H R of {name} at vertex {vertex} of {inscribed:?}");
            SPHERE_EXACT.assert(mean * radius, 1.0, scale, &what);
        }
    }
    (compared, negative)
}

#[test]
fn spheres_with_negative_areas_are_exact() {
    let (mut compared, mut negative, mut vertices) = (0, 0, 0);
    for exponent in [-12, -6, 0, 6, 12] {
        for amplitude in [0.0, 0.3, 0.6, 0.9] {
            let inscribed = Inscribed {
                seed: 11,
                amplitude,
                refinement: 3,
                exponent,
            };
            let counts = assert_sphere_exact(inscribed);
            compared += counts.0;
            negative += counts.1;
            vertices += inscribed.mesh().positions.len();
        }
    }
    // The law would be empty if many vertices were left out, or if no area were negative.
    assert!(
        compared * 100 >= vertices * 99,
        "{compared} of {vertices} compared"
    );
    assert!(
        negative * 100 >= vertices,
        "{negative} of {vertices} areas negative"
    );
}

#[test]
fn linear_and_quadratic_functions_on_a_flat_patch() {
    let flat = disc(4);
    let jittered = Rough {
        base: helfrich_tests::meshes::Base::Disc,
        seed: 3,
        amplitude: 0.15,
        refinement: 1,
    };
    let jittered = jittered.mesh().map(|[x, y, _]| [x, y, 0.0]);
    for kind in KINDS {
        for (mesh, regular) in [(&flat, true), (&jittered, false)] {
            let measured = Measured::new(Cotangent::new(kind), mesh);
            let field = mesh.positions.iter();
            let field = Vec::from_iter(
                field.map(|[x, y, _]| [2.0 * x - 3.0 * y + 5.0, x * x + 3.0 * y * y]),
            );
            let laplacian = measured.apply(&field);
            let mut rows = Rows::new();
            measured.assemble(&mut rows);
            for (vertex, &[linear, quadratic]) in laplacian.iter().enumerate() {
                if mesh.connectivity.vertex_kind(vertex) != VertexKind::Interior {
                    continue;
                }
                let scale = 10.0 * rows.row(vertex).1.iter().map(|c| c.abs()).sum::<f64>();
                tolerance::FLAT_EXACT.assert(linear, 0.0, scale, "Δ of a linear function");
                if regular {
                    tolerance::FLAT_EXACT.assert(quadratic, 8.0, scale, "Δ (x² + 3y²)");
                }
            }
        }
    }
}

/// Δ_S x = −2 x/R² and Δ_S (3z² − 1) = −6 (3z² − 1)/R²: eigenfunctions on the sphere.
///
/// The error of the first is tangential and of first order, because along n the operator is exact.
#[test]
fn eigenfunctions_of_the_sphere() {
    let mut before = [f64::INFINITY; 2];
    for refinement in 2..=4 {
        let mesh = icosphere(refinement);
        let field = mesh.positions.iter();
        let field = Vec::from_iter(field.map(|&[x, y, z]| [x, y, z, 3.0 * z * z - 1.0]));
        let laplacian = Measured::new(Cotangent::new(DualArea::Mixed), &mesh).apply(&field);
        let mut errors = [0.0_f64; 2];
        for (l, f) in laplacian.iter().zip(&field) {
            for axis in 0..3 {
                errors[0] = errors[0].max((l[axis] + 2.0 * f[axis]).abs());
            }
            errors[1] += (l[3] + 6.0 * f[3]).abs() / field.len() as f64;
        }
        for (error, before) in errors.iter().zip(before) {
            assert!(
                *error < before / 1.8,
                "refinement {refinement}: {error} after {before}"
            );
        }
        before = errors;
    }
    assert!(before[0] < EIGENFUNCTION_MAX.value);
    assert!(before[1] < EIGENFUNCTION_MEAN.value);
}

/// Areas that Meyer et al. assign to the corners of an obtuse triangle.
#[test]
fn mixed_areas_of_an_obtuse_triangle() {
    let positions = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let obtuse = Mesh::new(positions, vec![[0, 1, 2]]);
    assert_eq!(dual_areas(DualArea::Mixed, &obtuse), [0.5, 0.5, 1.0]);
    assert_eq!(dual_areas(DualArea::Barycentric, &obtuse), [2.0 / 3.0; 3]);
    // ⅛ (cot β l² + cot γ m²): by hand, cot = 1, 3, −½ at the corners and l² = 10, 2, 16 opposite.
    assert_eq!(dual_areas(DualArea::Voronoi, &obtuse), [-0.25, 0.25, 2.0]);
}

/// On a stretched mesh, rows contain the vertices nearest in space, which are many edges away in one
/// direction.
#[test]
fn rows_of_jets_have_the_nearest_vertices_of_stretched_meshes() {
    let mesh = icosphere(3).map(|[x, y, z]| [2.0 * x, y, z]);
    let measured = Measured::new(Jet::j4(), &mesh);
    let mut rows = Rows::new();
    measured.assemble(&mut rows);
    for vertex in 0..mesh.positions.len() {
        let to = |other: usize| {
            let offset = difference(mesh.positions[other], mesh.positions[vertex]);
            dot(offset, offset)
        };
        let columns = rows.row(vertex).0;
        let farthest = columns.iter().map(|&v| to(v as usize)).fold(0.0, f64::max);
        let others = (0..mesh.positions.len()).filter(|&v| v != vertex);
        let nearer = others.filter(|&v| to(v) < farthest * (1.0 - 4e-6)).count();
        assert!(
            nearer < columns.len(),
            "vertex {vertex}: {nearer} nearer than the farthest of {}",
            columns.len()
        );
    }
}

/// A row omits no vertex within two edges that is nearer than one of its own, on meshes with and without
/// equal distances.
#[test]
fn rows_of_jets_have_the_nearest_vertices() {
    let uneven = |x: [f64; 3]| [0, 1, 2].map(|k| x[k] + 0.05 * (57.0 * x[(k + 1) % 3]).sin());
    for mesh in [
        icosphere(3),
        icosphere(3).map(uneven),
        disc(9),
        torus(36, 18),
    ] {
        let measured = Measured::new(Jet::j4(), &mesh);
        let mut rows = Rows::new();
        measured.assemble(&mut rows);
        for vertex in 0..mesh.positions.len() {
            let to = |&other: &u32| {
                let offset = difference(mesh.positions[other as usize], mesh.positions[vertex]);
                dot(offset, offset)
            };
            let mut columns = Vec::from(rows.row(vertex).0);
            let farthest = columns.iter().map(to).fold(0.0, f64::max);
            columns.sort_unstable();
            let count = columns.len();
            columns.dedup();
            assert_eq!(columns.len(), count, "a neighbour twice at vertex {vertex}");
            let connectivity = &mesh.connectivity;
            let ring = connectivity.one_ring(vertex).iter();
            for near in ring.flat_map(|&v| connectivity.one_ring(v as usize)) {
                let known = *near as usize == vertex || columns.binary_search(near).is_ok();
                // Distances that agree to six digits count as equal.
                assert!(
                    known || to(near) >= farthest * (1.0 - 4e-6),
                    "vertex {vertex}"
                );
            }
        }
    }
}
