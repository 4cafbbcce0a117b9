//! Points immersed in the fluid.

use crate::{cells, everything, lattice, periodic, scattered, seen, stirred};
use helfrich_std::flow::lattice_boltzmann::{Immersed, Kernel, Node, Precision, Setup, Sides};
use helfrich_tests::meshes::SplitMix64;
use helfrich_tests::tolerance::{self, Tolerance};
use std::f64::consts::PI;
use std::num::NonZeroUsize;

/// Velocities kept during an f32 collision against those summed from populations in f64.
const LATTICE_KEPT_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "sums of nineteen populations and a force, each rounded at 6e-8 of the largest",
);

/// Work of forces on points against that on nodes, relative to either.
const LATTICE_WORK: Tolerance = Tolerance::new(
    1e-12,
    "forces on nodes are differences of velocities, a hundredth of the velocities",
);

/// Difference of mobilities in two boxes, relative.
const LATTICE_IMAGES: Tolerance = Tolerance::new(
    1e-2,
    "second order: the lattice's k² deviates in the next order, (2π/14)² for the first wave",
);

const KERNELS: [Kernel; 3] = [Kernel::Two, Kernel::Three, Kernel::Four];

#[test]
fn kernels_keep_sums_and_first_moments() {
    for kernel in KERNELS {
        for step in 0..=40 {
            let place = -0.5 + 0.025 * f64::from(step);
            let nodes = Vec::from_iter((-4..=4).map(|node| f64::from(node) - place));
            let sum = |value: &dyn Fn(f64) -> f64| -> f64 {
                nodes.iter().map(|&r| value(r) * kernel.weight(r)).sum()
            };
            let used = nodes.iter().filter(|&&r| kernel.weight(r) != 0.0).count();
            assert!(used <= kernel.points(), "{kernel:?} at {place}: {used}");
            let assert = |found, expected, what: &str| {
                let what = format!("{what} of {kernel:?} at {place}");
                tolerance::LATTICE_KERNEL.assert(found, expected, 1.0, &what);
            };
            assert(sum(&|_| 1.0), 1.0, "sum");
            assert(sum(&|r| r), 0.0, "first moment");
            let squares = sum(&|r| kernel.weight(r));
            match kernel {
                Kernel::Two => {}
                Kernel::Three => assert(squares, 0.5, "squares"),
                Kernel::Four => {
                    assert(squares, 0.375, "squares");
                    let even: f64 = (nodes.iter().step_by(2)).map(|&r| kernel.weight(r)).sum();
                    assert(even, 0.5, "even nodes");
                }
            }
        }
    }
}

#[test]
fn spread_forces_add_up() {
    let size = [9, 7, 8];
    let points = scattered(40, size);
    let mut random = SplitMix64::new(3);
    let forces = Vec::from_iter(
        points
            .iter()
            .map(|_| [(); 3].map(|()| 1e-3 * random.symmetric())),
    );
    for kernel in KERNELS {
        let mut lattice = lattice::<f64>(periodic(size, 0.1));
        let mut immersed = Immersed::new(kernel);
        // Positions whole periods away are equivalent.
        let away = points.iter().map(|&[x, y, z]| [x - 9.0, y + 14.0, z]);
        immersed.place(&lattice, &Vec::from_iter(away)).unwrap();
        immersed.spread(&mut lattice, &forces).unwrap();
        lattice.advance(5);
        for axis in 0..3 {
            let total: f64 = forces.iter().map(|force| force[axis]).sum();
            // The momentum includes half of the force of the next step.
            let found = lattice.momentum()[axis];
            tolerance::LATTICE_ROUNDING.assert(found, 5.5 * total, 0.05 * 504.0, "momentum");
        }
        lattice.clear_forces();
        let before = lattice.momentum();
        lattice.advance(1);
        for (found, expected) in lattice.momentum().into_iter().zip(before) {
            tolerance::LATTICE_ROUNDING.assert(found, expected, 0.05 * 504.0, "without forces");
        }
    }
}

