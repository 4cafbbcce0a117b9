//! Drag of spheres in Stokes flow.

use crate::{cells, lattice, periodic, sphere};
use helfrich_std::flow::lattice_boltzmann::Setup;
use helfrich_tests::tolerance;
use std::f64::consts::PI;

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
