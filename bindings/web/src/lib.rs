//! The page of helfrich: a mesh in a browser, its curvatures with error bars, and what is doubtful about them.
//!
//! A [`Session`] holds one mesh, and gives an [`Answer`] to each [`Request`]. It needs neither files nor threads, and is
//! the same natively and in WebAssembly. `abi.rs` hands requests and answers to JavaScript. All words, names and units
//! of the page come from here.

#[cfg(target_family = "wasm")]
mod abi;
mod answer;
mod example;
mod relax;
mod results;
mod session;

pub use answer::{Answer, Array, Refusal};
pub use session::{Request, Session};
