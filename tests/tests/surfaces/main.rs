//! Meshes and surfaces: connectivity, geometry, subdivision, exact shapes, and meshes on them.

mod adaptive;
mod detection_limit;
mod expected_errors;
mod families;
mod isosurfaces;
mod mesh;
mod noise;
mod reordering;
mod shapes;
mod subdivision;
mod surface;
