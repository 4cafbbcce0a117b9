//! Scene files: TOML text becomes plain, validated data. Nothing here runs a simulation. Checks and
//! explanations that need the meshes are in [`simulation`](crate::simulation).
//!
//! A scene lists its surfaces, the effects that act on each, the driver and the outputs. An absent
//! effect is `None` and costs nothing. Every number of a [`Scene`] is in the scene's [`UnitSystem`]; numbers
//! of the file with a unit are converted.
//!
//! The module `tables` lists all keys with form, dimension and range. The messages of the parser and
//! [`json_schema`] are generated from these tables.

mod boundary;
mod builder;
mod check;
mod column;
pub(crate) mod course;
mod drivers;
mod effects;
mod embedded;
mod flow;
mod keys;
mod material;
mod mesh_source;
mod output;
mod overrides;
mod parameter;
mod places;
mod population;
mod problem;
mod read;
mod reader;
mod remesh;
mod schema;
mod shipped;
mod source;
mod start;
mod surface;
mod tables;
mod units;
mod value;

pub use boundary::Boundary;
pub use column::unit_of;
pub(crate) use drivers::AXES;
pub use drivers::{BoundaryIntegral, Driver, Integrator, LatticeBoltzmann, Relax, Scheme};
#[doc(hidden)]
pub use effects::Named;
pub use effects::{
    Adhesion, AreaDifferenceTarget, Aspiration, Bending, BorderTension, EffectError, Effects,
    Elasticity, Ends, GaussianBending, Gravity, Group, HeldArea, HeldAreaDifference, HeldTargets,
    HeldVolume, Hold, InPlaneLaw, LineTension, LocalArea, MembraneViscosity, Pressure, Pull,
    Reference, ReferenceSource, Stretching, Target, Tension, VolumeTarget,
};
pub(crate) use effects::{
    Groups, MeshCheck, Preparation, Stretch, capillary_number, reduced_volume,
};
pub use flow::Flow;
pub use material::Material;
pub(crate) use mesh_source::MeshFiles;
pub use mesh_source::{MeshFileSource, MeshSource, MeshSourceError};
pub use output::{Every, Output, PictureField, Pictures, Plot, Probe, Rheology, Slice, Volume};
pub use overrides::{OverrideSyntaxError, Overrides};
pub use parameter::Parameter;
pub(crate) use parameter::Parameters;
pub use population::PopulationScene;
pub use problem::{Place, Problem, SceneError, SceneErrors};
pub use remesh::{Extent, Remesh, Topology};
pub use schema::json_schema;
#[doc(hidden)]
pub use shipped::shipped_file;
pub use shipped::{SHIPPED, ShippedScene, shipped_files};
pub use start::start_shape;
pub use surface::{ObstacleScene, Orientation, SurfaceScene};
pub(crate) use units::{Dimension, thermal_energy};

use crate::flow::lattice_boltzmann::memory;
use crate::flow::{Barrier, Course};
use crate::scalar::Scalar;
use helfrich::{Images, Repulsion};
use serde::Serialize;
use std::ops::Range;
use std::path::Path;

/// A validated scene: surfaces, effects, driver and outputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// One line that describes the scene.
    pub title: String,
    /// The units of every number in the scene.
    pub units: UnitSystem,
    /// The temperature in kelvin, if the scene has this key, or a number in the unit kT.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// The surfaces, at least one, with different names.
    pub surfaces: Vec<SurfaceScene>,
    /// Which of the surfaces are populations; they come after the others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub populations: Vec<PopulationScene>,
    /// Interactions between surfaces.
    pub interactions: Vec<InteractionScene>,
    /// Bodies at rest in the fluid, with different names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<ObstacleScene>,
    /// The driver, which moves the surfaces.
    pub driver: Driver,
    /// The course of the driver's flow.
    #[serde(skip_serializing_if = "Course::is_steady")]
    pub course: Course,
    /// The outputs and their intervals.
    pub output: Output,
}

impl Scene {
    /// The population of a surface, with its place among the populations.
    pub fn population_of(&self, surface: usize) -> Option<(usize, &PopulationScene)> {
        let mut populations = self.populations.iter().enumerate();
        populations.find(|(_, population)| population.surfaces.contains(&surface))
    }

    /// Whether a surface is a copy of the one before it, at another place.
    pub(crate) fn is_copy(&self, surface: usize) -> bool {
        let population = self.population_of(surface);
        population.is_some_and(|(_, population)| surface > population.surfaces.start)
    }

    /// The path of a surface's table, such as `surface.0`.
    pub(crate) fn path_of(&self, surface: usize) -> String {
        match self.population_of(surface) {
            Some((index, _)) => format!("population.{index}"),
            None => format!("surface.{surface}"),
        }
    }

