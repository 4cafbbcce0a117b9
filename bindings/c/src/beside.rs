//! Forces that no effect of one membrane has: of viscosity, from velocities, and between surfaces.

use crate::call::{Call, finite, finite_sum, surface};
use crate::membrane::threads;
use crate::mesh::Mesh;
use crate::number::Number;
use crate::status::{Failure, Outcome, Status};
use helfrich::{Images, MembraneViscosity, Prepared, Repulsion, Surface};
use helfrich_std::contact::repel;
use helfrich_std::execute::Parallel;

/// Refuses a number that is not finite or below 0; `positive` refuses 0, too.
fn in_range<N: Number>(name: &str, value: N, positive: bool) -> Result<f64, Failure> {
    let value = value.wide();
    let is_low = value < 0.0 || positive && value == 0.0;
    if value.is_finite() && !is_low {
        return Ok(value);
    }
    let limit = if positive { "above" } else { "at least" };
    let text = format!("`{name}` is {value}: a finite number {limit} 0 is needed");
    Err(Failure::argument(text))
}

fn viscous<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, velocities, count): (*const [N; 3], *const [N; 3], usize),
    [shear, dilational]: [N; 2],
    force: *mut [N; 3],
    power: *mut N,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let velocities = call.field("velocities", velocities, count, mesh)?;
    let force = call.write("force", force, count)?;
    let power = call.write_if_wanted("power", power, 1)?;
    let viscosity = MembraneViscosity {
        shear: in_range("shear", shear, false)?,
        dilational: in_range("dilational", dilational, false)?,
    };
    let surface = surface(mesh, &positions)?;
    let mut viscosity = Prepared::new(viscosity, mesh);
    N::compute(&mut *force, |force| {
        force.fill([0.0; 3]);
        viscosity.add_dissipative_force(surface, &velocities[..], force);
    });
    finite("force", "vertex", force.as_flattened().iter().copied(), 3)?;
    if let Some([power]) = power {
        let found = viscosity.dissipated_power(surface, &velocities[..]);
        *power = finite_sum("power", N::nearest(found))?;
    }
    Ok(())
}

twins! {
    /// Sets `force`, `count` rows of three, to the nodal forces of the viscosity of a membrane whose vertices have
    /// these velocities, and `*power` to the power −Σ F·v ≥ 0 that it dissipates, unless it is NULL.
    ///
    /// The surface stress is (η_d − η_s) (tr d) P + 2 η_s d, d the rate of strain in the plane of a triangle and P the
    /// projector on it (Boussinesq and Scriven). `shear` is η_s, `dilational` η_d: force times time per length, at
    /// least 0, as the effect membrane_viscosity of scenes has them. Velocities of a rigid body have no force.
    fn hf_viscous_force, hf_viscous_force_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], velocities: *const [$N; 3], count: usize,
        shear: $N, dilational: $N, force: *mut [$N; 3], power: *mut $N,
    ) |call| viscous(call, mesh, (positions, velocities, count), [shear, dilational], force, power)
}

/// The arrays of several surfaces, one after the other.
struct Several<N> {
    meshes: *const *const Mesh,
    count: usize,
    positions: *const [N; 3],
    forces: *mut [N; 3],
    total: usize,
}

