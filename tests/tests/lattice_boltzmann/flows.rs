//! Flows compared with exact solutions.

use crate::{between, cells, lattice, periodic, seen, stirred, turned, unit};
use helfrich_std::flow::lattice_boltzmann::{Lattice, LatticeError, Node, Setup, Sides};
use helfrich_tests::tolerance::{self, Tolerance};
use std::f64::consts::{PI, TAU};

/// Steady flows on a lattice between plates, for which wall conditions are exact, relative to the largest
/// velocity.
const LATTICE_STEADY: Tolerance = Tolerance::new(
    1e-12,
    "rounding over thousands of steps; the start has decayed to e⁻⁴⁰ or less",
);

/// Velocities of a decayed vortex with 48 nodes per wavelength, relative to the initial speed.
const LATTICE_VORTEX: Tolerance = Tolerance::new(
    2e-3,
    "second order in k = 2π/48, k² = 0.017, and in the Mach number, Ma² = 5e-4",
);

/// Velocities of the vortex in a stream that is four times as fast, relative to the initial speed.
const LATTICE_STREAM: Tolerance = Tolerance::new(
    4e-3,
    "the viscosity is short by 3 · 0.05² = 0.75 %, which changes the speed by 0.26 % after a half-life; \
     the other errors are those without a stream",
);

/// Reduction of the viscosity and speed of waves in streams, relative to 3u² and u.
const LATTICE_GALILEAN: Tolerance = Tolerance::new(5e-2, "k² = (2π/32)² = 0.04 of it");

/// Velocities in a duct 32 nodes wide, relative to that in the centre.
const LATTICE_DUCT: Tolerance = Tolerance::new(1e-3, "second order: 1/32²");

#[test]
fn flow_between_plates_is_the_exact_parabola() {
    // The flow is along each axis and across each, so that the walls of every direction are tested, at
    // several viscosities.
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
                LATTICE_STEADY.assert(found, expected, top, "u");
            }
            LATTICE_STEADY.assert(found.density, 1.0, 1.0, "density");
        }
        // Each wall carries half of the force on the fluid.
        let on_fluid = force * cells(lattice.cells()).count() as f64;
        for found in lattice.wall_forces(across) {
            LATTICE_STEADY.assert(found[axis], 0.5 * on_fluid, on_fluid, "force");
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
                LATTICE_STEADY.assert(found, expected, 0.05, "u");
            }
        }
        let [low, high] = lattice.wall_forces(across);
        let shear = 6.0 * viscosity * rate;
        LATTICE_STEADY.assert(low[axis], shear, shear, "force on the low wall");
        LATTICE_STEADY.assert(high[axis], -shear, shear, "force on the high wall");
    }
}

/// Plates that oscillate against each other drive the Stokes layers of unsteady flow, `u = Re U sinh(κy)/sinh(κh/2)
/// e^{iωt}` with `κ² = iω/ν` (H. Schlichting, Boundary-Layer Theory, section 5.3), to second order.
#[test]
fn oscillating_plates_drive_stokes_layers_to_second_order() {
    let (viscosity, speed) = (0.2, 0.02);
    let errors = [8, 16, 32].map(|width| {
        let width_squared = f64::from(width * width);
        // 2 cycles a time of diffusion, h²/ν: layers as thick as half of the gap.
        let omega = 8.0 * viscosity / width_squared * 2.0;
        let walls = |time: f64| {
            let speed = speed * (omega * time).cos();
            Sides::Walls {
                low: unit(0, -speed),
                high: unit(0, speed),
            }
        };
        let setup = periodic([2, width as usize, 1], viscosity);
        let mut lattice = lattice::<f64>(between(1, walls(0.0), setup.clone()));
        let steps = (5.0 * TAU / omega) as u64;
        for step in 0..steps {
            let sides = between(1, walls(step as f64 + 0.5), setup.clone()).sides;
            lattice.move_walls(sides).unwrap();
            lattice.advance(1);
        }
        let kappa = (omega / (2.0 * viscosity)).sqrt();
        // sinh((1 + i) z).
        let sinh = |z: f64| [z.sinh() * z.cos(), z.cosh() * z.sin()];
        let [c, d] = sinh(kappa * 0.5 * f64::from(width));
        let [cosine, sine] = [(omega * steps as f64).cos(), (omega * steps as f64).sin()];
        let error = |cell: [usize; 3]| {
            let [a, b] = sinh(kappa * (cell[1] as f64 + 0.5 - 0.5 * f64::from(width)));
            let over = (c * c + d * d).recip();
            let [re, im] = [(a * c + b * d) * over, (b * c - a * d) * over];
            let expected = speed * (re * cosine - im * sine);
            (lattice.node(cell).velocity[0] - expected).abs() / speed
        };
        cells(lattice.cells()).map(error).fold(0.0, f64::max)
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.6).contains(&order), "order {order} in {errors:?}");
    }
    let mut box_of_fluid = lattice::<f64>(periodic([2, 8, 1], viscosity));
    let sides = between(1, Sides::RESTING, periodic([2, 8, 1], viscosity)).sides;
    assert!(matches!(
        box_of_fluid.move_walls(sides),
        Err(LatticeError::OtherSides { axis: 1 })
    ));
}

/// Taylor–Green vortex in the plane across an axis, in a stream: velocity at a time.
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

    /// Largest error of the velocity, relative, after the vortex has lost half of its speed.
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
            // The Mach number decreases with the node spacing, at constant Reynolds number.
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
    LATTICE_VORTEX.assert(errors[2], 0.0, 1.0, "velocity");
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
    LATTICE_STREAM.assert(error, 0.0, 1.0, "velocity");
}

