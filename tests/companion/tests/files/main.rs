//! Mesh files.

mod columns;
mod readers;
mod weld;
mod writers;
