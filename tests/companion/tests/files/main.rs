//! Mesh files.

mod budget;
mod columns;
mod orientation;
mod polygons;
mod readers;
mod repair;
mod weld;
mod writers;
