//! Quantities of membranes that are held exactly.

use super::Membrane;
use crate::call::{finite, guarded, of_vertices, surface};
use crate::status::{Error, Failure, Status};
use helfrich_std::dynamics::Problem;

/// Number of quantities of a membrane that are held exactly, or 0 if it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_constraint_count(membrane: *const Membrane) -> usize {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { membrane.as_ref() }.map_or(0, |membrane| membrane.simulation.constraint_count())
}

/// Sets `gradients`, `constraint_count` times `count` rows of three, to the gradients of the quantities that are
/// held exactly, one quantity after the other. Forces without their components along these keep the quantities.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_constraint_gradients(
    membrane: *mut Membrane,
    positions: *const [f64; 3],
    count: usize,
    gradients: *mut [f64; 3],
    constraint_count: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let membrane = call.object_mut("membrane", membrane)?;
            let positions = call.at_vertices("positions", positions, count, &membrane.mesh)?;
            surface(&membrane.mesh, &positions)?;
            let needed = membrane.simulation.constraint_count();
            if constraint_count != needed {
                let of = "one field for each constraint";
                return Err(Failure::count("gradients", constraint_count, needed, of));
            }
            let gradients = call.write("gradients", gradients, needed * count)?;
            let mut fields = vec![vec![[0.0; 3]; count]; needed];
            membrane
                .simulation
                .constraint_gradients(&positions, &mut fields);
            gradients.copy_from_slice(&fields.concat());
            finite(
                "gradients",
                "row",
                gradients.as_flattened().iter().copied(),
                3,
            )
        })
    }
}

/// Moves `positions` so that each quantity that is held exactly has its target value, and sets `*residual` to
/// the largest relative error that remains; it is infinite if the targets cannot be reached from there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_membrane_restore(
    membrane: *mut Membrane,
    positions: *mut [f64; 3],
    count: usize,
    residual: *mut f64,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let membrane = call.object_mut("membrane", membrane)?;
            of_vertices("positions", count, &membrane.mesh)?;
            let positions = call.write("positions", positions, count)?;
            let place = call.place("residual", residual)?;
            surface(&membrane.mesh, positions)?;
            *place = membrane.simulation.restore(positions);
            Ok(())
        })
    }
}
