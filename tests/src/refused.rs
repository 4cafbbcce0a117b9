//! Code that the compiler must refuse, each next to code that it must accept.
//!
//! ```
//! let mesh = helfrich_tests::meshes::tetrahedron();
//! let points: Vec<glam::Vec3> = mesh.positions_in().into_iter().map(glam::Vec3::from).collect();
//! helfrich::Surface::new(&mesh.connectivity, &points).unwrap();
//! ```
//!
//! The padded vector, which differs in nothing else (error E0277, a trait that is not implemented,
//! with the notes of `Points`):
//!
//! ```compile_fail,E0277
//! let mesh = helfrich_tests::meshes::tetrahedron();
//! let points: Vec<glam::Vec3A> = mesh.positions_in().into_iter().map(glam::Vec3A::from).collect();
//! helfrich::Surface::new(&mesh.connectivity, &points).unwrap();
//! ```
