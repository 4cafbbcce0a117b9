//! Repulsion of surfaces against a double loop over all pairs, its gradient, and its limits.

mod double_loop;
mod images;
mod kept;
mod parts;

use autodiff::F1;
use double_loop::{apart, areas, by_pairs};
use helfrich::interaction::RepulsionMemory;
use helfrich::{Images, Interaction, Real, Repulsion, Serial, Surface};
use helfrich_std::execute::Parallel;
use helfrich_tests::laws::{largest, with_derivatives};
use helfrich_tests::meshes::{
    GENERIC, Mesh, SplitMix64, bent, cases, cross, difference, dot, hemisphere, icosphere, norm,
    rotation, torus, turned,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Repulsion in f32 against f64, relative.
const REPULSION_SINGLE: Tolerance = Tolerance::new(
    1e-5,
    "positions of size 3 rounded at 6e-8 over a range of 0.5, in the third power",
);

type Positions<T> = Vec<[T; 3]>;

/// Repulsion in free space.
fn free<T: Real>(modulus: T, range: T) -> Repulsion<T> {
    Repulsion {
        modulus,
        range,
        attraction: T::zero(),
        parts: false,
        first_group: None,
        images: Images::none(),
    }
}

/// Energy and forces on each surface.
fn evaluate<T: Real>(
    repulsion: Repulsion<T>,
    meshes: &[Mesh],
    positions: &[Positions<T>],
) -> (T, Vec<Positions<T>>) {
    evaluate_with(&mut Default::default(), repulsion, meshes, positions)
}

/// The same with this memory.
fn evaluate_with<T: Real>(
    memory: &mut RepulsionMemory<T>,
    repulsion: Repulsion<T>,
    meshes: &[Mesh],
    positions: &[Positions<T>],
) -> (T, Vec<Positions<T>>) {
    let surfaces = meshes.iter().zip(positions);
    let surfaces = surfaces.map(|(mesh, x)| Surface::new(&mesh.connectivity, x).unwrap());
    let surfaces = Vec::from_iter(surfaces);
    let mut forces = Vec::from_iter(positions.iter().map(|x| vec![[T::zero(); 3]; x.len()]));
    let mut slices = Vec::from_iter(forces.iter_mut().map(Vec::as_mut_slice));
    let energy = repulsion.add_force_and_energy(&Serial, &surfaces, memory, &mut slices);
    let alone = repulsion.energy(&Serial, &surfaces, memory);
    assert_eq!(alone, energy, "with and without forces");
    (energy, forces)
}

fn positions<T: Real>(meshes: &[Mesh]) -> Vec<Positions<T>> {
    meshes.iter().map(Mesh::positions_in).collect()
}

/// `w(d)/k` and `−w'(d)/(k d)` of a repulsion.
fn law(range: f64, distance: f64) -> [f64; 2] {
    law_with(0.0, range, distance)
}

/// The same with attraction.
fn law_with(attraction: f64, range: f64, distance: f64) -> [f64; 2] {
    let s2 = (distance / range).powi(2);
    if s2 >= 1.0 {
        return [0.0; 2];
    }
    let energy = 0.25 * range.powi(2) * (1.0 - s2).powi(3) * (1.0 / s2 - attraction);
    let pressed = 1.0 + 2.0 * s2 - 3.0 * attraction * s2 * s2;
    let pressure = 0.5 * range * (1.0 - s2).powi(2) * pressed / s2.powf(1.5);
    [energy, pressure / distance]
}

/// Bodies next to, inside and around each other.
fn crowd(seed: u64, count: usize) -> Vec<Mesh> {
    crowd_of([icosphere(2), torus(16, 8), hemisphere(2)], seed, count)
}

fn crowd_of(bodies: [Mesh; 3], seed: u64, count: usize) -> Vec<Mesh> {
    let mut random = SplitMix64::new(seed);
    let kinds = bodies;
    let mut bodies = Vec::new();
    for k in 0..count {
        let away = [0; 3].map(|_| 1.5 * random.symmetric());
        let turn = rotation([0; 4].map(|_| random.symmetric()));
        let placed = |x| {
            let [x, y, z] = turned(turn, bent(x));
            [x + away[0], y + away[1], z + away[2]]
        };
        bodies.push(kinds[k % 3].map(placed));
    }
    bodies
}

/// Factor by which rounding of positions matters more if surfaces almost touch: errors grow as 1/d, and the
/// energy as 1/d².
fn nearness(energy: f64) -> f64 {
    1.0 + energy.sqrt()
}

fn check_pairs(repulsion: Repulsion<f64>, meshes: &[Mesh]) -> f64 {
    let x = positions::<f64>(meshes);
    let (energy, forces) = evaluate(repulsion, meshes, &x);
    let ([expected, _], direct) = by_pairs(repulsion, meshes, &x);
    let attraction = 0.0;
    let ([size, of_parts], _) = by_pairs(
        Repulsion {
            attraction,
            ..repulsion
        },
        meshes,
        &x,
    );
    let size = size.max(of_parts);
    let near = nearness(size);
    let scale = near * (1.0 + repulsion.attraction) * size;
    tolerance::SAME.assert(energy, expected, scale, "E");
    // Only net forces are compared: forces from changes of the vertex areas have no net force. Their values
    // are checked by the law of gradients.
    for (force, direct) in forces.iter().zip(&direct) {
        let net =
            |force: &[[f64; 3]]| [0, 1, 2].map(|axis| force.iter().map(|f| f[axis]).sum::<f64>());
        let scale = direct.iter().map(|&f| norm(f)).sum::<f64>();
        let error = norm(difference(net(force), net(direct)));
        let scale = near * (scale + largest(force) + of_parts / repulsion.range);
        tolerance::SAME.assert(error, 0.0, scale, "force on a surface");
    }
    energy
}

fn check_gradient(repulsion: Repulsion<f64>, meshes: &[Mesh], seed: u64) {
    let x = positions::<f64>(meshes);
    let (_, forces) = evaluate(repulsion, meshes, &x);
    let largest = forces.iter().map(|f| largest(f)).fold(0.0, f64::max);
    let mut random = SplitMix64::new(seed);
    let dual = Repulsion {
        modulus: F1::cst(repulsion.modulus),
        range: F1::cst(repulsion.range),
        attraction: F1::cst(repulsion.attraction),
        parts: repulsion.parts,
        first_group: repulsion.first_group,
        images: Images {
            periods: repulsion.images.periods.map(F1::cst),
            own: repulsion.images.own,
        },
    };
    for _ in 0..4 {
        let directions = Vec::from_iter(x.iter().map(|x| random.directions(x.len())));
        let moved = x.iter().zip(&directions);
        let moved = moved.map(|(x, d)| with_derivatives(x, d));
        let (energy, _) = evaluate(dual, meshes, &Vec::from_iter(moved));
        let pairs = forces.iter().flatten().zip(directions.iter().flatten());
        let work: f64 = pairs.map(|(&f, &d)| -dot(f, d)).sum();
        let scale = largest * x.iter().map(Vec::len).sum::<usize>() as f64;
        tolerance::GRADIENT_DUAL.assert(work, energy.dx, scale, "−F·d");
    }
}

/// None, or one at which surfaces rest at 0.9 to 0.3 of the range.
fn attractions() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 1.3..50.0]
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn cells_find_all_pairs(
        seed in 0..1_000_000_u64,
        count in 2..6_usize,
        range in 0.05..2.5,
        attraction in attractions(),
        first_group in prop::option::of(1..4_usize),
    ) {
        let repulsion = Repulsion { attraction, first_group, ..free(3.0, range) };
        check_pairs(repulsion, &crowd(seed, count));
    }

    #[test]
    fn forces_are_gradients(
        seed in 0..1_000_000_u64,
        range in 0.2..1.0,
        attraction in attractions(),
        first_group in prop::option::of(Just(1)),
    ) {
        let repulsion = Repulsion { attraction, first_group, ..free(3.0, range) };
        check_gradient(repulsion, &crowd(seed, 3), seed);
    }

    #[test]
    fn forces_and_torques_balance(seed in 0..1_000_000_u64) {
        let meshes = crowd(seed, 4);
        let x = positions::<f64>(&meshes);
        let (_, forces) = evaluate(free(3.0, 0.7), &meshes, &x);
        let (mut net, mut torque, mut scale) = ([0.0; 3], [0.0; 3], f64::MIN_POSITIVE);
        for (&x, &f) in x.iter().flatten().zip(forces.iter().flatten()) {
            let turn = cross(x, f);
            for axis in 0..3 {
                net[axis] += f[axis];
                torque[axis] += turn[axis];
            }
            scale += norm(f) * (1.0 + norm(x));
        }
        tolerance::BALANCE.assert(norm(net), 0.0, scale, "ΣF");
        tolerance::BALANCE.assert(norm(torque), 0.0, scale, "Σ x × F");
    }
}

