//! Staggered momentum, which changes its sign from node to node and from step to step.
//!
//! Populations move by one node or none along an axis, so that the momentum along it, weighted with the sign
//! `(−1)^(i + n)` at node i in step n, is conserved like momentum itself, whatever the viscosity: G. Zanetti,
//! Phys. Rev. A 40 (1989) 1539. Membranes must not feed it.

use crate::{cells, lattice, periodic, turned, unit};
use helfrich::elasticity::Skalak;
use helfrich::{InPlane, Prepared, Surface};
use helfrich_std::flow::lattice_boltzmann::{Kernel, Lattice, Node, Units};
use helfrich_std::flow::{Immersion, Membranes};
use helfrich_tests::meshes::{Mesh, icosphere};
use helfrich_tests::tolerance::{self, Tolerance};

/// Staggered momentum with a membrane in the fluid, relative to its initial value.
const LATTICE_STAGGERED: Tolerance = Tolerance::new(
    1e-2,
    "the first step has no predecessor, so that vertices are off by half of its displacement: a membrane \
     of a tenth of μ spacing/step pulls them back and forth by a tenth of that, on a part of the nodes",
);

const SIZE: [usize; 3] = [16, 13, 15];
const RADIUS: f64 = 4.0;
/// Speed of the fluid at the start; the speed of sound is 0.577.
const SPEED: f64 = 1e-3;

struct Elastic<'a> {
    mesh: &'a Mesh,
    elasticity: Prepared<f64, InPlane<f64, Skalak<f64>>>,
}

impl<'a> Elastic<'a> {
    fn new(mesh: &'a Mesh, shear_modulus: f64) -> Self {
        let law = Skalak {
            shear_modulus,
            area_ratio: 1.0,
        };
        let law = InPlane::new(law, &mesh.connectivity, mesh.surface()).expect("a reference");
        Self {
            mesh,
            elasticity: Prepared::new(law, &mesh.connectivity),
        }
    }
}

impl Membranes for Elastic<'_> {
    fn set_forces(
        &mut self,
        positions: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) -> Result<(), String> {
        forces.fill([0.0; 3]);
        let surface =
            Surface::new(&self.mesh.connectivity, positions).map_err(|e| e.to_string())?;
        self.elasticity.add_force(surface, forces);
        Ok(())
    }
}

fn sign(number: usize) -> f64 {
    if number.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Fluid whose velocity along an axis alternates from each plane of nodes to the next.
fn staggered(axis: usize) -> Lattice<f64> {
    let mut lattice = lattice(periodic(turned(SIZE, axis), 1.0 / 3.0));
    lattice.fill(|cell| Node {
        density: 1.0,
        velocity: unit(axis, sign(cell[axis]) * SPEED),
    });
    lattice
}

/// Mean staggered momentum over all nodes.
fn momentum(lattice: &Lattice<f64>, axis: usize) -> f64 {
    let size = lattice.cells();
    let nodes = cells(size).map(|cell| {
        let node = lattice.node(cell);
        sign(cell[axis]) * node.density * node.velocity[axis]
    });
    let count = size.iter().product::<usize>() as f64;
    sign(lattice.steps() as usize) * nodes.sum::<f64>() / count
}

#[test]
fn it_is_conserved() {
    for axis in 0..3 {
        let mut lattice = staggered(axis);
        lattice.advance(99);
        tolerance::LATTICE_ROUNDING.assert(momentum(&lattice, axis), SPEED, 1.0, "momentum");
    }
}

/// If vertices moved with the velocities of single steps, they would oscillate, and their membrane would pull
/// them in step with the fluid: without walls, which absorb some of it, this momentum would grow without
/// bound.
#[test]
fn membranes_do_not_feed_it() {
    // Growth is the same along all axes; that each has its part is seen early.
    for (axis, steps) in [(0, 500), (1, 100), (2, 100)] {
        let lattice = staggered(axis);
        let middle = lattice.cells().map(|count| 0.5 * count as f64);
        let mesh = icosphere(2).map(|x| std::array::from_fn(|k| middle[k] + RADIUS * x[k]));
        let mut membranes = Elastic::new(&mesh, 0.03);
        let units = Units {
            spacing: 1.0,
            step: 1.0,
            density: 1.0,
        };
        let count = mesh.positions.len();
        let mut immersion = Immersion::new(lattice, units, [0.0; 3], Kernel::Two, count);
        let mut positions = mesh.positions.clone();
        for step in 1..=steps {
            let advanced = immersion.advance(&mut membranes, &mut positions);
            advanced.unwrap_or_else(|error| panic!("{axis}, step {step}: {error}"));
            let found = momentum(immersion.lattice(), axis);
            let what = format!("momentum along {axis} after step {step}");
            LATTICE_STAGGERED.assert(found, SPEED, SPEED, &what);
        }
    }
}
