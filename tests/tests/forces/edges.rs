//! Open edges: line tension, and the Gaussian modulus.

use autodiff::F1;
use helfrich::{
    Functional, GaussianBending, LineTension, Method, Real, Serial, SurfaceTension,
    TotalGaussianCurvature, VertexKind,
};
use helfrich_tests::laws::{check_gradient, energy, forces, imbalance};
use helfrich_tests::meshes::{
    Mesh, cap, cases, catenoid, disc, hemisphere, icosphere, rough_any, round_disc, torus,
};
use helfrich_tests::tolerance;
use proptest::prelude::*;
use std::f64::consts::PI;

fn both<T: Real>() -> (LineTension<T>, GaussianBending<T>) {
    let constant = T::constant;
    (
        LineTension::new(constant(1.7)),
        GaussianBending::new(constant(-0.9)),
    )
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn forces_are_gradients_and_balance(rough in rough_any()) {
        let mesh = rough.mesh();
        let (line, gaussian) = both();
        let (mesh, positions) = (&mesh.connectivity, &mesh.positions);
        check_gradient(&line, both::<F1>().0, mesh, positions);
        check_gradient(&gaussian, both::<F1>().1, mesh, positions);
        if !mesh.is_closed() {
            let (net, torque) = imbalance(positions, &forces(both(), mesh, positions));
            tolerance::BALANCE.assert(net, 0.0, 1.0, "Σ F");
            tolerance::BALANCE.assert(torque, 0.0, 1.0, "Σ x × F");
        }
    }
}

fn boundary(mesh: &Mesh) -> Vec<usize> {
    let kinds = mesh.connectivity.vertex_kinds().iter().enumerate();
    let boundary = kinds.filter(|(_, kind)| **kind == VertexKind::Boundary);
    boundary.map(|(vertex, _)| vertex).collect()
}

/// On a regular polygon with N sides of length s on a circle of radius r, the force on a corner is `2Λ
/// sin(π/N) = Λ s/r`: Λ/r per length, inward.
#[test]
fn line_tension_pulls_a_circle_inward() {
    let mesh = round_disc(4);
    let tension = 1.7;
    let method = LineTension::new(tension);
    let force = forces(method, &mesh.connectivity, &mesh.positions);
    let edge = boundary(&mesh);
    let side = 2.0 * (PI / edge.len() as f64).sin();
    let length = side * edge.len() as f64;
    let found = energy(method, &mesh.connectivity, &mesh.positions);
    tolerance::SAME.assert(found, tension * length, length, "Λ L");
    for (vertex, &force) in force.iter().enumerate() {
        let pull = if edge.contains(&vertex) {
            tension * side
        } else {
            0.0
        };
        let inward = mesh.positions[vertex].map(|x| -pull * x);
        for axis in 0..3 {
            tolerance::SAME.assert(force[axis], inward[axis], tension, "force");
        }
    }
}

/// `∫ K dS = 2π (1 − cos θ)` over a cap, and `−4π tanh h` over a catenoid. The sum over interior vertices
/// leaves out half a row of triangles at the edge. This error is of first order, the rest of second.
#[test]
fn integrated_gaussian_curvature_converges() {
    let measured = |mesh: Mesh| {
        let mut workspace = TotalGaussianCurvature.workspace(&mesh.connectivity);
        let mut value = [0.0];
        TotalGaussianCurvature.values(&Serial, mesh.surface(), &mut workspace, &mut value);
        value[0]
    };
    let of_cap = |angle: f64| 2.0 * PI * (1.0 - angle.cos());
    let of_catenoid = |height: f64| -4.0 * PI * height.tanh();
    for (angle, name) in [(1.0, "cap"), (2.5, "cup")] {
        let errors = [8, 16].map(|rings| {
            let row = angle / f64::from(rings);
            let found = measured(cap(rings, angle));
            [of_cap(angle), of_cap(angle - 0.5 * row)].map(|exact| (found - exact).abs())
        });
        check_orders(errors, name);
    }
    let errors = [32, 64].map(|around| {
        let mesh = catenoid(around, 1.2);
        let row = mesh.positions[around as usize][2] - mesh.positions[0][2];
        let found = measured(mesh);
        [of_catenoid(1.2), of_catenoid(1.2 - 0.5 * row)].map(|exact| (found - exact).abs())
    });
    check_orders(errors, "catenoid");
}

