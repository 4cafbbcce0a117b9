//! Effects besides bending, each on an octahedron with an exact result.

use super::{MODULUS, RADIUS, SQRT_3, dot, near, octahedron, positions, vanishes};
use alloc::vec;
use alloc::vec::Vec;
use core::fmt::Display;
use helfrich::{
    Constraint, Constraints, EnclosedVolume, Images, InPlane, Interaction, MembraneViscosity,
    NeoHookean, Prepared, Real, Repulsion, Serial, Surface, Targets, TriangleMesh,
};

/// Area of the octahedron around each of its six vertices, a third of four triangles.
const VERTEX_AREA: f64 = 4.0 * SQRT_3 * RADIUS * RADIUS / 6.0;

/// Checks every effect.
///
/// # Panics
/// If a result is wrong.
pub fn run<T: Real + Display>() {
    let solid = octahedron();
    let mesh = mesh(6, solid.triangles.clone());
    let points = positions::<T>(&solid, RADIUS);
    let surface = surface(&mesh, &points);
    in_plane(surface);
    dissipation(surface);
    repulsion(surface);
    correction(&mesh, &points);
}

fn mesh(vertices: usize, triangles: Vec<[u32; 3]>) -> TriangleMesh {
    match TriangleMesh::new(vertices, triangles) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error}"),
    }
}

fn surface<'a, T: Real>(mesh: &'a TriangleMesh, points: &'a [[T; 3]]) -> Surface<'a, T> {
    match Surface::new(mesh, points) {
        Ok(surface) => surface,
        Err(error) => panic!("{error}"),
    }
}

/// Checks that each force is radial, by symmetry, with this outward component.
fn radial<T: Real + Display>(surface: Surface<'_, T>, force: &[[T; 3]], expected: f64, what: &str) {
    for (&force, &position) in force.iter().zip(surface.positions()) {
        let along = dot(force, position) / T::constant(RADIUS);
        near(along, expected, what);
        near(dot(force, force).sqrt(), expected.abs(), what);
    }
}

/// Checks a uniform stretch λ: E = A0 W, with the tension G (1 − λ⁻⁶) against every change of area.
fn in_plane<T: Real + Display>(surface: Surface<'_, T>) {
    let stretch = 1.25_f64;
    let squared = stretch * stretch;
    let fourth = squared * squared;
    let law = NeoHookean {
        shear_modulus: T::constant(MODULUS),
    };
    let stretched = InPlane::new(law, surface.mesh(), surface)
        .and_then(|law| law.with_scaled_reference(T::constant(1.0 / stretch)));
    let mut stretched = match stretched {
        Ok(law) => Prepared::new(law, surface.mesh()),
        Err(error) => panic!("{error}"),
    };
    let mut force = vec![[T::zero(); 3]; 6];
    let energy = stretched.add_force_and_energy(surface, &mut force);
    let density = 0.5 * MODULUS * (2.0 * squared - 3.0 + 1.0 / fourth);
    near(
        energy,
        6.0 * VERTEX_AREA / squared * density,
        "the neo-Hookean energy",
    );
    let tension = MODULUS * (1.0 - 1.0 / (squared * fourth));
    let inward = -2.0 * tension * VERTEX_AREA / RADIUS;
    radial(surface, &force, inward, "the neo-Hookean force");
}

/// Checks growth at the rate r, which only the dilational viscosity resists, with the power 4 η_d r² A; and
/// rotation, which nothing resists.
fn dissipation<T: Real + Display>(surface: Surface<'_, T>) {
    let viscosity = MembraneViscosity {
        shear: T::constant(0.75),
        dilational: T::constant(MODULUS),
    };
    let mut viscosity = Prepared::new(viscosity, surface.mesh());
    let rate = 0.5;
    let grow = |point: &[T; 3]| point.map(|x| T::constant(rate) * x);
    let velocities = Vec::from_iter(surface.positions().iter().map(grow));
    let power = 4.0 * MODULUS * rate * rate * 6.0 * VERTEX_AREA;
    let found = viscosity.dissipated_power(surface, &velocities);
    near(found, power, "the dissipated power");
    let mut force = vec![[T::zero(); 3]; 6];
    viscosity.add_dissipative_force(surface, &velocities, &mut force);
    let inward = -power / (6.0 * rate * RADIUS);
    radial(surface, &force, inward, "the dissipative force");

    let turn = |&[x, y, _]: &[T; 3]| [-y, x, T::zero()];
    let velocities = Vec::from_iter(surface.positions().iter().map(turn));
    force.fill([T::zero(); 3]);
    viscosity.add_dissipative_force(surface, &velocities, &mut force);
    vanishes(&force, "the dissipative force on a body that turns");
}

