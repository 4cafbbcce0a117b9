//! Companion of [`helfrich`]: whatever opens a file, draws a random number, starts a thread or
//! prints.

pub mod io;
