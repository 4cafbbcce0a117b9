//! The lattice Boltzmann method against exact flows and conservation laws.

use helfrich_std::flow::lattice_boltzmann::{
    Immersed, Kernel, Lattice, LatticeError, Node, Precision, Setup, Sides, Units, mach, memory,
    reynolds,
};
use helfrich_tests::meshes::{Mesh, SplitMix64, icosphere};
use helfrich_tests::tolerance;
use std::f64::consts::{PI, TAU};
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

/// Walls along one axis.
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

/// The cell's axes in another order: what was along x is along `axis`.
fn turned([x, y, z]: [usize; 3], axis: usize) -> [usize; 3] {
    [[x, y, z], [z, x, y], [y, z, x]][axis]
}

fn unit(axis: usize, length: f64) -> [f64; 3] {
    std::array::from_fn(|k| if k == axis { length } else { 0.0 })
}

/// A smooth flow without symmetry, of a speed about 0.05.
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

/// All numbers of a lattice that anyone can see.
fn seen<T: Precision>(lattice: &Lattice<T>) -> Vec<Node> {
    cells(lattice.cells())
        .map(|cell| lattice.node(cell))
        .collect()
}

#[test]
fn flow_between_plates_is_the_exact_parabola() {
    // Along each axis and across each: every direction's walls are tried, at any viscosity.
    for (viscosity, axis, inertia) in [(0.1, 0, true), (1.0, 1, true), (0.4, 2, false)] {
        let across = (axis + 1) % 3;
        let (width, force) = (9, 1e-5);
        let setup = Setup {
            inertia,
            ..periodic(turned([3, width, 2], axis), viscosity)
        };
        let mut lattice = lattice::<f64>(between(across, Sides::RESTING, setup));
        lattice.set_force(unit(axis, force)).unwrap();
        lattice.advance((20.0 * (width * width) as f64 / viscosity) as u64 / 2);
        let width = width as f64;
        let top = force * width * width / (8.0 * viscosity);
        for cell in cells(lattice.cells()) {
            let height = cell[across] as f64 + 0.5;
            let expected = unit(axis, force / (2.0 * viscosity) * height * (width - height));
            let found = lattice.node(cell);
            for (found, expected) in found.velocity.into_iter().zip(expected) {
                tolerance::LATTICE_STEADY.assert(found, expected, top, "u");
            }
            tolerance::LATTICE_STEADY.assert(found.density, 1.0, 1.0, "density");
        }
        // Each wall carries half of the force on the fluid.
        let on_fluid = force * cells(lattice.cells()).count() as f64;
        for found in lattice.wall_forces(across) {
            tolerance::LATTICE_STEADY.assert(found[axis], 0.5 * on_fluid, on_fluid, "force");
        }
    }
}

#[test]
fn flow_between_moving_plates_is_exactly_linear() {
    for (viscosity, axis) in [(0.05, 0), (0.7, 1), (0.2, 2)] {
        let across = (axis + 2) % 3;
        let speeds = [-0.02, 0.05];
        let walls = Sides::Walls {
            low: unit(axis, speeds[0]),
            high: unit(axis, speeds[1]),
        };
        let setup = periodic(turned([2, 3, 8], axis), viscosity);
        let mut lattice = lattice::<f64>(between(across, walls, setup));
        lattice.advance((10.0 * 64.0 / viscosity) as u64);
        let rate = (speeds[1] - speeds[0]) / 8.0;
        for cell in cells(lattice.cells()) {
            let expected = unit(axis, speeds[0] + rate * (cell[across] as f64 + 0.5));
            for (found, expected) in lattice.node(cell).velocity.into_iter().zip(expected) {
                tolerance::LATTICE_STEADY.assert(found, expected, 0.05, "u");
            }
        }
        let [low, high] = lattice.wall_forces(across);
        let shear = 6.0 * viscosity * rate;
        tolerance::LATTICE_STEADY.assert(low[axis], shear, shear, "force on the low wall");
        tolerance::LATTICE_STEADY.assert(high[axis], -shear, shear, "force on the high wall");
    }
}

