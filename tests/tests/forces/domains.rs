//! Domains: a Gaussian modulus at each vertex, and the line tension of borders.

use autodiff::F1;
use helfrich::{
    BorderTension, GaussianBending, GaussianDomains, GompperKroll, MaterialParameter, Prepared,
    Real, Serial, TriangleMesh,
};
use helfrich_tests::laws::{check_gradient, energy, forces};
use helfrich_tests::meshes::{
    Mesh, SplitMix64, cap, cases, disc, dot, icosphere, norm, rough_any, round_disc, torus,
};
use helfrich_tests::tolerance;
use proptest::prelude::*;
use std::f64::consts::PI;

/// Three random domains, so that some triangles belong to all three.
fn at_random(vertices: usize) -> (Vec<f64>, Vec<i64>) {
    let mut random = SplitMix64::new(3);
    let moduli = (0..vertices).map(|_| random.symmetric()).collect();
    let labels = (0..vertices).map(|_| random.below(3) as i64 - 1).collect();
    (moduli, labels)
}

fn gaussian<T: Real>(moduli: &[f64]) -> GaussianDomains<T> {
    let moduli = moduli.iter().map(|&modulus| T::constant(modulus));
    GaussianDomains {
        modulus: MaterialParameter::PerVertex(moduli.collect()),
    }
}

fn border<T: Real>(mesh: &TriangleMesh, labels: &[i64]) -> BorderTension<T> {
    BorderTension::new(T::constant(1.7), mesh, labels)
}

proptest! {
    #![proptest_config(cases(32))]

    /// Labels at vertices and on triangles; the forces also have no net force and torque.
    #[test]
    fn forces_are_gradients(rough in rough_any()) {
        let Mesh { connectivity: mesh, positions } = &rough.mesh();
        let (moduli, labels) = at_random(positions.len());
        check_gradient(&gaussian(&moduli), gaussian::<F1>(&moduli), mesh, positions);
        check_gradient(&border(mesh, &labels), border::<F1>(mesh, &labels), mesh, positions);
        let (_, labels) = at_random(mesh.triangles().len());
        let of_triangles = BorderTension::of_triangles(1.7, mesh, &labels);
        let dual = BorderTension::of_triangles(F1::constant(1.7), mesh, &labels);
        check_gradient(&of_triangles, dual, mesh, positions);
    }
}

/// Equal moduli give the energy and forces of [`GaussianBending`]. On closed surfaces the energy is a
/// constant and the force is zero to the last bit.
#[test]
fn equal_moduli_are_one() {
    let modulus = -0.9;
    for (mesh, total) in [(icosphere(2), 4.0 * PI), (torus(9, 7), 0.0), (disc(4), 0.0)] {
        let vertices = mesh.positions.len();
        let rough = mesh.map(|[x, y, z]| [x + 0.1 * y * z, 1.3 * y, z + 0.2 * x * x]);
        let Mesh {
            connectivity: mesh,
            positions,
        } = &rough;
        let each = gaussian(&vec![modulus; vertices]);
        let one = GaussianBending::new(modulus);
        let [found, expected] = [
            energy(each.clone(), mesh, positions),
            energy(one, mesh, positions),
        ];
        tolerance::GAUSS_BONNET.assert(found, expected, vertices as f64, "∫ κ_G K dS");
        let (found_forces, expected_forces) =
            (forces(each, mesh, positions), forces(one, mesh, positions));
        if mesh.is_closed() {
            tolerance::SAME.assert(found, modulus * total, 1.0, "2πχ κ_G");
            assert!(
                found_forces.iter().all(|force| *force == [0.0; 3]),
                "closed"
            );
        }
        for (found, expected) in found_forces.iter().zip(expected_forces) {
            for axis in 0..3 {
                tolerance::SAME.assert(found[axis], expected[axis], 1.0, "force");
            }
        }
    }
}

/// Number of the circle of each vertex, in a cap of `rings` circles about its highest point.
fn circles(rings: u32) -> Vec<u32> {
    let circle = |ring: u32| std::iter::repeat_n(ring, 6 * ring as usize);
    std::iter::once(0)
        .chain((1..=rings).flat_map(circle))
        .collect()
}

/// `E = κ_G ∫ K dS` over the inner half of the circles, with zero modulus elsewhere. ∫ K dS is the area on
/// the Gauss sphere, `2π (1 − n_z)` at the border midway between two circles. The error is of second order,
/// also on a spheroid.
#[test]
fn the_energy_of_a_domain_converges() {
    for (stretch, name) in [(1.0, "sphere"), (1.6, "spheroid")] {
        let errors = [8, 16, 32].map(|rings: u32| {
            let angle = 2.0;
            let mesh = cap(rings, angle).map(|[x, y, z]| [x, y, stretch * z]);
            let circles = circles(rings);
            let inner = |&circle: &u32| if circle <= rings / 2 { 1.3 } else { 0.0 };
            let moduli = Vec::from_iter(circles.iter().map(inner));
            let found = energy(gaussian(&moduli), &mesh.connectivity, &mesh.positions);
            let middle = angle * (f64::from(rings / 2) + 0.5) / f64::from(rings);
            let (sine, cosine) = middle.sin_cos();
            let along = cosine / stretch;
            let exact = 1.3 * 2.0 * PI * (1.0 - along / along.hypot(sine));
            (found - exact).abs()
        });
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        assert!(
            orders.iter().all(|order| (order - 2.0).abs() < 0.4),
            "{name}: {orders:?}, {errors:?}"
        );
    }
}

