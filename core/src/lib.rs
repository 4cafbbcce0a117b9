//! Bending of triangulated membranes: discrete Laplace–Beltrami operators, curvatures, the Helfrich
//! bending energy and force, and other effects that act on membranes.
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
//! * [`LaplaceBeltrami`] operators measure [`Curvatures`] and apply to fields: [`Cotangent`],
//!   [`HeatKernel`], [`Paraboloid`], [`Jet`].
//! * [`SmoothSurface`] is the surface of the fits of [`Jet`] between the vertices.
//! * [`Cotangent`] has the stiffness and mass matrices of linear finite elements, as
//!   [`SparseMatrix`] for any solver, with gradient and divergence.
//! * [`bending`] methods give an [`Energy`], a nodal [`Force`], a [`ForceDensity`]; the exact
//!   gradients among them are [`Conservative`].
//! * [`elasticity`] in the plane is [`InPlane`] with a law, over a reference that may differ from
//!   the shape at the start: [`NeoHookean`], [`Skalak`], [`LocalArea`].
//! * A [`Functional`] is a number of each connected component: [`TotalArea`], [`EnclosedVolume`],
//!   [`TotalMeanCurvature`], [`TotalGaussianCurvature`], [`BoundaryLength`]. Energies are made of them
//!   ([`Penalty`], [`SurfaceTension`], [`OsmoticPressure`], [`AreaDifference`], and of open edges
//!   [`LineTension`] and [`GaussianBending`]), and [`Constraints`] hold them exactly.
//! * [`GaussianDomains`] and [`BorderTension`] are energies of parts of a membrane with other
//!   parameters.
//! * [`Gravity`], [`PointLoads`], [`EndPull`] and [`WallAdhesion`] are external forces.
//!   [`Repulsion`] is an [`Interaction`], which acts between surfaces. [`MembraneViscosity`] is a
//!   [`Dissipation`], which depends on velocities.
//! * The sum of two methods is the pair `(a, b)`; longer sums nest. [`Prepared`] holds a method with
//!   its [`Workspace`]; [`shapes`] are surfaces known exactly.
//!
//! # Notation, signs, units
//!
//! * Triangles run counter-clockwise seen from outside; the unit normal n points outward.
//! * `Δ_S = div_S grad_S`, negative semi-definite. `H = (c₁ + c₂)/2`, positive on a sphere, so that
//!   `Δ_S x = −2 H n`. `K = c₁ c₂`.
//! * `E = 2κ ∫ H² dS`: `8πκ` for every sphere.
//! * Force `F_i = −∂E/∂x_i`: the force that the membrane exerts on its surroundings at a vertex.
//!   Force density `f = 2κ [Δ_S H + 2H (H² − K)] n`, force per area of membrane.
//! * In-plane moduli are forces per length; some authors give E_s = 3 G for neo-Hookean membranes.
//!   Positive surface tension contracts, positive osmotic pressure inflates.
//! * H is in 1/length, K in 1/length², Δ_S H in 1/length³, κ in units of energy; lengths are in
//!   whatever unit the positions have.
//! * *Pointwise* values are per area; *integrated* ones belong to a vertex and are named areas, mass,
//!   stiffness, gradients of an energy or functional, or integrated.
//!
//! # Features
//!
//! `std` (on by default) takes elementary functions from the platform instead of `libm`. `glam` and
//! `nalgebra` make the points of these crates readable in place.
#![no_std]
#![forbid(unsafe_code)]
#![warn(clippy::std_instead_of_core, clippy::std_instead_of_alloc)]

extern crate alloc;

mod adhesion;
mod any_functional;
mod aspiration;
pub mod bending;
mod components;
pub mod constraint;
mod corrected_curvature;
mod curvature;
mod diagnostic;
mod dissipation;
mod domains;
pub mod edit;
pub mod elasticity;
pub mod element;
mod end_pull;
mod face_tree;
mod fit;
pub mod functional;
mod gravity;
mod hinge;
mod indices;
pub mod interaction;
mod lane;
pub mod laplacian;
mod load;
mod mesh;
mod mesh_identity;
mod method;
mod neighbourhood;
mod noise;
mod parameter;
mod points;
mod prepared;
mod projection;
mod quality;
mod real;
mod reduction;
mod remesh;
mod reordering;
mod self_crossing;
pub mod shapes;
mod smooth_surface;
mod sparse_matrix;
pub mod subdivision;
mod surface;
mod triangle;
mod vec3;

pub use adhesion::{WallAdhesion, WallAdhesionMemory};
pub use any_functional::{AnyFunctional, AnyFunctionalMemory};
pub use aspiration::{Aspiration, AspirationMemory};
pub use bending::{
    ControlPoints, Galerkin, GompperKroll, Hamann, Juelicher, KantorNelson, LoopSubdivision,
    MaterialParameter, PatchFunctional, StrongForm,
};
pub use components::{Components, Part};
pub use constraint::{
    AreaDifference, Constraint, ConstraintError, Constraints, Correction, GaussianBending,
    LineTension, OsmoticPressure, Penalty, SurfaceTension, Targets,
};
pub use corrected_curvature::{CorrectedCurvature, CorrectedCurvatureMemory, VertexNormals};
pub use curvature::{Curvature, Curvatures};
pub use diagnostic::{Finding, Quality};
pub use dissipation::{Dissipation, MembraneViscosity};
pub use domains::{BorderTension, GaussianDomains, GaussianDomainsMemory};
pub use elasticity::{InPlane, LocalArea, NeoHookean, ReferenceError, Skalak, StrainEnergy};
pub use element::{Execution, Serial};
pub use end_pull::{EndPull, EndPullMemory};
pub use face_tree::MeshPoint;
pub use functional::{
    BoundaryLength, EnclosedVolume, Functional, TotalArea, TotalGaussianCurvature,
    TotalMeanCurvature,
};
pub use gravity::{Gravity, GravityMemory};
pub use indices::TriangleIndices;
pub use interaction::{Images, Interaction, Repulsion};
pub use lane::Lane;
pub use laplacian::{Bandwidth, Cotangent, HeatKernel, Jet, LaplaceBeltrami, Paraboloid, Rows};
pub use load::{LoadError, PointLoads};
pub use mesh::{MeshError, TriangleMesh, VertexKind};
pub use method::{
    Conservative, Energy, Force, ForceDensity, Method, ParameterError, TwoPass, Workspace,
};
pub use noise::{
    AdaptiveJet, Cause, Estimate, FitExtent, Measured, Noise, Scale, Smoothing, Verdict,
};
pub use points::{Points, PointsMut};
pub use prepared::Prepared;
pub use projection::{Projected, ProjectedMemory, RigidBody, remove_net_force_and_torque};
pub use real::Real;
pub use remesh::{Remeshed, Remeshing};
pub use reordering::Reordering;
pub use self_crossing::crossing_triangles;
pub use smooth_surface::{FieldPoint, SmoothFields, SmoothPoint, SmoothSurface};
pub use sparse_matrix::SparseMatrix;
pub use subdivision::Subdivision;
pub use surface::{Surface, SurfaceError};
pub use triangle::DualArea;
