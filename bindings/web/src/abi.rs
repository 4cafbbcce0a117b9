//! The functions that JavaScript calls. The page has one session, in one thread.
//!
//! A request is a text in JSON and any bytes, each in memory that [`allocate`] gave; [`ask`] takes both over. Part 0 of
//! the answer is its text, the others are its arrays. They stay until the next request.

#![expect(
    unsafe_code,
    reason = "JavaScript hands over pointers into the memory of WebAssembly, and its functions are foreign"
)]

use crate::{Answer, Refusal, Session};
use helfrich_std::clock;
use std::cell::RefCell;
use std::panic;
use std::time::Duration;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Tells the fraction of the work that is done.
    safe fn progress(done: f64);
    /// Milliseconds since a fixed moment.
    safe fn milliseconds() -> f64;
    /// Tells the message of a panic, before WebAssembly ends.
    fn panicked(text: *const u8, length: usize);
}

/// The session, the text of its last answer, and the answer.
#[derive(Default)]
struct Page {
    session: Session,
    text: String,
    answer: Answer,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

/// Has to be called first.
#[unsafe(no_mangle)]
extern "C" fn start() {
    clock::set(|| Duration::from_secs_f64(milliseconds() / 1000.0));
    panic::set_hook(Box::new(|panic| {
        let text = panic.to_string();
        // SAFETY: the text lives until the call has ended.
        unsafe { panicked(text.as_ptr(), text.len()) };
    }));
}

/// Memory of this many bytes, for [`ask`].
#[unsafe(no_mangle)]
extern "C" fn allocate(length: usize) -> *mut u8 {
    Box::leak(vec![0; length].into_boxed_slice()).as_mut_ptr()
}

/// Answers a request; returns the number of arrays of the answer.
///
/// # Safety
/// Both pointers come from [`allocate`] with these lengths, and are not used afterwards.
#[unsafe(no_mangle)]
unsafe extern "C" fn ask(
    request: *mut u8,
    request_length: usize,
    data: *mut u8,
    data_length: usize,
) -> usize {
    let taken = |pointer: *mut u8, length: usize| {
        let slice = std::ptr::slice_from_raw_parts_mut(pointer, length);
        // SAFETY: by the contract `allocate` leaked this box, and nobody else frees it.
        unsafe { Box::from_raw(slice) }.into_vec()
    };
    let (request, data) = (taken(request, request_length), taken(data, data_length));
    PAGE.with_borrow_mut(|page| {
        page.answer = Answer::default();
        let request = serde_json::from_slice(&request).map_err(Refusal::new);
        let answer =
            request.and_then(|request| page.session.answer(request, data, &mut progress_of));
        (page.text, page.answer) = match answer {
            Ok(answer) => (answer.to_json(), answer),
            Err(refusal) => (refusal.to_json(), Answer::default()),
        };
        page.answer.arrays.len()
    })
}

fn progress_of(done: f64) {
    progress(done);
}

/// Address and length of a part of the last answer: 0 is the text, the arrays follow.
fn part(number: usize) -> (*const u8, usize) {
    PAGE.with_borrow(|page| match number {
        0 => (page.text.as_ptr(), page.text.len()),
        _ => page.answer.arrays[number - 1].1.place(),
    })
}

/// The address of a part of the last answer.
#[unsafe(no_mangle)]
extern "C" fn part_address(number: usize) -> *const u8 {
    part(number).0
}

/// The length of a part of the last answer in bytes.
#[unsafe(no_mangle)]
extern "C" fn part_length(number: usize) -> usize {
    part(number).1
}
