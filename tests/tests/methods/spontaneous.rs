//! Spontaneous curvature, reference angles, and forces without net force and torque.

use autodiff::F1;
use helfrich::shapes::{Ellipsoid, Shape};
use helfrich::{
    Components, ControlPoints, Cotangent, DualArea, ForceDensity, GompperKroll, Jet, KantorNelson,
    LaplaceBeltrami, LoopSubdivision, MaterialParameter, Prepared, Projected, ReferenceError,
    Serial, StrongForm, Surface, TriangleMesh, remove_net_force_and_torque,
};
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_tests::accuracy::{exact_points, force_and_energy, surface};
use helfrich_tests::laws::{check_gradient, net};
use helfrich_tests::meshes::{self, Mesh};
use helfrich_tests::tolerance;
use std::f64::consts::PI;

fn made(shape: &str, family: Family, vertices: usize) -> GeneratedMesh {
    generate(&shape.parse().unwrap(), family, vertices, 1).unwrap()
}

fn density<M: ForceDensity<f64>>(method: M, surface: Surface<'_, f64>) -> Vec<[f64; 3]> {
    let mut density = vec![[0.0; 3]; surface.mesh().vertex_count()];
    Prepared::new(method, surface.mesh()).force_density(surface, &mut density);
    density
}

#[test]
fn gompper_kroll_has_the_exact_gradient() {
    let made = made("discocyte", Family::Irregular, 162);
    let values: Vec<f64> = exact_points(&made).iter().map(|p| 0.8 * p.mean).collect();
    let dual: Vec<F1> = values.iter().map(|&x| F1::cst(x)).collect();
    for per_vertex in [false, true] {
        let mut one = GompperKroll::new(1.3);
        let mut two = GompperKroll::new(F1::cst(1.3));
        if per_vertex {
            one.spontaneous_curvature = MaterialParameter::PerVertex(values.clone());
            two.spontaneous_curvature = MaterialParameter::PerVertex(dual.clone());
        } else {
            one.spontaneous_curvature = 0.7.into();
            two.spontaneous_curvature = F1::cst(0.7).into();
        }
        check_gradient(&one, two, &made.mesh, &made.positions);
    }
    let sheet = meshes::sheet(6);
    let mut one = GompperKroll::new(1.0);
    let mut two = GompperKroll::new(F1::cst(1.0));
    one.spontaneous_curvature = (-0.4).into();
    two.spontaneous_curvature = F1::cst(-0.4).into();
    check_gradient(&one, two, &sheet.connectivity, &sheet.positions);
}

/// These meshes have triangles with several extraordinary corners, and a boundary.
#[test]
fn loop_subdivision_has_the_exact_gradient() {
    let made = made("discocyte", Family::Irregular, 60);
    let sheet = meshes::sheet(6);
    let surfaces = [
        (&made.mesh, &made.positions),
        (&sheet.connectivity, &sheet.positions),
    ];
    for (mesh, positions) in surfaces {
        let values: Vec<f64> = positions.iter().map(|x| 0.4 + x[0] - 0.7 * x[2]).collect();
        let dual: Vec<F1> = values.iter().map(|&x| F1::cst(x)).collect();
        for controls in ControlPoints::ALL {
            let mut one = LoopSubdivision::with_controls(1.3, controls);
            let mut two = LoopSubdivision::with_controls(F1::cst(1.3), controls);
            one.spontaneous_curvature = 0.7.into();
            two.spontaneous_curvature = F1::cst(0.7).into();
            check_gradient(&one, two.clone(), mesh, positions);
            one.spontaneous_curvature = MaterialParameter::PerVertex(values.clone());
            two.spontaneous_curvature = MaterialParameter::PerVertex(dual.clone());
            check_gradient(&one, two, mesh, positions);
        }
    }
}

