//! Meshes at their positions in a scene.

use super::error::BuildError;
use crate::generate::{GeneratedMesh, generate};
use crate::noise::Quieted;
use crate::scene::{MeshFiles, MeshSource, Orientation};
use helfrich::{Surface, TriangleMesh};
use std::sync::Arc;

/// Scales a closed mesh so that it encloses this volume.
pub(super) fn scale_to_volume(mesh: &TriangleMesh, positions: &mut [[f64; 3]], volume: f64) {
    let enclosed = Surface::new(mesh, &*positions)
        .ok()
        .and_then(|surface| surface.volume());
    if let Some(enclosed) = enclosed {
        let factor = (volume / enclosed).cbrt();
        for coordinate in positions.as_flattened_mut() {
            *coordinate *= factor;
        }
    }
}

/// A surface or an obstacle at its position in the scene.
pub(crate) struct Placed {
    pub(super) mesh: Arc<TriangleMesh>,
    /// Positions of the mesh, scaled but not moved.
    pub(super) unplaced: Arc<Vec<[f64; 3]>>,
    pub(crate) positions: Vec<[f64; 3]>,
    /// The points of the shape for the vertices of a generated mesh.
    pub(super) preimages: Option<Arc<Vec<[f64; 3]>>>,
    /// The noise that was removed from the mesh file, in the file's unit.
    pub(super) quieted: Option<Arc<Quieted>>,
}

impl Placed {
    /// `without_noise` says that vertices of a mesh file are moved onto a smooth surface if they have
    /// noise.
    pub(crate) fn new(
        name: &str,
        source: &MeshSource,
        scale: f64,
        orientation: Option<Orientation>,
        position: [f64; 3],
        files: &mut MeshFiles,
        without_noise: bool,
    ) -> Result<Self, BuildError> {
        let mut quieted = None;
        let (mesh, mut unplaced, preimages) = match source {
            MeshSource::Shape {
                shape,
                family,
                vertices,
                seed,
                match_volume,
            } => {
                let made = generate(shape, *family, *vertices, *seed);
                let GeneratedMesh {
                    mesh,
                    mut positions,
                    preimages,
                    ..
                } = made.map_err(|source| BuildError::Generate {
                    surface: name.to_owned(),
                    source,
                })?;
                if *match_volume {
                    scale_to_volume(&mesh, &mut positions, shape.volume());
                }
                (Arc::new(mesh), positions, Some(Arc::new(preimages)))
            }
            MeshSource::File(file) => {
                if without_noise {
                    quieted = files.quieted(file)?;
                }
                let file = files.read(file)?;
                let positions = quieted
                    .as_ref()
                    .map_or(&file.positions, |quieted| &quieted.positions);
                (Arc::new(file.mesh.clone()), positions.clone(), None)
            }
        };
        for vertex in &mut unplaced {
            *vertex = vertex.map(|x| scale * x);
        }
        Ok(Self {
            positions: at(&unplaced, orientation, position),
            mesh,
            unplaced: Arc::new(unplaced),
            preimages,
            quieted,
        })
    }

    /// The same mesh at another place.
    pub(super) fn moved(&self, orientation: Option<Orientation>, position: [f64; 3]) -> Self {
        Self {
            mesh: Arc::clone(&self.mesh),
            unplaced: Arc::clone(&self.unplaced),
            positions: at(&self.unplaced, orientation, position),
            preimages: self.preimages.clone(),
            quieted: self.quieted.clone(),
        }
    }

    /// Its mesh.
    pub(crate) fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }
}

/// Points turned and moved.
fn at(points: &[[f64; 3]], orientation: Option<Orientation>, position: [f64; 3]) -> Vec<[f64; 3]> {
    let place = |point: &[f64; 3]| {
        let turned = turn(orientation, *point);
        core::array::from_fn(|axis| position[axis] + turned[axis])
    };
    points.iter().map(place).collect()
}

/// Rodrigues' rotation about an axis.
fn turn(orientation: Option<Orientation>, x: [f64; 3]) -> [f64; 3] {
    let Some(Orientation { axis, angle }) = orientation else {
        return x;
    };
    let [axis, x] = [axis, x].map(glam::DVec3::from_array);
    glam::DQuat::from_axis_angle(axis.normalize(), angle.to_radians())
        .mul_vec3(x)
        .to_array()
}
