//! C interface of helfrich: the functions of `include/helfrich.h`, which is generated from this crate.
//!
//! Every function that can fail returns a [`Status`](status::Status) and takes a pointer to a
//! caller-owned [`Error`](status::Error), or NULL. Nothing is global, and nothing unwinds into the caller.
//!
//! # Safety
//!
//! One contract holds for all functions. A handle is NULL, or was returned by this library and has not been
//! freed. A pointer to an array is NULL, or the array has as many entries as its count says, and nobody else
//! changes it during the call. A text is NULL, or ends with a zero byte. NULL, counts that do not fit,
//! arrays that overlap, and wrong contents are reported as errors.

#![expect(
    unsafe_code,
    reason = "pointers of callers become slices, in call.rs and where handles are freed"
)]
#![expect(
    clippy::missing_safety_doc,
    reason = "one contract for all functions: see the head of this file"
)]

#[macro_use]
mod twins;

mod call;
mod number;

pub mod beside;
pub mod many;
pub mod measure;
pub mod membrane;
pub mod mesh;
pub mod method;
pub mod names;
pub mod operator;
pub mod smooth;
pub mod status;

pub use status::{Error, Status};

/// Version of this interface: it grows when a function, a type or the meaning of an argument changes.
pub const ABI_VERSION: u32 = 1;

/// The version of the interface that this library has: compare it with `HF_ABI_VERSION` of the header.
#[unsafe(no_mangle)]
pub extern "C" fn hf_abi_version() -> u32 {
    ABI_VERSION
}

/// The version of the library, such as "0.1.0". The text is static.
#[unsafe(no_mangle)]
pub extern "C" fn hf_version() -> *const std::ffi::c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
