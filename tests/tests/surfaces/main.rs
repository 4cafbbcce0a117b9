//! Meshes and surfaces: connectivity, geometry, subdivision, exact shapes and what is made on them.

mod families;
mod mesh;
mod points;
mod reordering;
mod shapes;
mod subdivision;
mod surface;