/// H0 = α + β (z + ρ) on a torus of radii R and r; the order is that of the surface itself. At angle t around
/// the tube, `H = (R + 2r cos t)/(2r ρ)`, `z = r sin t`, `ρ = R + r cos t` and `dS = 2π r ρ dt`; the
/// trapezoidal rule is exact up to rounding.
#[test]
fn loop_subdivision_with_varying_spontaneous_curvature() {
    let (alpha, beta, big, small) = (0.3, 0.8, 1.0, 0.5);
    let term = |k: i32| {
        let (sine, cosine) = (2.0 * PI * f64::from(k) / 100.0).sin_cos();
        let distance = big + small * cosine;
        let mean = (distance + small * cosine) / (2.0 * small * distance);
        let excess = mean - alpha - beta * (small * sine + distance);
        2.0 * excess * excess * 2.0 * PI * small * distance
    };
    let expected = (0..100).map(term).sum::<f64>() * 2.0 * PI / 100.0;
    let error = |vertices: usize| {
        let made = made("torus:1,0.5", Family::Smooth, vertices);
        let field = |x: &[f64; 3]| alpha + beta * (x[2] + x[0].hypot(x[1]));
        let values = made.positions.iter().map(field).collect();
        let mut method = LoopSubdivision::new(1.0);
        method.spontaneous_curvature = MaterialParameter::PerVertex(values);
        let (_, energy) = force_and_energy(method, surface(&made));
        (energy - expected).abs() / expected
    };
    let errors = [1000, 4000].map(error);
    assert!(
        errors[0] < 1e-3 && errors[1] < errors[0] / 13.0,
        "{errors:?}"
    );
}

/// On a sphere of radius R: E = 8πκ (1 − H0 R)².
#[test]
fn energy_of_a_sphere() {
    let made = made("sphere", Family::Regular, 2562);
    for spontaneous in [0.5, 1.0, -0.25] {
        let expected = 8.0 * PI * (1.0 - spontaneous) * (1.0 - spontaneous);
        let mut method = GompperKroll::new(1.0);
        method.spontaneous_curvature = spontaneous.into();
        let (_, energy) = force_and_energy(method, surface(&made));
        tolerance::STALL.assert(energy, expected, 8.0 * PI, "E of B");
        let mut method = StrongForm::meyer(1.0);
        method.spontaneous_curvature = spontaneous.into();
        let (_, energy) = force_and_energy(method, surface(&made));
        tolerance::STALL.assert(energy, expected, 8.0 * PI, "E of C");
        let mut method = LoopSubdivision::new(1.0);
        method.spontaneous_curvature = spontaneous.into();
        let (_, energy) = force_and_energy(method, surface(&made));
        tolerance::STALL.assert(energy, expected, 8.0 * PI, "E of S");
    }
}

/// A spontaneous curvature of zero at every vertex takes another path in the code with the same result.
#[test]
fn zero_per_vertex_is_none() {
    let made = made("discocyte", Family::Relaxed, 642);
    let zero = MaterialParameter::PerVertex(vec![0.0; 642]);
    let plain = GompperKroll::new(1.0);
    let mut varying = plain.clone();
    varying.spontaneous_curvature = zero.clone();
    let (expected, _) = force_and_energy(plain, surface(&made));
    let (found, _) = force_and_energy(varying, surface(&made));
    assert_eq!(found, expected);
    let plain = LoopSubdivision::new(1.0);
    let mut varying = plain.clone();
    varying.spontaneous_curvature = zero.clone();
    let (expected, _) = force_and_energy(plain, surface(&made));
    let (found, _) = force_and_energy(varying, surface(&made));
    assert_eq!(found, expected);
    let plain = StrongForm::meyer(1.0);
    let mut varying = plain.clone();
    varying.spontaneous_curvature = zero;
    assert_eq!(
        density(varying, surface(&made)),
        density(plain, surface(&made))
    );
}

