//! Meshes for [`helfrich`]: files, generators, inspection and sections.
//!
//! * [`io`]: mesh files. [`generate`]: mesh families on exact shapes.
//! * [`info`]: properties of a mesh. [`subdivide`]: refined meshes.
//! * [`section`]: sections of a surface by a plane. [`enclosure`]: points inside closed surfaces.
//! * [`orientation`]: components that are inside out. [`polygon`]: polygons divided into triangles.
//! * [`packing`]: bodies placed at random in a box.
//! * [`repair`]: meshes made of triangles that are none. [`parting`]: necks that are cut, and holes that are closed.

pub mod enclosure;
pub mod generate;
pub mod info;
pub mod io;
pub mod orientation;
pub mod packing;
pub mod parting;
pub mod polygon;
pub mod repair;
pub mod section;
pub mod subdivide;
