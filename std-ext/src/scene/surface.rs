//! A surface of a scene: its mesh, position and effects.

use super::effects::Effects;
use crate::generate::{AnyShape, Family};
use crate::io::{MeshFile, ReadError, read, read_welded};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

/// One surface and the effects that act on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceScene {
    /// The surface's name; `surface-1` and so on for those without one.
    pub name: String,
    /// The source of its mesh.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is rotated and moved.
    pub scale: f64,
    /// Position of the mesh's origin.
    pub position: [f64; 3],
    /// Rotation of the mesh about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
    /// Viscosity ratio λ of the fluid inside to the fluid of the driver, which is outside of all
    /// surfaces. Only flow drivers use viscosities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscosity_ratio: Option<f64>,
    /// The effects that act on it.
    #[serde(flatten)]
    pub effects: Effects,
}

impl SurfaceScene {
    /// Whether the membrane has no memory of the positions of its material, so that vertices may be
    /// moved along it.
    pub fn is_fluid(&self) -> bool {
        !self.effects.iter().any(|(_, effect)| effect.is_solid())
    }

    /// Whether vertices may slide along the surface in a flow: the surface is fluid, and no vertex
    /// is loaded.
    pub fn slides(&self) -> bool {
        self.is_fluid() && self.effects.stretching.is_none()
    }

    /// Whether bending or surface tension limits explicit steps in a flow.
    pub fn is_stiff(&self) -> bool {
        self.effects.bending.is_some() || self.effects.tension.is_some()
    }

    /// Whether all effects are gradients of energies, unlike bending by a method in strong form.
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
    /// The source of its mesh.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is rotated and moved.
    pub scale: f64,
    /// Position of the mesh's origin.
    pub position: [f64; 3],
    /// Rotation of the mesh about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
}

/// The source of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshSource {
    /// Generated on an exact shape: [`crate::generate::generate`].
    Shape {
        /// The shape.
        #[serde(serialize_with = "as_text")]
        shape: AnyShape,
        /// The family: the distribution of vertices.
        #[serde(serialize_with = "as_text")]
        family: Family,
        /// Number of vertices.
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
    /// Whether vertices at the same point are merged. With `None` a mesh with split vertices is
    /// refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weld: Option<bool>,
}

impl MeshFileSource {
    /// Reads the file.
    ///
    /// # Errors
    /// If the file cannot be read, or its mesh has split vertices and `weld` is not set; see
    /// [`MeshSourceError`].
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

/// Mesh files that have been read, so that each is read once.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshFiles {
    known: Vec<(MeshFileSource, Arc<MeshFile>)>,
}

impl MeshFiles {
    /// The content of a file, read now or before.
    ///
    /// # Errors
    /// As [`MeshFileSource::read`].
    pub(crate) fn read(
        &mut self,
        source: &MeshFileSource,
    ) -> Result<Arc<MeshFile>, MeshSourceError> {
        if let Some((_, file)) = self.known.iter().find(|(known, _)| known == source) {
            return Ok(Arc::clone(file));
        }
        let file = Arc::new(source.read()?);
        self.known.push((source.clone(), Arc::clone(&file)));
        Ok(file)
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

/// The reason why a mesh file of a scene cannot be used. The message is one line that starts with
/// the name of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshSourceError {
    /// The file cannot be read or welded.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The mesh has split vertices: boundary vertices with the same positions.
    #[error(
        "{}: the mesh has split vertices: {count} vertices of its boundary are at the same points as others: \
         `weld = true` beside `mesh` merges them, `weld = false` keeps them apart", path.display()
    )]
    Split {
        /// The file.
        path: PathBuf,
        /// Number of split vertices.
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
