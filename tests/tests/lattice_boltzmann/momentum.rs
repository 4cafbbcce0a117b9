//! Conservation of momentum and mass, and their exchange with walls and obstacles.

use crate::{between, cells, lattice, periodic, scattered, sphere, stirred};
use helfrich_std::flow::lattice_boltzmann::{Immersed, Kernel, Node, Sides};
use helfrich_tests::meshes::SplitMix64;
use helfrich_tests::tolerance;

#[test]
fn momentum_grows_by_the_force_and_mass_stays() {
    let setup = periodic([13, 6, 5], 0.03);
    let mut lattice = lattice::<f64>(setup);
    lattice.fill(stirred([13, 6, 5]));
    lattice.set_force([1e-4, -2e-4, 3e-5]).unwrap();
    lattice.add_force([4, 5, 0], [2e-3, 1e-3, -5e-3]).unwrap();
    let (mass, before) = (lattice.mass(), lattice.momentum());
    let total = [
        390.0 * 1e-4 + 2e-3,
        390.0 * -2e-4 + 1e-3,
        390.0 * 3e-5 - 5e-3,
    ];
    let steps = 7;
    lattice.advance(steps);
    tolerance::LATTICE_ROUNDING.assert(lattice.mass(), mass, mass, "mass");
    for axis in 0..3 {
        let expected = before[axis] + steps as f64 * total[axis];
        let found = lattice.momentum()[axis];
        tolerance::LATTICE_ROUNDING.assert(found, expected, 0.05 * mass, "momentum");
    }
}

#[test]
fn walls_and_obstacles_take_the_momentum_that_is_lost() {
    let size = [14, 10, 11];
    let lid = Sides::Walls {
        low: [0.0; 3],
        high: [0.03, 0.0, 0.02],
    };
    let setup = between(1, lid, between(2, Sides::RESTING, periodic(size, 0.2)));
    let mut lattice = lattice::<f64>(setup);
    // One obstacle reaches through the periodic side, the other into the wall.
    for centre in [[13.2, 5.1, 6.0], [6.0, 1.0, 3.0]] {
        let ball = sphere(2.6, centre);
        lattice
            .add_obstacle(&ball.connectivity, &ball.positions)
            .unwrap();
    }
    let stirred = stirred(size);
    let solid = Vec::from_iter(cells(size).map(|cell| lattice.is_solid(cell)));
    let mut solid = solid.into_iter();
    lattice.fill(|cell| match solid.next() {
        Some(false) => stirred(cell),
        _ => Node::REST,
    });
    let nodes = cells(size).filter(|&cell| !lattice.is_solid(cell)).count();
    assert!(nodes < 14 * 10 * 11 - 100, "the obstacles are there");
    let force = [1e-4, 2e-4, -3e-4];
    lattice.set_force(force).unwrap();
    let mass = lattice.mass();
    // Points in the fluid between the obstacles, with other forces in each step.
    let points = scattered(40, [3, 4, 6]).into_iter();
    let points = points.map(|[x, y, z]| [8.0 + 0.5 * x, 4.5 + 0.5 * y, 2.0 + z]);
    let points = Vec::from_iter(points);
    let mut immersed = Immersed::new(Kernel::Three);
    immersed.place(&lattice, &points).unwrap();
    let mut random = SplitMix64::new(9);
    for _ in 0..9 {
        let mut random = || 1e-3 * (0.5 + random.symmetric());
        let forces = Vec::from_iter(points.iter().map(|_| [(); 3].map(|()| random())));
        lattice.clear_forces();
        immersed.spread(&mut lattice, &forces).unwrap();
        let momentum = lattice.momentum();
        lattice.advance(1);
        let after = lattice.momentum();
        for axis in 0..3 {
            let walls = [1, 2].map(|across| lattice.wall_forces(across));
            let walls: f64 = walls.iter().flatten().map(|force| force[axis]).sum();
            let obstacles = [0, 1].map(|number| lattice.obstacle_force(number)[axis]);
            let given = walls + obstacles[0] + obstacles[1];
            assert!(given.abs() > 1e-3, "there is something to balance: {given}");
            let immersed: f64 = forces.iter().map(|force| force[axis]).sum();
            assert!(immersed > 1e-3, "{immersed}");
            let expected = momentum[axis] + nodes as f64 * force[axis] + immersed - given;
            tolerance::LATTICE_ROUNDING.assert(after[axis], expected, 0.05 * mass, "momentum");
        }
    }
    tolerance::LATTICE_ROUNDING.assert(lattice.mass(), mass, mass, "mass");
}