/// Checks that errors are of first order, and of second order without the half row of triangles.
fn check_orders([coarse, fine]: [[f64; 2]; 2], name: &str) {
    let [first, second] = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
    assert!(
        (first - 1.0).abs() < 0.2 && (second - 2.0).abs() < 0.4,
        "{name}: orders {first} and {second}, errors {coarse:?} and {fine:?}"
    );
}

/// On flat discs and closed surfaces, the integrated Gaussian curvature is 2πχ minus the total turning angle
/// of the boundary, whatever the mesh.
#[test]
fn gaussian_energy_is_topological() {
    let modulus = -0.9;
    for (mesh, total) in [(icosphere(2), 4.0 * PI), (torus(9, 7), 0.0), (disc(4), 0.0)] {
        let method = GaussianBending::new(modulus);
        let found = energy(method, &mesh.connectivity, &mesh.positions);
        let vertices = mesh.positions.len() as f64;
        tolerance::GAUSS_BONNET.assert(found, modulus * total, vertices, "κ_G ∫ K dS");
        if mesh.connectivity.is_closed() {
            let force = forces(method, &mesh.connectivity, &mesh.positions);
            assert!(force.iter().all(|force| *force == [0.0; 3]), "closed");
        }
    }
}

/// Forces act only on vertices at the boundary and next to it.
#[test]
fn forces_stay_at_the_edge() {
    let mesh = hemisphere(3);
    let force = forces(both(), &mesh.connectivity, &mesh.positions);
    for (vertex, force) in force.iter().enumerate() {
        let kind = |vertex: u32| mesh.connectivity.vertex_kind(vertex as usize);
        let ring = mesh.connectivity.one_ring(vertex);
        let near = |&vertex: &u32| kind(vertex) == VertexKind::Boundary;
        let at_edge = near(&(vertex as u32)) || ring.iter().any(near);
        assert!(at_edge || *force == [0.0; 3], "vertex {vertex}");
    }
}

/// A membrane under uniform tension σ pulls its edge with σ per length, tangentially and inward: the total
/// along the axis is `σ 2π r sin θ` for a cap with an edge of radius r at the angle θ, and `σ 2π r dz/ds =
/// 2πσ` at each end of a catenoid of neck radius 1. A vertex of the edge also bears the normal force of half
/// a row of triangles, an error of first order on the cap, where H is not 0.
#[test]
fn tension_pulls_at_the_edge() {
    let pull = |mesh: &Mesh| {
        let method = SurfaceTension::new(1.0);
        let force = forces(method, &mesh.connectivity, &mesh.positions);
        let upper = |vertex: &usize| mesh.positions[*vertex][2] > 0.0;
        let edge = boundary(mesh).into_iter().filter(upper);
        edge.map(|vertex| force[vertex][2]).sum::<f64>()
    };
    type Make = fn(u32) -> Mesh;
    let of_cap = 2.0 * PI * 1.0_f64.sin().powi(2);
    let cases: [(Make, f64, f64, &str); 2] = [
        (|size| cap(size, 1.0), of_cap, 1.0, "cap"),
        (|size| catenoid(4 * size, 1.2), -2.0 * PI, 2.0, "catenoid"),
    ];
    for (make, exact, expected, name) in cases {
        let [coarse, fine] = [8, 16].map(|size| (pull(&make(size)) - exact).abs());
        let order = (coarse / fine).log2();
        assert!(
            (order - expected).abs() < 0.2 && fine < 0.1 * exact.abs(),
            "{name}: order {order}, errors {coarse:e} and {fine:e}"
        );
    }
}
