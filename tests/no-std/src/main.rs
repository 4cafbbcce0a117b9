//! Proof that `helfrich` needs no std: a program without std, C library, or operating system services except
//! `write` and `exit`. It computes with methods A, B, C, the cotangent operator, in-plane elasticity,
//! membrane viscosity, repulsion and an exact constraint, and its exit code is 0 only if the results are
//! right.
//!
//! x86-64 and AArch64 Linux.
#![no_std]
#![no_main]
// Otherwise the compiler would turn the loops of `memory` into calls of the same functions.
#![no_builtins]

extern crate alloc;

mod checks;
mod memory;
mod system;

/// Start of the program, called by the few instructions in [`system`].
extern "C" fn start() -> ! {
    checks::run();
    system::exit(0)
}

#[panic_handler]
fn panic(information: &core::panic::PanicInfo<'_>) -> ! {
    use core::fmt::Write;
    // If even writing fails, the exit code remains.
    let _ = writeln!(system::StandardError, "{information}");
    system::exit(1)
}