/// A shear wave in a stream along it: Galilean invariance is broken only by the third power of the velocity,
/// which reduces the viscosity by the fraction 3u² (Y. H. Qian, S. A. Orszag, Europhys. Lett. 21 (1993) 255).
/// Lower powers have no effect.
#[test]
fn streams_change_waves_by_the_mach_number_squared() {
    let (edge, viscosity) = (32, 0.1);
    let k = TAU / edge as f64;
    let decay = |stream: f64| {
        let mut lattice = lattice::<f64>(periodic([edge, 1, 1], viscosity));
        lattice.fill(|[x, _, _]| Node {
            density: 1.0,
            velocity: [stream, 1e-3 * (k * (x as f64 + 0.5)).cos(), 0.0],
        });
        // Amplitude and phase, after an initial transient: equilibrium populations lack the stress of the
        // wave.
        let wave = |lattice: &Lattice<f64>| {
            let mut sums = [0.0; 2];
            for x in 0..edge {
                let phase = k * (x as f64 + 0.5);
                let velocity = lattice.node([x, 0, 0]).velocity[1];
                sums[0] += velocity * phase.cos();
                sums[1] += velocity * phase.sin();
            }
            let [a, b] = sums;
            [a.hypot(b), b.atan2(a)]
        };
        lattice.advance(50);
        let before = wave(&lattice);
        lattice.advance(100);
        let after = wave(&lattice);
        let rate = (before[0] / after[0]).ln() / (100.0 * k * k);
        let speed = (after[1] - before[1]).rem_euclid(TAU) / (100.0 * k);
        [rate, speed]
    };
    let [still, rest] = decay(0.0);
    tolerance::LATTICE_ROUNDING.assert(rest, 0.0, 1.0, "speed without a stream");
    for stream in [0.05, 0.1] {
        let [rate, speed] = decay(stream);
        let short = 3.0 * stream * stream;
        LATTICE_GALILEAN.assert((still - rate) / still, short, short, "viscosity");
        LATTICE_GALILEAN.assert(speed, stream, stream, "speed of the wave");
    }
}

/// Without inertia a stream adds to the flow and does not carry it along.
#[test]
fn streams_without_inertia_are_added() {
    let size = [9, 6, 7];
    let stream = [0.05, -0.03, 0.02];
    let flow = |stream: [f64; 3]| {
        let mut lattice = lattice::<f64>(Setup {
            inertia: false,
            ..periodic(size, 0.1)
        });
        let stirred = stirred(size);
        lattice.fill(|cell| {
            let Node { density, velocity } = stirred(cell);
            Node {
                density,
                velocity: std::array::from_fn(|axis| velocity[axis] + stream[axis]),
            }
        });
        lattice.add_force([4, 5, 0], [2e-3, 1e-3, -5e-3]).unwrap();
        lattice.advance(9);
        seen(&lattice)
    };
    for (still, streaming) in flow([0.0; 3]).iter().zip(flow(stream)) {
        tolerance::LATTICE_KERNEL.assert(streaming.density, still.density, 1.0, "density");
        let sums = still
            .velocity
            .iter()
            .zip(stream)
            .map(|(u, stream)| u + stream);
        for (found, expected) in streaming.velocity.into_iter().zip(sums) {
            tolerance::LATTICE_KERNEL.assert(found, expected, 1.0, "velocity");
        }
    }
}

/// Velocity in a square duct in units of G w²/μ: the parabola between two of the sides, minus the series for
/// the other two (F. M. White, Viscous Fluid Flow, section 3-3).
fn duct(y: f64, z: f64) -> f64 {
    let series = (0..40).map(|term| {
        let k = f64::from(2 * term + 1) * PI;
        // cosh(k(z − ½))/cosh(k/2), without overflow.
        let cosh = ((k * (z - 1.0)).exp() + (-k * z).exp()) / (1.0 + (-k).exp());
        4.0 * (k * y).sin() * cosh / (k * k * k)
    });
    0.5 * y * (1.0 - y) - series.sum::<f64>()
}

#[test]
fn flow_in_a_duct_is_that_of_the_series_to_second_order() {
    let (viscosity, force) = (0.5, 1e-5);
    for axis in 0..3 {
        let errors = [8, 16, 32].map(|width| {
            let [across, other] = [(axis + 1) % 3, (axis + 2) % 3];
            let setup = periodic(turned([1, width, width], axis), viscosity);
            let setup = between(
                across,
                Sides::RESTING,
                between(other, Sides::RESTING, setup),
            );
            let mut lattice = lattice::<f64>(setup);
            lattice.set_force(unit(axis, force)).unwrap();
            let width = width as f64;
            lattice.advance((30.0 * width * width / (2.0 * PI * PI * viscosity)) as u64);
            let scale = force * width * width / viscosity;
            let error = |cell: [usize; 3]| {
                let [y, z] = [across, other].map(|axis| (cell[axis] as f64 + 0.5) / width);
                (lattice.node(cell).velocity[axis] / scale - duct(y, z)).abs()
            };
            cells(lattice.cells()).map(error).fold(0.0, f64::max) / duct(0.5, 0.5)
        });
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.8..2.4).contains(&order), "order {order} in {errors:?}");
        }
        LATTICE_DUCT.assert(errors[2], 0.0, 1.0, "velocity");
    }
}

/// In two layers of different fluids between moving plates, the stress is the same.
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
        LATTICE_STEADY.assert(found, velocity, 0.03, "u");
        velocity += step;
    }
    assert!(matches!(
        layers.set_viscosities(|_| -1.0),
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
