//! Mesh files.

mod readers;
mod writers;
