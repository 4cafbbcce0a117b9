//! The lattice Boltzmann method compared with exact flows and conservation laws.

mod bits;
mod drag;
mod flows;
mod immersed;
mod inside;
mod momentum;
mod ranks;
mod reading;
mod refused;
mod staggered;
mod viscous;

use helfrich_std::flow::lattice_boltzmann::{Lattice, Node, Precision, Setup, Sides};
use helfrich_tests::meshes::{Mesh, SplitMix64, icosphere};
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

fn periodic(cells: [usize; 3], viscosity: f64) -> Setup {
    Setup {
        cells,
        sides: [Sides::Periodic; 3],
        viscosity,
        inertia: true,
        threads: NonZeroUsize::MIN,
    }
}

/// Setup with walls along one axis.
fn between(axis: usize, walls: Sides, setup: Setup) -> Setup {
    let mut sides = setup.sides;
    sides[axis] = walls;
    Setup { sides, ..setup }
}

fn lattice<T: Precision>(setup: Setup) -> Lattice<T> {
    Lattice::new(setup).unwrap()
}

fn cells([length, rows, planes]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..planes).flat_map(move |z| (0..rows).flat_map(move |y| (0..length).map(move |x| [x, y, z])))
}

/// Cyclic permutation of the axes: the x component moves to `axis`.
fn turned([x, y, z]: [usize; 3], axis: usize) -> [usize; 3] {
    [[x, y, z], [z, x, y], [y, z, x]][axis]
}

fn unit(axis: usize, length: f64) -> [f64; 3] {
    std::array::from_fn(|k| if k == axis { length } else { 0.0 })
}

/// Smooth flow without symmetry, with speeds of about 0.05.
fn stirred(lengths: [usize; 3]) -> impl Fn([usize; 3]) -> Node {
    move |cell| {
        let [x, y, z] = [0, 1, 2].map(|k| TAU * (cell[k] as f64 + 0.5) / lengths[k] as f64);
        Node {
            density: 1.0 + 0.01 * (x + 2.0 * y).sin() * z.cos(),
            velocity: [
                0.03 + 0.02 * (y + z).sin(),
                0.04 * (x - z).cos(),
                -0.02 * (2.0 * x + y).sin(),
            ],
        }
    }
}

/// Densities and velocities at all nodes.
fn seen<T: Precision>(lattice: &Lattice<T>) -> Vec<Node> {
    cells(lattice.cells())
        .map(|cell| lattice.node(cell))
        .collect()
}

fn sphere(radius: f64, [x, y, z]: [f64; 3]) -> Mesh {
    icosphere(3).map(|p| [x + radius * p[0], y + radius * p[1], z + radius * p[2]])
}

/// A lattice with all features at once, whose sizes are no multiples of a vector width.
fn everything<T: Precision>(threads: usize) -> Lattice<T> {
    let size = [11, 7, 9];
    let setup = Setup {
        threads: NonZeroUsize::new(threads).unwrap(),
        ..between(1, Sides::RESTING, periodic(size, 0.1))
    };
    let mut lattice = lattice::<T>(setup);
    let ball = sphere(2.2, [3.0, 3.1, 8.0]);
    lattice
        .add_obstacle(&ball.connectivity, &ball.positions)
        .unwrap();
    lattice.fill(stirred(size));
    lattice.set_force([1e-4, 0.0, -1e-4]).unwrap();
    lattice.add_force([9, 3, 4], [0.0, 2e-3, 1e-3]).unwrap();
    lattice
        .set_viscosities(|[x, _, _]| if x < 6 { 0.1 } else { 0.5 })
        .unwrap();
    lattice
}

/// Points at random positions relative to nodes, on nodes and half-way between them.
fn scattered(count: usize, size: [usize; 3]) -> Vec<[f64; 3]> {
    let mut random = SplitMix64::new(7);
    let mut points =
        Vec::from_iter((0..count).map(|_| {
            std::array::from_fn(|axis| (0.5 + 0.5 * random.symmetric()) * size[axis] as f64)
        }));
    points.extend([
        [3.5, 4.5, 5.5],
        [4.0, 5.0, 3.0],
        [3.0, 3.5, 4.0],
        [0.0, 5.5, 6.999],
    ]);
    points
}