#[test]
fn forces_act_where_they_are_and_keep_their_torque() {
    for kernel in KERNELS {
        // Before a step, fluid at rest has the velocity F/2.
        let mut lattice = lattice::<f64>(periodic([9, 8, 10], 0.1));
        let point = [4.3, 3.9, 5.62];
        let force = [1e-3, -2e-3, 5e-4];
        let mut immersed = Immersed::new(kernel);
        immersed.place(&lattice, &[point]).unwrap();
        immersed.spread(&mut lattice, &[force]).unwrap();
        let mut first = [[0.0; 3]; 3];
        for cell in cells([9, 8, 10]) {
            let velocity = lattice.node(cell).velocity;
            for (axis, first) in first.iter_mut().enumerate() {
                let away = cell[axis] as f64 + 0.5 - point[axis];
                for (first, velocity) in first.iter_mut().zip(velocity) {
                    *first += away * 2.0 * velocity;
                }
            }
        }
        for moment in first.into_iter().flatten() {
            tolerance::LATTICE_KERNEL.assert(moment, 0.0, 1e-3, "first moment of the force");
        }
    }
}

#[test]
fn linear_flows_are_interpolated_exactly() {
    // Walls permit a linear flow. The points keep one or two nodes away from the wall at 0.
    let size = [10, 9, 11];
    let setup = Setup {
        sides: [Sides::RESTING; 3],
        ..periodic(size, 0.1)
    };
    let flow = |[x, y, z]: [f64; 3]| {
        [
            0.01 + 0.002 * x - 0.003 * y,
            0.004 * z - 0.02,
            0.001 * (x + y + z),
        ]
    };
    let points = Vec::from_iter(scattered(60, [7, 6, 8]).iter().map(|x| x.map(|x| x + 1.5)));
    // Reads before even and before odd steps.
    for inertia in [true, false] {
        let setup = Setup {
            inertia,
            ..setup.clone()
        };
        let mut lattice = lattice::<f64>(setup);
        // Filling accounts for half of the force, like reading.
        lattice.set_force([2e-3, -1e-3, 3e-3]).unwrap();
        for _ in 0..2 {
            lattice.fill(|cell| Node {
                density: 1.02,
                velocity: flow(cell.map(|k| k as f64 + 0.5)),
            });
            for kernel in KERNELS {
                let mut immersed = Immersed::new(kernel);
                let mut velocities = vec![[f64::NAN; 3]; points.len()];
                immersed.place(&lattice, &points).unwrap();
                immersed.interpolate(&mut lattice, &mut velocities);
                for (found, &point) in velocities.iter().zip(&points) {
                    for (&found, expected) in found.iter().zip(flow(point)) {
                        tolerance::LATTICE_KERNEL.assert(found, expected, 0.05, "velocity");
                    }
                }
            }
            lattice.advance(1);
        }
    }
}

/// One point alone reads the same velocity as many points, which share rows and leave parts of them out.
#[test]
fn points_do_not_know_of_each_other() {
    let size = [80, 6, 7];
    let mut lattice = lattice::<f64>(periodic(size, 0.1));
    lattice.fill(stirred(size));
    lattice.advance(1);
    let mut points = scattered(3, size);
    points.extend([[79.9, 3.0, 3.0], [0.1, 2.0, 6.9], [30.0, 4.0, 4.0]]);
    for kernel in KERNELS {
        let mut immersed = Immersed::new(kernel);
        let mut together = vec![[0.0; 3]; points.len()];
        immersed.place(&lattice, &points).unwrap();
        immersed.interpolate(&mut lattice, &mut together);
        for (point, expected) in points.iter().zip(together) {
            let mut alone = [[0.0; 3]];
            immersed.place(&lattice, &[*point]).unwrap();
            immersed.interpolate(&mut lattice, &mut alone);
            assert_eq!(alone, [expected], "{kernel:?} at {point:?}");
        }
    }
}

