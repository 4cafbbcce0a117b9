//! Conservation of momentum: by internal forces, and by a fluid under given forces.

use super::{Made, ready};
use glam::DVec3;
use helfrich_std::flow::lattice_boltzmann::{Immersed, Kernel, Lattice, Precision, Setup, Sides};
use helfrich_std::generate::random::Random;
use helfrich_std::method::BendingMethod;
use std::num::NonZeroUsize;

/// Two capsules that repel each other, on meshes of needles and caps.
const PAIR: &str = r#"
units = "none"
[[surface]]
name = "left"
shape = "ellipsoid:1,0.8,0.7"
family = "hard"
vertices = 162
position = [-0.95, 0, 0]
elasticity = { law = "skalak", shear_modulus = 1, area_ratio = 3, reference = { shape = "sphere:0.8" } }
bending = { method = "gompper-kroll", modulus = 0.5 }
area = { modulus = 3, target = 7 }
local_area = { modulus = 2, reference = { shape = "sphere:0.8" } }
volume = { modulus = 5, target = 1.5 }
[[surface]]
name = "right"
shape = "sphere:0.9"
family = "hard"
seed = 5
vertices = 162
position = [0.9, 0.3, 0.1]
elasticity = { law = "neo-hookean", shear_modulus = 2, reference = { shape = "ellipsoid:1,0.8,0.7" } }
bending = { method = "gompper-kroll", modulus = 0.5 }
tension = { value = 0.3 }
pressure = { value = 1.5 }
[[interaction]]
kind = "repulsion"
strength = 5
cutoff = 0.6
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 1 }
strain = 1
[output]
surfaces = false
pictures = false
"#;

/// Largest net force and torque of an effect, in units of rounding of the sum of its parts.
pub(super) fn of_effects(method: BendingMethod) -> Made<f64> {
    let methods = [0, 1].map(|surface| format!("surface.{surface}.bending.method={method}"));
    let changes = [methods[0].as_str(), methods[1].as_str()];
    let (_, mut simulation, positions) = ready(PAIR, &changes)??;
    let mut worst = 0.0_f64;
    let acting = simulation.resolve(&positions);
    if acting.len() < 9 {
        return Ok(f64::NAN);
    }
    for acting in acting {
        let [mut force, mut torque] = [DVec3::ZERO; 2];
        let [mut forces, mut torques] = [0.0; 2];
        for (&position, &part) in positions[acting.vertices].iter().zip(&acting.force) {
            let (position, part) = (DVec3::from(position), DVec3::from(part));
            force += part;
            torque += position.cross(part);
            forces += part.length();
            torques += position.length() * part.length();
        }
        if forces == 0.0 {
            return Ok(f64::NAN);
        }
        for share in [force.length() / forces, torque.length() / torques] {
            worst = if share.is_nan() {
                share
            } else {
                worst.max(share)
            };
        }
    }
    Ok(worst / f64::EPSILON)
}

/// Kernels that spread forces, by their number of nodes along an axis.
pub(super) const KERNELS: [(&str, Kernel); 3] = [
    ("kernel of two points", Kernel::Two),
    ("kernel of three points", Kernel::Three),
    ("kernel of four points", Kernel::Four),
];

/// Unexplained momentum after 100 steps, in units of the rounding of the mass times the speed of sound.
pub(super) fn of_fluid<T: Precision>(kernel: Kernel) -> Made<f64> {
    const CELLS: [usize; 3] = [12, 10, 14];
    let lid = Sides::Walls {
        low: [0.0; 3],
        high: [0.03, 0.0, 0.02],
    };
    let mut lattice = Lattice::<T>::new(Setup {
        cells: CELLS,
        sides: [Sides::Periodic, lid, Sides::Periodic],
        viscosity: 0.1,
        inertia: true,
        threads: NonZeroUsize::MIN,
    })?;
    let mut random = Random::new(3);
    let mut vector = |scale: f64| (scale * random.on_sphere()).to_array();
    let middle = CELLS.map(|cells| 0.5 * cells as f64);
    let points = Vec::from_iter((0..40).map(|_| {
        let [x, y, z] = vector(2.5);
        [middle[0] + x, middle[1] + y, middle[2] + z]
    }));
    let mut immersed = Immersed::new(kernel);
    immersed.place(&lattice, &points)?;
    let mut momentum = DVec3::from(lattice.momentum());
    for _ in 0..100 {
        let forces = Vec::from_iter(points.iter().map(|_| vector(1e-3)));
        lattice.clear_forces();
        immersed.spread(&mut lattice, &forces)?;
        lattice.advance(1);
        momentum += forces.into_iter().map(DVec3::from).sum::<DVec3>();
        momentum -= lattice
            .wall_forces(1)
            .map(DVec3::from)
            .into_iter()
            .sum::<DVec3>();
    }
    // The momentum of the lattice includes half of the current forces, so they are cleared.
    lattice.clear_forces();
    let missing = DVec3::from(lattice.momentum()) - momentum;
    let rounding = T::epsilon().to_f64().unwrap_or(f64::NAN);
    Ok(missing.length() / (rounding * lattice.mass() / 3.0_f64.sqrt()))
}
