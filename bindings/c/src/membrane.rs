//! Membranes: a mesh and the effects that act on it.

pub mod constraint;
pub mod engine;

use crate::call::{Call, finite, finite_sum, free, guarded, of_vertices, surface};
use crate::mesh::Mesh;
use crate::names::name;
use crate::number::Number;
use crate::status::{Error, Failure, Outcome, Status};
use helfrich::TriangleMesh;
use helfrich_std::dynamics::Problem;
use helfrich_std::execute::{available_threads, with_threads};
use helfrich_std::io::{Column, ColumnPlace, MeshFile};
use helfrich_std::scene::SceneFile;
use helfrich_std::simulation::{Simulation, build};
use std::ffi::c_char;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Effects on one mesh, with the memory of their evaluations. One thread at a time may use it.
#[derive(Debug)]
pub struct Membrane {
    simulation: Simulation,
    mesh: Arc<TriangleMesh>,
    effects: Vec<String>,
    /// What the energy of bending leaves out.
    left_out: Option<String>,
    force: Vec<[f64; 3]>,
}

/// A material parameter by a name, for `{ column = "name" }` in the text of effects.
#[derive(Debug)]
#[repr(C)]
pub struct Values {
    /// Its name, ended by a zero byte.
    pub name: *const c_char,
    /// One number for each vertex, or for each triangle.
    pub values: *const f64,
    /// Number of values.
    pub count: usize,
}

/// The number of threads that a caller asks for; 0 stands for all.
pub(crate) fn threads(count: usize) -> NonZeroUsize {
    NonZeroUsize::new(count).unwrap_or_else(available_threads)
}

impl Membrane {
    fn new(
        mesh: &Arc<TriangleMesh>,
        reference: &[[f64; 3]],
        effects: &str,
        columns: Vec<Column>,
        threads: NonZeroUsize,
    ) -> Result<Self, Failure> {
        let at_start = surface(mesh, reference)?;
        let invalid =
            |error: &dyn ToString| Failure::new(Status::InvalidEffects, error.to_string());
        let file = MeshFile::new(reference.to_vec(), TriangleMesh::clone(mesh));
        let scene = SceneFile::of_effects(effects, file, columns);
        let scene = scene.map_err(|error| invalid(&error))?;
        let built = with_threads(threads, || build(&scene));
        let (simulation, _) = built.map_err(|error| invalid(&error))?;
        let mut bending = scene.scene.surfaces.iter();
        let bending = bending.find_map(|surface| surface.effects.bending.as_ref());
        Ok(Self {
            left_out: bending.and_then(|bending| bending.method.what_is_left_out(at_start)),
            effects: simulation.effect_names(),
            simulation,
            mesh: Arc::clone(mesh),
            force: vec![[0.0; 3]; reference.len()],
        })
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.force.len()
    }

    /// Sets the forces and returns the energy.
    pub(crate) fn evaluate(
        &mut self,
        positions: &[[f64; 3]],
        force: &mut [[f64; 3]],
    ) -> Result<f64, Failure> {
        surface(&self.mesh, positions)?;
        of_vertices("force", force.len(), &self.mesh)?;
        let energy = self.simulation.evaluate(positions, force).energy;
        finite("force", "vertex", force.as_flattened().iter().copied(), 3)?;
        finite_sum("energy", energy)
    }

    /// Evaluates, and keeps the forces.
    fn keep(&mut self, positions: &[[f64; 3]]) -> Result<f64, Failure> {
        let mut force = std::mem::take(&mut self.force);
        let energy = self.evaluate(positions, &mut force);
        self.force = force;
        energy
    }
}

