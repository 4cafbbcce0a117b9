//! Single against double precision.

use helfrich_tests::laws::{Candidate, Law, Subject, for_each, largest};
use helfrich_tests::meshes::{Mesh, bent, difference, icosphere, norm};
use helfrich_tests::tolerance::methods::SinglePrecision;

#[test]
fn single_precision_within_the_table() {
    struct Single(Mesh);
    impl Law for Single {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate, &candidate);
        }
    }
    impl Single {
        fn check_method(&self, double: &dyn Subject<f64>, single: &dyn Subject<f32>) {
            let name = double.name();
            let bound = SinglePrecision::of(name);
            let mesh = &self.0.connectivity;
            let rounded = self.0.positions_in::<f32>();
            let positions = &self.0.positions;

            let expected = double.energy(1.0, mesh, positions);
            let found = f64::from(single.energy(1.0, mesh, &rounded));
            bound
                .energy
                .assert(found, expected, expected, &format!("{name}: energy"));

            let expected = double.forces(1.0, mesh, positions);
            let found = single.forces(1.0, mesh, &rounded);
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