/// Checks two octahedra side by side, of which one vertex each is within the range of the other.
fn repulsion<T: Real + Display>(left: Surface<'_, T>) {
    let (range, gap) = (1.0, 0.5);
    let repulsion = Repulsion {
        modulus: T::constant(MODULUS),
        range: T::constant(range),
        attraction: T::zero(),
        parts: false,
        first_group: None,
        images: Images::none(),
    };
    let apart = T::constant(2.0 * RADIUS + gap);
    let moved = Vec::from_iter(left.positions().iter().map(|&[x, y, z]| [x + apart, y, z]));
    let right = surface(left.mesh(), &moved);
    let mut forces = [[[T::zero(); 3]; 6]; 2];
    let [on_left, on_right] = &mut forces;
    let energy = repulsion.add_force_and_energy(
        &Serial,
        &[left, right],
        &mut Default::default(),
        &mut [on_left, on_right],
    );
    // The nearest point of each is the vertex itself, which belongs to four triangles.
    let (squared, inside) = (gap * gap, 1.0 - gap * gap);
    let expected = MODULUS * VERTEX_AREA * 0.25 * inside * inside * inside / squared;
    near(energy, expected, "the energy of repulsion");
    let net = forces.map(|force| force.map(|[x, _, _]| x).iter().copied().sum::<T>());
    let steep = (1.0 + 2.0 * squared) / (squared * gap);
    let push = MODULUS * VERTEX_AREA * 0.5 * inside * inside * steep;
    near(net[0], -push, "the push on the left");
    near(net[1], push, "the push on the right");

    // Growth about the vertex within the range changes the area there, but no distance.
    let near_vertex = right.positions()[3];
    let grow = |(&force, &[x, y, z]): (&[T; 3], &[T; 3])| {
        let [a, b, c] = near_vertex;
        dot(force, [x - a, y - b, z - c])
    };
    let work: T = forces[1].iter().zip(right.positions()).map(grow).sum();
    near(work, -expected, "the work against growth");
}

/// Checks two octahedra in one mesh, which are brought to twice and three times their volume 4/3 R³: each
/// grows independently and stays an octahedron.
fn correction<T: Real + Display>(one: &TriangleMesh, points: &[[T; 3]]) {
    let second = one.triangles().iter().map(|corners| corners.map(|v| v + 6));
    let mesh = mesh(12, one.triangles().iter().copied().chain(second).collect());
    let mut points = [points, points].concat();
    let volume = 4.0 / 3.0 * RADIUS * RADIUS * RADIUS;
    let factors = [2.0, 3.0];
    let constraint = Constraint {
        functional: EnclosedVolume,
        targets: Targets::PerComponent(factors.map(|f| T::constant(f * volume)).to_vec()),
    };
    let constraints = vec![constraint];
    let mut constraints = Prepared::new(Constraints { constraints }, &mesh);
    let corrected = constraints.with(|constraints, execution, workspace| {
        constraints.correct(execution, &mesh, &mut points, workspace)
    });
    if let Err(error) = corrected {
        panic!("{error}");
    }
    for (component, points) in points.chunks(6).enumerate() {
        for &point in points {
            let radius = dot(point, point).sqrt();
            let cubed = radius * radius * radius;
            let expected = factors[component] * RADIUS * RADIUS * RADIUS;
            near(cubed, expected, "the cubed radius of a corrected solid");
        }
    }
}