/// A vortex of Taylor and Green in the plane across an axis, in a stream: the velocity at a time.
struct Vortex {
    edge: usize,
    speed: f64,
    stream: [f64; 2],
    viscosity: f64,
}

impl Vortex {
    fn node(&self, cell: [usize; 3], time: f64) -> Node {
        let k = TAU / self.edge as f64;
        let phase = |axis: usize| k * (cell[axis] as f64 + 0.5 - self.stream[axis] * time);
        let (x, y) = (phase(0), phase(1));
        let speed = self.speed * (-2.0 * self.viscosity * k * k * time).exp();
        let [u, v] = self.stream;
        Node {
            density: 1.0 - 0.75 * speed * speed * ((2.0 * x).cos() + (2.0 * y).cos()),
            velocity: [
                u - speed * x.cos() * y.sin(),
                v + speed * x.sin() * y.cos(),
                0.0,
            ],
        }
    }

    /// The largest error of the velocity, relative, after the vortex has lost half of its speed.
    fn error(&self) -> f64 {
        let mut lattice = lattice::<f64>(periodic([self.edge, self.edge, 1], self.viscosity));
        lattice.fill(|cell| self.node(cell, 0.0));
        let k = TAU / self.edge as f64;
        let steps = (2.0_f64.ln() / (2.0 * self.viscosity * k * k)).round();
        lattice.advance(steps as u64);
        let mut largest: f64 = 0.0;
        for cell in cells(lattice.cells()) {
            let (found, expected) = (lattice.node(cell), self.node(cell, steps));
            for axis in 0..3 {
                largest = largest.max((found.velocity[axis] - expected.velocity[axis]).abs());
            }
        }
        largest / self.speed
    }
}

#[test]
fn vortices_decay_at_second_order() {
    let errors = [12, 24, 48].map(|edge| {
        Vortex {
            edge,
            // The Mach number falls with the distance of nodes, the Reynolds number stays.
            speed: 0.6 / edge as f64,
            stream: [0.0; 2],
            viscosity: 0.1,
        }
        .error()
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.4).contains(&order), "order {order} in {errors:?}");
    }
    tolerance::LATTICE_VORTEX.assert(errors[2], 0.0, 1.0, "velocity");
}

#[test]
fn vortices_decay_alike_in_a_stream() {
    let error = Vortex {
        edge: 48,
        speed: 0.6 / 48.0,
        stream: [0.04, -0.03],
        viscosity: 0.1,
    }
    .error();
    tolerance::LATTICE_STREAM.assert(error, 0.0, 1.0, "velocity");
}

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

fn sphere(radius: f64, [x, y, z]: [f64; 3]) -> Mesh {
    icosphere(3).map(|p| [x + radius * p[0], y + radius * p[1], z + radius * p[2]])
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
    // One reaches through the periodic side, the other into the wall.
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
    let (mass, mut momentum) = (lattice.mass(), lattice.momentum());
    for _ in 0..9 {
        lattice.advance(1);
        let after = lattice.momentum();
        for axis in 0..3 {
            let walls = [1, 2].map(|across| lattice.wall_forces(across));
            let walls: f64 = walls.iter().flatten().map(|force| force[axis]).sum();
            let obstacles = [0, 1].map(|number| lattice.obstacle_force(number)[axis]);
            let given = walls + obstacles[0] + obstacles[1];
            assert!(given.abs() > 1e-3, "there is something to balance: {given}");
            let expected = momentum[axis] + nodes as f64 * force[axis] - given;
            tolerance::LATTICE_ROUNDING.assert(after[axis], expected, 0.05 * mass, "momentum");
        }
        momentum = after;
    }
    tolerance::LATTICE_ROUNDING.assert(lattice.mass(), mass, mass, "mass");
}

