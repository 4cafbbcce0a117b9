//! Entry point and the two system calls of the program.

use core::arch::{asm, global_asm};
use core::fmt;

/// Ends the program.
pub fn exit(code: usize) -> ! {
    #[cfg(target_arch = "x86_64")]
    const EXIT: usize = 60;
    #[cfg(target_arch = "aarch64")]
    const EXIT: usize = 93;
    // SAFETY: `exit` touches no memory.
    unsafe { call(EXIT, code, 0, 0) };
    // The kernel does not return from `exit`.
    loop {
        core::hint::spin_loop();
    }
}

/// Writes to file descriptor 2.
pub struct StandardError;

impl fmt::Write for StandardError {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        #[cfg(target_arch = "x86_64")]
        const WRITE: usize = 1;
        #[cfg(target_arch = "aarch64")]
        const WRITE: usize = 64;
        // SAFETY: `write` reads these bytes and changes nothing.
        let written = unsafe { call(WRITE, 2, text.as_ptr() as usize, text.len()) };
        if written == text.len() {
            Ok(())
        } else {
            Err(fmt::Error)
        }
    }
}

/// A system call with three arguments.
///
/// # Safety
/// The conditions of the system call itself.
#[cfg(target_arch = "x86_64")]
unsafe fn call(number: usize, first: usize, second: usize, third: usize) -> usize {
    let result;
    // SAFETY: the kernel's convention: it changes rax, rcx and r11 and no other register.
    unsafe {
        asm!(
            "syscall",
            inlateout("rax") number => result,
            in("rdi") first,
            in("rsi") second,
            in("rdx") third,
            out("rcx") _,
            out("r11") _,
            options(nostack),
        );
    }
    result
}

/// A system call with three arguments.
///
/// # Safety
/// The conditions of the system call itself.
#[cfg(target_arch = "aarch64")]
unsafe fn call(number: usize, first: usize, second: usize, third: usize) -> usize {
    let result;
    // SAFETY: the kernel's convention: it changes x0 and no other register.
    unsafe {
        asm!(
            "svc 0",
            in("x8") number,
            inlateout("x0") first => result,
            in("x1") second,
            in("x2") third,
            options(nostack),
        );
    }
    result
}

/// Personality function of unwinding. It is never called, because a panic ends the program at once, but
/// tables in the compiled `alloc` crate name it.
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}

// The kernel starts a program without a return address and, on x86-64, with a stack alignment that no
// function expects.
#[cfg(target_arch = "x86_64")]
global_asm!(
    ".globl _start",
    "_start:",
    "xor ebp, ebp",
    "and rsp, -16",
    "call {start}",
    "ud2",
    start = sym crate::start,
);

#[cfg(target_arch = "aarch64")]
global_asm!(
    ".globl _start",
    "_start:",
    "mov x29, xzr",
    "mov x30, xzr",
    "bl {start}",
    "brk #1",
    start = sym crate::start,
);
