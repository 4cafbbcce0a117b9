//! Bending of triangulated membranes: discrete Laplace–Beltrami operators, curvatures, the Helfrich
//! bending energy and force, and what else acts on membranes.
//!
//! # From points to forces
//!
//! ```
//! use helfrich::{GompperKroll, Prepared, Surface, TriangleMesh};
//!
//! let mesh = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let points = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]];
//! let surface = Surface::new(&mesh, &points)?;
//!
//! let mut bending = Prepared::new(GompperKroll::new(1.0), &mesh);
//! let mut force = [[0.0; 3]; 4];
//! let energy = bending.add_force_and_energy(surface, &mut force);
//! assert!(energy > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`TriangleMesh`] is connectivity, validated once; [`Surface`] adds positions, read in place
//!   from any [`Points`].
//! * [`LaplaceBeltrami`] operators measure [`Curvature`] and apply to fields: [`Cotangent`],
//!   [`HeatKernel`], [`Paraboloid`], [`Jet`].
//! * [`bending`] methods give an [`Energy`], a nodal [`Force`], a [`ForceDensity`]; the exact
//!   gradients among them are [`Conservative`].
//! * [`elasticity`] in the plane is [`InPlane`] with a law, over a reference that may differ from
//!   the shape at the start: [`NeoHookean`], [`Skalak`], [`LocalArea`].
//! * A [`Functional`] is a number of each connected component: [`TotalArea`], [`EnclosedVolume`],
//!   [`TotalMeanCurvature`]. Energies are made of them ([`Penalty`], [`SurfaceTension`],
//!   [`OsmoticPressure`], [`AreaDifference`]), and [`Constraints`] hold them exactly.
//! * [`Gravity`] and [`PointLoads`] come from outside. An [`Interaction`] acts between surfaces:
//!   [`Repulsion`]. A [`Dissipation`] depends on velocities: [`MembraneViscosity`].
//! * The sum of two methods is the pair `(a, b)`; longer sums nest. [`Prepared`] holds a method with
//!   its plan and memory; [`shapes`] are surfaces known exactly.
//!
//! # Notation, signs, units
//!
//! * Triangles run counter-clockwise seen from outside; the unit normal n points outward.
//! * `Δ_S = div_S grad_S`, negative semi-definite. `H = (c₁ + c₂)/2`, positive on a sphere, so that
//!   `Δ_S x = −2 H n`. `K = c₁ c₂`.
//! * `E = 2κ ∫ H² dS`: `8πκ` for every sphere.
//! * Force `F_i = −∂E/∂x_i`, what the membrane exerts on its surroundings at a vertex, in units of
//!   force. Force density `f = 2κ [Δ_S H + 2H (H² − K)] n`, force per area of membrane.
//! * In-plane moduli are forces per length; E_s, which some give for neo-Hookean membranes, is 3 G.
//!   Positive surface tension contracts, positive osmotic pressure inflates.
//! * H is in 1/length, K in 1/length², Δ_S H in 1/length³, κ in units of energy; lengths are in
//!   whatever unit the positions have.
//! * *Pointwise* values are per area; *integrated* ones belong to a vertex and are named areas,
//!   gradients or stiffness.
//!
//! # Features
//!
//! `std` (on by default) takes elementary functions from the platform in place of `libm`; `glam`
//! and `nalgebra` let their points be read in place.
#![no_std]
#![forbid(unsafe_code)]
#![warn(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

extern crate alloc;

pub mod bending;
pub mod constraint;
mod dissipation;
pub mod elasticity;
pub mod element;
mod energy;
pub mod functional;
mod gravity;
pub mod interaction;
mod lane;
pub mod laplacian;
mod load;
mod mesh;
mod neighbourhood;
mod points;
mod projection;
mod quality;
mod real;
mod reduction;
mod reordering;
pub mod shapes;
pub mod subdivision;
mod surface;
mod triangle;
mod vec3;

pub use bending::{
    ControlPoints, GompperKroll, Juelicher, KantorNelson, LoopSubdivision, SpontaneousCurvature,
    StrongForm,
};
pub use constraint::{
    AreaDifference, Constraint, ConstraintError, Constraints, Correction, OsmoticPressure, Penalty,
    SurfaceTension, Targets,
};
pub use dissipation::{Dissipation, MembraneViscosity};
pub use elasticity::{InPlane, LocalArea, NeoHookean, ReferenceError, Skalak, StrainEnergy};
pub use element::{Execution, Serial};
pub use energy::{Conservative, Energy, Finding, Force, ForceDensity, Method, Prepared};
pub use functional::{EnclosedVolume, Functional, Quantity, TotalArea, TotalMeanCurvature};
pub use gravity::{Gravity, GravityMemory};
pub use interaction::{Interaction, Repulsion};
pub use lane::Lane;
pub use laplacian::{
    Bandwidth, Cotangent, Curvature, HeatKernel, Jet, LaplaceBeltrami, Paraboloid, Rows,
};
pub use load::{LoadError, PointLoads};
pub use mesh::{MeshError, TriangleMesh, VertexKind};
pub use points::{Points, PointsMut};
pub use projection::{
    Components, Projected, ProjectedMemory, RigidBody, remove_net_force_and_torque,
};
pub use quality::Quality;
pub use real::Real;
pub use reordering::Reordering;
pub use subdivision::Subdivision;
pub use surface::{Surface, SurfaceError};
pub use triangle::DualArea;
