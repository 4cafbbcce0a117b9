//! Bending of triangulated membranes.
#![no_std]
#![forbid(unsafe_code)]
#![warn(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

extern crate alloc;

pub mod bending;
pub mod element;
mod energy;
mod lane;
pub mod laplacian;
mod mesh;
mod neighbourhood;
mod points;
mod real;
mod reduction;
pub mod shapes;
mod surface;
mod triangle;
mod vec3;

pub use bending::{GompperKroll, KantorNelson, StrongForm};
pub use element::{Execution, Serial};
pub use energy::{Conservative, Energy, Finding, Force, ForceDensity, Method, Prepared};
pub use lane::Lane;
pub use laplacian::{Bandwidth, Cotangent, Curvature, HeatKernel, LaplaceBeltrami, Rows};
pub use mesh::{MeshError, TriangleMesh, VertexKind};
pub use points::{Points, PointsMut};
pub use real::Real;
pub use surface::{Surface, SurfaceError};
pub use triangle::DualArea;
