//! Proof that `helfrich` needs no std: a program without std, C library or operating system
//! services but `write` and `exit`, that computes with methods A, B, C, the cotangent operator,
//! in-plane elasticity, membrane viscosity, repulsion and an exact constraint, and ends with 0 only
//! if the results are right.
//!
//! x86-64 and AArch64 Linux.
#![no_std]
#![no_main]
// Otherwise the loops of `memory` would be compiled to calls of themselves.
#![no_builtins]

extern crate alloc;

mod checks;
mod memory;
mod system;

/// Where the program starts, called by the few instructions in [`system`].
extern "C" fn start() -> ! {
    checks::run();
    system::exit(0)
}

#[panic_handler]
fn panic(information: &core::panic::PanicInfo<'_>) -> ! {
    use core::fmt::Write;
    // If not even that can be written, the exit code tells.
    let _ = writeln!(system::StandardError, "{information}");
    system::exit(1)
}
