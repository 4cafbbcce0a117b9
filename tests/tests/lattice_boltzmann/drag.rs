//! Drag of spheres in Stokes flow.
//!
//! H. Hasimoto, J. Fluid Mech. 5 (1959) 317: a sphere that is held in a cubic periodic box of edge L in a
//! stream of mean velocity U feels a force F with `6πμ a U/F = 1 − 1.7601 c^(1/3) + c − 1.5593 c²`, where c
//! is the volume fraction of the sphere.

use crate::{cells, lattice, periodic, sphere};
use helfrich_std::flow::lattice_boltzmann::{Immersed, Kernel, Lattice, Node, Setup};
use helfrich_tests::meshes::icosphere;
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::{PI, TAU};

/// Force on an obstacle in steady flow against its value some time earlier, relative.
const LATTICE_DRAG_BALANCE: Tolerance = Tolerance::new(
    1e-4,
    "the longest wave has decayed to e⁻¹³ by then; boxes with obstacles have somewhat slower ones",
);

/// Drag of a sphere of six nodes' radius, relative.
const LATTICE_DRAG: Tolerance = Tolerance::new(
    2e-2,
    "the surface is made of steps: the radius is uncertain by a tenth of a node spacing",
);

/// Slope of a sphere's mobility in 1/L, from three boxes, relative.
const LATTICE_BOX: Tolerance = Tolerance::new(
    2e-2,
    "the next term, of sixth order, is 27 (4/24)⁶ = 6e-4 of the mobility",
);

/// Hydrodynamic radius of a sphere of points, relative to its radius.
const LATTICE_SMEARED: Tolerance = Tolerance::new(
    1.5e-2,
    "kernels are not Gaussians: a tenth of what they add to the radius, which is 0.5 of 4 for the widest",
);

const VISCOSITY: f64 = 0.6;

/// Stokes flow in a cubic box.
fn cubic(edge: usize) -> Lattice<f64> {
    lattice(Setup {
        inertia: false,
        ..periodic([edge; 3], VISCOSITY)
    })
}

/// The longest wave decays at the rate νk² per step: 15 of its lifetimes.
fn settling_steps(edge: usize) -> u64 {
    let wave = TAU / edge as f64;
    (15.0 / (VISCOSITY * wave * wave)) as u64
}

/// Advances fluid from which a body takes the momentum `drag` in each step. A force on all fluid nodes
/// returns it, so that the stream persists and all other remains of the start decay like waves. Returns the
/// velocity, averaged over the box, and the force on the body, including the driving pressure gradient on its
/// `solid` nodes.
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

/// [`streaming`] past an obstacle in the middle of the box, and the number of its nodes.
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

/// Radius of the sphere that has this drag in a periodic box.
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

/// The drag in three boxes, extrapolated to open fluid without Hasimoto's formula: U/F = 1/(6πμa) − s/L +
/// q/L³.
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
    // Newton's divided differences for the powers 1, 1/L and 1/L³.
    let [a, b, c] = edges.map(|edge| 1.0 / edge);
    let [ab, bc] = [
        (mobilities[0] - mobilities[1]) / (a - b),
        (mobilities[1] - mobilities[2]) / (b - c),
    ];
    let cubic = (ab - bc) / ((a * a + a * b + b * b) - (b * b + b * c + c * c));
    let slope = ab - cubic * (a * a + a * b + b * b);
    let open = mobilities[0] - slope * a - cubic * a * a * a;
    LATTICE_BOX.assert(slope, -2.8373, 2.8373, "slope in 1/L");
    let radius = (0.75 * volume / PI).cbrt();
    LATTICE_DRAG.assert(1.0 / open, radius, radius, "6πμa by drag");
}

/// Mean velocity of points on a sphere that all push the fluid with the same force, and the sum of these
/// forces, which a force on all nodes balances.
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
    immersed.interpolate(&mut lattice, &mut velocities);
    let sum: f64 = velocities.iter().map(|velocity| velocity[0]).sum();
    [sum / count as f64, force]
}

/// A shell of forces at r moves one at r' with velocity `F/(6πμ max(r, r'))`. Points are spread by the kernel
/// once towards the fluid and once from it, each with variance σ² along each axis. As far as the kernel
/// resembles a Gaussian, the mean of max(r, r') is then `a + σ/√π + σ²/a`.
#[test]
fn spheres_of_points_have_the_drag_of_stokes() {
    let (edge, radius) = (22, 4.0);
    for kernel in [Kernel::Two, Kernel::Three, Kernel::Four] {
        let found = hydrodynamic_radius(edge, pushed_by_points(edge, radius, kernel));
        // Variance of the kernel, averaged over positions between nodes.
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
