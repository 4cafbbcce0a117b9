//! Many membranes at once, on several threads.

use crate::call::{Call, finite, finite_sum};
use crate::membrane::{Membrane, threads};
use crate::number::Number;
use crate::status::{Failure, Outcome};
use helfrich_std::execute::in_parts;
use std::sync::{Mutex, PoisonError};

/// A membrane with its parts of the arrays.
type Task<'a, N> = (
    usize,
    &'a mut Membrane,
    &'a [[N; 3]],
    &'a mut [[N; 3]],
    &'a mut N,
);

fn forces<N: Number + Send + Sync>(
    call: &mut Call,
    (membranes, count): (*const *mut Membrane, usize),
    positions: *const [N; 3],
    forces: *mut [N; 3],
    total: usize,
    energies: *mut N,
    thread_count: usize,
) -> Outcome {
    let handles = call.read("membranes", membranes, count)?;
    let mut positions = call.read("positions", positions, total)?;
    let mut forces = call.write("forces", forces, total)?;
    let energies = call.write("energies", energies, count)?;
    let mut tasks: Vec<Task<'_, N>> = Vec::with_capacity(count);
    let mut vertices = 0_usize;
    let membranes = call.objects_mut("membranes", handles)?;
    for (index, (membrane, energy)) in membranes.into_iter().zip(energies).enumerate() {
        let own = membrane.vertex_count();
        vertices += own;
        if own > positions.len() {
            let of = format!("one for each vertex of membranes 0 to {index}");
            return Err(Failure::count("positions", total, vertices, &of));
        }
        let (at, after) = positions.split_at(own);
        let (force, left) = std::mem::take(&mut forces).split_at_mut(own);
        (positions, forces) = (after, left);
        tasks.push((index, membrane, at, force, energy));
    }
    if !positions.is_empty() {
        let of = "one for each vertex of all membranes";
        return Err(Failure::count("positions", total, vertices, of));
    }
    let workers = threads(thread_count).get().min(tasks.len());
    let queue = Mutex::new(tasks.into_iter());
    let failed: Mutex<Option<(usize, Failure)>> = Mutex::new(None);
    in_parts(0..workers, &|_| {
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((index, membrane, at, force, energy)) = next else {
                return;
            };
            let at = N::widen(at);
            let found = N::compute(&mut *force, |force| membrane.evaluate(&at, force));
            let found = found.and_then(|energy| {
                finite("force", "vertex", force.as_flattened().iter().copied(), 3)?;
                finite_sum("energy", N::nearest(energy))
            });
            match found {
                Ok(value) => *energy = value,
                Err(failure) => {
                    let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                    if failed.as_ref().is_none_or(|(first, _)| index < *first) {
                        *failed = Some((index, failure));
                    }
                }
            }
        }
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        None => Ok(()),
        Some((index, failure)) => Err(Failure {
            text: format!("membrane {index}: {}", failure.text),
            ..failure
        }),
    }
}

twins! {
    /// Evaluates many membranes on up to `threads` threads, 0 for all: nodal forces and energies, as by
    /// hf_membrane_force of each, to the last bit.
    ///
    /// `membranes` has `count` different membranes, which should have been made for one thread each. `positions` and
    /// `forces` have the rows of all membranes one after the other, `total` in all; `energies` has `count`
    /// numbers. If a membrane fails, the error is that of the first one, and the results of the others are valid.
    fn hf_membranes_force, hf_membranes_force_f32<$N>(
        membranes: *const *mut Membrane, count: usize, positions: *const [$N; 3],
        forces: *mut [$N; 3], total: usize, energies: *mut $N, threads: usize,
    ) |call| self::forces(call, (membranes, count), positions, forces, total, energies, threads)
}
