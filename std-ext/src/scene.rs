//! Scene files: TOML text becomes plain, validated data. Nothing here runs a simulation.
//!
//! A scene names its surfaces, the effects that act on each, the driver and the outputs. What it
//! does not name does not exist: an effect that is absent is `None`, and costs nothing.
//! Every number of a [`Scene`] is in the scene's [`Units`]; numbers that the file gives with a
//! unit of their own are converted.
//!
//! Which keys there are, of which form, dimension and range, stands in one table (`keys`): the
//! parser's messages and [`json_schema`] are made from it.

mod build;
mod check;
mod driver;
mod explain;
mod keys;
mod lattice;
mod mesh_check;
mod output;
mod problem;
mod reader;
mod schema;
mod surface;
mod units;
mod value;

pub use driver::{BoundaryIntegral, Driver, Flow, Integrator, Relax, Scheme};
pub use explain::{Active, Explanation, Group, LatticeExplanation, Parameter, SurfaceExplanation};
pub(crate) use lattice::FINITE_BOX;
pub use lattice::{LatticeBoltzmann, StepLimit};
pub use output::{Every, Output, PictureField, Plot, Probe, Slice, Volume};
pub use problem::{Place, Problem, SceneError, SceneErrors};
pub use schema::json_schema;
pub use surface::{
    AreaDifferenceTarget, Bending, Elasticity, Gravity, Held, Hold, InPlaneLaw, LocalArea,
    MembraneViscosity, MeshSource, Obstacle, Orientation, Reference, ReferenceSource, Stretching,
    SurfaceScene, Target, VolumeTarget,
};
pub use value::{OverrideSyntaxError, Overrides};

use crate::info::MeshInfo;
use helfrich::{Surface, TriangleMesh};
use serde::Serialize;
use std::path::Path;

/// A validated scene: what exists, what acts on it, how it is driven and what is written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// What the scene is, in a line.
    pub title: String,
    /// The units of every number in the scene.
    pub units: Units,
    /// The surfaces, one or more, with different names.
    pub surfaces: Vec<SurfaceScene>,
    /// What acts between surfaces.
    pub interactions: Vec<Interaction>,
    /// Bodies at rest in the fluid, with different names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Obstacle>,
    /// What moves the surfaces.
    pub driver: Driver,
    /// What is written, and how often.
    pub output: Output,
}

/// The units of a scene's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Units {
    /// µm, pN and s, and what follows from them: pN·µm = 10⁻¹⁸ J, pN/µm = µN/m, pN/µm² = Pa.
    Micro,
    /// Numbers without units.
    None,
}

/// What acts between surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Interaction {
    /// Repulsion at short range, `E = ∫∫ k (1 − r²/r_c²)³ dS dS` over two surfaces.
    Repulsion {
        /// k, energy per area squared.
        strength: f64,
        /// r_c, from which on there is none.
        cutoff: f64,
        /// The two surfaces, counted from 0; every pair if `None`.
        #[serde(skip_serializing_if = "Option::is_none")]
        between: Option<[usize; 2]>,
    },
}

/// A scene as read, with what is needed to say where in its text something stands.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// What is probably not meant, each with its place: worth a line, no reason to stop.
    pub warnings: Vec<SceneError>,
    source: problem::Source,
    origins: value::Origins,
}

impl SceneFile {
    /// Reads and validates a scene file; `overrides` replace or add to its values.
    ///
    /// Paths of mesh files become relative to the scene file's folder.
    ///
    /// # Errors
    /// Everything that is wrong with it, if anything is.
    pub fn read(path: &Path, overrides: &Overrides) -> Result<Self, SceneErrors> {
        let text = problem::read_text(path)?;
        Self::parse(&text, path, overrides)
    }

    /// The same from a text; `path` is what messages call it, and what mesh files are relative to.
    ///
    /// # Errors
    /// Everything that is wrong with it, if anything is.
    pub fn parse(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, SceneErrors> {
        build::parse(text, path, overrides)
    }

    /// Compares a surface's effects with its mesh, scaled as the scene says, once that is known.
    ///
    /// # Errors
    /// Everything that the mesh does not allow.
    pub fn check_mesh(&self, surface: usize, mesh: &MeshInfo) -> Result<(), SceneErrors> {
        mesh_check::check_mesh(self, surface, mesh)
    }

    /// Whether an obstacle's mesh, scaled as the scene says, is one that fluid can flow around.
    ///
    /// # Errors
    /// If it has no inside.
    pub fn check_obstacle(&self, obstacle: usize, mesh: &MeshInfo) -> Result<(), SceneErrors> {
        mesh_check::check_obstacle(self, obstacle, mesh)
    }

    /// Whether a surface starts outside of an obstacle, and the obstacle outside of the surface.
    ///
    /// # Errors
    /// If a vertex of one is inside of the other.
    pub fn check_apart(
        &self,
        surface: usize,
        surface_positions: Surface<'_, f64>,
        obstacle: usize,
        obstacle_positions: Surface<'_, f64>,
    ) -> Result<(), SceneErrors> {
        let numbers = [surface, obstacle];
        mesh_check::check_apart(self, numbers, surface_positions, obstacle_positions)
    }

    /// A warning if a surface starts across another one.
    ///
    /// # Errors
    /// If it starts inside of the other, and the driver knows no viscosities of nested surfaces.
    pub fn check_outside(
        &self,
        numbers: [usize; 2],
        inner: Surface<'_, f64>,
        outer: Surface<'_, f64>,
    ) -> Result<Option<SceneError>, SceneErrors> {
        mesh_check::check_outside(self, numbers, inner, outer)
    }

    /// What is probably not meant about a surface and its mesh, scaled as the scene says.
    pub fn mesh_warnings(&self, surface: usize, mesh: &MeshInfo) -> Vec<SceneError> {
        mesh_check::mesh_warnings(self, surface, mesh)
    }

    /// Compares a surface's mesh with the one of a reference that it names.
    ///
    /// # Errors
    /// If the two do not have the same triangles.
    pub fn check_reference(
        &self,
        surface: usize,
        mesh: &TriangleMesh,
        reference: &TriangleMesh,
    ) -> Result<(), SceneErrors> {
        mesh_check::check_reference(self, surface, mesh, reference)
    }
}
