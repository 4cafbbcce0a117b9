//! Interpolation of the fluid between nodes.

use crate::{between, cells, everything, lattice, periodic, scattered, stirred, unit};
use helfrich_std::flow::lattice_boltzmann::{Node, Setup, Sides};
use helfrich_tests::meshes::{Mesh, SplitMix64};
use helfrich_tests::tolerance::{self, Tolerance};

/// Pressures of fluid at rest, relative to the rise from node to node.
const HYDROSTATIC: Tolerance = Tolerance::new(
    1e-9,
    "rounding of densities near 1, of which the rise is 3e-4; sound has decayed to e⁻⁹⁰",
);

/// A linear flow is interpolated exactly up to the walls, where it has their velocity.
#[test]
fn flow_between_plates_is_read_off_anywhere() {
    for (axis, inertia) in [(0, true), (1, false), (2, true)] {
        let along = (axis + 1) % 3;
        let speeds = [-0.02, 0.05];
        let walls = Sides::Walls {
            low: unit(along, speeds[0]),
            high: unit(along, speeds[1]),
        };
        let size = [8, 9, 7];
        let setup = Setup {
            inertia,
            ..between(axis, walls, periodic(size, 0.1))
        };
        let mut lattice = lattice::<f64>(setup);
        let width = size[axis] as f64;
        let velocity =
            |height: f64| unit(along, speeds[0] + (speeds[1] - speeds[0]) * height / width);
        for _ in 0..2 {
            lattice.fill(|cell| Node {
                density: 1.01,
                velocity: velocity(cell[axis] as f64 + 0.5),
            });
            let mut points = scattered(60, size);
            points.extend([0.0, 1e-9, 0.3, width - 0.2, width].map(|height| {
                let mut point = [3.3, 2.8, -41.0];
                point[axis] = height;
                point
            }));
            for point in points {
                let found = lattice.fluid_at(point).unwrap();
                tolerance::LATTICE_KERNEL.assert(found.density, 1.01, 1.0, "density");
                for (found, expected) in found.velocity.into_iter().zip(velocity(point[axis])) {
                    tolerance::LATTICE_KERNEL.assert(found, expected, 0.05, "velocity");
                }
            }
            lattice.advance(1);
        }
        for height in [-1e-9, width + 1e-9, f64::NAN, f64::INFINITY] {
            let mut point = [3.3, 2.8, 4.0];
            point[axis] = height;
            assert_eq!(lattice.fluid_at(point), None, "{height}");
        }
    }
}

/// Fluid at rest between walls under a force per volume g toward the higher wall: the pressure rises by g from
/// node to node, and its mean, of the initial density, is 0.
#[test]
fn fluid_at_rest_has_the_pressure_of_its_weight() {
    let (width, weight) = (8, 1e-4);
    for axis in 0..3 {
        let mut size = [2; 3];
        size[axis] = width;
        let mut lattice = lattice::<f64>(between(axis, Sides::RESTING, periodic(size, 0.3)));
        lattice.set_force(unit(axis, weight)).unwrap();
        // Sound decays as e^(−ν k² t) with k = π/8.
        lattice.advance(2000);
        for cell in cells(size) {
            let node = lattice.node(cell);
            let height = cell[axis] as f64 + 0.5 - 0.5 * width as f64;
            HYDROSTATIC.assert(node.pressure(), weight * height, weight, "pressure");
            HYDROSTATIC.assert(node.velocity[axis], 0.0, weight, "velocity");
        }
    }
}

#[test]
fn fluid_at_walls_has_their_velocity() {
    let size = [6, 5, 4];
    let velocities = [[0.01, 0.0, 0.03], [-0.02, 0.0, 0.01]];
    let [low, high] = velocities;
    let sliding = between(1, Sides::Walls { low, high }, periodic(size, 0.1));
    let mut lattice = lattice::<f64>(between(0, Sides::RESTING, sliding));
    lattice.fill(stirred(size));
    lattice.advance(3);
    let at = |point, expected: [f64; 3]| {
        let found = lattice.fluid_at(point).unwrap().velocity;
        for (found, expected) in found.into_iter().zip(expected) {
            tolerance::LATTICE_KERNEL.assert(found, expected, 0.05, "velocity at a wall");
        }
    };
    let mut random = SplitMix64::new(2);
    for _ in 0..50 {
        // Points away from edges, where the velocity changes from that of one wall to that of the other.
        let [x, y] = [3.0, 2.5].map(|middle| middle + (middle - 0.5) * random.symmetric());
        let z = 4.0 * random.symmetric();
        at([x, 0.0, z], low);
        at([x, 5.0, z], high);
        at([0.0, y, z], [0.0; 3]);
        at([6.0, y, z], [0.0; 3]);
    }
}

#[test]
fn fluid_at_nodes_is_that_of_nodes() {
    let mut lattice = everything::<f64>(1);
    for _ in 0..2 {
        for cell in cells(lattice.cells()) {
            let [x, y, z] = cell.map(|k| k as f64 + 0.5);
            // On periodic axes, a point whole periods away gives the same.
            for point in [[x, y, z], [x - 11.0, y, z + 18.0]] {
                let expected = (!lattice.is_solid(cell)).then(|| lattice.node(cell));
                assert_eq!(lattice.fluid_at(point), expected);
            }
        }
        lattice.advance(1);
    }
}

/// Cube whose faces lie half-way between nodes.
fn cube([low, high]: [f64; 2]) -> Mesh {
    let corner = |corner: usize| [0, 1, 2].map(|axis| [low, high][(corner >> axis) & 1]);
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let [a, b] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        let far = 1 << axis;
        triangles.extend([[0, b, a], [a, b, a + b]]);
        triangles.extend([[far, far + a, far + b], [far + a, far + a + b, far + b]]);
    }
    Mesh::new((0..8).map(corner).collect(), triangles)
}

#[test]
fn fluid_stops_at_obstacles() {
    let size = [12, 11, 13];
    let mut lattice = lattice::<f64>(periodic(size, 0.1));
    let cube = cube([3.0, 7.0]);
    (lattice.add_obstacle(&cube.connectivity, &cube.positions)).unwrap();
    lattice.fill(stirred(size));
    lattice.advance(5);
    let mut random = SplitMix64::new(1);
    for _ in 0..100 {
        let place = [(); 3].map(|()| 5.0 + 2.0 * random.symmetric());
        for axis in 0..3 {
            // Points away from the cube's edges, where fluid adjoins on two sides.
            let mut others = (0..3).filter(|&other| other != axis);
            let amid = others.all(|other| (3.5..6.5).contains(&place[other]));
            for (side, away) in [(3.0, -1.0), (7.0, 1.0)] {
                let at = |distance: f64| {
                    let mut point = place;
                    point[axis] = side + away * distance;
                    lattice.fluid_at(point)
                };
                assert_eq!(at(-1e-9), None);
                let [on, near, next] = [1e-14, 0.2, 0.5].map(|distance| at(distance).unwrap());
                for k in (0..3).filter(|_| amid) {
                    let assert = |found, expected, what| {
                        tolerance::LATTICE_KERNEL.assert(found, expected, 0.1, what);
                    };
                    assert(on.velocity[k], 0.0, "on the side");
                    assert(near.velocity[k], 0.4 * next.velocity[k], "next to it");
                    assert(on.density, next.density, "density");
                    assert!(next.velocity[k] != 0.0);
                }
            }
        }
    }
    assert_eq!(lattice.fluid_at([5.0; 3]), None);
}
