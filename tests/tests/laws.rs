//! The laws of methods, over every method.

use helfrich::Cotangent;
use helfrich_tests::laws::{
    Balanced, Candidate, ForceIsDifference, ForceIsGradient, Invariant, Law, Measured, ScaleFree,
    ScaleFreeSingle, covered_modules, energy, for_each, for_each_conservative, forces, imbalance,
};
use helfrich_tests::meshes::{
    Mesh, cases, disc, hemisphere, icosahedron, icosphere, norm, octahedron, rough_any,
    rough_closed, tetrahedron,
};
use helfrich_tests::tolerance;
use proptest::prelude::*;

#[test]
fn every_method_of_the_library_is_in_the_suite() {
    let source = include_str!("../../core/src/bending.rs");
    let modules = source
        .lines()
        .filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    let modules = Vec::from_iter(modules);
    assert!(!modules.is_empty(), "no module found in core's bending.rs");
    let covered = covered_modules();
    for module in modules {
        assert!(
            covered.contains(&module),
            "core/src/bending/{module}.rs is in no law: add it to laws::for_each"
        );
    }
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn forces_are_gradients_by_dual_numbers(rough in rough_any()) {
        for_each_conservative(&mut ForceIsGradient(&rough.mesh()));
    }

    #[test]
    fn forces_are_gradients_by_differences(rough in rough_any()) {
        for_each_conservative(&mut ForceIsDifference(&rough.mesh()));
    }

    #[test]
    fn forces_and_torques_balance(rough in rough_any()) {
        for_each_conservative(&mut Balanced(&rough.mesh()));
    }

    #[test]
    fn motion_and_labels_do_not_matter(rough in rough_any(), seed in 0..1_000_000_u64) {
        for_each(&mut Invariant { mesh: &rough.mesh(), seed });
    }

    #[test]
    fn scale_does_not_matter(rough in rough_any(), exponent in -12..=12_i32) {
        let mesh = &rough.mesh();
        for modulus in [1.0, 1e-19] {
            for_each(&mut ScaleFree { mesh, scale: 10.0_f64.powi(exponent), modulus });
        }
        let scale = 2.0_f64.powf((f64::from(exponent) * 10.0 / 3.0).round());
        for modulus in [1.0, 2.0_f64.powi(-63)] {
            for_each(&mut ScaleFree { mesh, scale, modulus });
        }
    }

    #[test]
    fn scale_does_not_matter_in_single_precision(rough in rough_closed(), exponent in -6..=6_i32) {
        let mesh = &rough.mesh();
        for_each(&mut ScaleFreeSingle(ScaleFree {
            mesh, scale: 10.0_f64.powi(exponent), modulus: 1.0,
        }));
        let scale = 2.0_f64.powf((f64::from(exponent) * 10.0 / 3.0).round());
        for_each(&mut ScaleFreeSingle(ScaleFree { mesh, scale, modulus: 1.0 }));
        // A cell in metres, its modulus in joules: smaller products than these would underflow.
        for_each(&mut ScaleFreeSingle(ScaleFree { mesh, scale: 4e-6, modulus: 2e-19 }));
    }
}

#[test]
fn known_solids_obey() {
    // Sheared, for in the symmetric solids no force is left to compare with.
    for solid in [tetrahedron(), octahedron(), icosahedron()] {
        let mesh = solid.map(|[x, y, z]| [x + 0.3 * y, y - 0.2 * z, 0.7 * z + 0.1 * x]);
        for_each_conservative(&mut Balanced(&mesh));
        for_each_conservative(&mut ForceIsGradient(&mesh));
    }
    for mesh in [icosphere(2), hemisphere(2)] {
        for_each_conservative(&mut ForceIsDifference(&mesh));
        for_each(&mut Invariant {
            mesh: &mesh,
            seed: 7,
        });
    }
}

/// The sign of every force: against a bump on a plane, along the radius nowhere on a sphere.
#[test]
fn forces_flatten_a_bump() {
    struct Flattens<'a>(&'a Mesh);
    impl Law for Flattens<'_> {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let bumped = self.0;
            let force = forces(
                candidate.method(1.0),
                &bumped.connectivity,
                &bumped.positions,
            );
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

/// Method C is no gradient: how far from balance it is, is bounded by the table.
#[test]
fn strong_form_is_nearly_balanced_on_smooth_meshes() {
    struct NearlyBalanced(Mesh);
    impl Law for NearlyBalanced {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let (mesh, positions) = (&self.0.connectivity, &self.0.positions);
            let force = forces(candidate.method(1.0), mesh, positions);
            let (net, torque) = imbalance(positions, &force);
            tolerance::STRONG_BALANCE.assert(net, 0.0, 1.0, candidate.name());
            tolerance::STRONG_BALANCE.assert(torque, 0.0, 1.0, candidate.name());
        }
    }
    let bent = icosphere(3).map(|[x, y, z]| [x + 0.2 * y * z, 0.8 * y + 0.1 * x * x, 0.6 * z]);
    for_each(&mut NearlyBalanced(bent));
}

/// Spheres without exactness: energies, and f R³/κ, which should be 8πκ and 0.
#[test]
fn spheres_within_the_table() {
    struct OnSphere;
    impl Law for OnSphere {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let name = candidate.name();
            for refinement in [2, 3, 4] {
                let mesh = icosphere(refinement);
                let (connectivity, positions) = (&mesh.connectivity, &mesh.positions);
                let force = forces(candidate.method(1.0), connectivity, positions);
                let density = Measured::new(Cotangent::default(), &mesh)
                    .curvature
                    .iter()
                    .zip(&force)
                    .map(|(curvature, &force)| norm(force) / curvature.area)
                    .fold(0.0, f64::max);
                let energy = energy(candidate.method(1.0), connectivity, positions);
                let energy = energy / (8.0 * std::f64::consts::PI);
                println!("{name} {refinement}: {density:.4e} {energy:.6}");
            }
        }
    }
    for_each(&mut OnSphere);
}
