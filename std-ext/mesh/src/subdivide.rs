//! Refinement of mesh files by Loop's rules.

use crate::io::MeshFile;
use helfrich::subdivision::{Subdivision, limit_positions};
use helfrich::{MeshError, Serial};

/// Positions of the vertices of a refined mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// The positions after refinement: the control points of the next level.
    Controls,
    /// The positions on the smooth surface to which further refinement converges.
    Limit,
}

/// Reason why a mesh cannot be refined to a level.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SubdivideError {
    /// The result has more vertices or triangles than a mesh may have.
    #[error("{levels} levels of refinement are too many: {source}")]
    TooLarge {
        /// The requested levels.
        levels: u32,
        /// The number and its limit.
        source: MeshError,
    },
    /// The result does not fit the memory of this machine.
    #[error(
        "{levels} levels of refinement are too many: {triangles} triangles need about {} MB of \
         memory, which this machine does not give", bytes / 1_000_000
    )]
    OutOfMemory {
        /// The requested levels.
        levels: u32,
        /// The number of triangles of the result.
        triangles: usize,
        /// The memory that the refinement needs.
        bytes: usize,
    },
}

/// Memory in bytes that the last refinement needs for each triangle of its result: the mesh twice while it is
/// built, the map, and the positions.
const BYTES_A_TRIANGLE: usize = 200;

/// Refines a mesh `levels` times; 0 returns it unchanged.
///
/// The size of the result is checked before the first refinement.
///
/// # Errors
/// If the result is too large; see [`SubdivideError`].
pub fn subdivide(file: MeshFile, levels: u32, target: Target) -> Result<MeshFile, SubdivideError> {
    let too_large = |source| SubdivideError::TooLarge { levels, source };
    let [_, triangles] = Subdivision::sizes(&file.mesh, levels).map_err(too_large)?;
    if levels > 0 {
        let bytes = triangles.saturating_mul(BYTES_A_TRIANGLE);
        // The memory is reserved and released unused, because a failure here gives a message, whereas a later
        // one aborts the program.
        if Vec::<u8>::new().try_reserve_exact(bytes).is_err() {
            return Err(SubdivideError::OutOfMemory {
                levels,
                triangles,
                bytes,
            });
        }
    }
    let MeshFile {
        mut positions,
        mut mesh,
        ..
    } = file;
    // One level at a time, because the composed map of all levels would need more memory than the
    // mesh.
    for _ in 0..levels {
        let fine = Subdivision::new(&mesh, 1).map_err(too_large)?;
        positions = fine.refine(&positions);
        mesh = fine.into_mesh();
    }
    if target == Target::Limit {
        let mut limit = vec![[0.0; 3]; positions.len()];
        limit_positions(&mesh).apply(&Serial, &positions, &mut limit);
        positions = limit;
    }
    Ok(MeshFile::new(positions, mesh))
}
