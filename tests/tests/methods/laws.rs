//! Laws of methods, applied to every method.

use helfrich::{Cotangent, DualArea, Finding, GompperKroll, KantorNelson, StrongForm, VertexKind};
use helfrich_tests::laws::{
    Balanced, Candidate, Finite, ForceIsDifference, ForceIsGradient, Invariant, InvariantFits, Law,
    Measured, ScaleFree, ScaleFreeSingle, Subject, energy, findings, for_each,
    for_each_conservative, for_each_curvatures, for_each_operator, forces, imbalance,
};
use helfrich_tests::meshes::{
    Base, GENERIC, Inscribed, Mesh, Rough, bent, cases, disc, hemisphere, icosahedron, icosphere,
    norm, octahedron, rotation, rough_any, rough_closed, tetrahedron, turned,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;

/// Net force and torque of the strong form on a smooth mesh of 642 vertices, relative to Σ|F|.
const STRONG_BALANCE: Tolerance = Tolerance::new(
    5e-3,
    "forces are pointwise values times areas and no gradient: they balance as the mesh is refined, those \
     of the heat kernel of a quarter of an area and of jets of degree 4 least well",
);

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn forces_are_gradients_by_dual_numbers(rough in rough_any()) {
        for_each_conservative(&mut ForceIsGradient(&rough.mesh()));
    }

    #[test]
    fn forces_and_torques_balance(rough in rough_any()) {
        for_each_conservative(&mut Balanced(&rough.mesh()));
    }

    /// Each surface has one scale, with or without rounding: half of the surfaces are enough for either.
    #[test]
    fn scale_does_not_matter(
        rough in rough_any(), exponent in -12..=12_i32, is_exact in any::<bool>(),
    ) {
        let mesh = &rough.mesh();
        let (scale, modulus) = match is_exact {
            true => (power_of_two(exponent), 2.0_f64.powi(-63)),
            false => (10.0_f64.powi(exponent), 1e-19),
        };
        for_each(&mut ScaleFree { mesh, scale, modulus });
    }

    #[test]
    fn scale_does_not_matter_in_single_precision(
        rough in rough_closed(), exponent in -6..=6_i32, which in 0..3,
    ) {
        let mesh = &rough.mesh();
        let (scale, modulus) = match which {
            0 => (10.0_f64.powi(exponent), 1.0),
            1 => (power_of_two(exponent), 1.0),
            // A cell in metres, with its modulus in joules: smaller products than these would underflow.
            _ => (4e-6, 2e-19),
        };
        for_each(&mut ScaleFreeSingle(ScaleFree { mesh, scale, modulus }));
    }
}

// Each surface takes several evaluations of every method.
proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn forces_are_gradients_by_differences(rough in rough_any()) {
        for_each_conservative(&mut ForceIsDifference(&rough.mesh()));
    }

    #[test]
    fn motion_and_labels_do_not_matter(rough in rough_any(), seed in 0..1_000_000_u64) {
        for_each(&mut Invariant { mesh: &rough.mesh(), seed });
    }
}

/// The power of two that is about this power of ten.
fn power_of_two(exponent: i32) -> f64 {
    2.0_f64.powf((f64::from(exponent) * 10.0 / 3.0).round())
}

/// The choice of neighbours for a fit depends neither on rotation nor on labels, on rough meshes from twelve
/// vertices on.
#[test]
fn motion_and_labels_do_not_matter_to_fits() {
    for base in [Base::Icosphere, Base::Torus, Base::Hemisphere, Base::Disc] {
        for refinement in 0..3 {
            for (amplitude, seed) in [(0.1, 2), (0.2, 3)] {
                let rough = Rough {
                    base,
                    seed,
                    amplitude,
                    refinement,
                };
                let mesh = &rough.mesh();
                for_each(&mut InvariantFits(Invariant { mesh, seed: 7 }));
            }
        }
    }
}

#[test]
fn known_solids_obey() {
    // The solids are bent, because symmetric ones have hardly any force to compare.
    for solid in [tetrahedron(), octahedron(), icosahedron()] {
        let mesh = solid.map(|x| bent(turned(rotation(GENERIC), x)));
        for_each_conservative(&mut Balanced(&mesh));
        for_each_conservative(&mut ForceIsGradient(&mesh));
    }
    for mesh in [icosphere(2).map(bent), hemisphere(2)] {
        for_each_conservative(&mut ForceIsDifference(&mesh));
        for_each(&mut Invariant {
            mesh: &mesh,
            seed: 7,
        });
    }
}

/// The three moduli of an edge that the literature uses for one κ.
#[test]
fn calibrations_of_the_edge_modulus() {
    let root = 3.0_f64.sqrt();
    for (method, expected) in [
        (KantorNelson::new(5.0), 10.0 / root),
        (
            KantorNelson::with_opposite_gaussian_modulus(5.0),
            5.0 * root,
        ),
        (KantorNelson::with_sphere_energy(5.0), 10.0 * root),
    ] {
        tolerance::POLYHEDRON.assert(method.edge_modulus, expected, expected, "k̃");
    }
}