/// f converges to the exact one for H0 = α + β z on an ellipsoid, where Δ_S z = −2 H n_z and ∇_S z = e_z −
/// n_z n; by jets, because they converge.
#[test]
fn strong_form_with_varying_spontaneous_curvature() {
    let error = |vertices: usize| {
        let made = made("ellipsoid", Family::Relaxed, vertices);
        let (alpha, beta) = (0.4, 0.9);
        let values = made.positions.iter().map(|x| alpha + beta * x[2]).collect();
        let mut method = StrongForm::new(1.0, Jet::j4());
        method.spontaneous_curvature = MaterialParameter::PerVertex(values);
        let found = density(method, surface(&made));
        let mut worst = 0.0_f64;
        for (point, found) in exact_points(&made).iter().zip(found) {
            let (h, n) = (point.mean, point.normal);
            let h0 = alpha + beta * point.position[2];
            let laplacian = point.laplacian_of_mean + beta * 2.0 * h * n[2];
            let cubic = (h - h0) * (h * h - point.gaussian + h0 * h);
            let along_normal = 2.0 * (laplacian + 2.0 * cubic);
            for axis in 0..3 {
                let up = if axis == 2 { 1.0 } else { 0.0 };
                let gradient = beta * (up - n[2] * n[axis]);
                let exact = along_normal * n[axis] - 4.0 * (h - h0) * gradient;
                worst = worst.max((found[axis] - exact).abs());
            }
        }
        worst
    };
    let errors = [error(642), error(2562)];
    assert!(errors[1] < 0.2 && errors[1] < 0.3 * errors[0], "{errors:?}");
}

/// A biconcave disc, which has convex and concave hinges, feels no force if it is its own reference.
#[test]
fn a_reference_shape_has_exactly_no_force() {
    for family in [Family::Regular, Family::Irregular] {
        let made = made("discocyte", family, 642);
        let method = KantorNelson::new(1.0)
            .with_reference(&made.mesh, surface(&made))
            .unwrap();
        let (force, energy) = force_and_energy(method.clone(), surface(&made));
        assert_eq!(energy, 0.0);
        assert!(force.iter().flatten().all(|&x| x == 0.0));

        let pull = |x: &[f64; 3]| [x[0], x[1], 1.2 * x[2]];
        let stretched: Vec<_> = made.positions.iter().map(pull).collect();
        let (_, energy) = force_and_energy(method, Surface::new(&made.mesh, &stretched).unwrap());
        assert!(energy > 0.0);
    }
}

#[test]
fn reference_angles_have_the_exact_gradient() {
    let made = made("discocyte", Family::Irregular, 162);
    let reference = Ellipsoid::new([1.0, 0.9, 0.5]).unwrap();
    let positions: Vec<[f64; 3]> = made
        .preimages
        .iter()
        .map(|&p| reference.position(p))
        .collect();
    let constant = |x: &[f64; 3]| x.map(F1::cst);
    let dual_positions: Vec<[F1; 3]> = positions.iter().map(constant).collect();
    let shape = Surface::new(&made.mesh, &positions).unwrap();
    let dual_shape = Surface::new(&made.mesh, &dual_positions).unwrap();
    let one = KantorNelson::new(1.0)
        .with_reference(&made.mesh, shape)
        .unwrap();
    let two = KantorNelson::new(F1::cst(1.0))
        .with_reference(&made.mesh, dual_shape)
        .unwrap();
    check_gradient(&one, two, &made.mesh, &made.positions);
}

#[test]
fn a_reference_for_another_mesh_is_refused() {
    let made = made("sphere", Family::Regular, 162);
    let octahedron = meshes::octahedron();
    let refused = KantorNelson::new(1.0).with_reference(&made.mesh, octahedron.surface());
    let (reference, mesh) = (8, 320);
    let expected = ReferenceError::CountMismatch { reference, mesh };
    assert_eq!(refused, Err(expected));
}

