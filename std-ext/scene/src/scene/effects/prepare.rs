//! Effects prepared for the mesh of their surface.

use super::super::material::Material;
use super::{Effects, Geometry, Stretch};
use crate::effect::{CannotBend, CompiledPotential, Effect, Lumping, Viscosity};
use crate::io::ColumnPlace;
use helfrich::{
    Constraint, LoadError, MaterialParameter, ParameterError, ReferenceError, Reordering, Surface,
    SurfaceError, TriangleMesh,
};

/// The reason why an effect cannot be prepared for a mesh. The message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EffectError {
    /// A position of a reference overflows.
    #[error(transparent)]
    Positions(#[from] SurfaceError),
    /// A reference cannot be used.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// Loads cannot be applied to the ends of a surface.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The bending method cannot act.
    #[error(transparent)]
    Bending(#[from] CannotBend),
    /// The surface does not start where the effect can act; the message says where it should.
    #[error("{0}")]
    Misplaced(String),
}

/// A surface at the start, and the effects prepared for it so far.
pub(crate) struct Preparation<'a> {
    /// The surface in its initial position, in the order in which it will be evaluated.
    pub(crate) surface: Surface<'a, f64>,
    /// The cache-friendly order, if it differs from that of the scene.
    pub(crate) order: Option<&'a Reordering>,
    /// The position of the origin of the mesh.
    pub(crate) position: [f64; 3],
    /// The areas by which force densities become nodal forces.
    pub(crate) lumping: Lumping,
    /// The functionals by which area and volume are held.
    pub(crate) geometry: Geometry,
    /// All effects of the surface.
    pub(crate) siblings: &'a Effects,
    /// The positions of the reference of the effect that is being prepared, in the same order.
    pub(crate) unstressed: Vec<[f64; 3]>,
    /// Effects whose forces depend on positions.
    pub(crate) forces: Vec<Effect>,
    /// Constraints, each with the name of its effect.
    pub(crate) constraints: Vec<(&'static str, Constraint<f64>)>,
    /// The viscosity of the membrane.
    pub(crate) viscosity: Option<Viscosity>,
    /// The loads of a stretched surface.
    pub(crate) stretch: Option<Stretch>,
}

impl Preparation<'_> {
    /// The mesh of the surface.
    pub(super) fn mesh(&self) -> &TriangleMesh {
        self.surface.mesh()
    }

    /// Values at the vertices or triangles of the scene's mesh, in the order of [`Self::mesh`].
    pub(super) fn ordered<V: Copy>(&self, place: ColumnPlace, values: Vec<V>) -> Vec<V> {
        match (self.order, place) {
            (None, _) => values,
            (Some(order), ColumnPlace::Vertices) => order.apply(&values),
            (Some(order), ColumnPlace::Triangles) => order.apply_to_triangles(&values),
        }
    }

    /// A property of the membrane on [`Self::mesh`].
    pub(super) fn parameter(&self, material: &Material) -> MaterialParameter<f64> {
        match material.parameter() {
            MaterialParameter::PerVertex(values) => {
                MaterialParameter::PerVertex(self.ordered(ColumnPlace::Vertices, values))
            }
            constant => constant,
        }
    }

    /// Adds an effect whose force is the gradient of its energy; refused if products of the scene's
    /// numbers are not finite.
    pub(super) fn conservative(
        &mut self,
        name: &'static str,
        method: impl CompiledPotential,
    ) -> Result<(), EffectError> {
        self.forces
            .push(Effect::conservative(name, method, self.mesh())?);
        Ok(())
    }
}
