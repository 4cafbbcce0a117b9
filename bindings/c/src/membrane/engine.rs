//! Membranes whose vertices are among those of an engine.

use super::Membrane;
use crate::call::{Call, finite, finite_sum, of_vertices};
use crate::number::Number;
use crate::status::{Failure, Outcome, Status};

/// Arrays of an engine that has more vertices than those of one membrane.
struct Engine<N> {
    places: *const u32,
    count: usize,
    positions: *const [N; 3],
    total: usize,
    owned: usize,
    force: *mut [N; 3],
}

fn add_force_at<N: Number>(
    call: &mut Call,
    membrane: *mut Membrane,
    engine: &Engine<N>,
    energy: *mut N,
) -> Outcome {
    let membrane = call.object_mut("membrane", membrane)?;
    of_vertices("places", engine.count, &membrane.mesh)?;
    let places = call.read("places", engine.places, engine.count)?;
    let positions = call.read("positions", engine.positions, engine.total)?;
    if engine.owned > engine.total {
        let text = format!(
            "`owned` is {}: there are {} entries",
            engine.owned, engine.total
        );
        return Err(Failure::new(Status::InvalidCount, text));
    }
    let all = call.write("force", engine.force, engine.owned)?;
    let place = call.write_if_wanted("energy", energy, 1)?;
    let mut own = Vec::with_capacity(places.len());
    for (vertex, &at) in places.iter().enumerate() {
        let position = positions.get(at as usize).ok_or_else(|| {
            let total = positions.len();
            Failure::argument(format!(
                "vertex {vertex} has the place {at} in `places`: there are {total} places, counted from 0"
            ))
        })?;
        own.push(position.map(N::wide));
    }
    let energy = finite_sum("energy", N::nearest(membrane.keep(&own)?))?;
    let components = membrane.force.as_flattened().iter();
    finite("force", "vertex", components.map(|&f| N::nearest(f)), 3)?;
    for (&at, force) in places.iter().zip(&membrane.force) {
        if let Some(sum) = all.get_mut(at as usize) {
            *sum = std::array::from_fn(|axis| N::nearest(sum[axis].wide() + force[axis]));
        }
    }
    if let Some([place]) = place {
        *place = energy;
    }
    Ok(())
}

twins! {
    /// Adds the nodal forces of a membrane whose vertices are scattered in larger arrays of an engine.
    ///
    /// The position of vertex i is row `places[i]` of `positions`, which has `total` rows; `places` has `count`
    /// entries, one for each vertex. Forces are added to the `owned` first rows of `force`, and left out at places
    /// beyond, those of ghosts: where several ranks have all vertices of a membrane as owned or ghost ones, each
    /// evaluates it and keeps its own share, and no forces are sent. Ghosts have to be unwrapped images, near
    /// their neighbours. `*energy` is set to the energy of the whole membrane unless it is NULL.
    fn hf_membrane_add_force_at, hf_membrane_add_force_at_f32<$N>(
        membrane: *mut Membrane, places: *const u32, count: usize, positions: *const [$N; 3],
        total: usize, owned: usize, force: *mut [$N; 3], energy: *mut $N,
    ) |call| {
        let engine = Engine { places, count, positions, total, owned, force };
        add_force_at(call, membrane, &engine, energy)
    }
}
