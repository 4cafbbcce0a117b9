//! Area, volume and integrated mean curvature of components, and their gradients.

use autodiff::F1;
use helfrich::functional::ComponentElements;
use helfrich::{
    AnyFunctional, BoundaryLength, EnclosedVolume, Functional, Method, PatchFunctional, Real,
    Serial, Surface, TotalArea, TotalGaussianCurvature, TotalMeanCurvature, TriangleMesh,
};
use helfrich_tests::laws::with_derivatives;
use helfrich_tests::meshes::{
    Mesh, SplitMix64, bent, cases, disc, hemisphere, icosphere, octahedron, rough_any, tetrahedron,
    torus,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;
use std::f64::consts::PI;

/// The functionals of patches.
const PATCHES: [PatchFunctional; 2] = [PatchFunctional::Area, PatchFunctional::Volume];

/// The derivative of functionals of patches by dual numbers, relative to the largest gradient.
const FITTED: Tolerance = Tolerance::new(
    1e-11,
    "normal equations of 27 coefficients on meshes of a few dozen vertices lose up to four digits",
);

fn values<T: Real>(functional: impl Functional<T>, mesh: &Mesh, positions: &[[T; 3]]) -> Vec<T> {
    let mut workspace = functional.workspace(&mesh.connectivity);
    let surface = Surface::new(&mesh.connectivity, positions).unwrap();
    let mut values = vec![T::nan(); functional.component_count(&workspace)];
    functional.values(&Serial, surface, &mut workspace, &mut values);
    values
}

fn gradient(functional: impl Functional<f64>, mesh: &Mesh, weights: &[f64]) -> Vec<[f64; 3]> {
    let mut workspace = functional.workspace(&mesh.connectivity);
    let mut gradient = vec![[0.0; 3]; mesh.positions.len()];
    let surface = mesh.surface();
    functional.add_gradient(&Serial, surface, &mut workspace, weights, &mut gradient);
    gradient
}

/// Checks that values before a gradient do not change its bits, whatever was evaluated between.
fn check_measured_gradient<F: Functional<f64> + Copy>(functional: F, mesh: &Mesh) {
    let mut workspace = functional.workspace(&mesh.connectivity);
    let count = functional.component_count(&workspace);
    let weights: Vec<f64> = (0..count).map(|c| 1.0 - 0.3 * c as f64).collect();
    let expected = gradient(functional, mesh, &weights);
    let nearby = mesh.map(|[x, y, z]| [1.02 * x, 0.98 * y, z + 0.03 * x * y]);
    let mut values = vec![0.0; count];
    for _ in 0..2 {
        let mut other = vec![[0.0; 3]; expected.len()];
        functional.values(&Serial, nearby.surface(), &mut workspace, &mut values);
        functional.add_measured_gradient(
            &Serial,
            nearby.surface(),
            &mut workspace,
            &weights,
            &mut other,
        );
        functional.values(&Serial, mesh.surface(), &mut workspace, &mut values);
        for _ in 0..2 {
            let mut found = vec![[0.0; 3]; expected.len()];
            functional.add_measured_gradient(
                &Serial,
                mesh.surface(),
                &mut workspace,
                &weights,
                &mut found,
            );
            assert_eq!(found, expected);
        }
        assert_ne!(other, expected);
    }
}

/// The meshes side by side, with their vertices and triangles interleaved, and one isolated vertex.
fn together(meshes: &[Mesh]) -> Mesh {
    let (mut positions, mut triangles) = (vec![], vec![]);
    for (k, mesh) in meshes.iter().enumerate() {
        let first = positions.len() as u32;
        let away = 4.0 * k as f64;
        positions.extend(mesh.positions.iter().map(|x| [x[0] + away, x[1], x[2]]));
        let moved = |triangle: &[u32; 3]| triangle.map(|vertex| vertex + first);
        triangles.extend(mesh.connectivity.triangles().iter().map(moved));
    }
    positions.push([-9.0; 3]);
    Mesh::new(positions, triangles).relabelled(5).0
}

fn several() -> Mesh {
    together(&[icosphere(1), torus(9, 6), hemisphere(2), disc(2)].map(|mesh| mesh.map(bent)))
}

/// Compares the derivative of a functional along random directions with its gradient.
fn check_gradient(mesh: &Mesh) {
    fn check<F>(functional: F, mesh: &Mesh, bound: Tolerance)
    where
        F: Functional<f64> + Functional<F1> + Copy,
    {
        let mut random = SplitMix64::new(8);
        let components = values(functional, mesh, &mesh.positions).len();
        let weights = Vec::from_iter((0..components).map(|_| random.symmetric()));
        let gradient = gradient(functional, mesh, &weights);
        let largest = gradient
            .iter()
            .flatten()
            .fold(1e-3_f64, |m, x| m.max(x.abs()));
        for _ in 0..4 {
            let direction = random.directions(mesh.positions.len());
            let moved = with_derivatives(&mesh.positions, &direction);
            let dual = values(functional, mesh, &moved);
            let derivative: f64 = dual.iter().zip(&weights).map(|(f, w)| w * f.dx).sum();
            let pairs = gradient.iter().flatten().zip(direction.iter().flatten());
            let found: f64 = pairs.map(|(g, d)| g * d).sum();
            let scale = largest * (mesh.positions.len() as f64);
            bound.assert(found, derivative, scale, "gradient");
        }
    }
    let exact = tolerance::GRADIENT_DUAL;
    check(TotalArea, mesh, exact);
    check(EnclosedVolume, mesh, exact);
    check(TotalMeanCurvature, mesh, exact);
    check(TotalGaussianCurvature, mesh, exact);
    check(BoundaryLength, mesh, exact);
    for quantity in [
        AnyFunctional::Area,
        AnyFunctional::Volume,
        AnyFunctional::MeanCurvature,
    ] {
        check(quantity, mesh, exact);
    }
    for functional in PATCHES {
        // It has the values and gradients of the functional itself.
        check(AnyFunctional::OfPatches(functional), mesh, FITTED);
    }
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn gradients_are_exact(rough in rough_any()) {
        check_gradient(&rough.mesh());
    }
}

#[test]
fn gradients_are_exact_with_several_components() {
    check_gradient(&several());
}

/// Edge a: a tetrahedron has `A = √3 a²` and `V = a³/(6√2)`, an octahedron `A = 2√3 a²` and `V = √2 a³/3`;
/// the angles between normals are π − acos(1/3) and acos(1/3).
#[test]
fn gradients_after_values_have_the_same_bits() {
    let mesh = several();
    check_measured_gradient(TotalArea, &mesh);
    check_measured_gradient(EnclosedVolume, &mesh);
    check_measured_gradient(TotalMeanCurvature, &mesh);
    for functional in PATCHES {
        check_measured_gradient(functional, &mesh);
        check_measured_gradient(AnyFunctional::OfPatches(functional), &mesh);
    }
}

#[test]
fn solids_have_their_values() {
    let (root2, root3) = (2.0_f64.sqrt(), 3.0_f64.sqrt());
    let angle = (1.0_f64 / 3.0).acos();
    let edge = tetrahedron().edge_length();
    for (mesh, a, area, volume, mean) in [
        (
            tetrahedron(),
            edge,
            root3,
            1.0 / (6.0 * root2),
            3.0 * (PI - angle),
        ),
        (octahedron(), root2, 2.0 * root3, root2 / 3.0, 6.0 * angle),
    ] {
        let at = |values: Vec<f64>| values[0];
        let x = &mesh.positions;
        for (found, expected, what) in [
            (at(values(TotalArea, &mesh, x)), area * a * a, "A"),
            (
                at(values(EnclosedVolume, &mesh, x)),
                volume * a * a * a,
                "V",
            ),
            (at(values(TotalMeanCurvature, &mesh, x)), mean * a, "M"),
        ] {
            tolerance::POLYHEDRON.assert(found, expected, expected, what);
        }
    }
}

/// M converges to 4πR in second order.
#[test]
fn mean_curvature_of_spheres_converges() {
    let error = |refinement| {
        let sphere = icosphere(refinement);
        values(TotalMeanCurvature, &sphere, &sphere.positions)[0] / (4.0 * PI) - 1.0
    };
    let order = (error(3) / error(4)).log2();
    assert!(
        error(4).abs() < 2e-3 && (order - 2.0).abs() < 0.1,
        "{order}"
    );
}

/// Each component has the same values and gradients as alone. Open components have no volume, closed ones no
/// boundary length.
#[test]
fn components_are_independent() {
    fn check(functional: impl Functional<f64> + Copy, measures: fn(&TriangleMesh) -> bool) {
        let whole = several();
        let workspace = functional.workspace(&whole.connectivity);
        let components = functional.components(&workspace).clone();
        let all = values(functional, &whole, &whole.positions);
        let everything = gradient(functional, &whole, &vec![1.0; all.len()]);
        for (component, &value) in all.iter().enumerate() {
            let here = |vertex: u32| components.of_vertex()[vertex as usize] == component as u32;
            let mut triangles = whole.connectivity.triangles().to_vec();
            triangles.retain(|triangle| here(triangle[0]));
            if triangles.is_empty() {
                assert_eq!(value, 0.0, "an isolated vertex");
                continue;
            }
            // The vertices of the other components are isolated now, and each is a component.
            let alone = Mesh::new(whole.positions.clone(), triangles);
            let found = values(functional, &alone, &alone.positions);
            let nonzero = Vec::from_iter(found.iter().filter(|&&value| value != 0.0));
            if measures(&alone.connectivity) {
                assert_eq!(nonzero, [&value]);
            } else {
                assert_eq!((nonzero.len(), value), (0, 0.0), "nothing to measure");
            }
            let gradient = gradient(functional, &alone, &vec![1.0; found.len()]);
            for (vertex, &gradient) in gradient.iter().enumerate() {
                if here(vertex as u32) {
                    assert_eq!(gradient, everything[vertex]);
                } else {
                    assert_eq!(gradient, [0.0; 3]);
                }
            }
        }
        let mut only = vec![0.0; all.len()];
        only[1] = 1.0;
        let gradient = gradient(functional, &whole, &only);
        for (vertex, &gradient) in gradient.iter().enumerate() {
            let inside = components.of_vertex()[vertex] == 1;
            let expected = if inside { everything[vertex] } else { [0.0; 3] };
            assert_eq!(gradient, expected);
        }
    }
    check(TotalArea, |_| true);
    check(EnclosedVolume, TriangleMesh::is_closed);
    check(TotalMeanCurvature, |_| true);
    check(BoundaryLength, |mesh| !mesh.is_closed());
    check(PatchFunctional::Area, |_| true);
    check(PatchFunctional::Volume, TriangleMesh::is_closed);
}

/// A translation by 2²⁷ ≈ 1e8 radii, on a grid on which it is exact, does not change a bit.
#[test]
fn offsets_do_not_matter() {
    let pitch = 2.0_f64.powi(-24);
    let here = several().map(|x| x.map(|x| (x / pitch).round() * pitch));
    let far = 2.0_f64.powi(27);
    let there = here.map(|x| [x[0] + far, x[1] - far, x[2] + 3.0 * far]);
    fn check(functional: impl Functional<f64> + Copy, here: &Mesh, there: &Mesh) {
        let near = values(functional, here, &here.positions);
        assert_eq!(near, values(functional, there, &there.positions));
        let weights = vec![1.0; near.len()];
        assert_eq!(
            gradient(functional, here, &weights),
            gradient(functional, there, &weights)
        );
    }
    check(TotalArea, &here, &there);
    check(EnclosedVolume, &here, &there);
    check(TotalMeanCurvature, &here, &there);
    check(TotalGaussianCurvature, &here, &there);
    check(BoundaryLength, &here, &there);
    for functional in PATCHES {
        check(functional, &here, &there);
    }
}

/// The elements of each component are listed together; an element belongs to the component of its first
/// corner.
#[test]
fn elements_are_grouped_by_component() {
    let mesh = several();
    let elements: ComponentElements<3> = Method::<f64>::memory(&TotalArea, &mesh.connectivity);
    let components = elements.components();
    let mut count = 0;
    for component in 0..components.count() {
        for triangle in elements.of(component) {
            let at = |vertex: u32| components.of_vertex()[vertex as usize] as usize;
            assert!(triangle.iter().all(|&vertex| at(vertex) == component));
            count += 1;
        }
    }
    assert_eq!(count, mesh.connectivity.triangles().len());
}