/// Velocities that a collision keeps are those that interpolation reads before the step.
#[test]
fn collisions_keep_velocities() {
    // Row lengths that do not fill vectors, and points around all their ends.
    let size = [11, 7, 9];
    let points = scattered(30, size);
    let forces = vec![[2e-4, -1e-4, 3e-4]; points.len()];
    fn compare<T: Precision>(
        setup: Setup,
        points: &[[f64; 3]],
        forces: &[[f64; 3]],
        allowed: &tolerance::Tolerance,
    ) {
        let mut lattice = lattice::<T>(setup.clone());
        lattice.fill(stirred(setup.cells));
        lattice.set_force([1e-4, 0.0, -2e-4]).unwrap();
        // Three steps: even, odd, even.
        for kernel in KERNELS {
            let mut immersed = Immersed::new(kernel);
            immersed.place(&lattice, points).unwrap();
            lattice.clear_forces();
            immersed.spread(&mut lattice, forces).unwrap();
            let mut read = vec![[0.0; 3]; points.len()];
            immersed.interpolate(&mut lattice, &mut read);
            let mut plain = lattice.clone();
            plain.advance(1);
            lattice.advance_keeping_velocities();
            assert!(lattice.state() == plain.state(), "the step is the same");
            let mut kept = vec![[f64::NAN; 3]; points.len()];
            immersed.interpolate_kept(&lattice, &mut kept);
            for (kept, read) in kept.iter().flatten().zip(read.iter().flatten()) {
                allowed.assert(*kept, *read, 0.05, &format!("velocity by {kernel:?}"));
            }
        }
    }
    for (inertia, threads) in [(true, 1), (true, 4), (false, 1)] {
        let setup = Setup {
            inertia,
            threads: NonZeroUsize::new(threads).unwrap(),
            ..periodic(size, 0.1)
        };
        compare::<f64>(setup.clone(), &points, &forces, &tolerance::LATTICE_KERNEL);
        compare::<f32>(setup, &points, &forces, &LATTICE_KEPT_SINGLE);
    }
}

#[test]
#[should_panic(expected = "velocities have not been kept at the points")]
fn velocities_that_were_not_kept_are_not_made_up() {
    let mut lattice = lattice::<f64>(periodic([8, 8, 8], 0.1));
    let mut immersed = Immersed::new(Kernel::Two);
    lattice.advance_keeping_velocities();
    immersed.place(&lattice, &[[4.0; 3]]).unwrap();
    immersed.interpolate_kept(&lattice, &mut [[0.0; 3]]);
}

/// Interpolation is the transpose of spreading: the work of forces on points is that on nodes.
#[test]
fn work_on_points_is_work_on_nodes() {
    let size = [9, 7, 8];
    let points = scattered(30, size);
    let mut random = SplitMix64::new(5);
    let forces = Vec::from_iter(
        points
            .iter()
            .map(|_| [(); 3].map(|()| 1e-3 * random.symmetric())),
    );
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for kernel in KERNELS {
        let mut lattice = lattice::<f64>(periodic(size, 0.1));
        lattice.fill(stirred(size));
        lattice.advance(1);
        let before = seen(&lattice);
        let mut immersed = Immersed::new(kernel);
        immersed.place(&lattice, &points).unwrap();
        let mut velocities = vec![[0.0; 3]; points.len()];
        immersed.interpolate(&mut lattice, &mut velocities);
        let at_points: f64 = velocities
            .iter()
            .zip(&forces)
            .map(|(&u, &f)| dot(u, f))
            .sum();
        immersed.spread(&mut lattice, &forces).unwrap();
        let at_nodes: f64 = (before.iter().zip(seen(&lattice)))
            .map(|(before, after)| {
                let force = [0, 1, 2].map(|axis| {
                    2.0 * after.density * (after.velocity[axis] - before.velocity[axis])
                });
                dot(before.velocity, force)
            })
            .sum();
        LATTICE_WORK.assert(at_nodes, at_points, 1e-3, "work");
    }
}

/// Immediate responses to forces equal the change of the velocities after spreading them, and are symmetric.
#[test]
fn responses_are_those_of_spread_forces() {
    let size = [40, 7, 8];
    let points = scattered(30, size);
    let mut random = SplitMix64::new(5);
    let mut forces = || {
        let rows = points.iter();
        Vec::from_iter(rows.map(|_| [(); 3].map(|()| 1e-2 * random.symmetric())))
    };
    let (first, second) = (forces(), forces());
    let work = |forces: &[[f64; 3]], velocities: &[[f64; 3]]| -> f64 {
        let pairs = forces.iter().flatten().zip(velocities.iter().flatten());
        pairs.map(|(force, velocity)| force * velocity).sum()
    };
    for (kernel, inertia) in KERNELS.into_iter().zip([true, false, true]) {
        let mut lattice = lattice::<f64>(Setup {
            inertia,
            ..periodic(size, 0.1)
        });
        lattice.fill(stirred(size));
        lattice.advance(1);
        let mut immersed = Immersed::new(kernel);
        immersed.place(&lattice, &points).unwrap();
        let [mut before, mut after, mut added, mut other] =
            [(); 4].map(|()| vec![[f64::NAN; 3]; points.len()]);
        immersed.interpolate(&mut lattice, &mut before);
        immersed.respond(&lattice, &first, &mut added);
        immersed.respond(&lattice, &second, &mut other);
        immersed.spread(&mut lattice, &first).unwrap();
        immersed.interpolate(&mut lattice, &mut after);
        for point in 0..points.len() {
            for axis in 0..3 {
                let expected = after[point][axis] - before[point][axis];
                let what = format!("{kernel:?}, point {point}, axis {axis}");
                tolerance::LATTICE_KERNEL.assert(added[point][axis], expected, 0.05, &what);
            }
        }
        let there = work(&second, &added);
        LATTICE_WORK.assert(work(&first, &other), there, there, "work");
        assert!(work(&first, &added) > 0.0);
    }
}