/// The sign of every force: it flattens a bump on a plane.
#[test]
fn forces_flatten_a_bump() {
    struct Flattens<'a>(&'a Mesh);
    impl Law for Flattens<'_> {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let candidate: &dyn Subject<f64> = &candidate;
            let bumped = self.0;
            let force = candidate.forces(1.0, &bumped.connectivity, &bumped.positions);
            assert!(
                force[0][2] < 0.0,
                "{}: {:?} on a bump",
                candidate.name(),
                force[0]
            );
        }
    }
    let bumped = disc(6).map(|[x, y, _]| [x, y, 0.1 * (-8.0 * (x * x + y * y)).exp()]);
    for_each(&mut Flattens(&bumped));
}

/// Method C is no gradient; the table bounds its net force and torque.
#[test]
fn strong_form_is_nearly_balanced_on_smooth_meshes() {
    struct NearlyBalanced(Mesh);
    impl Law for NearlyBalanced {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let candidate: &dyn Subject<f64> = &candidate;
            let (mesh, positions) = (&self.0.connectivity, &self.0.positions);
            let force = candidate.forces(1.0, mesh, positions);
            let (net, torque) = imbalance(positions, &force);
            STRONG_BALANCE.assert(net, 0.0, 1.0, candidate.name());
            STRONG_BALANCE.assert(torque, 0.0, 1.0, candidate.name());
        }
    }
    for_each(&mut NearlyBalanced(icosphere(3).map(bent)));
}

/// Errors on a sphere are within the table: of the energy, and the largest f R³/κ, which should be 0.
#[test]
fn spheres_within_the_table() {
    struct OnSphere<'a>(&'a Mesh);
    impl Law for OnSphere<'_> {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate);
        }
    }
    impl OnSphere<'_> {
        fn check_method(&self, candidate: &dyn Subject<f64>) {
            let name = candidate.name();
            let expected = tolerance::methods::OnSphere::of(name, candidate.is_gradient());
            let is_exception = tolerance::methods::ON_SPHERE
                .iter()
                .any(|on| on.method == name);
            let (mesh, positions) = (&self.0.connectivity, &self.0.positions);
            let energy = candidate.energy(1.0, mesh, positions);
            let energy = energy / (8.0 * std::f64::consts::PI);
            let error = expected.energy_error;
            error.assert(energy, expected.energy, 1.0, &format!("{name}: E/8πκ"));

            let force = candidate.forces(1.0, mesh, positions);
            let measured = Measured::new(Cotangent::default(), self.0);
            let density = measured.curvature.iter().zip(&force);
            let density = density.map(|(curvature, &force)| norm(force) / curvature.area);
            let density = density.fold(0.0, f64::max);
            let bound = expected.density;
            bound.assert(density, 0.0, 1.0, &format!("{name}: f R³/κ"));
            assert!(
                !is_exception || bound.value < 1.0 || density > 0.25 * bound.value,
                "{name}: f R³/κ is {density}, its exception in ON_SPHERE is not needed"
            );
        }
    }
    for_each(&mut OnSphere(&icosphere(4)));
}

fn replaced(mesh: &Mesh, vertex: usize, position: [f64; 3]) -> Mesh {
    let mut replaced = mesh.clone();
    replaced.positions[vertex] = position;
    replaced
}

/// Surfaces with degenerate triangles, with boundary, or with isolated vertices.
fn degenerate_meshes() -> Vec<Mesh> {
    let sphere = icosphere(1);
    let neighbours = sphere.connectivity.one_ring(0);
    let [first, second] = [0, 1].map(|k| sphere.positions[neighbours[k] as usize]);
    let middle = [0, 1, 2].map(|axis| 0.5 * (first[axis] + second[axis]));
    let mut isolated = sphere.positions.clone();
    isolated.push([3.0, 0.0, 0.0]);
    vec![
        // Two vertices at one point; a vertex in the middle of an edge; all vertices at one point; all on a
        // line.
        replaced(&sphere, 0, first),
        replaced(&sphere, 0, middle),
        sphere.map(|_| [1.0, 2.0, 3.0]),
        sphere.map(|[x, ..]| [x, 0.0, 0.0]),
        Mesh::new(isolated, sphere.connectivity.triangles().to_vec()),
        tetrahedron().map(|[x, y, _]| [x, y, 0.0]),
        hemisphere(2),
        disc(3),
        Mesh::new(
            vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[0, 1, 2]],
        ),
    ]
}

#[test]
fn degenerate_surfaces_give_finite_numbers() {
    for mesh in degenerate_meshes() {
        for scale in [1e-12, 1.0, 1e12] {
            let mesh = mesh.map(|x| x.map(|x| scale * x));
            for_each(&mut Finite(&mesh));
            for_each_operator(&mut Finite(&mesh));
            for_each_curvatures(&mut Finite(&mesh));
        }
    }
}

