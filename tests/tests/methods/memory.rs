//! Memory use of methods.

use helfrich::{
    Force, GompperKroll, Juelicher, KantorNelson, LoopSubdivision, Prepared, StrongForm,
};
use helfrich_std::info::MeshInfo;
use helfrich_std::method::{
    BendingMethod, ListVisitor, ListedEnergy, ListedOperator, Of, for_each_listed,
};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_tests::allocation::held;
use helfrich_tests::laws::{Candidate, ConservativeCandidate, Listed, ListedStrong};
use helfrich_tests::meshes::{bent, icosphere};
use std::path::Path;

/// Bytes per vertex of plan and memory of a method in f64 after its first evaluation.
fn bytes<M: Force<f64>>(method: M) -> f64 {
    let mesh = icosphere(4).map(bent);
    let mut force = vec![[0.0; 3]; mesh.positions.len()];
    let (prepared, bytes) = held(|| {
        let mut prepared = Prepared::new(method, &mesh.connectivity);
        prepared.add_force(mesh.surface(), &mut force);
        prepared
    });
    drop(prepared);
    bytes as f64 / mesh.positions.len() as f64
}

#[test]
fn the_counter_counts_bytes() {
    let (memory, bytes) = held(|| vec![1_u8; 1000]);
    assert_eq!(bytes, 1000);
    let (_, bytes) = held(|| drop(memory));
    assert_eq!(bytes, -1000);
}

/// Memory is bounded by counts of numbers of 8 bytes and indices of 4.
#[test]
fn memory_is_bounded() {
    for (name, found, bound) in [
        // Four indices for each of three edges per vertex; force and energy.
        ("A", bytes(KantorNelson::new(1.0)), 100.0),
        // ∂A/∂x and A; weights of the second pass.
        ("B", bytes(GompperKroll::new(1.0)), 70.0),
        ("Jülicher", bytes(Juelicher::new(1.0)), 90.0),
        // Curvatures of 80 bytes and seven weights of the operator.
        ("C", bytes(StrongForm::meyer(1.0)), 220.0),
        // All neighbours within the kernel's range, 12 bytes each.
        ("D", bytes(StrongForm::belkin(1.0)), 1800.0),
        ("E", bytes(StrongForm::farutin(1.0)), 290.0),
        // Three quadrature points for each of two patches per vertex; control points and the weights that
        // give them.
        ("S", bytes(LoopSubdivision::new(1.0)), 2400.0),
        // 64, 112 and 192 neighbours of 12 bytes, chosen from 120, 220 and 370 candidates of 4 bytes; H and K at
        // six neighbours; two gradients.
        ("J4", bytes(StrongForm::j4(1.0)), 1760.0),
        ("J6", bytes(StrongForm::j6(1.0)), 2760.0),
        ("J8", bytes(StrongForm::j8(1.0)), 4500.0),
    ] {
        assert!(
            found > 0.5 * bound && found <= bound,
            "{name}: {found} bytes"
        );
    }
}

/// Bytes per vertex of a bending method according to the explanation of a scene.
fn explained(method: &str) -> f64 {
    let mesh = icosphere(4).map(bent);
    let memory = |bending: &str| {
        let text = format!(
            "units = \"none\"\n[[surface]]\nname = \"cell\"\nshape = \"sphere:1\"\n\
             vertices = 2562\ntension = {{ value = 1 }}\n{bending}\n\
             [driver]\nkind = \"relax\"\nscheme = \"overdamped\"\n"
        );
        let overrides = Overrides::new::<&str>([]).unwrap();
        let file = SceneFile::parse(&text, Path::new("cell.toml"), &overrides).unwrap();
        let explanation = file.scene.explain(&[MeshInfo::new(mesh.surface())]);
        explanation.memory as f64
    };
    let bending = format!("bending = {{ method = \"{method}\", modulus = 1 }}");
    (memory(&bending) - memory("")) / mesh.positions.len() as f64
}

#[test]
fn explanations_know_what_methods_take() {
    struct Explained;
    impl Explained {
        fn check(method: BendingMethod, found: f64) {
            let explained = explained(method.name());
            assert!(
                (0.75..=1.25).contains(&(explained / found)),
                "{method}: {explained} bytes for {found}"
            );
        }
    }
    impl ListVisitor for Explained {
        fn energy<const PLACE: usize>(&mut self, method: Of<PLACE>)
        where
            Of<PLACE>: ListedEnergy,
        {
            let prepared = ConservativeCandidate::method(Listed(method), 1.0);
            Self::check(Of::<PLACE>::METHOD, bytes(prepared));
        }
        fn strong_form<const PLACE: usize>(&mut self, method: Of<PLACE>)
        where
            Of<PLACE>: ListedOperator,
        {
            Self::check(Of::<PLACE>::METHOD, bytes(ListedStrong(method).method(1.0)));
        }
    }
    for_each_listed(&mut Explained);
}
