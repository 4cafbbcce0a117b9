//! Mesh files refined by Loop's rules.

use crate::io::MeshFile;
use helfrich::subdivision::{Subdivision, limit_positions};
use helfrich::{MeshError, Serial};

/// Where the vertices of a refined mesh lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// Where refinement puts them: the control points of the next level.
    Controls,
    /// On the smooth surface to which further refinement would lead.
    Limit,
}

/// Why a mesh cannot be refined that often.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SubdivideError {
    /// The result has more vertices or triangles than a mesh may have.
    #[error("{levels} levels of refinement are too many: {source}")]
    TooLarge {
        /// The levels asked for.
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
        /// The levels asked for.
        levels: u32,
        /// How many triangles there would be.
        triangles: usize,
        /// How much memory they need on the way.
        bytes: usize,
    },
}

/// Memory that the last refinement needs for each triangle of its result, in bytes: the mesh twice
/// over while it is built, the map and the positions.
const BYTES_A_TRIANGLE: usize = 200;

/// Refines a mesh `levels` times; 0 leaves it as it is.
///
/// Whether the result is possible is asked before anything is refined.
///
/// # Errors
/// If the result is too large; see [`SubdivideError`].
pub fn subdivide(file: MeshFile, levels: u32, target: Target) -> Result<MeshFile, SubdivideError> {
    let too_large = |source| SubdivideError::TooLarge { levels, source };
    let [_, triangles] = Subdivision::sizes(&file.mesh, levels).map_err(too_large)?;
    if levels > 0 {
        let bytes = triangles.saturating_mul(BYTES_A_TRIANGLE);
        // Asked for and given back untouched: a refusal here is a message, later it is an abort.
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
    } = file;
    // One level at a time: the composed map of all of them would need more memory than the mesh.
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
    Ok(MeshFile { positions, mesh })
}