fn new<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (reference, count): (*const [N; 3], usize),
    effects: *const c_char,
    (values, value_count): (*const Values, usize),
    thread_count: usize,
    membrane: *mut *mut Membrane,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let reference = call.at_vertices("reference", reference, count, mesh)?;
    let effects = call.text("effects", effects)?;
    let mut columns = Vec::new();
    for given in call.read("values", values, value_count)? {
        let place = match given.count {
            count if count == mesh.vertex_count() => ColumnPlace::Vertices,
            count if count == mesh.triangles().len() => ColumnPlace::Triangles,
            count => {
                let of = "one for each vertex, or one for each triangle";
                return Err(Failure::count("values", count, mesh.vertex_count(), of));
            }
        };
        columns.push(Column {
            name: call.text("name", given.name)?.to_owned(),
            place,
            values: call.read("values", given.values, given.count)?.to_vec(),
        });
    }
    let made = Membrane::new(mesh, &reference, effects, columns, threads(thread_count))?;
    call.give("membrane", membrane, made)
}

twins! {
    /// Makes a membrane: a mesh and the effects that act on it.
    ///
    /// `effects` is TOML with the keys that effects have in a scene, one or more of those that hf_effect_name
    /// lists: `bending = { method = "j6", modulus = 1.0 }`. docs/SCENES.md describes them. Numbers have no units: they
    /// are in those of the caller. The `count` rows of `reference` are the positions at which effects are free of
    /// stress, and where initial areas and volumes are measured. `values` are `value_count` material parameters for
    /// `{ column = "name" }`; NULL with 0. Evaluations run on up to `threads` threads, 0 for all; no result
    /// depends on their number.
    ///
    /// On success `*membrane` is a new membrane, which hf_membrane_free frees. Fails with
    /// HF_STATUS_INVALID_EFFECTS if the text is wrong; the message names the line and what would be right.
    fn hf_membrane_new, hf_membrane_new_f32<$N>(
        mesh: *const Mesh, reference: *const [$N; 3], count: usize, effects: *const c_char,
        values: *const Values, value_count: usize, threads: usize, membrane: *mut *mut Membrane,
    ) |call| new(call, mesh, (reference, count), effects, (values, value_count), threads, membrane)
}

/// Frees a membrane; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_free(membrane: *mut Membrane) {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { free(membrane) }
}

/// Writes the warnings about the effects and the mesh, one a line, into `text`, which has room for `capacity`
/// bytes; nothing if there are none. Fails with HF_STATUS_INVALID_COUNT if there is too little room, and says
/// how much is needed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_warnings(
    membrane: *const Membrane,
    text: *mut c_char,
    capacity: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let membrane = call.object("membrane", membrane)?;
            let warnings = membrane.simulation.warnings().iter();
            let lines = warnings
                .map(|warning| format!("{}\n", warning.problem))
                .chain(membrane.left_out.iter().map(|text| format!("{text}\n")));
            call.put(&lines.collect::<String>(), text, capacity)
        })
    }
}

/// Number of effects of a membrane that are forces, or 0 if it is NULL. Constraints are not among them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_effect_count(membrane: *const Membrane) -> usize {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { membrane.as_ref() }.map_or(0, |membrane| membrane.effects.len())
}

/// Writes the name of one of the forces of a membrane; otherwise as hf_method_name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_effect_name(
    membrane: *const Membrane,
    index: usize,
    text: *mut c_char,
    capacity: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let effects = &call.object("membrane", membrane)?.effects;
            let names = Vec::from_iter(effects.iter().map(String::as_str));
            name(call, &names, index, text, capacity)
        })
    }
}

fn energy<N: Number>(
    call: &mut Call,
    membrane: *mut Membrane,
    positions: *const [N; 3],
    count: usize,
    energy: *mut N,
) -> Outcome {
    let membrane = call.object_mut("membrane", membrane)?;
    let positions = call.at_vertices("positions", positions, count, &membrane.mesh)?;
    let place = call.place("energy", energy)?;
    *place = finite_sum("energy", N::nearest(membrane.keep(&positions)?))?;
    Ok(())
}

