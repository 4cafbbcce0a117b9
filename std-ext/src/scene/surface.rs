//! A surface of a scene: its mesh and where it is put.

use super::effects::Effects;
use crate::generate::{AnyShape, Family};
use crate::io::{MeshFile, ReadError, read, read_welded};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// One surface and the effects that act on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceScene {
    /// The surface's name; `surface-1` and so on for those without one.
    pub name: String,
    /// Where its mesh comes from.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is turned and moved.
    pub scale: f64,
    /// Where the mesh's origin is put.
    pub position: [f64; 3],
    /// How the mesh is turned about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
    /// Viscosity inside over that of the driver's fluid, which is outside of all surfaces, λ. Only flow
    /// drivers know viscosities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscosity_ratio: Option<f64>,
    /// The effects that act on it.
    #[serde(flatten)]
    pub effects: Effects,
}

impl SurfaceScene {
    /// Whether the membrane has no memory of where its material was: vertices may be moved along
    /// it.
    pub fn is_fluid(&self) -> bool {
        !self.effects.iter().any(|(_, effect)| effect.is_solid())
    }

    /// Whether vertices may slide along the surface in a flow: it is fluid, and none is pulled.
    pub fn slides(&self) -> bool {
        self.is_fluid() && self.effects.stretching.is_none()
    }

    /// Whether bending or surface tension limits explicit steps in a flow.
    pub fn is_stiff(&self) -> bool {
        self.effects.bending.is_some() || self.effects.tension.is_some()
    }

    /// Whether all effects are gradients of energies: bending by a method in strong form is not.
    pub fn is_conservative(&self) -> bool {
        let bending = self.effects.bending;
        bending.is_none_or(|bending| bending.method.is_conservative())
    }
}

/// A closed body at rest in the fluid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Obstacle {
    /// The obstacle's name; `obstacle-1` and so on for those without one.
    pub name: String,
    /// Where its mesh comes from.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is turned and moved.
    pub scale: f64,
    /// Where the mesh's origin is put.
    pub position: [f64; 3],
    /// How the mesh is turned about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
}

/// Where a mesh comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshSource {
    /// Generated on an exact shape: [`crate::generate::generate`].
    Shape {
        /// The shape.
        #[serde(serialize_with = "as_text")]
        shape: AnyShape,
        /// How vertices are spread over it.
        #[serde(serialize_with = "as_text")]
        family: Family,
        /// How many there are.
        vertices: usize,
        /// Seed of the families that are random.
        seed: u64,
        /// Whether the mesh is scaled so that it encloses the shape's volume.
        match_volume: bool,
    },
    /// Read from a mesh file.
    File(MeshFileSource),
}

/// A mesh file, and whether vertices at the same point are one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MeshFileSource {
    /// The file.
    pub path: PathBuf,
    /// Whether vertices at the same point are made one; `None` if nothing is said of it: then a mesh
    /// that is cut where it need not be is refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weld: Option<bool>,
}

impl MeshFileSource {
    /// Reads the file.
    ///
    /// # Errors
    /// If it cannot be read, or its mesh is cut and nothing is said of that; see [`MeshSourceError`].
    pub fn read(&self) -> Result<MeshFile, MeshSourceError> {
        let Self { path, weld } = self;
        if *weld == Some(true) {
            return Ok(read_welded(path)?);
        }
        let file = read(path)?;
        match file.split_vertices() {
            count if count > 0 && weld.is_none() => Err(MeshSourceError::Split {
                path: path.clone(),
                count,
            }),
            _ => Ok(file),
        }
    }
}

impl fmt::Display for MeshFileSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let welded = if self.weld == Some(true) {
            ", welded"
        } else {
            ""
        };
        write!(f, "{}{welded}", self.path.display())
    }
}

/// Why a scene's mesh file cannot be used. The message is one line that starts with the file's name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshSourceError {
    /// It cannot be read, or welded.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Vertices at its boundary are at the points of others there.
    #[error(
        "{}: the mesh is cut where it need not be: {count} vertices at its boundary are at the points of \
         others there: `weld = true` beside `mesh` makes one vertex of each, `weld = false` leaves them \
         apart", path.display()
    )]
    Split {
        /// The file.
        path: PathBuf,
        /// How many vertices.
        count: usize,
    },
}

pub(super) fn as_text<S: serde::Serializer>(
    value: &impl std::fmt::Display,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Orientation {
    /// The axis, of any length above 0.
    pub axis: [f64; 3],
    /// The angle in degrees, right-handed about the axis.
    pub angle: f64,
}
