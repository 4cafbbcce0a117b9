//! The bending methods.
//!
//! At a boundary, methods with an energy sum over what surrounds interior vertices: hinges (A), interior
//! vertices (B, Jülicher, Hamann) or triangles with interior corners only (S, G). About half a row of triangles
//! is left out, so that energies of surfaces that bend there have an error of first order in the edge length.
//! Forces act on all vertices, and those at the boundary are the natural boundary conditions. Methods in
//! strong form have no forces at a boundary; the energies of those over jets include it.

mod area_vectors;
mod galerkin;
mod gompper_kroll;
mod hamann;
mod juelicher;
mod kantor_nelson;
mod loop_subdivision;
mod material_parameter;
mod strong_form;
mod surface_point;

pub use crate::hinge::{Hinge, HingeMemory, Hinges, OverHinges};
pub(crate) use area_vectors::{AreaVectorForce, AreaVectors};
pub use galerkin::{Galerkin, GalerkinMemory, PatchFunctional, PatchFunctionalMemory};
pub use gompper_kroll::{GompperKroll, GompperKrollMemory};
pub use hamann::{Hamann, HamannMemory};
pub use juelicher::{Juelicher, JuelicherMemory};
pub use kantor_nelson::{FlatReference, KantorNelson, ReferenceAngles};
pub use loop_subdivision::{
    ConsistentMemory, ControlPoints, LoopSubdivision, LoopSubdivisionMemory,
};
pub use material_parameter::MaterialParameter;
pub use strong_form::{StrongForm, StrongFormMemory};
