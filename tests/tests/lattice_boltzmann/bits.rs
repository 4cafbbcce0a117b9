//! Bitwise reproducibility: the independence of results from threads and position, and their dependence on
//! the number type.

use crate::{cells, everything, lattice, periodic, seen, stirred};
use helfrich_tests::tolerance::Tolerance;

/// f32 against f64 after forty steps, relative to the deviations.
const LATTICE_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "f32 rounds at 6e-8 of the deviations, some twenty times a step, with random signs",
);

#[test]
fn nothing_depends_on_the_number_of_threads() {
    let mut alone = everything::<f64>(1);
    alone.advance(5);
    for threads in [2, 3, 20] {
        let mut shared = everything::<f64>(threads);
        shared.advance(5);
        assert!(alone.state() == shared.state(), "{threads} threads");
        assert!(alone.wall_forces(1) == shared.wall_forces(1));
    }
}

#[test]
fn stored_states_go_on_bit_for_bit() {
    for first in [4, 5] {
        let mut through = everything::<f32>(1);
        through.advance(first);
        let stored = serde_json::to_string(through.state()).unwrap();
        through.advance(6);
        let mut resumed = everything::<f32>(1);
        resumed
            .restore(serde_json::from_str(&stored).unwrap())
            .unwrap();
        assert_eq!(resumed.steps(), first);
        resumed.advance(6);
        assert!(through.state() == resumed.state());
    }
}

#[test]
fn single_precision_follows_double() {
    let (mut single, mut double) = (everything::<f32>(1), everything::<f64>(1));
    single.advance(40);
    double.advance(40);
    for (found, expected) in seen(&single).iter().zip(seen(&double)) {
        LATTICE_SINGLE.assert(found.density, expected.density, 0.01, "density");
        for axis in 0..3 {
            let (found, expected) = (found.velocity[axis], expected.velocity[axis]);
            LATTICE_SINGLE.assert(found, expected, 0.05, "velocity");
        }
    }
}

/// A flow that is shifted periodically gives the same bits, because rows, ends of vectors and both kinds of
/// step treat every node alike.
#[test]
fn flows_are_the_same_wherever_they_start() {
    let size = [11, 6, 5];
    let [mut here, mut there] = [(); 2].map(|()| lattice::<f64>(periodic(size, 0.1)));
    let shift = [4, 1, 3];
    let flow = stirred(size);
    let shifted = |cell: [usize; 3]| std::array::from_fn(|k| (cell[k] + shift[k]) % size[k]);
    here.fill(&flow);
    there.fill(|cell| flow(shifted(cell)));
    for _ in 0..3 {
        here.advance(1);
        there.advance(1);
        for cell in cells(size) {
            assert_eq!(there.node(cell), here.node(shifted(cell)), "{cell:?}");
        }
    }
}