fn repulsion<N: Number>(
    call: &mut Call,
    several: &Several<N>,
    [modulus, range]: [N; 2],
    periods: *const [N; 3],
    energy: *mut N,
    thread_count: usize,
) -> Outcome {
    let handles = call.read("meshes", several.meshes, several.count)?;
    let positions = call.read("positions", several.positions, several.total)?;
    let forces = call.write("forces", several.forces, several.total)?;
    let place = call.write_if_wanted("energy", energy, 1)?;
    let periods = match periods.is_null() {
        true => [0.0; 3],
        false => {
            let [x, y, z] = *call.object("periods", periods)?;
            [
                in_range("periods", x, false)?,
                in_range("periods", y, false)?,
                in_range("periods", z, false)?,
            ]
        }
    };
    let range = in_range("range", range, true)?;
    if let Some(period) = periods.into_iter().find(|&l| 0.0 < l && l < range) {
        let text =
            format!("`range` is {range}: at most {period}, the length of the box, is needed");
        return Err(Failure::argument(text));
    }
    let repulsion = Repulsion {
        modulus: in_range("modulus", modulus, true)?,
        range,
        attraction: 0.0,
        parts: false,
        first_group: None,
        images: Images { periods, own: true },
    };
    let mut meshes = Vec::with_capacity(handles.len());
    for &handle in handles {
        meshes.push(&call.object("meshes", handle)?.triangles);
    }
    let vertices = meshes.iter().map(|mesh| mesh.vertex_count()).sum();
    if vertices != several.total {
        let of = "one for each vertex of all meshes";
        return Err(Failure::count("positions", several.total, vertices, of));
    }
    let counts = Vec::from_iter(meshes.iter().map(|mesh| mesh.vertex_count()));
    let positions = N::widen(positions);
    let mut rest = &positions[..];
    let mut surfaces: Vec<Surface<'_, f64>> = Vec::with_capacity(meshes.len());
    for (index, mesh) in meshes.into_iter().enumerate() {
        let (own, after) = rest.split_at(mesh.vertex_count());
        rest = after;
        surfaces.push(surface(mesh, own).map_err(|failure| Failure {
            text: format!("surface {index}: {}", failure.text),
            ..failure
        })?);
    }
    let energy = N::compute(&mut *forces, |forces| {
        forces.fill([0.0; 3]);
        let mut rest = forces;
        let mut each = Vec::with_capacity(surfaces.len());
        for surface in &surfaces {
            let (own, after) = rest.split_at_mut(surface.mesh().vertex_count());
            each.push(own);
            rest = after;
        }
        let execution = Parallel {
            threads: threads(thread_count),
        };
        let mut memory = Default::default();
        repel(&execution, &repulsion, &surfaces, &mut memory, &mut each)
    });
    let energy = N::nearest(energy);
    let is_finite = |force: &[N; 3]| force.iter().all(|component| component.wide().is_finite());
    let broken = forces.iter().position(|force| !is_finite(force));
    if broken.is_some() || !energy.wide().is_finite() {
        let (mut index, mut vertex) = (0, broken.unwrap_or_default());
        while counts.get(index).is_some_and(|&count| count <= vertex) {
            vertex -= counts[index];
            index += 1;
        }
        let place = match broken {
            Some(_) => format!("surface {index} touches another surface at vertex {vertex}"),
            None => "two surfaces touch".to_owned(),
        };
        let text = format!("{place}, where the repulsion has no bound: move them apart");
        return Err(Failure::new(Status::Undefined, text));
    }
    if let Some([place]) = place {
        *place = energy;
    }
    Ok(())
}

twins! {
    /// Sets `forces` to the nodal forces of a short-range repulsion of `count` surfaces from each other, and `*energy` to
    /// its energy, unless it is NULL.
    ///
    /// The energy is ½ Σ A w(d), summed over the vertices with their areas A and distances d from each other surface,
    /// with w(d) = k r²/4 (1 − s²)³/s², s = d/r for d < r, and 0 beyond. Fails with HF_STATUS_UNDEFINED where surfaces
    /// touch: it has no bound there. `modulus` is k, an energy per area squared, and `range` r. `positions` and
    /// `forces` have the rows of all surfaces one after the other, `total` in all; a mesh may be given several times.
    /// `periods` are the lengths of a periodic box along its three axes, at least the range or 0 for those that are not
    /// periodic, or NULL: in a box surfaces are repelled by all images, also of themselves. Evaluations run on up to
    /// `threads` threads, 0 for all; no result depends on their number.
    fn hf_repulsion, hf_repulsion_f32<$N>(
        meshes: *const *const Mesh, count: usize, positions: *const [$N; 3], forces: *mut [$N; 3],
        total: usize, modulus: $N, range: $N, periods: *const [$N; 3], energy: *mut $N,
        threads: usize,
    ) |call| {
        let several = Several { meshes, count, positions, forces, total };
        repulsion(call, &several, [modulus, range], periods, energy, threads)
    }
}
