//! Reasons why a scene cannot be prepared.

use crate::generate::GenerateError;
use crate::scene::{EffectError, MeshSourceError, SceneErrors};
use helfrich::{ConstraintError, SurfaceError};

/// The reason why a scene cannot be prepared. The message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A mesh does not meet a requirement of the scene.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// A mesh cannot be generated.
    #[error("surface \"{surface}\": {source}")]
    Generate {
        /// The surface's name.
        surface: String,
        /// The reason.
        source: GenerateError,
    },
    /// A mesh file cannot be read, or has split vertices.
    #[error(transparent)]
    Read(#[from] MeshSourceError),
    /// A position overflows.
    #[error("surface \"{surface}\": {source}")]
    Positions {
        /// The surface's name.
        surface: String,
        /// Which.
        source: SurfaceError,
    },
    /// An effect cannot be prepared.
    #[error("surface \"{surface}\": {source}")]
    Effect {
        /// The surface's name.
        surface: String,
        /// The reason.
        source: EffectError,
    },
    /// An exact constraint cannot be reached from the start of the surface.
    #[error("surface \"{surface}\": {}", unreachable(constraints, source, start.as_ref()))]
    Constraints {
        /// The surface's name.
        surface: String,
        /// The constraints, by their names in scenes.
        constraints: Vec<&'static str>,
        /// A shape from which they can be reached, if it is known.
        start: Option<String>,
        /// The reason.
        source: ConstraintError,
    },
}

/// The reason why constraints with these names cannot be met.
fn unreachable(names: &[&str], error: &ConstraintError, start: Option<&String>) -> String {
    let name = |constraint: usize| names.get(constraint).copied().unwrap_or_default();
    match *error {
        ConstraintError::Dependent { constraint, .. } => format!(
            "from where it starts, `{}` cannot be changed without the others that are held exactly, \
             as the volume of a sphere without its area: begin with {}",
            name(constraint),
            start.map_or(
                "another shape, an ellipsoid say".to_owned(),
                |shape| format!("shape = \"{shape}\"")
            )
        ),
        ConstraintError::NotReached {
            constraint,
            residual,
            ..
        } => format!(
            "from where it starts, `{}` does not come nearer to its target than {residual:.1e} of it: \
             begin with {}",
            name(constraint),
            start.map_or("a shape that is nearer to it".to_owned(), |shape| format!(
                "shape = \"{shape}\""
            ))
        ),
        error => error.to_string(),
    }
}