#[test]
#[should_panic(expected = "velocities are interpolated before forces are added")]
fn responses_of_nodes_that_were_not_read_are_not_made_up() {
    let mut lattice = lattice::<f64>(periodic([8, 8, 8], 0.1));
    let mut immersed = Immersed::new(Kernel::Two);
    immersed.place(&lattice, &[[4.0; 3]]).unwrap();
    immersed.interpolate(&mut lattice, &mut [[0.0; 3]]);
    immersed.place(&lattice, &[[5.0; 3]]).unwrap();
    immersed.respond(&lattice, &[[1.0; 3]], &mut [[0.0; 3]]);
}

#[test]
fn points_and_forces_do_not_depend_on_the_number_of_threads() {
    let run = |threads| {
        let mut lattice = everything::<f64>(threads);
        let mut points = Vec::from_iter(
            scattered(1500, [11, 4, 9])
                .iter()
                .map(|&[x, y, z]| [x, y.min(3.0) + 2.0, z]),
        );
        let mut immersed = Immersed::new(Kernel::Four);
        let mut velocities = vec![[0.0; 3]; points.len()];
        let mut read = velocities.clone();
        for _ in 0..5 {
            immersed.place(&lattice, &points).unwrap();
            lattice.clear_forces();
            let forces = Vec::from_iter(
                points
                    .iter()
                    .map(|&[x, y, z]| [3e-5 * y, 6e-6 * z, -3e-6 * x]),
            );
            immersed.spread(&mut lattice, &forces).unwrap();
            immersed.interpolate(&mut lattice, &mut read);
            lattice.advance_keeping_velocities();
            immersed.interpolate_kept(&lattice, &mut velocities);
            for (point, velocity) in points.iter_mut().zip(&velocities) {
                for (x, u) in point.iter_mut().zip(velocity) {
                    *x += u;
                }
            }
        }
        (lattice.state().clone(), points, read)
    };
    let alone = run(1);
    for threads in [2, 3, 20] {
        assert!(alone == run(threads), "{threads} threads");
    }
}

/// H. Hasimoto, J. Fluid Mech. 5 (1959) 317: in a cubic periodic box, the velocity at a force F is smaller by
/// 2.8373 F/(6πμL) than in open fluid. The velocity due to the images has the Laplacian 2F/(3μL³) there,
/// whose effect on a force that is spread by σ² along each axis is proportional to σ². The difference of two
/// boxes does not depend on the flow near the point.
#[test]
fn point_forces_feel_their_images() {
    let (viscosity, force, offset) = (0.5, 1e-4, 0.2);
    for kernel in KERNELS {
        let mobility = |edge: usize| {
            let mut lattice = lattice::<f64>(Setup {
                inertia: false,
                ..periodic([edge; 3], viscosity)
            });
            // A uniform force on all nodes balances that of the point.
            let volume = (edge * edge * edge) as f64;
            lattice.set_force([-force / volume, 0.0, 0.0]).unwrap();
            let mut immersed = Immersed::new(kernel);
            immersed.place(&lattice, &[[3.5 + offset; 3]]).unwrap();
            immersed.spread(&mut lattice, &[[force, 0.0, 0.0]]).unwrap();
            lattice.advance((edge * edge) as u64);
            let mut velocity = [[0.0; 3]];
            immersed.interpolate(&mut lattice, &mut velocity);
            velocity[0][0] / force
        };
        let spread: f64 = (-3..=3)
            .map(|node| f64::from(node) - offset)
            .map(|r| r * r * kernel.weight(r))
            .sum();
        let slower = |edge: f64| {
            let volume = edge * edge * edge;
            2.8373 / (6.0 * PI * viscosity * edge) - 2.0 * spread / (3.0 * viscosity * volume)
        };
        let expected = slower(14.0) - slower(28.0);
        let found = mobility(28) - mobility(14);
        LATTICE_IMAGES.assert(found, expected, expected, "difference");
    }
}
