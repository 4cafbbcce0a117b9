//! The state of reading a scene: problems and warnings so far, and mesh files.

use super::mesh_source::{MeshFileSource, MeshFiles};
use super::problem::{Problem, Problems};
use super::reader::Reader;
use super::value::Origin;
use crate::flow::Barrier;
use std::path::{Path, PathBuf};

/// Reads a scene from its values.
pub(super) struct Builder<'a> {
    /// The scene file's.
    pub(super) folder: &'a Path,
    pub(super) problems: &'a mut Problems,
    pub(super) warnings: &'a mut Problems,
    /// Repulsions, which limit steps of a driver like properties of its surfaces.
    pub(super) barriers: Vec<Barrier>,
    /// Mesh files that were read to know the size of their surfaces.
    pub(super) meshes: MeshFiles,
}

impl Builder<'_> {
    pub(super) fn contradiction(&mut self, origin: &Origin, message: String) {
        self.problems
            .add(origin, Problem::Contradiction { message });
    }

    pub(super) fn doubt(&mut self, origin: &Origin, message: String) {
        self.warnings.add(origin, Problem::Doubtful { message });
    }

    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// A mesh file, and whether it is welded.
    pub(super) fn mesh_file(&mut self, name: &str, around: Reader<'_>) -> MeshFileSource {
        MeshFileSource {
            path: self.file(name),
            weld: around.switch("weld"),
        }
    }
}