/// Bodies separated by more cells than integers can count, and cells smaller than the last digit of
/// coordinates: the pairs found are those of the double loop.
#[test]
fn any_extent_is_searched() {
    let crowd = crowd(1, 3);
    let repulsion = free(2.0, 0.4);
    let near = check_pairs(repulsion, &crowd);
    assert!(near > 0.0);
    for far in [1e6, 1e14, 1e75] {
        // Two vertices of each surface are pulled far out: all bounding boxes intersect, and cells are few or
        // many.
        let mut meshes = crowd.clone();
        for (k, mesh) in meshes.iter_mut().enumerate() {
            mesh.positions[0][k] = far;
            mesh.positions[1][k] = -far;
        }
        let x = positions::<f64>(&meshes);
        let surfaces = meshes.iter().zip(&x);
        let surfaces = surfaces.map(|(mesh, x)| Surface::new(&mesh.connectivity, x).unwrap());
        let surfaces = Vec::from_iter(surfaces);
        let energy = repulsion.energy(&Serial, &surfaces, &mut Default::default());
        let ([expected, _], _) = by_pairs(repulsion, &meshes, &x);
        tolerance::SAME.assert(energy, expected, expected, &format!("E, {far:e}"));
    }
    // Relative to a far vertex, positions are rounded to a 64th, and cells as well. Near pairs are found
    // nevertheless.
    let far = 1e14;
    let drawn_out = |mesh: &Mesh| {
        let mut positions = mesh.map(|x| x.map(|x| x + far)).positions;
        positions.push([-far; 3]);
        Mesh::new(positions, mesh.connectivity.triangles().to_vec())
    };
    let meshes = Vec::from_iter(crowd.iter().map(drawn_out));
    assert!(check_pairs(repulsion, &meshes) > 0.0);
    for range in [1e-300, 1e-17, 1e17, 1e60] {
        let found = check_pairs(Repulsion { range, ..repulsion }, &crowd);
        assert!(found.is_finite(), "range {range:e}: {found}");
    }
}

