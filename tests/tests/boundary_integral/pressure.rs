//! Uniform pressures inside membranes.

use super::{ONE, largest_norm};
use helfrich::{AnyFunctional, Surface, TriangleMesh};
use helfrich_std::flow::{KeptVolumes, Membranes, Suspension};
use helfrich_std::held::Quantity;
use helfrich_tests::meshes::icosphere;
use std::sync::Arc;

/// Membranes that exert this uniform pressure, and a constant force on each vertex besides.
struct Inflated {
    mesh: Arc<TriangleMesh>,
    pressures: [f64; 2],
    weight: f64,
}

impl Membranes for Inflated {
    fn set_forces(
        &mut self,
        positions: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) -> Result<(), String> {
        let surface = Surface::new(&self.mesh, positions).map_err(|error| error.to_string())?;
        let (components, _) = self.mesh.components();
        forces.fill([0.0; 3]);
        let mut volume = Quantity::new(AnyFunctional::Volume, &self.mesh);
        volume.values(surface);
        volume.add_gradient(surface, forces);
        for (force, component) in forces.iter_mut().zip(components) {
            *force = force.map(|own| self.pressures[component as usize] * own);
            force[2] += self.weight;
        }
        Ok(())
    }
}

/// A uniform pressure in each of two ellipsoids moves nothing, however large; flat triangles alone would make velocities of
/// second order. What moves the surfaces stays as it is, and the fluid has the pressure.
#[test]
fn uniform_pressures_move_nothing() {
    let squeezed = icosphere(2).map(|[x, y, z]| [1.3 * x, 0.8 * y, z]);
    let both = squeezed.beside(&squeezed, [4.0, 0.0, 0.0]);
    let mesh = Arc::new(both.connectivity.clone());
    let positions = &both.positions;
    let found = |pressures, weight| {
        let membranes = &mut Inflated {
            mesh: Arc::clone(&mesh),
            pressures,
            weight,
        };
        let meshes = [Arc::clone(&mesh)];
        let mut suspension = Suspension::new(&meshes, 1.0, &[1.0], None, ONE);
        suspension.keep_volumes(KeptVolumes::new(&meshes, &|_| true, positions));
        let mut velocities = vec![[0.0; 3]; positions.len()];
        let evaluated = suspension.set_velocities(membranes, positions, &mut velocities);
        evaluated.expect("velocities");
        let centres = [[0.0; 3], [4.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let fluid = suspension.fluid_at(membranes, positions, &centres);
        (velocities, fluid.expect("a fluid"))
    };
    let (velocities, fluid) = found([7.0, 3.0], 0.0);
    // An ellipsoid of forces of this size, all in one direction, would move with a velocity of order 1.
    assert!(largest_norm(&velocities) < 1e-13);
    assert!(largest_norm(&fluid.velocity) < 1e-13);
    // The forces push outwards: the fluid inside has less pressure. 320 triangles a body.
    for (pressure, expected) in fluid.pressure.iter().zip([-7.0, -3.0, 0.0]) {
        assert!((pressure - expected).abs() < 0.2, "{:?}", fluid.pressure);
    }
    let [(heavy, _), (inflated, _)] = [found([0.0; 2], 0.1), found([7.0, 3.0], 0.1)];
    let largest = largest_norm(&heavy);
    for (one, other) in heavy.iter().flatten().zip(inflated.iter().flatten()) {
        assert!((one - other).abs() < 1e-12 * largest, "{one} {other}");
    }
    assert!(largest > 0.5);
}
