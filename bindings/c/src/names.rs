//! Names of methods, effects, findings and verdicts, which other functions take and return.

use crate::call::{Call, guarded};
use crate::status::{Error, Failure, Outcome, Status};
use helfrich::Finding;
use helfrich_std::measurement::verdict_name;
use helfrich_std::method::BendingMethod;
use helfrich_std::scene::Effects;
use std::ffi::c_char;

/// Writes one of several names.
pub(crate) fn name(
    call: &mut Call,
    names: &[&str],
    index: usize,
    text: *mut c_char,
    capacity: usize,
) -> Outcome {
    let Some(name) = names.get(index) else {
        let count = names.len();
        let text = format!("`index` is {index}: there are {count} names, counted from 0");
        return Err(Failure::argument(text));
    };
    call.put(name, text, capacity)
}

/// Writes the name of a method into `text`, which has room for `capacity` bytes: 64 suffice.
///
/// `index` counts from 0. Fails with HF_STATUS_INVALID_ARGUMENT beyond the last, and with
/// HF_STATUS_INVALID_COUNT if there is too little room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_method_name(
    index: usize,
    text: *mut c_char,
    capacity: usize,
    error: *mut Error,
) -> Status {
    let names = BendingMethod::NAMED.map(BendingMethod::name);
    // SAFETY: the caller keeps the contract of this library.
    unsafe { guarded(error, |call| name(call, &names, index, text, capacity)) }
}

/// Writes the name of an effect, which is its key in the text of hf_membrane_new; otherwise as hf_method_name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_effect_name(
    index: usize,
    text: *mut c_char,
    capacity: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            name(call, Effects::NAMES, index, text, capacity)
        })
    }
}

/// Writes the name of a kind of finding, which is the bit `index` of a vertex's flags; otherwise as
/// hf_method_name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_flag_name(
    index: usize,
    text: *mut c_char,
    capacity: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            name(call, &Finding::KINDS, index, text, capacity)
        })
    }
}

/// Writes the name of a verdict of hf_measure; otherwise as hf_method_name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_verdict_name(
    index: usize,
    text: *mut c_char,
    capacity: usize,
    error: *mut Error,
) -> Status {
    let names = crate::measure::VERDICTS.map(verdict_name);
    // SAFETY: the caller keeps the contract of this library.
    unsafe { guarded(error, |call| name(call, &names, index, text, capacity)) }
}
