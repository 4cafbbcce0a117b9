//! Repulsion with a memory that is kept while surfaces move, against one that knows nothing.

use super::{Positions, crowd, evaluate, evaluate_with, free, positions};
use helfrich::interaction::RepulsionMemory;
use helfrich::{Images, Repulsion};
use helfrich_tests::meshes::{GENERIC, Mesh, SplitMix64, cases, icosphere, rotation, turned};
use proptest::prelude::*;

/// A generator of motions: each surface moves and turns on its own, and its vertices move a little.
struct Motion {
    random: SplitMix64,
    /// A length for each step, and the part of it that is the vertices' own.
    size: f64,
    rough: f64,
}

impl Motion {
    fn vector(&mut self, size: f64) -> [f64; 3] {
        [(); 3].map(|()| size * self.random.symmetric())
    }

    fn step(&mut self, all: &mut [Positions<f64>]) {
        for positions in all {
            let shift = self.vector(self.size);
            let [a, b, c] = self.vector(self.size);
            let turn = rotation([1.0, a, b, c]);
            for x in positions {
                let own = self.vector(self.rough * self.size);
                let y = turned(turn, *x);
                *x = [0, 1, 2].map(|k| y[k] + shift[k] + own[k]);
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(16))]

    /// To the last bit, however fast surfaces move, also by whole periods, and if the range or the box changes on the way.
    #[test]
    fn memory_does_not_enter_results(
        seed in 0..1_000_000_u64,
        count in 1..4_usize,
        range in 0.1..0.6,
        logarithm in -4.0..0.0,
        rough in 0.0..1.0,
        parts: bool,
        own: bool,
        period in prop::sample::select(vec![0.0, 1.5, 4.0]),
    ) {
        let mut repulsion = Repulsion {
            parts,
            images: Images { periods: [period, 0.0, 0.5 * period], own },
            ..free(3.0, range)
        };
        let meshes = crowd(seed, count);
        let mut all = positions(&meshes);
        let mut motion = Motion { random: SplitMix64::new(seed), size: 10_f64.powf(logarithm), rough };
        let mut kept = RepulsionMemory::default();
        for step in 0..12 {
            match step {
                5 => repulsion.modulus *= 2.0,
                8 => all[0].iter_mut().for_each(|x| x[0] += period),
                10 => repulsion.range *= 1.5,
                _ => {}
            }
            let found = evaluate_with(&mut kept, repulsion, &meshes, &all);
            let same = found == evaluate(repulsion, &meshes, &all);
            prop_assert!(same, "step {}", step);
            motion.step(&mut all);
        }
    }
}

proptest! {
    #![proptest_config(cases(16))]

    /// Forces on some surfaces have the bits that they have among the forces on all.
    #[test]
    fn forces_on_some_surfaces_are_those_among_all(
        seed in 0..1_000_000_u64,
        count in 2..5_usize,
        range in 0.1..0.6,
        parts: bool,
        own: bool,
        wanted in prop::collection::vec(any::<bool>(), 4),
        period in prop::sample::select(vec![0.0, 1.5, 4.0]),
    ) {
        let repulsion = Repulsion {
            parts,
            images: Images { periods: [period, 0.0, 0.5 * period], own },
            ..free(3.0, range)
        };
        let meshes = crowd(seed, count);
        let mut all = positions(&meshes);
        let mut motion = Motion { random: SplitMix64::new(seed), size: 1e-3, rough: 0.3 };
        let mut limited = RepulsionMemory::default();
        limited.limit_to(Some(&wanted[..count]));
        for step in 0..3 {
            let (_, found) = evaluate_with(&mut limited, repulsion, &meshes, &all);
            let (_, expected) = evaluate(repulsion, &meshes, &all);
            for surface in (0..count).filter(|&surface| wanted[surface]) {
                let same = found[surface] == expected[surface];
                prop_assert!(same, "step {}, surface {}", step, surface);
            }
            motion.step(&mut all);
        }
        limited.limit_to(None);
        let same = evaluate_with(&mut limited, repulsion, &meshes, &all) == evaluate(repulsion, &meshes, &all);
        prop_assert!(same, "again all");
    }
}

/// Two spheres that nearly touch.
fn pair() -> [Mesh; 2] {
    let turn = rotation(GENERIC);
    [0.0, 2.1].map(|shift| {
        icosphere(3).map(|x| {
            let [x, y, z] = turned(turn, x);
            [x + shift, y, z]
        })
    })
}

/// Checks that a rod which moves so, as a function of time from 0 to 2, is found as soon as another is within the range,
/// wherever the list was made before.
fn check_that_it_is_found(name: &str, motion: impl Fn(f64, [f64; 3]) -> [f64; 3]) {
    let meshes = pair().map(|mesh| mesh.map(|[x, y, z]| [x, 3.0 * y, z]));
    let repulsion = free(1.0, 0.3);
    let mut memory = RepulsionMemory::default();
    let mut first = None;
    for step in 0..160 {
        let mut all = positions(&meshes);
        let time = f64::from(step) / 80.0;
        all[1].iter_mut().for_each(|x| *x = motion(time, *x));
        let found = evaluate_with(&mut memory, repulsion, &meshes, &all);
        let same = found == evaluate(repulsion, &meshes, &all);
        assert!(same, "{name}, step {step}");
        first = first.or((found.0 > 0.0).then_some(step));
    }
    // It comes within the range while lists last for several steps.
    let searches = memory.searches();
    assert!(
        first.is_some_and(|first| first > 20) && searches < 60,
        "{name}: step {first:?}, {searches} searches"
    );
}

#[test]
fn what_comes_near_is_found_in_time() {
    check_that_it_is_found("comes", |time, [x, y, z]| [x + 2.0 - time, y, z]);
    check_that_it_is_found("turns", |time, [x, y, z]| {
        let (sine, cosine) = (1.1 * time).sin_cos();
        let x = x - 2.1;
        [2.2 + cosine * x - sine * y, 3.5 + sine * x + cosine * y, z]
    });
    check_that_it_is_found("grows", |time, [x, y, z]| {
        [x + 0.8 - 0.8 * time * (-9.0 * y * y).exp(), y, z]
    });
}

/// Slow relative motion asks for a search every few evaluations only, a common translation for none.
#[test]
fn slow_motion_needs_few_searches() {
    let meshes = pair();
    let repulsion = free(1.0, 0.4);
    let mut all = positions(&meshes);
    let mut memory = RepulsionMemory::default();
    for _ in 0..64 {
        evaluate_with(&mut memory, repulsion, &meshes, &all);
        all[1].iter_mut().for_each(|x| x[1] += 0.002);
    }
    // The first knows no velocity, and the skin of those after it lasts 16 evaluations; `evaluate_with` evaluates twice.
    let searches = memory.searches();
    assert!((2..=10).contains(&searches), "{searches}");
    for _ in 0..8 {
        all.iter_mut().flatten().for_each(|x| x[0] += 64.0);
        evaluate_with(&mut memory, repulsion, &meshes, &all);
    }
    assert!(
        memory.searches() <= searches + 1,
        "{} after {searches}",
        memory.searches()
    );
}

/// A mesh with other triangles over the same vertices is not mistaken for the one before.
#[test]
fn another_mesh_is_noticed() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.5],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.5],
    ];
    let point = Mesh::new(
        [[0.4, 0.4, 0.5], [0.6, 0.4, 2.0], [0.4, 0.6, 2.0]].to_vec(),
        vec![[0, 1, 2]],
    );
    let quadrilaterals = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
    let [first, second] = quadrilaterals.map(|triangles| {
        [
            Mesh::new(corners.to_vec(), triangles.to_vec()),
            point.clone(),
        ]
    });
    let repulsion = free(1.0, 0.3);
    let mut memory = RepulsionMemory::default();
    let all = positions(&first);
    let (before, _) = evaluate_with(&mut memory, repulsion, &first, &all);
    let found = evaluate_with(&mut memory, repulsion, &second, &all);
    assert!(found == evaluate(repulsion, &second, &all));
    assert!(before == 0.0 && found.0 > 0.0, "{before}, {}", found.0);
}
