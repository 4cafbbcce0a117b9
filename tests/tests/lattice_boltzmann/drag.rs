//! Drag of spheres in Stokes flow.
//!
//! H. Hasimoto, J. Fluid Mech. 5 (1959) 317: a sphere in a cubic box of edge L with periodic sides,
//! held in a stream of mean velocity U, feels a force F with
//! `6πμ a U/F = 1 − 1.7601 c^(1/3) + c − 1.5593 c²`, c the fraction of the volume that is sphere.

use crate::{cells, lattice, periodic, sphere};
use helfrich_std::flow::lattice_boltzmann::{Immersed, Kernel, Lattice, Node, Setup};
use helfrich_tests::meshes::icosphere;
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::{PI, TAU};

/// Force on an obstacle in steady flow against that some time before, relative.
const LATTICE_DRAG_BALANCE: Tolerance = Tolerance::new(
    1e-4,
    "e⁻¹³ is left of the longest wave by then; boxes with obstacles have somewhat slower ones",
);

/// Drag of a sphere of six nodes' radius, relative.
const LATTICE_DRAG: Tolerance = Tolerance::new(
    2e-2,
    "its surface is made of steps: the radius is uncertain by a tenth of the distance of nodes",
);

/// Loss of a sphere's mobility by periodic sides, from three boxes.
const LATTICE_BOX: Tolerance = Tolerance::new(
    2e-2,
    "the next term, of sixth order, is 27 (4/24)⁶ = 6e-4 of the mobility",
);

/// Drag of a sphere of points, by its radius, relative.
const LATTICE_SMEARED: Tolerance = Tolerance::new(
    1.5e-2,
    "kernels are no Gaussians: a tenth of what they add to the radius, which is 0.5 of 4 for the \
     widest",
);

const VISCOSITY: f64 = 0.6;

/// Stokes flow in a cubic box.
fn cubic(edge: usize) -> Lattice<f64> {
    lattice(Setup {
        inertia: false,
        ..periodic([edge; 3], VISCOSITY)
    })
}

/// The longest wave decays by νk² a step: 15 of its lives.
fn settling_steps(edge: usize) -> u64 {
    let wave = TAU / edge as f64;
    (15.0 / (VISCOSITY * wave * wave)) as u64
}

/// Advances fluid of which a body takes `drag` in each step, with the force on all nodes that gives
/// it back: the stream stays, and what else is left of the start decays as fast as waves do. Returns
/// velocity, averaged over the box, and the force on the body with that of the pressure gradient on
/// its `solid` nodes.
fn streaming(
    mut lattice: Lattice<f64>,
    solid: f64,
    mut drag: impl FnMut(&mut Lattice<f64>) -> f64,
) -> [f64; 2] {
    let edge = lattice.cells()[0];
    let volume = (edge * edge * edge) as f64;
    let first = Node {
        density: 1.0,
        velocity: [1e-3, 0.0, 0.0],
    };
    lattice.fill(|_| first);
    let steps = settling_steps(edge);
    let (mut taken, mut earlier) = (0.0, 0.0);
    for step in 0..steps {
        taken = drag(&mut lattice);
        if step == steps * 9 / 10 {
            earlier = taken;
        }
        let force = taken / (volume - solid);
        lattice.set_force([force, 0.0, 0.0]).unwrap();
    }
    LATTICE_DRAG_BALANCE.assert(taken, earlier, taken, "steady drag");
    let velocity = lattice.momentum()[0] / volume;
    [velocity, taken * volume / (volume - solid)]
}

/// The same for an obstacle in the middle, with its number of nodes.
fn past_obstacle(edge: usize, radius: f64) -> ([f64; 2], f64) {
    let mut lattice = cubic(edge);
    let ball = sphere(radius, [0.5 * edge as f64; 3]);
    let number = lattice
        .add_obstacle(&ball.connectivity, &ball.positions)
        .unwrap();
    let solid = cells([edge; 3])
        .filter(|&cell| lattice.is_solid(cell))
        .count() as f64;
    let found = streaming(lattice, solid, |lattice| {
        lattice.advance(1);
        lattice.obstacle_force(number)[0]
    });
    (found, solid)
}

