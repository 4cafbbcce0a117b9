//! Single against double precision.

use helfrich_tests::laws::{Candidate, Law, energy, for_each, forces, largest};
use helfrich_tests::meshes::{Mesh, bent, difference, icosphere, norm};
use helfrich_tests::tolerance::methods::SinglePrecision;

#[test]
fn single_precision_within_the_table() {
    struct Single(Mesh);
    impl Law for Single {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let name = candidate.name();
            let bound = SinglePrecision::of(name);
            let mesh = &self.0.connectivity;
            let single = self.0.positions_in::<f32>();
            let double = &self.0.positions;

            let expected = energy(candidate.method(1.0_f64), mesh, double);
            let found = f64::from(energy(candidate.method(1.0_f32), mesh, &single));
            bound
                .energy
                .assert(found, expected, expected, &format!("{name}: energy"));

            let expected = forces(candidate.method(1.0_f64), mesh, double);
            let found = forces(candidate.method(1.0_f32), mesh, &single);
            let scale = largest(&expected);
            for (found, expected) in found.iter().zip(&expected) {
                let error = norm(difference(found.map(f64::from), *expected));
                bound
                    .force
                    .assert(error, 0.0, scale, &format!("{name}: force"));
            }
        }
    }
    // Bent, so that forces do not vanish.
    for_each(&mut Single(icosphere(3).map(bent)));
}
