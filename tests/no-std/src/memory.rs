//! Parts of a C library: a memory allocator that never frees, and the functions on bytes that compiled code
//! calls.

use core::alloc::{GlobalAlloc, Layout};
use core::cell::UnsafeCell;
use core::ptr::null_mut;
use core::sync::atomic::{AtomicUsize, Ordering};

/// Size of all memory; the checks need about a tenth of it.
const SIZE: usize = 16 << 20;

struct Bump {
    memory: UnsafeCell<[u8; SIZE]>,
    used: AtomicUsize,
}

// SAFETY: the atomic counter hands out each byte once.
unsafe impl Sync for Bump {}

#[global_allocator]
static BUMP: Bump = Bump {
    memory: UnsafeCell::new([0; SIZE]),
    used: AtomicUsize::new(0),
};

// SAFETY: every block lies in `memory`, is aligned as requested, and overlaps no other.
unsafe impl GlobalAlloc for Bump {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let start = self.memory.get().cast::<u8>();
        // This size suffices for the block at any alignment of its start.
        let size = layout.size() + layout.align() - 1;
        let offset = self.used.fetch_add(size, Ordering::Relaxed);
        if offset + size > SIZE {
            return null_mut();
        }
        let padding = (start as usize + offset).wrapping_neg() % layout.align();
        start.wrapping_add(offset + padding)
    }

    unsafe fn dealloc(&self, _block: *mut u8, _layout: Layout) {}
}

/// C's `memcpy`.
///
/// # Safety
/// Both have `count` bytes, and do not overlap.
#[unsafe(no_mangle)]
unsafe extern "C" fn memcpy(target: *mut u8, source: *const u8, count: usize) -> *mut u8 {
    for at in 0..count {
        // SAFETY: `at` is below `count`.
        unsafe { *target.add(at) = *source.add(at) };
    }
    target
}

/// C's `memmove`.
///
/// # Safety
/// Both have `count` bytes.
#[unsafe(no_mangle)]
unsafe extern "C" fn memmove(target: *mut u8, source: *const u8, count: usize) -> *mut u8 {
    if target as usize <= source as usize {
        // SAFETY: going up, a byte is read before it is overwritten.
        return unsafe { memcpy(target, source, count) };
    }
    for at in (0..count).rev() {
        // SAFETY: `at` is below `count`; going down, a byte is read before it is overwritten.
        unsafe { *target.add(at) = *source.add(at) };
    }
    target
}

/// C's `memset`.
///
/// # Safety
/// `target` has `count` bytes.
#[unsafe(no_mangle)]
unsafe extern "C" fn memset(target: *mut u8, byte: i32, count: usize) -> *mut u8 {
    for at in 0..count {
        // SAFETY: `at` is below `count`.
        unsafe { *target.add(at) = byte as u8 };
    }
    target
}

/// C's `memcmp`.
///
/// # Safety
/// Both have `count` bytes.
#[unsafe(no_mangle)]
unsafe extern "C" fn memcmp(left: *const u8, right: *const u8, count: usize) -> i32 {
    for at in 0..count {
        // SAFETY: `at` is below `count`.
        let (left, right) = unsafe { (*left.add(at), *right.add(at)) };
        if left != right {
            return i32::from(left) - i32::from(right);
        }
    }
    0
}

/// C's `bcmp`, whose result only tells whether there is a difference.
///
/// # Safety
/// Both have `count` bytes.
#[unsafe(no_mangle)]
unsafe extern "C" fn bcmp(left: *const u8, right: *const u8, count: usize) -> i32 {
    // SAFETY: the same contract.
    unsafe { memcmp(left, right, count) }
}