/// The radius of the sphere that has this drag in a box.
fn hydrodynamic_radius(edge: usize, [velocity, force]: [f64; 2]) -> f64 {
    let (mut low, mut high) = (0.0, 0.5 * edge as f64);
    while high - low > 1e-6 {
        let radius = 0.5 * (low + high);
        let c = 4.0 / 3.0 * PI * (radius / edge as f64).powi(3);
        let slower = 1.0 - 1.7601 * c.cbrt() + c - 1.5593 * c * c;
        if 6.0 * PI * VISCOSITY * radius * velocity < slower * force {
            low = radius;
        } else {
            high = radius;
        }
    }
    low
}

/// In three boxes, without use of what is known of boxes: U/F = 1/(6πμa) − s/L + q/L³.
#[test]
fn spheres_have_the_drag_of_stokes_in_open_fluid() {
    let radius = 4.0;
    let edges = [24.0, 32.0, 44.0];
    let mut volume = 0.0;
    let mobilities = edges.map(|edge| {
        let ([velocity, force], solid) = past_obstacle(edge as usize, radius);
        volume = solid;
        6.0 * PI * VISCOSITY * velocity / force
    });
    // Newton's divided differences, with 1/L³ beside 1/L.
    let [a, b, c] = edges.map(|edge| 1.0 / edge);
    let [ab, bc] = [
        (mobilities[0] - mobilities[1]) / (a - b),
        (mobilities[1] - mobilities[2]) / (b - c),
    ];
    let cubic = (ab - bc) / ((a * a + a * b + b * b) - (b * b + b * c + c * c));
    let slope = ab - cubic * (a * a + a * b + b * b);
    let open = mobilities[0] - slope * a - cubic * a * a * a;
    LATTICE_BOX.assert(slope, -2.8373, 2.8373, "what a box takes");
    let radius = (0.75 * volume / PI).cbrt();
    LATTICE_DRAG.assert(1.0 / open, radius, radius, "6πμa by drag");
}

/// The velocity at points on a sphere that push the fluid in it and around with the same force each,
/// and the sum of these, which all nodes take back.
fn pushed_by_points(edge: usize, radius: f64, kernel: Kernel) -> [f64; 2] {
    let mut lattice = cubic(edge);
    let ball = icosphere(3).map(|x| x.map(|x| 0.5 * edge as f64 + 0.3 + radius * x));
    let count = ball.positions.len();
    let force = 1e-3;
    let mut immersed = Immersed::new(kernel);
    immersed.place(&lattice, &ball.positions).unwrap();
    let share = [force / count as f64, 0.0, 0.0];
    immersed.spread(&mut lattice, &vec![share; count]).unwrap();
    let back = -force / (edge * edge * edge) as f64;
    lattice.set_force([back, 0.0, 0.0]).unwrap();
    lattice.advance(settling_steps(edge));
    let mut velocities = vec![[0.0; 3]; count];
    immersed.interpolate(&lattice, &mut velocities);
    let sum: f64 = velocities.iter().map(|velocity| velocity[0]).sum();
    [sum / count as f64, force]
}

/// A shell of forces at r moves one at r' with `F/(6πμ max(r, r'))`. A kernel that spreads points
/// by σ² along each axis, once to the fluid and once from it, makes of the mean of max(r, r')
/// `a + σ/√π + σ²/a`, as far as it is like a Gaussian.
#[test]
fn spheres_of_points_have_the_drag_of_stokes() {
    let (edge, radius) = (22, 4.0);
    for kernel in [Kernel::Two, Kernel::Three, Kernel::Four] {
        let found = hydrodynamic_radius(edge, pushed_by_points(edge, radius, kernel));
        // Averaged over the places between nodes.
        let steps = (-200..=200).map(|step| 0.01 * f64::from(step));
        let variance: f64 = steps.map(|r| 0.01 * r * r * kernel.weight(r)).sum();
        let expected = radius + (variance / PI).sqrt() + variance / radius;
        LATTICE_SMEARED.assert(found, expected, radius, "radius by drag");
    }
}

#[test]
fn arrays_of_spheres_have_the_drag_of_hasimoto() {
    let (found, solid) = past_obstacle(28, 6.0);
    let radius = (0.75 * solid / PI).cbrt();
    LATTICE_DRAG.assert(hydrodynamic_radius(28, found), radius, radius, "radius");
}
