//! Repulsion between parts of one surface.

use super::double_loop::areas;
use super::{attractions, check_gradient, check_pairs, crowd, evaluate, free, law, positions};
use helfrich::Repulsion;
use helfrich_tests::laws::largest;
use helfrich_tests::meshes::{GENERIC, Mesh, cases, icosphere, rotation, sheet, turned};
use helfrich_tests::tolerance;
use proptest::prelude::*;

fn with_parts(range: f64) -> Repulsion<f64> {
    Repulsion {
        parts: true,
        ..free(3.0, range)
    }
}

/// A sphere whose poles are pressed in, up to this distance from each other, and turned in space.
fn dimpled(gap: f64) -> Mesh {
    let turn = rotation(GENERIC);
    icosphere(3).map(|[x, y, z]| {
        let inside = (-3.0 * (x * x + y * y)).exp();
        turned(
            turn,
            [x, y, z * (0.7 * (1.0 - inside) + 0.5 * gap * inside)],
        )
    })
}

proptest! {
    #![proptest_config(cases(8))]

    /// Also between surfaces that cross, and within surfaces that are folded.
    #[test]
    fn cells_find_all_pairs_of_parts(
        seed in 0..1_000_000_u64,
        count in 1..4_usize,
        range in 0.05..1.0,
        attraction in attractions(),
    ) {
        let repulsion = Repulsion { attraction, ..with_parts(range) };
        check_pairs(repulsion, &crowd(seed, count));
    }

    #[test]
    fn forces_on_parts_are_gradients(
        seed in 0..1_000_000_u64,
        gap in 0.05..0.3,
        attraction in attractions(),
    ) {
        let repulsion = Repulsion { attraction, ..with_parts(0.4) };
        let (energy, _) = evaluate(with_parts(0.4), &[dimpled(gap)], &positions(&[dimpled(gap)]));
        assert!(energy > 0.0);
        check_gradient(repulsion, &[dimpled(gap)], seed);
        check_gradient(repulsion, &crowd(seed, 3), seed);
    }
}

/// Two parallel sheets have the energy of their gap, as one surface of two components as well as two surfaces.
#[test]
fn sheets_of_one_surface_are_as_two_surfaces() {
    let one = sheet(8).map(|[x, y, _]| [x, y, 0.0]);
    let gap = 0.2;
    let other = one.map(|[x, y, z]| [x, y, z + gap]);
    let both = [one.beside(&other, [0.0; 3])];
    let two = [one.clone(), other];
    let range = 0.5;
    let [(joint, together), (separate, apart)] = [
        evaluate(with_parts(range), &both, &positions(&both)),
        evaluate(free(3.0, range), &two, &positions(&two)),
    ];
    let [per_area, _] = law(range, gap);
    let area: f64 = areas(&two[0], &two[0].positions).iter().sum();
    tolerance::SAME.assert(separate, 3.0 * area * per_area, separate, "E of the gap");
    tolerance::SAME.assert(joint, separate, separate, "E of one surface");
    let scale = largest(&apart.concat());
    for (a, b) in together.concat().iter().zip(&apart.concat()) {
        for axis in 0..3 {
            tolerance::SAME.assert(a[axis], b[axis], scale, "F of one surface");
        }
    }
}

/// A surface feels nothing of itself where its radii of curvature are longer than the range.
#[test]
fn smooth_surfaces_do_not_feel_themselves() {
    for refinement in [2, 4] {
        let sphere = [icosphere(refinement)];
        let (energy, forces) = evaluate(with_parts(0.95), &sphere, &positions(&sphere));
        assert_eq!(energy, 0.0);
        assert!(forces.concat().iter().all(|force| *force == [0.0; 3]));
        let (energy, _) = evaluate(with_parts(2.2), &sphere, &positions(&sphere));
        assert!(energy > 0.0, "a sphere faces itself across");
    }
}
