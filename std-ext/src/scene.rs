//! Scene files: TOML text becomes plain, validated data. Nothing here runs a simulation; what needs the
//! meshes, checks and explanations, is in [`simulation`](crate::simulation).
//!
//! A scene names its surfaces, the effects that act on each, the driver and the outputs. An absent
//! effect is `None` and costs nothing. Every number of a [`Scene`] is in the scene's [`Units`];
//! numbers that the file gives with a unit of their own are converted.
//!
//! One table (`keys`) lists all keys with form, dimension and range. The messages of the parser and
//! [`json_schema`] are generated from it.

mod build;
mod check;
mod driver;
mod effects;
mod keys;
mod lattice;
mod output;
mod parameter;
mod problem;
mod reader;
mod schema;
mod shipped;
mod surface;
mod units;
mod value;

pub use driver::{BoundaryIntegral, Driver, Flow, Integrator, Relax, Scheme};
pub use effects::{
    Adhesion, AreaDifferenceTarget, Bending, EffectError, Effects, Elasticity, Gravity, Group,
    HeldArea, HeldAreaDifference, HeldVolume, Hold, InPlaneLaw, LocalArea, MembraneViscosity,
    Pressure, Reference, ReferenceSource, Stretching, Target, Tension, VolumeTarget,
};
pub(crate) use effects::{
    Groups, MeshCheck, Named, Preparation, Stretch, SurfaceEffect, capillary_number, reduced_volume,
};
pub(crate) use lattice::AXES;
pub use lattice::LatticeBoltzmann;
pub use output::{Every, Output, PictureField, Plot, Probe, Slice, Volume};
pub use parameter::Parameter;
pub(crate) use parameter::Parameters;
pub use problem::{Place, Problem, SceneError, SceneErrors};
pub use schema::json_schema;
pub(crate) use shipped::shipped_file;
pub use shipped::{SHIPPED, ShippedScene, shipped_files};
pub(crate) use surface::MeshFiles;
pub use surface::{
    MeshFileSource, MeshSource, MeshSourceError, Obstacle, Orientation, SurfaceScene,
};
pub(crate) use units::{Dimension, thermal_energy};
pub use value::{OverrideSyntaxError, Overrides};

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

    /// An error at the place of a key; `path` is its path, such as `surface.0.bending`.
    pub(crate) fn contradiction(&self, path: &str, message: String) -> SceneError {
        let origin = self.origins.of(path);
        self.source
            .error(&origin, Problem::Contradiction { message })
    }

    /// A warning at the place of a key.
    pub(crate) fn doubt(&self, path: &str, message: String) -> SceneError {
        let origin = self.origins.of(path);
        self.source.error(&origin, Problem::Doubtful { message })
    }

    /// Whether the file, or an override, has the key.
    pub(crate) fn has(&self, path: &str) -> bool {
        self.origins.has(path)
    }
}
