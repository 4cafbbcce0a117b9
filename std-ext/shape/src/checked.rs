//! Surfaces in f64, checked by loops that are compiled here: they are as fast however a crate that calls them is
//! optimised.

use helfrich::{Surface, SurfaceError, TriangleMesh};

/// A surface with these positions: see [`Surface::new`].
///
/// # Errors
/// If the numbers of positions and vertices differ, or a position is not finite or too far away.
pub fn surface<'a>(
    mesh: &'a TriangleMesh,
    positions: &'a [[f64; 3]],
) -> Result<Surface<'a, f64>, SurfaceError> {
    Surface::new(mesh, positions)
}

/// Sets all vectors to 0.
pub fn clear(vectors: &mut [[f64; 3]]) {
    vectors.fill([0.0; 3]);
}
