//! Bending of triangulated membranes.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    warn(clippy::std_instead_of_core, clippy::std_instead_of_alloc)
)]

extern crate alloc;

mod lane;
mod mesh;
mod points;
mod real;
pub mod shapes;
mod surface;
mod vec3;

pub use lane::Lane;
pub use mesh::{MeshError, TriangleMesh, VertexKind};
pub use points::{Points, PointsMut};
pub use real::Real;
