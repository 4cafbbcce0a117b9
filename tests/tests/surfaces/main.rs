//! Meshes and surfaces: connectivity, geometry, subdivision, exact shapes, and meshes on them.

mod adaptive;
mod bars;
mod detection_limit;
mod edit;
mod expected_errors;
mod families;
mod isosurfaces;
mod many_shapes;
mod mesh;
mod noise;
mod parting;
mod remesh;
mod reordering;
mod rows;
mod shapes;
mod smooth_fields;
mod smooth_surface;
mod smoothing;
mod subdivision;
mod surface;
