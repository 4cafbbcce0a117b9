//! Viscous membranes in the fluid, up to viscosities at which they hardly deform.

use crate::{cells, lattice, periodic, stirred};
use helfrich::{MembraneViscosity, Prepared, Surface};
use helfrich_std::flow::lattice_boltzmann::{Kernel, Lattice, Setup, Units};
use helfrich_std::flow::{Immersion, ImmersionPrecision, Membranes};
use helfrich_tests::meshes::{Mesh, dot, icosphere};
use helfrich_tests::tolerance::{self, Tolerance};
use std::num::NonZeroUsize;

/// Ratio of the strains of two nearly rigid viscous membranes, relative.
const LATTICE_STIFF: Tolerance = Tolerance::new(
    0.05,
    "modes of higher order than strain, of which a box of four radii has many, deform the membrane \
     slightly more",
);

const SIZE: [usize; 3] = [16, 14, 15];
const RADIUS: f64 = 4.0;
/// Kinematic viscosity of the fluid.
const VISCOSITY: f64 = 1.0 / 3.0;

/// Membrane with viscosity alone.
struct Viscous<'a> {
    mesh: &'a Mesh,
    viscosity: Prepared<f64, MembraneViscosity<f64>>,
}

impl<'a> Viscous<'a> {
    /// Membrane with equal shear and dilational viscosity, `boussinesq` times the fluid's viscosity times the
    /// radius.
    fn new(mesh: &'a Mesh, boussinesq: f64) -> Self {
        let shear = boussinesq * VISCOSITY * RADIUS;
        let viscosity = MembraneViscosity {
            shear,
            dilational: shear,
        };
        Self {
            mesh,
            viscosity: Prepared::new(viscosity, &mesh.connectivity),
        }
    }
}

impl Membranes for Viscous<'_> {
    fn set_forces(&mut self, _: &[[f64; 3]], forces: &mut [[f64; 3]]) -> Result<(), String> {
        forces.fill([0.0; 3]);
        Ok(())
    }

    fn are_viscous(&self) -> bool {
        true
    }

    fn add_viscous_forces(
        &mut self,
        positions: &[[f64; 3]],
        velocities: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) {
        let surface = Surface::new(&self.mesh.connectivity, positions).expect("finite positions");
        let viscosity = &mut self.viscosity;
        viscosity.add_dissipative_force(surface, velocities, forces);
    }
}

/// Sphere in stirred fluid, in lattice units.
fn immersion<T: ImmersionPrecision>(setup: Setup, mesh: &Mesh) -> Immersion<T> {
    let mut lattice = lattice::<T>(setup);
    lattice.fill(stirred(SIZE));
    let units = Units {
        spacing: 1.0,
        step: 1.0,
        density: 1.0,
    };
    Immersion::new(lattice, units, [0.0; 3], Kernel::Two, mesh.positions.len())
}

fn ball(refinement: u32) -> Mesh {
    let middle = SIZE.map(|cells| 0.5 * cells as f64);
    icosphere(refinement).map(|x| std::array::from_fn(|k| middle[k] + RADIUS * x[k]))
}

/// Kinetic energy `Σ ρ u²/2` of all nodes.
fn kinetic_energy<T: ImmersionPrecision>(lattice: &Lattice<T>) -> f64 {
    let nodes = cells(SIZE).map(|cell| lattice.node(cell));
    let energies = nodes.map(|node| 0.5 * node.density * dot(node.velocity, node.velocity));
    energies.sum()
}

/// Viscous membranes take energy but no momentum from the fluid, at any viscosity: without driving, the flow
/// only decays. Forces from the velocities of the previous step would make it grow without bound from
/// viscosities of about one μa on.
#[test]
fn viscous_membranes_take_energy_and_no_momentum() {
    for (boussinesq, inertia) in [(0.5, true), (5.0, false), (20.0, true), (500.0, false)] {
        let mesh = ball(3);
        let setup = Setup {
            inertia,
            ..periodic(SIZE, VISCOSITY)
        };
        let mut immersion = immersion::<f64>(setup, &mesh);
        let mut membranes = Viscous::new(&mesh, boussinesq);
        let mut positions = mesh.positions.clone();
        let momentum = immersion.lattice().momentum();
        let (start, mass) = (
            kinetic_energy(immersion.lattice()),
            immersion.lattice().mass(),
        );
        // Until the shortest waves have decayed and the flow has passed around the sphere.
        for step in 0..60 {
            let what = format!("viscosity {boussinesq}, step {step}");
            let advanced = immersion.advance(&mut membranes, &mut positions);
            advanced.unwrap_or_else(|error| panic!("{what}: {error}"));
            let now = immersion.lattice();
            assert!(kinetic_energy(now) < start, "{what}");
            for (found, expected) in now.momentum().into_iter().zip(momentum) {
                tolerance::LATTICE_ROUNDING.assert(found, expected, 0.05 * mass, &what);
            }
        }
    }
}

/// A nearly rigid membrane moves as a rigid body: it keeps its edge lengths while the surrounding fluid
/// carries it along.
#[test]
fn stiff_membranes_move_as_rigid_bodies() {
    let change = |boussinesq: f64| {
        let mesh = ball(2);
        let mut immersion = immersion::<f64>(periodic(SIZE, VISCOSITY), &mesh);
        let mut membranes = Viscous::new(&mesh, boussinesq);
        let mut positions = mesh.positions.clone();
        for _ in 0..40 {
            let advanced = immersion.advance(&mut membranes, &mut positions);
            advanced.unwrap_or_else(|error| panic!("{boussinesq}: {error}"));
        }
        let length = |positions: &[[f64; 3]], [a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|vertex| positions[vertex as usize]);
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
        };
        let edges = mesh.connectivity.edges().iter();
        let changes = edges.map(|&edge| {
            (length(&positions, edge) / length(&mesh.positions, edge))
                .ln()
                .abs()
        });
        let moved = (positions[0][0] - mesh.positions[0][0]).abs();
        assert!(
            moved > 0.1,
            "{boussinesq}: the fluid carries it along by {moved}"
        );
        changes.fold(0.0, f64::max)
    };
    let [soft, stiff, stiffer] = [0.0, 100.0, 1000.0].map(change);
    assert!(soft > 10.0 * stiff, "{soft} {stiff}");
    // Rate of strain of a viscous membrane in a straining flow, as in `tests/dynamics/immersed.rs`.
    let rate = |b: f64| (175.0 + 160.0 * b) / (175.0 + 210.0 * b + 32.0 * b * b);
    let expected = rate(100.0) / rate(1000.0);
    LATTICE_STIFF.assert(stiff / stiffer, expected, expected, "strain");
}

#[test]
fn solutions_do_not_depend_on_the_number_of_threads() {
    // So many vertices that several threads are used.
    let mesh = ball(4);
    let run = |threads| {
        let setup = Setup {
            threads: NonZeroUsize::new(threads).unwrap(),
            ..periodic(SIZE, VISCOSITY)
        };
        let mut immersion = immersion::<f32>(setup, &mesh);
        let mut membranes = Viscous::new(&mesh, 20.0);
        let mut positions = mesh.positions.clone();
        for _ in 0..3 {
            immersion.advance(&mut membranes, &mut positions).unwrap();
        }
        (immersion.lattice().state().clone(), positions)
    };
    let alone = run(1);
    for threads in [2, 3] {
        assert!(alone == run(threads), "{threads} threads");
    }
}
