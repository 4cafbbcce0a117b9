//! Mesh files.

mod readers;
mod weld;
mod writers;