/// H. Hasimoto, J. Fluid Mech. 5 (1959) 317: a cubic array of spheres that hold a stream back.
#[test]
fn arrays_of_spheres_have_the_drag_of_hasimoto() {
    let (edge, viscosity) = (28, 0.3);
    let mut lattice = lattice::<f64>(Setup {
        inertia: false,
        ..periodic([edge; 3], viscosity)
    });
    let ball = sphere(6.0, [14.0; 3]);
    let number = lattice
        .add_obstacle(&ball.connectivity, &ball.positions)
        .unwrap();
    let solid = cells([edge; 3])
        .filter(|&cell| lattice.is_solid(cell))
        .count() as f64;
    let radius = (0.75 * solid / PI).cbrt();
    let force = 1e-6;
    lattice.set_force([force, 0.0, 0.0]).unwrap();
    lattice.advance(3000);
    let volume = (edge * edge * edge) as f64;
    let stream = lattice.momentum()[0] / volume;
    // A gradient of pressure also pushes the sphere itself, with its own volume.
    let drag = lattice.obstacle_force(number)[0];
    tolerance::LATTICE_DRAG_BALANCE.assert(drag, force * (volume - solid), drag, "balance");
    let drag = drag + force * solid;
    let fraction = solid / volume;
    let slower = 1.0 - 1.7601 * fraction.cbrt() + fraction - 1.5593 * fraction * fraction;
    let expected = 6.0 * PI * viscosity * radius * stream / slower;
    tolerance::LATTICE_DRAG.assert(drag, expected, expected, "drag");
}

/// Everything at once, in a lattice whose sizes no width of vectors divides.
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
        tolerance::LATTICE_SINGLE.assert(found.density, expected.density, 0.01, "density");
        for axis in 0..3 {
            let (found, expected) = (found.velocity[axis], expected.velocity[axis]);
            tolerance::LATTICE_SINGLE.assert(found, expected, 0.05, "velocity");
        }
    }
}

/// The same flow somewhere else is the same flow, to the last bit: rows, ends of vectors and both
/// kinds of step treat every node alike.
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

/// Two layers of fluids between moving plates: the stress is the same in both.
#[test]
fn viscosities_may_differ_from_node_to_node() {
    let walls = Sides::Walls {
        low: [0.0; 3],
        high: [0.03, 0.0, 0.0],
    };
    let viscosities = [0.1, 0.3];
    let of_layer = |y: usize| viscosities[usize::from(y >= 8)];
    let mut layers = lattice::<f64>(between(1, walls, periodic([2, 16, 1], 0.2)));
    let bytes = layers.bytes();
    layers.set_viscosities(|[_, y, _]| of_layer(y)).unwrap();
    assert_eq!(layers.bytes(), bytes + 2 * 16 * size_of::<f64>());
    layers.advance(20_000);
    let stress = 0.03 / (8.0 / viscosities[0] + 8.0 / viscosities[1]);
    let mut velocity = 0.0;
    for y in 0..16 {
        let step = 0.5 * stress / of_layer(y);
        velocity += step;
        let found = layers.node([0, y, 0]).velocity[0];
        tolerance::LATTICE_STEADY.assert(found, velocity, 0.03, "u");
        velocity += step;
    }
    assert!(matches!(
        layers.set_viscosities(|_| -1.0),
        Err(LatticeError::Viscosity { .. })
    ));

    // The same from an indicator.
    let setup = periodic([2, 16, 1], viscosities[0]);
    let mut other = lattice::<f64>(between(1, walls, setup));
    let inside = Vec::from_iter(cells([2, 16, 1]).map(|[_, y, _]| y >= 8));
    assert!(other.set_inner_viscosity(&inside, 0.0).is_err());
    other.set_inner_viscosity(&inside, viscosities[1]).unwrap();
    other.restore(layers.state().clone()).unwrap();
    other.advance(1);
    layers.advance(1);
    assert!(other.state() == layers.state());
}

