//! A global allocator that counts. Only a binary that names it as its `#[global_allocator]` counts.
#![expect(
    unsafe_code,
    reason = "a global allocator that counts cannot be written without"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator; counts the calls of each thread, and the bytes that it holds.
#[derive(Clone, Copy, Debug)]
pub struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
    /// Bytes taken on this thread and not given back on it.
    static BYTES: Cell<isize> = const { Cell::new(0) };
}

/// Counts a call that takes so many bytes more than it gives back.
fn count(bytes: isize) {
    CALLS.with(|calls| calls.set(calls.get() + 1));
    give_back(-bytes);
}

fn give_back(bytes: isize) {
    BYTES.with(|held| held.set(held.get() - bytes));
}

// SAFETY: every call is handed on to the system's allocator as it is; the counter allocates
// nothing, for it is initialised at compile time and has no destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller's promise, handed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        give_back(layout.size() as isize);
        // SAFETY: the caller's promise, handed on.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        // SAFETY: the caller's promise, handed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// How often `run` allocates on this thread, if [`Counting`] is the global allocator.
pub fn allocations(run: impl FnOnce()) -> usize {
    let before = CALLS.with(Cell::get);
    run();
    CALLS.with(Cell::get) - before
}

/// Result of `run`, and the number of bytes that this thread holds after it and not before, if [`Counting`]
/// is the global allocator.
pub fn held<R>(run: impl FnOnce() -> R) -> (R, isize) {
    let before = BYTES.with(Cell::get);
    let result = run();
    (result, BYTES.with(Cell::get) - before)
}
