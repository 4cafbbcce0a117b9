//! The laws of methods, over every method.

use helfrich_tests::laws::{
    Balanced, Candidate, ForceIsDifference, ForceIsGradient, Invariant, Law, ScaleFree,
    ScaleFreeSingle, covered_modules, for_each, for_each_conservative,
};
use helfrich_tests::meshes::{
    hemisphere, icosahedron, icosphere, octahedron, rough_any, rough_closed, tetrahedron,
};
use proptest::prelude::*;

/// Few cases here, more with `PROPTEST_CASES`.
fn cases(count: u32) -> ProptestConfig {
    let cases = match std::env::var_os("PROPTEST_CASES") {
        Some(_) => ProptestConfig::default().cases,
        None => count,
    };
    ProptestConfig {
        cases,
        max_shrink_iters: 100,
        ..ProptestConfig::default()
    }
}

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
    #![proptest_config(cases(12))]

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
fn platonic_solids_obey() {
    for mesh in [tetrahedron(), octahedron(), icosahedron()] {
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

/// Method C is no gradient: how far from balance it is, is bounded by the table.
#[test]
fn strong_form_is_nearly_balanced_on_smooth_meshes() {
    struct NearlyBalanced;
    impl Law for NearlyBalanced {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let ellipsoid = icosphere(3).map(|[x, y, z]| [x + 0.2 * y * z, 0.8 * y + 0.1 * x * x, 0.6 * z]);
            let (mesh, positions) = (&ellipsoid.connectivity, &ellipsoid.positions);
            let force = helfrich_tests::laws::forces(candidate.method(1.0), mesh, positions);
            let (net, torque) = helfrich_tests::laws::imbalance(positions, &force);
            println!("{}: {net:.3e} {torque:.3e}", candidate.name());
        }
    }
    for_each(&mut NearlyBalanced);
}