/// Spheres around each other at the distance of rest have the energy −W per area, and no force but that of their areas;
/// nearer they repel, farther they attract each other.
#[test]
fn surfaces_adhere_at_their_distance_of_rest() {
    let (energy, distance, range) = (0.7, 0.1, 0.25);
    let adhesion = Repulsion::<f64>::adhesion(energy, distance, range);
    let per_area = |gap: f64| {
        let Repulsion {
            modulus,
            attraction,
            ..
        } = adhesion;
        law_with(attraction, range, gap).map(|number| modulus * number)
    };
    let [least, none] = per_area(distance);
    tolerance::SAME.assert(least, -energy, energy, "energy at rest");
    tolerance::SAME.assert(none, 0.0, energy / (distance * distance), "force at rest");
    assert!(per_area(0.9 * distance)[1] > 0.0 && per_area(1.1 * distance)[1] < 0.0);
    let turn = rotation(GENERIC);
    let meshes = [
        icosphere(4).map(|x| x.map(|x| (1.0 - distance) * x)),
        icosphere(4).map(|x| turned(turn, x)),
    ];
    let (found, _) = evaluate(adhesion, &meshes, &positions(&meshes));
    let areas = 4.0 * PI * (1.0 + (1.0 - distance).powi(2));
    // Gaps between triangles scatter by e²/8 = 0.004 around the distance of rest, where the energy has its least.
    assert!(
        (found / (-0.5 * energy * areas) - 1.0).abs() < 0.02,
        "{found}"
    );
}

