//! Meshes of a scene: generated, or from files.

use super::keys::{Form, Key, optional};
use super::shipped_file;
use crate::generate::{AnyShape, Family};
use crate::io::{
    Column, Format, MeshFile, ReadError, parse_with_columns, read, read_welded, read_with_columns,
};
use crate::noise::Quieted;
use helfrich::Surface;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

pub(super) const WELD: Key = optional(
    "weld",
    Form::Switch,
    "Whether vertices of the mesh file at the same point are merged, which is necessary for files \
     with separate vertices for each face; unless this key is given, such files are refused.",
);

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

/// A mesh file, and the treatment of vertices at the same point. Errors do not quote the file, because the
/// scene of somebody else may name any.
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
            return Ok(read_welded(path).map_err(ReadError::without_words)?);
        }
        if shipped_file(path).is_some() {
            let (file, _) = self.read_with_columns()?;
            return Ok(file);
        }
        self.whole(read(path).map_err(ReadError::without_words)?)
    }

    /// Reads the file, which may be that of a shipped scene, with the numbers at its vertices and
    /// triangles, which are not welded.
    fn read_with_columns(&self) -> Result<(MeshFile, Vec<Column>), MeshSourceError> {
        let path = &self.path;
        let (file, columns) = match (shipped_file(path), Format::from_extension(path)) {
            (Some(bytes), Some(format)) => {
                let parsed = parse_with_columns(bytes, format);
                parsed.map_err(|error| ReadError::Parse {
                    path: path.clone(),
                    error,
                })?
            }
            _ => read_with_columns(path).map_err(ReadError::without_words)?,
        };
        Ok((self.whole(file)?, columns))
    }

    /// Refuses a mesh with split vertices, unless the scene allows them.
    fn whole(&self, file: MeshFile) -> Result<MeshFile, MeshSourceError> {
        match file.split_vertices() {
            count if count > 0 && self.weld.is_none() => Err(MeshSourceError::Split {
                path: self.path.clone(),
                count,
            }),
            _ => Ok(file),
        }
    }
}

/// Mesh files that have been read, so that each is read only once.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshFiles {
    known: Vec<Known>,
}

/// A file that has been read.
#[derive(Clone, Debug)]
struct Known {
    source: MeshFileSource,
    file: Arc<MeshFile>,
    /// The numbers at its vertices and triangles, if they were requested.
    columns: Option<Vec<Arc<Column>>>,
    /// The surface without noise, if it was requested and the file has noise.
    quieted: Option<Option<Arc<Quieted>>>,
}

impl MeshFiles {
    /// A mesh in memory under the name of a file, with numbers at its vertices and triangles. Its noise
    /// stays.
    pub(super) fn in_memory(source: MeshFileSource, file: MeshFile, columns: Vec<Column>) -> Self {
        let known = Known {
            source,
            file: Arc::new(file),
            columns: Some(columns.into_iter().map(Arc::new).collect()),
            quieted: Some(None),
        };
        Self { known: vec![known] }
    }

    /// The content of a file, which is read at the first request.
    ///
    /// # Errors
    /// As [`MeshFileSource::read`].
    pub(crate) fn read(
        &mut self,
        source: &MeshFileSource,
    ) -> Result<Arc<MeshFile>, MeshSourceError> {
        if let Some(known) = self.known.iter().find(|known| known.source == *source) {
            return Ok(Arc::clone(&known.file));
        }
        let file = Arc::new(source.read()?);
        self.known.push(Known {
            source: source.clone(),
            file: Arc::clone(&file),
            columns: None,
            quieted: None,
        });
        Ok(file)
    }

    /// The numbers at the vertices and triangles of a file that is not welded, which are read at the
    /// first request.
    ///
    /// # Errors
    /// As [`MeshFileSource::read`], and if a column cannot be read.
    pub(crate) fn columns(
        &mut self,
        source: &MeshFileSource,
    ) -> Result<Vec<Arc<Column>>, MeshSourceError> {
        let of_source = |known: &&Known| known.source == *source;
        let known = self.known.iter().find(of_source);
        if let Some(columns) = known.and_then(|known| known.columns.clone()) {
            return Ok(columns);
        }
        let (file, columns) = source.read_with_columns()?;
        let columns = Vec::from_iter(columns.into_iter().map(Arc::new));
        self.known.retain(|known| known.source != *source);
        self.known.push(Known {
            source: source.clone(),
            file: Arc::new(file),
            columns: Some(columns.clone()),
            quieted: None,
        });
        Ok(columns)
    }

    /// The surface of a file without its noise, computed at the first request; `None` if the file has
    /// no noise.
    ///
    /// # Errors
    /// As [`MeshFileSource::read`].
    pub(crate) fn quieted(
        &mut self,
        source: &MeshFileSource,
    ) -> Result<Option<Arc<Quieted>>, MeshSourceError> {
        let file = self.read(source)?;
        let known = self.known.iter_mut().find(|known| known.source == *source);
        let Some(known) = known else {
            return Ok(None);
        };
        let quieted = known.quieted.get_or_insert_with(|| {
            // Invalid positions are reported by the callers that use them.
            let surface = Surface::new(&file.mesh, &file.positions).ok()?;
            Quieted::new(surface, &mut |_| true).ok().map(Arc::new)
        });
        Ok(quieted.clone())
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