#[test]
#[should_panic(expected = "KantorNelson::with_reference for that mesh")]
fn reference_angles_of_another_mesh_do_not_go_unnoticed() {
    let octahedron = meshes::octahedron();
    let method = KantorNelson::new(1.0)
        .with_reference(&octahedron.connectivity, octahedron.surface())
        .unwrap();
    Prepared::new(method, &made("sphere", Family::Regular, 162).mesh);
}

fn check_projected<L: LaplaceBeltrami<f64> + Sync + Clone>(method: StrongForm<f64, L>) {
    let made = made("discocyte", Family::Irregular, 642);
    let (free, _) = force_and_energy(method.clone(), surface(&made));
    let (force, _) = force_and_energy(Projected(method.clone()), surface(&made));
    let largest = free.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let before = net(&free, &made.positions).concat();
    assert!(before.iter().any(|x| x.abs() > 1e-6 * largest));
    for component in net(&force, &made.positions).concat() {
        tolerance::NO_NET_FORCE.assert(component, 0.0, largest, "net force or torque");
    }
    // The projected force densities times areas are the same forces.
    let density = density(Projected(method), surface(&made));
    let mut areas = vec![0.0; made.mesh.vertex_count()];
    Cotangent::new(DualArea::Mixed).dual_areas(&Serial, surface(&made), &mut areas);
    for vertex in 0..areas.len() {
        for axis in 0..3 {
            let (found, expected) = (areas[vertex] * density[vertex][axis], force[vertex][axis]);
            tolerance::SAME.assert(found, expected, largest, "A f");
        }
    }
}

#[test]
fn projected_forces_have_no_sum_and_no_torque() {
    check_projected(StrongForm::meyer(1.0));
    check_projected(StrongForm::belkin(1.0));
    check_projected(StrongForm::farutin(1.0));
    check_projected(StrongForm::j4(1.0));
}

/// The projection of each of two spheres leaves the forces on the other unchanged; points on a line do not
/// resist rotation about it.
#[test]
fn components_are_projected_apart_and_lines_do_not_spin() {
    let Mesh {
        connectivity: mesh,
        positions,
    } = meshes::octahedron();
    let shifted = mesh.triangles().iter().map(|t| t.map(|vertex| vertex + 6));
    let both: Vec<_> = mesh.triangles().iter().copied().chain(shifted).collect();
    let both = TriangleMesh::new(12, both).unwrap();
    let far = positions.iter().map(|x| [x[0] + 5.0, x[1], x[2]]);
    let places: Vec<_> = positions.iter().copied().chain(far).collect();
    let wind = |vertex: usize| {
        let x = places[vertex];
        [1.0 + x[1], 0.3 * x[2] - x[0], (vertex as f64).sin()]
    };
    let mut force: Vec<_> = (0..12)
        .map(|v| if v < 6 { wind(v) } else { [0.0; 3] })
        .collect();
    let surface = Surface::new(&both, &places).unwrap();
    let components = Components::new(&both);
    let mut bodies = Vec::new();
    remove_net_force_and_torque(&components, surface, &[0.5; 12], &mut bodies, &mut force);
    assert!(force[6..].iter().flatten().all(|&x| x == 0.0));
    for component in net(&force, &places).concat() {
        tolerance::NO_NET_FORCE.assert(component, 0.0, 1.0, "net force or torque");
    }

    let line: Vec<_> = (0..6)
        .map(|k| [f64::from(k), 0.5 * f64::from(k), 0.0])
        .collect();
    let surface = Surface::new(&mesh, &line).unwrap();
    let mut force: Vec<_> = (0..6).map(wind).collect();
    let components = Components::new(&mesh);
    remove_net_force_and_torque(&components, surface, &[0.5; 6], &mut bodies, &mut force);
    for component in net(&force, &line).concat() {
        tolerance::NO_NET_FORCE.assert(component, 0.0, 10.0, "net force or torque");
    }
}
