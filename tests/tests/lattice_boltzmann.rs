//! The lattice Boltzmann method against exact flows and conservation laws.

use helfrich_std::flow::lattice_boltzmann::{Lattice, LatticeError, Node, Precision, Setup, Sides};
use helfrich_tests::meshes::{Mesh, icosphere};
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
    let mut lattice = lattice::<f64>(between(1, walls, periodic([2, 16, 1], 0.2)));
    let bytes = lattice.bytes();
    lattice.set_viscosities(|[_, y, _]| of_layer(y)).unwrap();
    assert_eq!(lattice.bytes(), bytes + 2 * 16 * size_of::<f64>());
    lattice.advance(20_000);
    let stress = 0.03 / (8.0 / viscosities[0] + 8.0 / viscosities[1]);
    let mut velocity = 0.0;
    for y in 0..16 {
        let step = 0.5 * stress / of_layer(y);
        velocity += step;
        let found = lattice.node([0, y, 0]).velocity[0];
        tolerance::LATTICE_STEADY.assert(found, velocity, 0.03, "u");
        velocity += step;
    }
    assert!(matches!(
        lattice.set_viscosities(|_| -1.0),
        Err(LatticeError::Viscosity { .. })
    ));
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
    for centre in [[9.3, 8.1, 7.7], [0.2, 16.8, -0.1]] {
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

/// Lines through vertices and along edges: a cube whose faces and diagonals lie on nodes, shared
/// out half-open.
#[test]
fn lines_through_edges_are_counted_once() {
    let lattice = lattice::<f64>(periodic([12; 3], 0.1));
    let corners = cells([2; 3]).map(|cell| cell.map(|end| 2.5 + 6.0 * end as f64));
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let cube = Mesh::new(corners.collect(), triangles);
    let inside = lattice.inside(&cube.connectivity, &cube.positions).unwrap();
    assert_eq!(inside.iter().filter(|&&inside| inside).count(), 6 * 6 * 6);
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
    let far = ball.map(|[x, y, z]| [x, y, z + 1e9]);
    assert!(obstacle(&far.positions).contains("along z"));
    let open = helfrich_tests::meshes::disc(2);
    let message = lattice
        .add_obstacle(&open.connectivity, &open.positions)
        .unwrap_err();
    assert!(message.to_string().contains("boundary edges"), "{message}");
}