/// A border that moves outward on a sphere changes the energy by `Δκ_G K` times the area that it sweeps: if
/// every point moves by the polar angle ε, `dE = Δκ_G 2π sin θ ε`.
#[test]
fn a_jump_of_the_modulus_pushes_its_border() {
    let errors = [8, 16, 32].map(|rings: u32| {
        let mesh = cap(rings, 2.0);
        let circles = circles(rings);
        let moduli = circles
            .iter()
            .map(|&circle| if circle <= rings / 2 { -0.4 } else { -1.7 });
        let moduli = Vec::from_iter(moduli);
        let force = forces(gaussian(&moduli), &mesh.connectivity, &mesh.positions);
        let mut work = 0.0;
        for ((&force, &[x, y, z]), &circle) in force.iter().zip(&mesh.positions).zip(&circles) {
            // Forces at the edge of the cap are left out.
            if circle > 0 && circle < rings - 1 {
                let across = x.hypot(y);
                work += dot(force, [z * x / across, z * y / across, -across]);
            }
        }
        let middle = 2.0 * (f64::from(rings / 2) + 0.5) / f64::from(rings);
        let expected = -1.3 * 2.0 * PI * middle.sin();
        (work / expected - 1.0).abs()
    });
    assert!(
        errors[2] < 5e-3 && errors[2] < 0.4 * errors[1] && errors[1] < 0.4 * errors[0],
        "{errors:?}"
    );
}

/// A border between two circles has the length `L = ½ (L_1 + L_2)`. With N vertices on a circle, each is
/// pulled towards the axis by `Λ sin(π/N)`, together Λ/ρ per length of the border. Other vertices feel no
/// force.
#[test]
fn a_circular_border_contracts() {
    let (rings, tension) = (8, 1.7);
    let mesh = cap(rings, 1.4);
    let circles = circles(rings);
    let labels = Vec::from_iter(circles.iter().map(|&circle| i64::from(circle > 4)));
    let method: BorderTension<f64> = border(&mesh.connectivity, &labels);
    let across = |x: &[f64; 3]| x[0].hypot(x[1]);
    let half_turn = |circle: u32| PI / f64::from(6 * circle);
    let perimeter = |circle: u32| {
        let vertex = circles.iter().position(|&found| found == circle).unwrap();
        let side = 2.0 * across(&mesh.positions[vertex]) * half_turn(circle).sin();
        f64::from(6 * circle) * side
    };
    let length = 0.5 * (perimeter(4) + perimeter(5));
    let found = method.length(&Serial, mesh.surface());
    tolerance::SAME.assert(found, length, length, "L");
    let found = energy(method.clone(), &mesh.connectivity, &mesh.positions);
    tolerance::SAME.assert(found, tension * length, length, "Λ L");
    let middle = 2.0 * PI * (1.4_f64 * 4.5 / 8.0).sin();
    assert!((length / middle - 1.0).abs() < 0.01, "{length} {middle}");
    let force = forces(method, &mesh.connectivity, &mesh.positions);
    for ((x, force), &circle) in mesh.positions.iter().zip(force).zip(&circles) {
        let pull = match circle {
            4 | 5 => tension * half_turn(circle).sin() / across(x),
            _ => 0.0,
        };
        let inward = [-pull * x[0], -pull * x[1], 0.0];
        for axis in 0..3 {
            tolerance::SAME.assert(force[axis], inward[axis], tension, "force");
        }
    }
}

/// Three domains meet in one equilateral triangle of side 1: the border is three times a third of the height.
#[test]
fn three_domains_meet_in_a_triangle() {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let height = 0.75_f64.sqrt();
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]];
    let method: BorderTension<f64> = border(&mesh, &[7, -3, 0]);
    let found = energy(method.clone(), &mesh, &positions);
    tolerance::SAME.assert(found, 1.7 * height, 1.0, "Λ L");
    for force in forces(method, &mesh, &positions) {
        tolerance::SAME.assert(norm(force), 1.7 * 0.5, 1.0, "force");
    }
}

/// Labels of triangles in a mesh of circles about its first vertex: 1 within the inner `rings`, else 0.
fn inner_triangles(mesh: &TriangleMesh, rings: u32) -> Vec<i64> {
    let inside = 1 + 3 * rings * (rings + 1);
    let triangles = mesh.triangles().iter();
    let is_inner = |corners: &[u32; 3]| corners.iter().all(|&vertex| vertex < inside);
    triangles
        .map(|corners| i64::from(is_inner(corners)))
        .collect()
}