    /// Memory of the driver's lattice in bytes: that of the populations, and that of forces and velocities at nodes,
    /// obstacles and viscosities. 0 without a lattice.
    pub(crate) fn lattice_memory(&self) -> [u64; 2] {
        let Driver::LatticeBoltzmann(lattice) = self.driver else {
            return [0; 2];
        };
        let cells = lattice.cells;
        let nodes = cells.map(|count| count as u64).iter().product::<u64>();
        let (populations, number) = match lattice.precision {
            Scalar::F32 => (memory::<f32>(cells), 4),
            _ => (memory::<f64>(cells), 8),
        };
        let populations = populations.unwrap_or(0) as u64;
        let ratio =
            |surface: &SurfaceScene| surface.viscosity_ratio.is_some_and(|ratio| ratio != 1.0);
        let contrast = u64::from(self.surfaces.iter().any(ratio));
        let labels = u64::from(!self.obstacles.is_empty());
        [populations, nodes * (number * (6 + contrast) + 2 * labels)]
    }
}

/// The units of a scene's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnitSystem {
    /// µm, pN and s, and what follows from them: pN·µm = 10⁻¹⁸ J, pN/µm = µN/m, pN/µm² = Pa.
    Micro,
    /// Numbers without units.
    None,
}

/// One side of an interaction: a surface, an obstacle, or all surfaces of a population.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Side {
    /// The first of them, counted from 0; obstacles count after the surfaces.
    pub first: usize,
    /// Their number.
    pub count: usize,
}

impl Side {
    /// Numbers of those on this side.
    pub fn range(self) -> Range<usize> {
        self.first..self.first + self.count
    }
}

impl From<usize> for Side {
    /// A single one.
    fn from(first: usize) -> Self {
        Self { first, count: 1 }
    }
}

/// An interaction between surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum InteractionScene {
    /// Short-range repulsion of two surfaces, with all their images in a periodic box: see
    /// [`helfrich::Repulsion`].
    Repulsion {
        /// k, energy per area squared.
        strength: f64,
        /// r_c, the range; there is no repulsion beyond it.
        cutoff: f64,
        /// The two sides; twice the same one for surfaces among themselves and with their own images. `None`: every pair
        /// and, in a periodic box, every surface with its own images; but on a lattice also every surface with every
        /// obstacle.
        #[serde(skip_serializing_if = "Option::is_none")]
        between: Option<[Side; 2]>,
        /// Whether parts of one surface act on each other where they face each other.
        parts: bool,
    },
    /// Adhesion of two surfaces: see [`helfrich::Repulsion::adhesion`].
    Adhesion {
        /// W, energy per area.
        energy: f64,
        /// d, the distance at which they rest.
        distance: f64,
        /// r_c > d, the range; there is no force beyond it.
        cutoff: f64,
        /// As for a repulsion.
        #[serde(skip_serializing_if = "Option::is_none")]
        between: Option<[Side; 2]>,
        /// As for a repulsion.
        parts: bool,
    },
}

impl InteractionScene {
    /// Its name, the `kind` in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Repulsion { .. } => "repulsion",
            Self::Adhesion { .. } => "adhesion",
        }
    }

    /// The pressure between the surfaces, without images.
    pub(crate) fn pressure(&self) -> Repulsion<f64> {
        match *self {
            Self::Repulsion {
                strength,
                cutoff,
                parts,
                ..
            } => Repulsion {
                modulus: strength,
                range: cutoff,
                attraction: 0.0,
                parts,
                first_group: None,
                images: Images::none(),
            },
            Self::Adhesion {
                energy,
                distance,
                cutoff,
                parts,
                ..
            } => Repulsion {
                parts,
                ..Repulsion::adhesion(energy, distance, cutoff)
            },
        }
    }

    /// The sides between which it acts; `None` for all surfaces.
    pub(crate) fn between(&self) -> Option<[Side; 2]> {
        match *self {
            Self::Repulsion { between, .. } | Self::Adhesion { between, .. } => between,
        }
    }

    /// Whether parts of one surface act on each other.
    pub(crate) fn parts(&self) -> bool {
        match *self {
            Self::Repulsion { parts, .. } | Self::Adhesion { parts, .. } => parts,
        }
    }

    /// The pressure in the form that limits of steps need.
    pub(crate) fn barrier(&self) -> Barrier {
        let pressure = self.pressure();
        Barrier {
            strength: pressure.modulus,
            cutoff: pressure.range,
            attraction: pressure.attraction,
        }
    }
}

/// A scene as read, with the places of its values in the text.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// Warnings about probable mistakes, each with its place.
    pub warnings: Vec<SceneError>,
    source: source::Source,
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
    /// Everything that is wrong with the scene.
    pub fn read(path: &Path, overrides: &Overrides) -> Result<Self, SceneErrors> {
        if let Some(shipped) = ShippedScene::named(path) {
            return Self::parse(shipped.text, &shipped.path(), overrides);
        }
        let text = source::read_text(path)?;
        Self::parse(&text, path, overrides)
    }

    /// Reads a scene from a text. `path` is its name in messages, and mesh files are relative to
    /// it.
    ///
    /// # Errors
    /// Everything that is wrong with the scene.
    pub fn parse(text: &str, path: &Path, overrides: &Overrides) -> Result<Self, SceneErrors> {
        read::parse(text, path, overrides)
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