#[test]
fn without_inertia_velocities_add_up() {
    let size = [9, 6, 7];
    let setup = Setup {
        inertia: false,
        ..periodic(size, 0.1)
    };
    let velocity = |factor: f64| {
        let mut lattice = lattice::<f64>(setup.clone());
        let flow = stirred(size);
        lattice.fill(|cell| {
            let Node { density, velocity } = flow(cell);
            Node {
                density: 1.0 + factor * (density - 1.0),
                velocity: velocity.map(|u| factor * u),
            }
        });
        lattice.set_force([factor * 1e-3, 0.0, 0.0]).unwrap();
        lattice.advance(9);
        seen(&lattice)
    };
    for (once, tenfold) in velocity(1.0).iter().zip(velocity(10.0)) {
        for axis in 0..3 {
            let (once, tenfold) = (once.velocity[axis], tenfold.velocity[axis]);
            tolerance::LATTICE_ROUNDING.assert(tenfold, 10.0 * once, 0.5, "velocity");
        }
    }
}

/// Whether nodes are inside, by their distance from the centre.
#[test]
fn nodes_are_inside_of_meshes_or_not() {
    let lattice = lattice::<f32>(periodic([20, 17, 15], 0.1));
    // In the middle, through all sides, and periods away.
    for centre in [[9.3, 8.1, 7.7], [0.2, 16.8, -0.1], [-991.0, 34.5, 1510.4]] {
        let ball = sphere(4.9, centre);
        let inside = lattice.inside(&ball.connectivity, &ball.positions).unwrap();
        for (number, [x, y, z]) in cells([20, 17, 15]).enumerate() {
            let away = |at: usize, centre: f64, count: f64| {
                let distance = (at as f64 + 0.5 - centre).rem_euclid(count);
                distance.min(count - distance)
            };
            let away = [
                away(x, centre[0], 20.0),
                away(y, centre[1], 17.0),
                away(z, centre[2], 15.0),
            ];
            let distance = away.iter().map(|d| d * d).sum::<f64>().sqrt();
            // The mesh lies between the sphere and its triangles' middles.
            if !(4.8..=4.9).contains(&distance) {
                assert_eq!(inside[number], distance < 4.85, "at {distance}");
            }
        }
    }
}

/// Lines through vertices and along edges: of six tetrahedra that fill a cube, all with corners on
/// nodes, one has each node, and together they have as many as the volume says.
#[test]
fn lines_through_edges_are_counted_once() {
    let lattice = lattice::<f64>(periodic([12; 3], 0.1));
    let mut owners = vec![0; 12 * 12 * 12];
    for path in [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ] {
        // Along three edges of the cube from one corner to the opposite one.
        let mut corner = [2.5; 3];
        let mut corners = vec![corner];
        for axis in path {
            corner[axis] += 6.0;
            corners.push(corner);
        }
        let faces = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        let part = Mesh::new(corners, faces);
        let inside = lattice.inside(&part.connectivity, &part.positions).unwrap();
        for (owners, inside) in owners.iter_mut().zip(inside) {
            *owners += usize::from(inside);
        }
    }
    assert!(owners.iter().all(|&owners| owners <= 1));
    assert_eq!(owners.iter().sum::<usize>(), 6 * 6 * 6);
}