/// The area of the triangles with label 1.
fn area_inside(mesh: &Mesh, labels: &[i64]) -> f64 {
    let inner = labels.iter().enumerate().filter(|&(_, &label)| label == 1);
    inner
        .map(|(triangle, _)| mesh.surface().triangle_area(triangle))
        .sum()
}

/// Line tension at which a bud with this bending energy costs as much as the flat domain, both of area πL²:
/// `Λ L/κ = E/κ / (ℓ_flat/L − ℓ/L)`, with the lengths ℓ of their borders.
fn tension_of_bud(flat: &Mesh, bud: &Mesh, labels: &[i64]) -> f64 {
    let bending = energy(GompperKroll::new(1.0), &bud.connectivity, &bud.positions);
    let [flat, bud] = [flat, bud].map(|mesh| {
        let border = BorderTension::of_triangles(1.0, &mesh.connectivity, labels);
        let radius = (area_inside(mesh, labels) / PI).sqrt();
        border.length(&Serial, mesh.surface()) / radius
    });
    bending / (flat - bud)
}

/// Budding of a domain of area πL² in a flat membrane of the same κ, as a spherical cap of polar angle θ:
/// `E = 8πκ sin²(θ/2)` and `ℓ = 2πL cos(θ/2)`, so that cap and flat domain cost the same at
/// `Λ L/κ = 4 (1 + cos(θ/2))`: from 8, where the flat domain is unstable to caps, to 4, above which a
/// complete bud is favoured. R. Lipowsky, J. Phys. II France 2 (1992) 1825; F. Jülicher, R. Lipowsky,
/// Phys. Rev. Lett. 70 (1993) 2964.
///
/// The method counts the bending energy of vertices at the border fully, although the outer half does not
/// belong to the domain. This error is of first order in 1/rings.
#[test]
fn domains_bud_as_caps_between_eight_and_four() {
    for angle in [0.2_f64, 1.0, 2.0, 2.5] {
        let exact = 4.0 * (1.0 + (0.5 * angle).cos());
        let errors = [12_u32, 24].map(|rings| {
            let bud = cap(rings + 1, angle * f64::from(rings + 1) / f64::from(rings));
            let labels = inner_triangles(&bud.connectivity, rings);
            tension_of_bud(&round_disc(rings + 1), &bud, &labels) / exact - 1.0
        });
        let extrapolated = 2.0 * errors[1] - errors[0];
        assert!(
            errors[1].abs() < 0.6 * errors[0].abs() && extrapolated.abs() < 5e-3,
            "{angle}: {errors:?} {extrapolated}"
        );
    }
}

/// A flat domain is unstable already at `Λ L/κ = 2.405²`, the square of the first zero of J0. Of all slopes
/// ψ(r) that take up the same area, the softest is `ψ = J1(kr)` inside, without moment at the border, because
/// the membrane outside follows as a catenoid, `ψ ~ 1/r`, which costs no energy.
#[test]
fn a_flat_domain_buckles_with_its_surroundings() {
    let zero = 2.404_825_557_695_773_f64;
    let exact = zero * zero;
    // J0(x) and J1(x) by their power series.
    let bessel = |x: f64, order: f64| {
        let term = |sum: (f64, f64), m: i32| {
            let m = f64::from(m);
            let next = -sum.1 * 0.25 * x * x / ((m + 1.0) * (m + 1.0 + order));
            (sum.0 + sum.1, next)
        };
        (0..40).fold((0.0, (0.5 * x).powf(order)), term).0
    };
    let errors = [12_u32, 24].map(|rings| {
        let flat = round_disc(3 * rings).map(|[x, y, _]| [3.0 * x, 3.0 * y, 0.0]);
        let slope = zero * bessel(zero, 1.0);
        let bent = flat.map(|[x, y, _]| {
            let r = x.hypot(y);
            let z = match r < 1.0 {
                true => bessel(zero * r, 0.0),
                false => -slope * r.ln(),
            };
            [x, y, 1e-3 * z]
        });
        let labels = inner_triangles(&bent.connectivity, rings);
        tension_of_bud(&flat, &bent, &labels) / exact - 1.0
    });
    assert!(
        errors[1].abs() < 0.02 && errors[1].abs() < 0.6 * errors[0].abs(),
        "{errors:?}"
    );
}

#[test]
#[should_panic(expected = "make a BorderTension for that mesh")]
fn borders_of_another_mesh_are_refused() {
    let (here, there) = (icosphere(1), torus(7, 6));
    let method: BorderTension<f64> = border(&there.connectivity, &[0; 42]);
    Prepared::new(method, &here.connectivity);
}

#[test]
#[should_panic(expected = "41 Gaussian moduli, one per vertex")]
fn moduli_of_another_mesh_are_refused() {
    let mesh = icosphere(1);
    energy(gaussian(&[1.0; 41]), &mesh.connectivity, &mesh.positions);
}
