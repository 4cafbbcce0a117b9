//! Scene files: TOML text becomes plain, validated data. Nothing here runs a simulation.
//!
//! A scene names its surfaces, the effects that act on each, the driver and the outputs. An absent
//! effect is `None` and costs nothing. Every number of a [`Scene`] is in the scene's [`Units`];
//! numbers that the file gives with a unit of their own are converted.
//!
//! One table (`keys`) lists all keys with form, dimension and range. The messages of the parser and
//! [`json_schema`] are generated from it.

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
pub(crate) use surface::MeshFiles;
pub use surface::{
    MeshFileSource, MeshSource, MeshSourceError, Obstacle, Orientation, SurfaceScene,
};
pub use value::{OverrideSyntaxError, Overrides};

use crate::info::MeshInfo;
use helfrich::{Surface, TriangleMesh};
use serde::Serialize;
use std::path::Path;

/// A validated scene: surfaces, effects, driver and outputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// One line that describes the scene.
    pub title: String,
    /// The units of every number in the scene.
    pub units: Units,
    /// The temperature in kelvin, if a number of the scene is in the unit kT, or the scene names it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// The surfaces, at least one, with different names.
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
    /// Short-range repulsion of two surfaces, with all their images in a periodic box: see
    /// [`helfrich::Repulsion`].
    Repulsion {
        /// k, energy per area squared.
        strength: f64,
        /// r_c, the range; there is no repulsion beyond it.
        cutoff: f64,
        /// The two surfaces, counted from 0, or twice the same surface for its own images. `None`:
        /// every pair and, in a periodic box, every surface with its own images.
        #[serde(skip_serializing_if = "Option::is_none")]
        between: Option<[usize; 2]>,
    },
}

/// A scene as read, with the places of its values in the text.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// Warnings about probable mistakes, each with its place.
    pub warnings: Vec<SceneError>,
    source: problem::Source,
    origins: value::Origins,
    /// Mesh files that the scene was read with.
    pub(crate) meshes: MeshFiles,
}

impl SceneFile {
    /// Reads and validates a scene file; `overrides` replace or add to its values.
    ///
    /// Paths of mesh files are relative to the folder of the scene file. If there is no such file,
    /// the name may be that of a [`ShippedScene`].
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

    /// Reads a scene from a text. `path` is its name in messages, and mesh files are relative to
    /// it.
    ///
    /// # Errors
    /// Everything that is wrong with it, if anything is.
    pub fn parse(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, SceneErrors> {
        build::parse(text, path, overrides)
    }

    /// Compares the effects of a surface with its mesh, scaled as in the scene.
    ///
    /// # Errors
    /// All conflicts between effects and the mesh.
    pub fn check_mesh(&self, surface: usize, mesh: &MeshInfo) -> Result<(), SceneErrors> {
        mesh_check::check_mesh(self, surface, mesh)
    }

    /// Checks that the mesh of an obstacle, scaled as in the scene, can be an obstacle.
    ///
    /// # Errors
    /// If it has no interior.
    pub fn check_obstacle(&self, obstacle: usize, mesh: &MeshInfo) -> Result<(), SceneErrors> {
        mesh_check::check_obstacle(self, obstacle, mesh)
    }

    /// Checks that a surface and an obstacle, with their images, are outside each other at the
    /// start.
    ///
    /// # Errors
    /// If a vertex of one is inside the other.
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

    /// A warning if a surface intersects another one, or an image of it, at the start.
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

    /// A warning about the mesh of an obstacle.
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
