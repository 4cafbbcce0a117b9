//! Repulsion of surfaces against the double loop over all pairs, its gradient, and its limits.

use autodiff::F1;
use helfrich::{Interaction, Real, Repulsion, Serial, Surface};
use helfrich_tests::laws::largest;
use helfrich_tests::meshes::{
    GENERIC, Mesh, SplitMix64, bent, cases, cross, difference, dot, hemisphere, icosphere, norm,
    rotation, torus, turned,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;
use std::f64::consts::PI;

type Positions<T> = Vec<[T; 3]>;

/// Energy and forces on each surface.
fn evaluate<T: Real>(
    repulsion: Repulsion<T>,
    meshes: &[Mesh],
    positions: &[Positions<T>],
) -> (T, Vec<Positions<T>>) {
    let surfaces = meshes.iter().zip(positions);
    let surfaces = surfaces.map(|(mesh, x)| Surface::new(&mesh.connectivity, x).unwrap());
    let surfaces = Vec::from_iter(surfaces);
    let mut forces = Vec::from_iter(positions.iter().map(|x| vec![[T::zero(); 3]; x.len()]));
    let mut slices = Vec::from_iter(forces.iter_mut().map(Vec::as_mut_slice));
    let mut memory = Default::default();
    let energy = repulsion.add_force_and_energy(&Serial, &surfaces, &mut memory, &mut slices);
    let alone = repulsion.energy(&Serial, &surfaces, &mut memory);
    assert_eq!(alone, energy, "with and without forces");
    (energy, forces)
}

fn positions<T: Real>(meshes: &[Mesh]) -> Vec<Positions<T>> {
    meshes.iter().map(Mesh::positions_in).collect()
}

/// The double loop: energy, and the force on each vertex at fixed areas.
fn by_pairs(
    repulsion: Repulsion<f64>,
    meshes: &[Mesh],
    positions: &[Positions<f64>],
) -> (f64, Vec<Positions<f64>>) {
    let areas = Vec::from_iter(meshes.iter().zip(positions).map(|(mesh, x)| {
        let surface = Surface::new(&mesh.connectivity, x).unwrap();
        let mut areas = vec![0.0; x.len()];
        for (number, triangle) in mesh.connectivity.triangles().iter().enumerate() {
            for &corner in triangle {
                areas[corner as usize] += surface.triangle_area(number) / 3.0;
            }
        }
        areas
    }));
    let Repulsion { modulus, range } = repulsion;
    let (mut energy, mut forces) = (0.0, Vec::new());
    for a in 0..meshes.len() {
        let mut force = vec![[0.0; 3]; positions[a].len()];
        for b in (0..meshes.len()).filter(|&b| b != a) {
            for (i, &x) in positions[a].iter().enumerate() {
                for (j, &y) in positions[b].iter().enumerate() {
                    let apart = difference(x, y);
                    let within = 1.0 - (norm(apart) / range).powi(2);
                    if within > 0.0 {
                        let weight = areas[a][i] * areas[b][j] * modulus;
                        energy += 0.5 * weight * within.powi(3);
                        let push = 6.0 * weight * within.powi(2) / range / range;
                        for axis in 0..3 {
                            force[i][axis] += push * apart[axis];
                        }
                    }
                }
            }
        }
        forces.push(force);
    }
    (energy, forces)
}

/// Bodies beside, in and around each other.
fn crowd(seed: u64, count: usize) -> Vec<Mesh> {
    let mut random = SplitMix64::new(seed);
    let body = |kind: usize| match kind {
        0 => icosphere(2),
        1 => torus(16, 8),
        _ => hemisphere(2),
    };
    let mut bodies = Vec::new();
    for k in 0..count {
        let away = [0; 3].map(|_| 1.5 * random.symmetric());
        let turn = rotation([0; 4].map(|_| random.symmetric()));
        let placed = |x| {
            let [x, y, z] = turned(turn, bent(x));
            [x + away[0], y + away[1], z + away[2]]
        };
        bodies.push(body(k % 3).map(placed));
    }
    bodies
}

fn check_pairs(repulsion: Repulsion<f64>, meshes: &[Mesh]) -> f64 {
    let x = positions::<f64>(meshes);
    let (energy, forces) = evaluate(repulsion, meshes, &x);
    let (expected, direct) = by_pairs(repulsion, meshes, &x);
    tolerance::SAME.assert(energy, expected, expected.abs(), "E");
    // What the areas add is seen by the law of gradients; here its sum, which is none.
    for (force, direct) in forces.iter().zip(&direct) {
        let net =
            |force: &[[f64; 3]]| [0, 1, 2].map(|axis| force.iter().map(|f| f[axis]).sum::<f64>());
        let scale = direct.iter().map(|&f| norm(f)).sum::<f64>();
        let error = norm(difference(net(force), net(direct)));
        tolerance::SAME.assert(error, 0.0, scale + largest(force), "force on a surface");
    }
    energy
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn cells_find_all_pairs(seed in 0..1_000_000_u64, count in 2..6_usize, range in 0.05..2.5) {
        check_pairs(Repulsion { modulus: 3.0, range }, &crowd(seed, count));
    }

    #[test]
    fn forces_are_gradients(seed in 0..1_000_000_u64, range in 0.2..1.0) {
        let meshes = crowd(seed, 3);
        let x = positions::<f64>(&meshes);
        let (_, forces) = evaluate(Repulsion { modulus: 3.0, range }, &meshes, &x);
        let largest = forces.iter().map(|f| largest(f)).fold(0.0, f64::max);
        let mut random = SplitMix64::new(seed);
        for _ in 0..4 {
            let directions = Vec::from_iter(x.iter().map(|x| random.directions(x.len())));
            let moved = x.iter().zip(&directions).map(|(x, d)| {
                let both = x.iter().zip(d);
                both.map(|(x, d)| [0, 1, 2].map(|k| F1::new(x[k], d[k]))).collect()
            });
            let dual = Repulsion { modulus: F1::cst(3.0), range: F1::cst(range) };
            let (energy, _) = evaluate(dual, &meshes, &Vec::from_iter(moved));
            let pairs = forces.iter().flatten().zip(directions.iter().flatten());
            let work: f64 = pairs.map(|(&f, &d)| -dot(f, d)).sum();
            let scale = largest * x.iter().map(Vec::len).sum::<usize>() as f64;
            tolerance::GRADIENT_DUAL.assert(work, energy.dx, scale, "−F·d");
        }
    }

    #[test]
    fn forces_and_torques_balance(seed in 0..1_000_000_u64) {
        let meshes = crowd(seed, 4);
        let x = positions::<f64>(&meshes);
        let (_, forces) = evaluate(Repulsion { modulus: 3.0, range: 0.7 }, &meshes, &x);
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

/// Bodies far apart by more cells than there are numbers, and cells smaller than any number's last
/// digit: the pairs are those of the double loop.
#[test]
fn any_extent_is_searched() {
    let crowd = crowd(1, 3);
    let repulsion = Repulsion {
        modulus: 2.0,
        range: 0.4,
    };
    let near = check_pairs(repulsion, &crowd);
    assert!(near > 0.0);
    for far in [1e6, 1e14, 1e75] {
        // One vertex of each drawn out: the boxes meet everywhere, and cells are few or many.
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
        let (expected, _) = by_pairs(repulsion, &meshes, &x);
        tolerance::SAME.assert(energy, expected, expected, &format!("E, {far:e}"));
    }
    // Where positions are rounded to an eighth, places in cells are as well, seen from a vertex far
    // away: near pairs are found all the same.
    let far = 1e15;
    let drawn_out = |mesh: &Mesh| {
        let mut positions = mesh.map(|x| x.map(|x| x + far)).positions;
        positions.push([-far; 3]);
        Mesh::new(positions, mesh.connectivity.triangles().to_vec())
    };
    let meshes = Vec::from_iter(crowd.iter().map(drawn_out));
    assert!(check_pairs(repulsion, &meshes) > 0.0);
    for range in [1e-300, 1e-17, 1e17, 1e300] {
        let found = check_pairs(Repulsion { range, ..repulsion }, &crowd);
        assert!(found.is_finite(), "range {range:e}: {found}");
    }
}

/// Concentric spheres: E = π² k R1 R2 r_c² (1 − h²/r_c²)⁴, h = R2 − R1, exactly; on meshes turned
/// against each other, to second order.
#[test]
fn concentric_spheres_have_the_energy_of_the_integral() {
    let error = |refinement: u32| {
        let (inner, outer, range) = (0.9, 1.0, 0.35_f64);
        let turn = rotation(GENERIC);
        let meshes = [
            icosphere(refinement).map(|x| x.map(|x| inner * x)),
            icosphere(refinement).map(|x| turned(turn, x).map(|x| outer * x)),
        ];
        let repulsion = Repulsion {
            modulus: 2.0,
            range,
        };
        let (energy, _) = evaluate(repulsion, &meshes, &positions(&meshes));
        let within = 1.0 - ((outer - inner) / range).powi(2);
        energy / (2.0 * PI * PI * inner * outer * range * range * within.powi(4)) - 1.0
    };
    let (coarse, fine) = (error(3), error(4));
    assert!(fine.abs() < 0.01, "{coarse:e}, {fine:e}");
    assert!((coarse / fine).log2() > 1.5, "{coarse:e}, {fine:e}");
}

/// Two small triangles face to face: pushed apart, by nothing beyond the range, and just within it
/// by a force that grows as the square of the depth.
#[test]
fn repulsion_sets_in_smoothly() {
    let push = |distance: f64| {
        let triangle = |z: f64| {
            let corners = [[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]];
            Mesh::new(corners.map(|[x, y]| [x, y, z]).to_vec(), vec![[0, 1, 2]])
        };
        let meshes = [triangle(0.0), triangle(distance)];
        let repulsion = Repulsion {
            modulus: 1.0,
            range: 1.0,
        };
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

/// Where boxes do not meet nothing is looked at, and where no vertex is near no force is touched.
#[test]
fn what_is_far_costs_nothing() {
    let repulsion = Repulsion {
        modulus: 1.0,
        range: 0.25,
    };
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
        let mut forces = Vec::from_iter(
            meshes
                .iter()
                .map(|m| vec![[f64::NAN; 3]; m.positions.len()]),
        );
        let mut slices = Vec::from_iter(forces.iter_mut().map(Vec::as_mut_slice));
        let mut memory = Default::default();
        let energy = repulsion.add_force_and_energy(&Serial, &surfaces, &mut memory, &mut slices);
        assert_eq!(energy, 0.0);
        assert_eq!(memory.candidates() > 0, near);
    }
    for range in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let meshes = crowd(3, 2);
        let nowhere = Repulsion { range, ..repulsion };
        let (energy, forces) = evaluate(nowhere, &meshes, &positions(&meshes));
        assert_eq!((energy, largest(&forces.concat())), (0.0, 0.0), "{range}");
    }
}

/// Moved by 1e8 radii without rounding, and with the surfaces in another order.
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
    let repulsion = Repulsion {
        modulus: 1.0,
        range: 0.5,
    };
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
    let meshes = crowd(8, 3);
    let double = Repulsion {
        modulus: 1.0,
        range: 0.5,
    };
    let single = Repulsion {
        modulus: 1.0_f32,
        range: 0.5,
    };
    let (expected, wanted) = evaluate(double, &meshes, &positions(&meshes));
    let (energy, forces) = evaluate(single, &meshes, &positions(&meshes));
    let rounding: Tolerance = tolerance::REPULSION_SINGLE;
    rounding.assert(energy.into(), expected, expected, "E");
    let scale = largest(&wanted.concat());
    for (a, b) in forces.iter().flatten().zip(wanted.iter().flatten()) {
        let error = norm(difference(a.map(f64::from), *b));
        rounding.assert(error, 0.0, scale, "F");
    }
}