#[test]
fn impossible_lattices_are_refused() {
    let good = periodic([4, 4, 4], 0.1);
    let refused = |setup: Setup| Lattice::<f64>::new(setup).unwrap_err().to_string();
    let with_cells = |cells| Setup {
        cells,
        ..good.clone()
    };
    assert!(refused(with_cells([4, 0, 4])).contains("0 nodes along y"));
    assert!(refused(with_cells([usize::MAX; 3])).contains("larger than any memory"));
    assert!(refused(with_cells([usize::MAX / 2, 1, 1])).contains("larger than any memory"));
    assert!(refused(with_cells([1 << 18, 1 << 18, 64])).contains("bytes of memory"));
    for viscosity in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let message = refused(Setup {
            viscosity,
            ..good.clone()
        });
        assert!(message.contains("above 0"), "{message}");
    }
    for velocity in [[0.0, 0.1, 0.0], [0.6, 0.0, 0.0], [f64::NAN, 0.0, 0.0]] {
        let walls = Sides::Walls {
            low: [0.0; 3],
            high: velocity,
        };
        let message = refused(between(1, walls, good.clone()));
        assert!(message.contains("the high wall along y"), "{message}");
    }
    let mut lattice = lattice::<f64>(good.clone());
    assert!(lattice.set_force([0.0, f64::NAN, 0.0]).is_err());
    assert!(
        lattice
            .add_force([0; 3], [f64::INFINITY, 0.0, 0.0])
            .is_err()
    );
    let other = Lattice::new(with_cells([4, 4, 5])).unwrap();
    let message = lattice
        .restore(other.state().clone())
        .unwrap_err()
        .to_string();
    assert!(message.contains("4 × 4 × 5"), "{message}");

    let ball = sphere(1.0, [2.0; 3]);
    let mut obstacle = |positions: &[[f64; 3]]| {
        let refused = lattice.add_obstacle(&ball.connectivity, positions);
        refused.unwrap_err().to_string()
    };
    assert!(obstacle(&ball.positions[1..]).contains("positions"));
    let small = ball.map(|x| x.map(|x| 2.0 + 0.1 * (x - 2.0)));
    assert!(obstacle(&small.positions).contains("no node"));
    let large = ball.map(|[x, y, z]| [x, y, 100.0 * z]);
    assert!(obstacle(&large.positions).contains("along z"));
    let open = helfrich_tests::meshes::disc(2);
    let message = lattice
        .add_obstacle(&open.connectivity, &open.positions)
        .unwrap_err();
    assert!(message.to_string().contains("boundary edges"), "{message}");
}

/// Places of points with every position relative to nodes, on nodes and half-way among them.
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
        // Periods away is the same place.
        let away = points.iter().map(|&[x, y, z]| [x - 9.0, y + 14.0, z]);
        immersed.place(&lattice, &Vec::from_iter(away)).unwrap();
        immersed.spread(&mut lattice, &forces).unwrap();
        lattice.advance(5);
        for axis in 0..3 {
            let total: f64 = forces.iter().map(|force| force[axis]).sum();
            // Half of the force of the next step counts as there.
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
        // Without a step, fluid at rest has the velocity F/2.
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
    // Between walls, so that the flow may be linear: the wall at 0 is 1 or 2 nodes away.
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
    // Before even steps and before odd ones.
    for inertia in [true, false] {
        let setup = Setup {
            inertia,
            ..setup.clone()
        };
        let mut lattice = lattice::<f64>(setup);
        // Filling takes half of the force into account, as reading does.
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
                immersed.interpolate(&lattice, &mut velocities);
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

/// What is interpolated is the transpose of what is spread: forces do the work that the fluid gets.
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
        immersed.interpolate(&lattice, &mut velocities);
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
        tolerance::LATTICE_WORK.assert(at_nodes, at_points, 1e-3, "work");
    }
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
        for _ in 0..5 {
            immersed.place(&lattice, &points).unwrap();
            lattice.clear_forces();
            let forces = Vec::from_iter(
                points
                    .iter()
                    .map(|&[x, y, z]| [3e-5 * y, 6e-6 * z, -3e-6 * x]),
            );
            immersed.spread(&mut lattice, &forces).unwrap();
            immersed.interpolate(&lattice, &mut velocities);
            lattice.advance(1);
            for (point, velocity) in points.iter_mut().zip(&velocities) {
                for (x, u) in point.iter_mut().zip(velocity) {
                    *x += u;
                }
            }
        }
        (lattice.state().clone(), points)
    };
    let alone = run(1);
    for threads in [2, 3, 20] {
        assert!(alone == run(threads), "{threads} threads");
    }
}