twins! {
    /// Sets `*energy` to the sum of the energies of all effects at these positions.
    ///
    /// For bending by a method in strong form it is the quadrature `2κ Σ (H − H0)² A`, whose gradient is not the
    /// force. For bending by kantor-nelson it is `2 ∫ κ (H² − ⅔ K) dS`, 8πκ/3 for a sphere. On an open mesh the energy
    /// of bending leaves out about half a row of triangles at the boundary, as hf_membrane_warnings says. Fails with
    /// HF_STATUS_UNDEFINED if the energy is not finite.
    fn hf_membrane_energy, hf_membrane_energy_f32<$N>(
        membrane: *mut Membrane, positions: *const [$N; 3], count: usize, energy: *mut $N,
    ) |call| self::energy(call, membrane, positions, count, energy)
}

fn force<N: Number>(
    call: &mut Call,
    membrane: *mut Membrane,
    positions: *const [N; 3],
    count: usize,
    force: *mut [N; 3],
    energy: *mut N,
) -> Outcome {
    let membrane = call.object_mut("membrane", membrane)?;
    let positions = call.at_vertices("positions", positions, count, &membrane.mesh)?;
    let force = call.write("force", force, count)?;
    let place = call.write_if_wanted("energy", energy, 1)?;
    let energy = N::compute(&mut *force, |force| membrane.evaluate(&positions, force))?;
    finite("force", "vertex", force.as_flattened().iter().copied(), 3)?;
    if let Some([place]) = place {
        *place = finite_sum("energy", N::nearest(energy))?;
    }
    Ok(())
}

twins! {
    /// Sets `force`, `count` rows of three, to the nodal forces −∂E/∂x of all effects, and `*energy` to their
    /// energy unless it is NULL.
    ///
    /// Nodal forces are in units of force. Forces of bending by a method in strong form are its force density times
    /// the area of the vertex, without net force and torque. Quantities that are held exactly exert no force:
    /// see hf_membrane_constraint_gradients. Fails with HF_STATUS_UNDEFINED if a force is not finite.
    fn hf_membrane_force, hf_membrane_force_f32<$N>(
        membrane: *mut Membrane, positions: *const [$N; 3], count: usize, force: *mut [$N; 3],
        energy: *mut $N,
    ) |call| self::force(call, membrane, positions, count, force, energy)
}

fn resolve<N: Number>(
    call: &mut Call,
    membrane: *mut Membrane,
    (positions, count): (*const [N; 3], usize),
    energies: *mut N,
    forces: *mut [N; 3],
    effect_count: usize,
) -> Outcome {
    let membrane = call.object_mut("membrane", membrane)?;
    let positions = call.at_vertices("positions", positions, count, &membrane.mesh)?;
    surface(&membrane.mesh, &positions)?;
    let effects = membrane.effects.len();
    if effect_count != effects {
        return Err(Failure::count(
            "energies",
            effect_count,
            effects,
            "one for each effect",
        ));
    }
    let energies = call.write_if_wanted("energies", energies, effects)?;
    let forces = call.write_if_wanted("forces", forces, effects * count)?;
    let acting = membrane.simulation.resolve(&positions);
    if let Some(energies) = energies {
        for (place, acting) in energies.iter_mut().zip(&acting) {
            *place = N::nearest(acting.energy);
        }
        finite("energies", "effect", energies.iter().copied(), 1)?;
    }
    if let Some(forces) = forces {
        forces.fill([N::nearest(0.0); 3]);
        let rows = forces.chunks_exact_mut(count.max(1));
        for (rows, acting) in rows.zip(&acting) {
            for (place, force) in rows[acting.vertices.clone()].iter_mut().zip(&acting.force) {
                *place = force.map(N::nearest);
            }
        }
        finite("forces", "row", forces.as_flattened().iter().copied(), 3)?;
    }
    Ok(())
}

twins! {
    /// Sets `energies` to the energy of each effect, and `forces` to its nodal forces: `effect_count` numbers, and
    /// `effect_count` times `count` rows of three. Either may be NULL.
    ///
    /// The order is that of hf_membrane_effect_name.
    fn hf_membrane_effect_forces, hf_membrane_effect_forces_f32<$N>(
        membrane: *mut Membrane, positions: *const [$N; 3], count: usize, energies: *mut $N,
        forces: *mut [$N; 3], effect_count: usize,
    ) |call| resolve(call, membrane, (positions, count), energies, forces, effect_count)
}
