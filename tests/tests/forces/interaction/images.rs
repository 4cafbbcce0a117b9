//! Repulsion in periodic boxes, where surfaces meet images of others and of themselves.

use super::{check_gradient, check_pairs, crowd_of, evaluate, free, nearness, positions};
use helfrich::{Images, Repulsion};
use helfrich_tests::laws::largest;
use helfrich_tests::meshes::{
    Mesh, SplitMix64, cases, difference, hemisphere, icosphere, norm, torus,
};
use helfrich_tests::tolerance;
use proptest::prelude::*;

fn in_a_box(range: f64, periods: [f64; 3]) -> Repulsion<f64> {
    Repulsion {
        images: Images { periods, own: true },
        ..free(3.0, range)
    }
}

fn crowd(seed: u64, count: usize) -> Vec<Mesh> {
    crowd_of([icosphere(1), torus(8, 5), hemisphere(1)], seed, count)
}

/// The sum of forces on a surface.
fn net(force: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| force.iter().map(|f| f[axis]).sum())
}

fn sum_of_norms(force: &[[f64; 3]]) -> f64 {
    force.iter().map(|&f| norm(f)).sum()
}

/// No period, a period shorter than the surfaces, or a longer one.
fn period() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 1.2..2.5, 2.5..9.0]
}

/// The surfaces, each translated by a random whole number of periods, at most `most`.
fn moved(repulsion: Repulsion<f64>, meshes: &[Mesh], most: f64, seed: u64) -> Vec<Mesh> {
    let mut random = SplitMix64::new(seed);
    let periods = repulsion.images.periods;
    let moved = meshes.iter().map(|mesh| {
        let shift = periods.map(|period| (most * random.symmetric()).round() * period);
        mesh.map(|x| [0, 1, 2].map(|axis| x[axis] + shift[axis]))
    });
    moved.collect()
}

/// Checks that two configurations have the same energy and the same force on every vertex.
#[track_caller]
fn check_same(repulsion: Repulsion<f64>, here: &[Mesh], there: &[Mesh]) {
    let [first, second] =
        [here, there].map(|meshes| evaluate(repulsion, meshes, &positions(meshes)));
    let near = nearness(first.0);
    tolerance::SAME.assert(second.0, first.0, near * first.0, "E");
    let scale = near * largest(&first.1.concat());
    for (a, b) in first.1.iter().flatten().zip(second.1.iter().flatten()) {
        tolerance::SAME.assert(norm(difference(*a, *b)), 0.0, scale, "F");
    }
}

proptest! {
    #![proptest_config(cases(16))]

    /// The boxes may be shorter than surfaces and ranges.
    #[test]
    fn all_images_are_found(
        seed in 0..1_000_000_u64,
        count in 1..4_usize,
        range in 0.05..2.0,
        periods in [period(), period(), period()],
        own in any::<bool>(),
    ) {
        let mut repulsion = in_a_box(range, periods);
        repulsion.images.own = own;
        check_pairs(repulsion, &crowd(seed, count));
    }

    #[test]
    fn forces_are_gradients(
        seed in 0..1_000_000_u64,
        range in 0.2..1.5,
        periods in [period(), period(), period()],
    ) {
        check_gradient(in_a_box(range, periods), &crowd(seed, 2), seed);
    }

    #[test]
    fn forces_balance(seed in 0..1_000_000_u64, periods in [period(), period(), period()]) {
        let meshes = crowd(seed, 3);
        let (_, forces) = evaluate(in_a_box(0.7, periods), &meshes, &positions(&meshes));
        let all = forces.concat();
        let scale = sum_of_norms(&all) + f64::MIN_POSITIVE;
        tolerance::BALANCE.assert(norm(net(&all)), 0.0, scale, "ΣF");
    }

    #[test]
    fn periods_do_not_matter(
        seed in 0..1_000_000_u64,
        range in 0.2..1.5,
        periods in [period(), period(), period()],
    ) {
        let repulsion = in_a_box(range, periods);
        let here = crowd(seed, 3);
        check_same(repulsion, &here, &moved(repulsion, &here, 5.0, seed));
    }
}