/// Concentric spheres with the gap h have E = 2π (R1² + R2²) w(h) exactly; meshes rotated against each other
/// approach it in second order.
#[test]
fn concentric_spheres_have_the_energy_of_their_gap() {
    let error = |refinement: u32| {
        let (inner, outer, range) = (0.8, 1.0, 0.35_f64);
        let turn = rotation(GENERIC);
        let meshes = [
            icosphere(refinement).map(|x| x.map(|x| inner * x)),
            icosphere(refinement).map(|x| turned(turn, x).map(|x| outer * x)),
        ];
        let (energy, _) = evaluate(free(2.0, range), &meshes, &positions(&meshes));
        let [gap_energy, _] = law(range, outer - inner);
        energy / (4.0 * PI * (inner * inner + outer * outer) * gap_energy) - 1.0
    };
    let (coarse, fine) = (error(3), error(4));
    assert!(fine.abs() < 0.01, "{coarse:e}, {fine:e}");
    assert!((coarse / fine).log2() > 1.5, "{coarse:e}, {fine:e}");
}

/// Between separate convex bodies, each vertex contributes the energy of its smallest distance once, whether
/// the nearest point lies in a triangle, on an edge or at a corner.
#[test]
fn what_is_nearest_for_several_triangles_counts_once() {
    let range = 0.9;
    let mut random = SplitMix64::new(5);
    let mut nonzero = 0;
    for _ in 0..20 {
        let place = [0; 3].map(|_| 2.0 * random.symmetric());
        let turn = rotation([0; 4].map(|_| random.symmetric()));
        let far = 2.4 / norm(place);
        let meshes = [
            icosphere(0),
            icosphere(1).map(|x| {
                let [x, y, z] = turned(turn, x);
                [x + far * place[0], y + far * place[1], z + far * place[2]]
            }),
        ];
        let x = positions::<f64>(&meshes);
        let mut expected = 0.0;
        for (a, b) in [(0, 1), (1, 0)] {
            let areas = areas(&meshes[a], &x[a]);
            for (area, &vertex) in areas.iter().zip(&x[a]) {
                let triangles = meshes[b].connectivity.triangles().iter();
                let distances =
                    triangles.map(|t| norm(apart(vertex, &t.map(|k| x[b][k as usize]))));
                let least = distances.fold(f64::INFINITY, f64::min);
                expected += 0.5 * area * law(range, least)[0];
                nonzero += usize::from(least < range);
            }
        }
        let (energy, _) = evaluate(free(1.0, range), &meshes, &x);
        tolerance::SAME.assert(energy, expected, expected, "E");
    }
    assert!(nonzero > 100, "{nonzero}");
}

