//! A global allocator that counts allocations, in binaries that use it as their `#[global_allocator]`.
#![expect(
    unsafe_code,
    reason = "a global allocator that counts cannot be written without"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// System allocator that counts the calls of each thread and the bytes that the thread has allocated.
#[derive(Clone, Copy, Debug)]
pub struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
    /// Bytes allocated minus bytes freed on this thread.
    static BYTES: Cell<isize> = const { Cell::new(0) };
}

/// Counts a call that changes the number of allocated bytes by `bytes`.
fn count(bytes: isize) {
    CALLS.with(|calls| calls.set(calls.get() + 1));
    give_back(-bytes);
}

fn give_back(bytes: isize) {
    BYTES.with(|held| held.set(held.get() - bytes));
}

// SAFETY: every call is passed to the system's allocator unchanged. The counter allocates nothing,
// because it is initialised at compile time and has no destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller's guarantee is passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        give_back(layout.size() as isize);
        // SAFETY: the caller's guarantee is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        // SAFETY: the caller's guarantee is passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// Number of allocations of `run` on this thread, if [`Counting`] is the global allocator.
pub fn allocations(run: impl FnOnce()) -> usize {
    let before = CALLS.with(Cell::get);
    run();
    CALLS.with(Cell::get) - before
}

/// Result of `run`, and the number of bytes that it leaves allocated on this thread, if [`Counting`] is
/// the global allocator.
pub fn held<R>(run: impl FnOnce() -> R) -> (R, isize) {
    let before = BYTES.with(Cell::get);
    let result = run();
    (result, BYTES.with(Cell::get) - before)
}