#[test]
fn degenerate_triangles_and_areas_are_reported() {
    struct Reports<'a>(&'a Mesh, Vec<u32>);
    impl Law for Reports<'_> {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate);
        }
    }
    impl Reports<'_> {
        fn check_method(&self, candidate: &dyn Subject<f64>) {
            // Jets are fitted to vertices, not triangles, and the limit surface of Loop subdivision has an
            // area even where a triangle of its control mesh has none.
            if ["jet", "loop_subdivision"]
                .iter()
                .any(|module| candidate.modules().contains(module))
            {
                return;
            }
            let found = candidate.findings(self.0);
            let triangles = found.iter().filter_map(|finding| match finding {
                Finding::DegenerateTriangle { triangle } => Some(*triangle),
                _ => None,
            });
            // A sum of two methods reports the findings of each.
            let mut triangles = Vec::from_iter(triangles);
            triangles.sort_unstable();
            triangles.dedup();
            assert_eq!(triangles, self.1, "{}", candidate.name());
        }
    }
    let sphere = icosphere(1);
    let neighbour = sphere.connectivity.one_ring(0)[0];
    let coincident = replaced(&sphere, 0, sphere.positions[neighbour as usize]);
    let both = |triangle: &[u32; 3]| triangle.contains(&0) && triangle.contains(&neighbour);
    let triangles = sphere.connectivity.triangles().iter().enumerate();
    let expected = triangles.filter(|(_, triangle)| both(triangle));
    let expected = Vec::from_iter(expected.map(|(triangle, _)| triangle as u32));
    assert_eq!(expected.len(), 2);
    for_each(&mut Reports(&coincident, expected));
    for_each(&mut Reports(&sphere, vec![]));

    let point = sphere.map(|_| [0.5; 3]);
    let everywhere = findings(GompperKroll::new(1.0), &point);
    let vertices = 0..point.positions.len() as u32;
    assert!(
        vertices
            .clone()
            .all(|vertex| everywhere.contains(&Finding::ZeroArea { vertex }))
    );

    let obtuse = Inscribed {
        seed: 11,
        amplitude: 0.9,
        refinement: 3,
        exponent: 0,
    }
    .mesh();
    let negative = |method| {
        findings(method, &obtuse)
            .into_iter()
            .filter(|finding| matches!(finding, Finding::NegativeArea { .. }))
            .count()
    };
    assert!(
        negative(GompperKroll::with_areas(1.0, DualArea::Voronoi)) > 0,
        "Voronoi areas of obtuse fans"
    );
    assert_eq!(negative(GompperKroll::new(1.0)), 0, "mixed areas");
}

/// Vertices at boundaries get the values that the documentation of each method states.
#[test]
fn boundaries_get_the_documented_values() {
    let mesh = hemisphere(2);
    let (connectivity, positions) = (&mesh.connectivity, &mesh.positions);
    let strong = forces(StrongForm::meyer(1.0), connectivity, positions);
    for (vertex, force) in strong.iter().enumerate() {
        let interior = |vertex: usize| connectivity.vertex_kind(vertex) == VertexKind::Interior;
        let ring = connectivity.one_ring(vertex);
        let surrounded = interior(vertex) && ring.iter().all(|&v| interior(v as usize));
        assert_eq!(
            *force != [0.0; 3],
            surrounded,
            "C at vertex {vertex}: {force:?}"
        );
    }
    for kind in [DualArea::Mixed, DualArea::Voronoi, DualArea::Barycentric] {
        let measured = Measured::new(Cotangent::new(kind), &mesh);
        for (vertex, curvature) in measured.curvature.iter().enumerate() {
            let interior = connectivity.vertex_kind(vertex) == VertexKind::Interior;
            assert_eq!(curvature.mean != 0.0, interior, "H at vertex {vertex}");
            assert_eq!(curvature.gaussian != 0.0, interior, "K at vertex {vertex}");
        }
    }
    // B sums over interior vertices, A over interior edges: a flat patch has no energy, whatever its
    // boundary, and a single hinge has the energy of its angle.
    let flat = disc(3);
    for energy in [
        energy(GompperKroll::new(1.0), &flat.connectivity, &flat.positions),
        energy(KantorNelson::new(1.0), &flat.connectivity, &flat.positions),
    ] {
        assert!(energy.abs() < tolerance::FLAT_EXACT.value, "{energy}");
    }
    let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let hinge = Mesh::new(square, vec![[0, 1, 2], [0, 3, 1]]);
    let right_angle = energy(
        KantorNelson::with_edge_modulus(3.0),
        &hinge.connectivity,
        &hinge.positions,
    );
    tolerance::POLYHEDRON.assert(right_angle, 3.0, 3.0, "k̃ (1 − cos 90°)");
}