/// A vertex approaches the interior of a triangle far larger than the range, where no other vertex is near.
/// The force from `p(h) = k r_c/2 (1 − s²)² (1 + 2s²)/s³` on half of its area grows without bound, and is
/// smooth where the nearest point crosses an edge to the next triangle.
#[test]
fn the_barrier_has_no_holes_and_no_top() {
    let quad = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    let plane = Mesh::new(
        quad.map(|[x, y]| [x, y, 0.0]).to_vec(),
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let push = |[x, y]: [f64; 2], height: f64| {
        let size = 1e-3;
        let corners = [[0.0, 0.0], [size, 0.0], [0.0, size]];
        let small = corners.map(|[a, b]| [x + a, y + b, height]);
        let meshes = [plane.clone(), Mesh::new(small.to_vec(), vec![[0, 1, 2]])];
        let (_, forces) = evaluate(free(2.0, 0.3), &meshes, &positions(&meshes));
        let net = |force: &[[f64; 3]]| force.iter().map(|f| f[2]).sum::<f64>();
        tolerance::SAME.assert(net(&forces[0]), -net(&forces[1]), net(&forces[1]), "ΣF");
        net(&forces[1]) / (0.5 * size * size)
    };
    for [x, y] in [[3.0, -3.0], [0.0, 0.0], [-0.0004, 0.0], [2.0, 2.0005]] {
        for height in [0.29, 0.2, 0.1, 0.01, 1e-5] {
            let expected = 0.5 * 2.0 * law(0.3, height)[1] * height;
            let found = push([x, y], height);
            tolerance::SAME.assert(found, expected, expected, "p/2");
        }
    }
}

/// Surfaces that touch have infinite energy.
#[test]
fn surfaces_that_touch_have_no_finite_energy() {
    let meshes = [icosphere(1), icosphere(1).map(|[x, y, z]| [x + 2.0, y, z])];
    let touching = [icosphere(1), icosphere(1)];
    let energy = |meshes: &[Mesh]| {
        let surfaces = Vec::from_iter(meshes.iter().map(Mesh::surface));
        free(1.0, 0.3).energy(&Serial, &surfaces, &mut Default::default())
    };
    assert!(energy(&meshes).is_finite());
    assert_eq!(energy(&touching), f64::INFINITY);
}

/// Two small parallel triangles repel each other; the force is zero beyond the range, and just within it
/// grows as the square of the depth.
#[test]
fn repulsion_sets_in_smoothly() {
    let push = |distance: f64| {
        let triangle = |z: f64| {
            let corners = [[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]];
            Mesh::new(corners.map(|[x, y]| [x, y, z]).to_vec(), vec![[0, 1, 2]])
        };
        let meshes = [triangle(0.0), triangle(distance)];
        let repulsion = free(1.0, 1.0);
        let (_, forces) = evaluate(repulsion, &meshes, &positions(&meshes));
        let net = |force: &[[f64; 3]]| force.iter().map(|f| f[2]).sum::<f64>();
        assert!(net(&forces[0]) <= 0.0 && net(&forces[1]) >= 0.0);
        net(&forces[1])
    };
    assert_eq!(push(1.0), 0.0);
    assert!(push(0.5) > 0.0);
    let ratio = push(0.998) / push(0.999);
    assert!((ratio - 4.0).abs() < 0.05, "{ratio}");
}

/// Surfaces that are far apart cost nothing: no pairs are examined if bounding boxes do not intersect, and
/// the energy is 0 if no vertex is near.
#[test]
fn what_is_far_costs_nothing() {
    let repulsion = free(1.0, 0.25);
    let apart = [
        icosphere(2),
        icosphere(2).map(|[x, y, z]| [x + 2.3, y, z]),
        icosphere(1).map(|x| x.map(|x| 0.5 * x)),
    ];
    for (meshes, near) in [
        (&apart[..2], false),
        (&apart[..], true),
        (&apart[..1], false),
    ] {
        let surfaces = Vec::from_iter(meshes.iter().map(Mesh::surface));
        let mut forces = Vec::from_iter(meshes.iter().map(|m| vec![[-0.0; 3]; m.positions.len()]));
        let mut slices = Vec::from_iter(forces.iter_mut().map(Vec::as_mut_slice));
        let mut memory = Default::default();
        let energy = repulsion.add_force_and_energy(&Serial, &surfaces, &mut memory, &mut slices);
        assert_eq!(energy, 0.0);
        assert_eq!(memory.candidates() > 0, near);
        // Adding 0.0 would make these positive.
        let components = forces.concat().into_flattened();
        assert!(components.iter().all(|x| *x == 0.0 && x.is_sign_negative()));
    }
    for range in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let meshes = crowd(3, 2);
        let nowhere = Repulsion { range, ..repulsion };
        let (energy, forces) = evaluate(nowhere, &meshes, &positions(&meshes));
        assert_eq!((energy, largest(&forces.concat())), (0.0, 0.0), "{range}");
    }
}

/// Two groups have the energy of all surfaces less that of each group alone, also with images.
#[test]
fn groups_act_on_each_other_alone() {
    let meshes = crowd(5, 5);
    let all = positions(&meshes);
    for periods in [[0.0; 3], [2.5, 0.0, 3.0]] {
        let images = Images {
            periods,
            own: false,
        };
        let repulsion = Repulsion {
            images,
            ..free(2.0, 0.6)
        };
        let energy = |range: Range<usize>, first_group| {
            let repulsion = Repulsion {
                first_group,
                ..repulsion
            };
            evaluate(repulsion, &meshes[range.clone()], &all[range])
        };
        let (whole, _) = energy(0..5, None);
        let (between, forces) = energy(0..5, Some(2));
        let [(one, on_one), (other, on_other)] = [energy(0..2, None), energy(2..5, None)];
        assert!(
            one + other > 0.0 && between > 0.0,
            "{one}, {other}, {between}"
        );
        tolerance::SAME.assert(between + one + other, whole, whole, "E");
        let (_, expected) = energy(0..5, None);
        let scale = largest(&expected.concat());
        let alone = on_one.iter().chain(&on_other).flatten();
        let parts = forces.iter().flatten().zip(alone);
        for ((a, b), sum) in parts.zip(expected.iter().flatten()) {
            let apart = difference(difference(*sum, *a), *b);
            tolerance::SAME.assert(norm(apart), 0.0, scale, "F");
        }
        // A group of all or of none leaves nothing to act on.
        assert_eq!(energy(0..5, Some(0)).0, 0.0);
        assert_eq!(energy(0..5, Some(5)).0, 0.0);
    }
}