/// H. Hasimoto, as above: in a cubic box a force F moves by 2.8373 F/(6πμL) less than in open fluid.
/// The velocity by the images has the Laplacian 2F/(3μL³) there, of which a force that is spread by
/// σ² along each axis sees σ². The difference of two boxes does not know the fluid near the point.
#[test]
fn point_forces_feel_their_images() {
    let (viscosity, force, offset) = (0.5, 1e-4, 0.2);
    for kernel in KERNELS {
        let mobility = |edge: usize| {
            let mut lattice = lattice::<f64>(Setup {
                inertia: false,
                ..periodic([edge; 3], viscosity)
            });
            // What the point gives to the fluid, all of it takes away.
            let volume = (edge * edge * edge) as f64;
            lattice.set_force([-force / volume, 0.0, 0.0]).unwrap();
            let mut immersed = Immersed::new(kernel);
            immersed.place(&lattice, &[[3.5 + offset; 3]]).unwrap();
            immersed.spread(&mut lattice, &[[force, 0.0, 0.0]]).unwrap();
            lattice.advance((edge * edge) as u64);
            let mut velocity = [[0.0; 3]];
            immersed.interpolate(&lattice, &mut velocity);
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
        tolerance::LATTICE_IMAGES.assert(found, expected, expected, "difference");
    }
}

#[test]
fn impossible_points_are_refused() {
    let setup = between(1, Sides::RESTING, periodic([8; 3], 0.1));
    let mut lattice = lattice::<f64>(setup);
    for (kernel, distance) in [
        (Kernel::Two, 0.5),
        (Kernel::Three, 1.0),
        (Kernel::Four, 1.5),
    ] {
        let mut immersed = Immersed::new(kernel);
        let [inside, outside] = [distance + 1e-9, distance - 1e-9];
        for y in [inside, 8.0 - inside] {
            assert!(
                immersed.place(&lattice, &[[1.0, y, 1.0]]).is_ok(),
                "{kernel:?} at {y}"
            );
        }
        for y in [outside, 8.0 - outside, -3.0, 1e300] {
            let message = immersed.place(&lattice, &[[1.0, 4.0, 1.0], [1.0, y, 1.0]]);
            let message = message.unwrap_err().to_string();
            assert!(
                message.contains("point 1") && message.contains("walls"),
                "{message}"
            );
            assert_eq!(immersed.count(), 0);
        }
        let message = immersed
            .place(&lattice, &[[1.0, 4.0, f64::NAN]])
            .unwrap_err();
        assert!(
            message.to_string().contains("coordinate z of point 0"),
            "{message}"
        );
        immersed.place(&lattice, &[[1.0, 4.0, -1e17]]).unwrap();
        assert!(
            immersed
                .spread(&mut lattice, &[[0.0, f64::NAN, 0.0]])
                .is_err()
        );
    }
    assert_eq!(lattice.momentum(), [0.0; 3]);
}

/// A drop of water in a channel: 1 µm, 1000 kg/m³ and 1e-6 m²/s.
#[test]
fn units_convert_both_ways() {
    let units = Units::with_viscosity(1e-6, 1e3, 1e-6, 0.1).unwrap();
    let assert = |found: f64, expected: f64| {
        tolerance::LATTICE_ROUNDING.assert(found, expected, expected, "unit");
    };
    assert(units.step, 1e-7);
    assert(units.velocity(), 10.0);
    assert(units.rate(), 1e7);
    assert(units.kinematic_viscosity() * 0.1, 1e-6);
    assert(units.dynamic_viscosity() * 0.1, 1e-3);
    assert(units.pressure(), 1e5);
    assert(units.tension(), 0.1);
    assert(units.force(), 1e-7);
    assert(units.energy(), 1e-13);
    assert(units.force_density(), 1e11);
    assert(mach(3.0_f64.sqrt().recip()), 1.0);
    assert(reynolds(0.02, 30.0, 0.1), 6.0);
    let bytes = memory::<f32>([100; 3]).unwrap();
    assert!((76_000_000..78_000_000).contains(&bytes), "{bytes}");
    assert_eq!(bytes, lattice::<f32>(periodic([100; 3], 0.1)).bytes());
    assert!(memory::<f64>([1, 0, 1]).is_err());
    for [spacing, density] in [[0.0, 1.0], [1.0, f64::NAN], [1e-200, 1.0]] {
        assert!(Units::with_viscosity(spacing, density, 1.0, 0.1).is_err());
    }
}