/// Translation by so many periods that cell indices are rounded until a single cell is left does not change
/// the pairs.
#[test]
fn many_periods_do_not_matter() {
    let pitch = 2.0_f64.powi(-8);
    let rounded = |mesh: &Mesh| mesh.map(|x| x.map(|x| (x / pitch).round() * pitch));
    let here = Vec::from_iter(crowd(8, 3).iter().map(rounded));
    for periods in [[8.0, 0.0, 4.0], [4.0; 3]] {
        let repulsion = in_a_box(0.5, periods);
        for most in [30, 38, 41].map(|exponent| 2.0_f64.powi(exponent)) {
            let there = moved(repulsion, &here, most, 3);
            assert!(evaluate(repulsion, &here, &positions(&here)).0 > 0.0);
            check_same(repulsion, &here, &there);
        }
    }
}

/// Two surfaces that overlap through the ends of the box have the same energy and forces as in the middle of
/// it and in free space, if they are far from all other images.
#[test]
fn an_overlap_through_the_end_is_one_inside() {
    let sphere = icosphere(2);
    let beside = sphere.map(|[x, y, z]| [x + 1.75, y + 0.25, z]);
    let behind = sphere.map(|[x, y, z]| [x + 1.75 - 8.0, y + 0.25, z + 16.0]);
    let inside = [sphere.clone(), beside];
    let through = [sphere, behind];
    let repulsion = in_a_box(0.5, [8.0; 3]);
    let within = evaluate(free(3.0, 0.5), &inside, &positions(&inside));
    assert!(within.0 > 0.0);
    let boxed = evaluate(repulsion, &inside, &positions(&inside));
    tolerance::SAME.assert(boxed.0, within.0, within.0, "E");
    check_same(repulsion, &inside, &through);
}

/// In a periodic row of equal spheres, the last is as near to the image of the first as neighbours are to
/// each other: no sphere feels a net force. In free space, both ends are pushed outward.
#[test]
fn a_symmetric_row_stays_symmetric() {
    let (period, range) = (6.3, 0.8);
    for count in [1_usize, 2, 3] {
        let distance = period / count as f64;
        let radius = 0.5 * distance - 0.1;
        let row = Vec::from_iter((0..count).map(|k| {
            let place = (k as f64 - 0.4) * distance;
            icosphere(2).map(|[x, y, z]| [radius * x + place, radius * y, radius * z])
        }));
        let (_, forces) = evaluate(in_a_box(range, [period, 0.0, 0.0]), &row, &positions(&row));
        for force in &forces {
            let scale = sum_of_norms(force);
            assert!(scale > 0.0);
            tolerance::SAME.assert(norm(net(force)), 0.0, scale, "net force");
        }
        let (_, apart) = evaluate(free(3.0, range), &row, &positions(&row));
        if count > 1 {
            assert!(norm(net(&apart[0])) > 0.5 * sum_of_norms(&apart[0]));
        }
    }
}

/// Images of the surface itself act only if `own` is set, and an invalid period counts as none.
#[test]
fn own_images_are_a_choice() {
    let sphere = [icosphere(2)];
    let energy = |period: f64, own: bool| {
        let mut repulsion = in_a_box(0.5, [period, 0.0, 0.0]);
        repulsion.images.own = own;
        evaluate(repulsion, &sphere, &positions(&sphere)).0
    };
    assert!(energy(2.1, true) > 0.0);
    assert_eq!(energy(2.1, false), 0.0);
    for period in [0.0, -2.1, f64::NAN, f64::INFINITY] {
        assert!(!in_a_box(0.5, [period; 3]).images.is_periodic());
        assert_eq!(energy(period, true), 0.0, "{period}");
    }
}

#[test]
fn shifts_are_those_between_bounds() {
    let images = Images {
        periods: [2.0, 0.0, 0.5],
        own: false,
    };
    assert_eq!(images.shifts(0, -3.0, 4.0), Some([-1.0, 2.0]));
    assert_eq!(images.shifts(0, 0.1, 1.9), None);
    assert_eq!(images.shifts(1, -3.0, 4.0), Some([0.0, 0.0]));
    assert_eq!(images.shifts(1, 0.1, 4.0), None);
    assert_eq!(images.shifts(2, 1.0, 1.4), Some([2.0, 2.0]));
}