/// Results are the same to the last bit for every number of threads, in a periodic box and in free space.
#[test]
fn threads_do_not_matter() {
    let beside = |x: f64| icosphere(4).map(bent).map(|[a, b, c]| [a + x, b, c]);
    let meshes = [beside(0.0), beside(2.1), beside(4.2)];
    let surfaces = Vec::from_iter(meshes.iter().map(Mesh::surface));
    let periods = [6.3, 0.0, 0.0];
    for images in [Images::none(), Images { periods, own: true }] {
        let repulsion = Repulsion {
            images,
            ..free(1.0, 0.4)
        };
        let (expected, wanted) = evaluate(repulsion, &meshes, &positions(&meshes));
        assert!(expected > 0.0);
        for threads in [1, 2, 5] {
            let execution = Parallel {
                threads: NonZeroUsize::new(threads).unwrap(),
            };
            let mut forces =
                Vec::from_iter(meshes.iter().map(|m| vec![[0.0; 3]; m.positions.len()]));
            let mut slices = Vec::from_iter(forces.iter_mut().map(Vec::as_mut_slice));
            let mut memory = Default::default();
            let energy =
                repulsion.add_force_and_energy(&execution, &surfaces, &mut memory, &mut slices);
            assert_eq!(energy, expected, "{threads} threads");
            assert_eq!(forces, wanted, "{threads} threads");
        }
    }
}

/// Translation by 1e8 radii without rounding, and another order of the surfaces, change results at most by
/// rounding.
#[test]
fn motion_and_order_do_not_matter() {
    let pitch = 2.0_f64.powi(-24);
    let far = 2.0_f64.powi(27);
    let here = crowd(8, 3);
    let here = Vec::from_iter(
        here.iter()
            .map(|mesh| mesh.map(|x| x.map(|x| (x / pitch).round() * pitch))),
    );
    let there = Vec::from_iter(
        here.iter()
            .map(|mesh| mesh.map(|x| [x[0] + far, x[1] - far, x[2]])),
    );
    let repulsion = free(1.0, 0.5);
    let first = evaluate(repulsion, &here, &positions(&here));
    assert!(first.0 > 0.0);
    assert_eq!(first, evaluate(repulsion, &there, &positions(&there)));
    let mut turned = here.clone();
    turned.reverse();
    let mut second = evaluate(repulsion, &turned, &positions(&turned));
    second.1.reverse();
    tolerance::SAME.assert(second.0, first.0, first.0, "E");
    let scale = largest(&first.1.concat());
    for (a, b) in first.1.iter().flatten().zip(second.1.iter().flatten()) {
        tolerance::SAME.assert(norm(difference(*a, *b)), 0.0, scale, "F");
    }
}

#[test]
fn single_precision_finds_the_same() {
    // The bodies do not overlap, because forces of nearly touching overlapping surfaces have no bound.
    let turn = rotation(GENERIC);
    let beside = icosphere(2).map(|x| {
        let [x, y, z] = turned(turn, bent(x));
        [x + 2.35, y, z]
    });
    let meshes = [icosphere(2), beside];
    let double = free(1.0, 0.5);
    let single = free(1.0_f32, 0.5);
    let (expected, wanted) = evaluate(double, &meshes, &positions(&meshes));
    let (energy, forces) = evaluate(single, &meshes, &positions(&meshes));
    let rounding: Tolerance = REPULSION_SINGLE;
    rounding.assert(energy.into(), expected, expected, "E");
    let scale = largest(&wanted.concat());
    for (a, b) in forces.iter().flatten().zip(wanted.iter().flatten()) {
        let error = norm(difference(a.map(f64::from), *b));
        rounding.assert(error, 0.0, scale, "F");
    }
}
