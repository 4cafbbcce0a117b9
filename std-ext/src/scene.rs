//! Scene files: TOML text becomes plain, validated data. Nothing here runs a simulation.
//!
//! A scene names its surfaces, the effects that act on each, the driver and the outputs. What it
//! does not name does not exist: an effect that is absent is `None`, and costs nothing.
//! Every number of a [`Scene`] is in the scene's [`Units`]; numbers that the file gives with a
//! unit of their own are converted.
//!
//! Which keys there are, of which form, dimension and range, stands in one table (`keys`): the
//! parser's messages and [`json_schema`] are made from it.

mod barrier;
mod build;
mod check;
mod driver;
mod effects;
mod explain;
mod keys;
mod lattice;
mod mesh_check;
mod output;
mod problem;
mod reader;
mod schema;
mod shipped;
mod surface;
mod units;
mod value;

pub use driver::{BoundaryIntegral, Driver, Flow, Integrator, Relax, Scheme};
pub use effects::{
    Adhesion, AreaDifferenceTarget, Bending, EffectError, Effects, Elasticity, Gravity, HeldArea,
    HeldAreaDifference, HeldVolume, Hold, InPlaneLaw, LocalArea, MembraneViscosity, Pressure,
    Reference, ReferenceSource, Stretching, Target, Tension, VolumeTarget,
};
pub(crate) use effects::{Named, Preparation, Stretch, SurfaceEffect};
pub use explain::{Active, Explanation, Group, LatticeExplanation, Parameter, SurfaceExplanation};
pub use lattice::FINITE_BOX;
pub use lattice::{LatticeBoltzmann, StepLimit};
pub use output::{Every, Output, PictureField, Plot, Probe, Slice, Volume};
pub use problem::{Place, Problem, SceneError, SceneErrors};
pub use schema::json_schema;
pub(crate) use shipped::shipped_file;
pub use shipped::{SHIPPED, ShippedScene, shipped_files};
pub use surface::{
    MeshFileSource, MeshSource, MeshSourceError, Obstacle, Orientation, SurfaceScene,
};
pub use value::{OverrideSyntaxError, Overrides};

use crate::info::MeshInfo;
use helfrich::{Surface, TriangleMesh};
use serde::Serialize;
use std::path::Path;

/// A validated scene: what exists, what acts on it, how it is driven and what is written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// One line that describes the scene.
    pub title: String,
    /// The units of every number in the scene.
    pub units: Units,
    /// The surfaces, one or more, with different names.
    pub surfaces: Vec<SurfaceScene>,
    /// Interactions between surfaces.
    pub interactions: Vec<Interaction>,
    /// Bodies at rest in the fluid, with different names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Obstacle>,
    /// The driver, which moves the surfaces.
    pub driver: Driver,
    /// The outputs and their intervals.
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

/// An interaction between surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Interaction {
    /// Repulsion at short range: see [`helfrich::Repulsion`]; of two surfaces and all images of
    /// these in a periodic box.
    Repulsion {
        /// k, energy per area squared.
        strength: f64,
        /// r_c, from which on there is none.
        cutoff: f64,
        /// The two surfaces, counted from 0, or twice one that has images; every pair if `None`, and
        /// in a periodic box every surface and the images of itself.
        #[serde(skip_serializing_if = "Option::is_none")]
        between: Option<[usize; 2]>,
    },
}

/// A scene as read, with what is needed to say where in its text something stands.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// Warnings about probable mistakes, each with its place.
    pub warnings: Vec<SceneError>,
    source: problem::Source,
    origins: value::Origins,
}

impl SceneFile {
    /// Reads and validates a scene file; `overrides` replace or add to its values.
    ///
    /// Paths of mesh files become relative to the scene file's folder. Where there is no file, the name
    /// of a [`ShippedScene`] stands for it.
    ///
    /// # Errors
    /// Everything that is wrong with it, if anything is.
    pub fn read(path: &Path, overrides: &Overrides) -> Result<Self, SceneErrors> {
        if let Some(shipped) = ShippedScene::named(path) {
            return Self::parse(shipped.text, &shipped.path(), overrides);
        }
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

    /// Whether a surface starts outside of an obstacle, and the obstacle outside of the surface, their
    /// images included.
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

    /// A warning if a surface starts across another one, or across an image of it.
    pub fn check_outside(
        &self,
        numbers: [usize; 2],
        inner: Surface<'_, f64>,
        outer: Surface<'_, f64>,
    ) -> Option<SceneError> {
        mesh_check::check_outside(self, numbers, inner, outer)
    }

    /// Warnings about a surface and its mesh, scaled as the scene demands.
    pub fn mesh_warnings(&self, surface: usize, mesh: &MeshInfo) -> Vec<SceneError> {
        mesh_check::mesh_warnings(self, surface, mesh)
    }

    /// A doubt about the mesh of an obstacle.
    pub fn obstacle_warning(&self, obstacle: usize, mesh: &MeshInfo) -> Option<SceneError> {
        mesh_check::obstacle_warning(self, obstacle, mesh)
    }

    /// Compares a surface's mesh with the one of the reference that an effect of it names.
    ///
    /// # Errors
    /// If the two do not have the same triangles.
    pub fn check_reference(
        &self,
        surface: usize,
        effect: &str,
        mesh: &TriangleMesh,
        reference: &TriangleMesh,
    ) -> Result<(), SceneErrors> {
        mesh_check::check_reference(self, surface, effect, mesh, reference)
    }
}
