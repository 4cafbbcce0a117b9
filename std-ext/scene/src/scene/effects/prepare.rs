//! Effects prepared for the mesh of their surface.

use super::super::material::Material;
use super::{Effects, Geometry, HeldTargets, Stretch};
use crate::effect::{CannotBend, CompiledPotential, Effect, Lumping, Viscosity};
use crate::held::Quantity;
use crate::io::ColumnPlace;
use helfrich::{
    AnyFunctional, Constraint, LoadError, MaterialParameter, ParameterError, ReferenceError,
    Reordering, Surface, SurfaceError, Targets, TriangleMesh,
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
    /// The targets of held quantities: those that were known before, or that have been prepared so far.
    pub(crate) targets: Vec<HeldTargets>,
    /// Area and volume of each component over those of its flat triangles, where exactly held ones are those of the smooth
    /// surface through the vertices; empty where they are those of the triangles.
    pub(crate) ratios: &'a [[f64; 2]],
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

    /// The present values of a quantity of the components as targets: of the smooth surface, if that is `measured`.
    pub(super) fn present(&self, quantity: AnyFunctional, measured: bool) -> Targets<f64> {
        let values = Quantity::targets(quantity, self.surface);
        match self.ratio_of(quantity).filter(|_| measured) {
            Some(which) => each(&values, self.ratios, |value, ratios| value * ratios[which]),
            None => values,
        }
    }

    /// The targets for flat triangles of targets for the smooth surface.
    pub(super) fn of_triangles(
        &self,
        quantity: AnyFunctional,
        targets: &Targets<f64>,
    ) -> Targets<f64> {
        match self.ratio_of(quantity) {
            Some(which) => each(targets, self.ratios, |value, ratios| value / ratios[which]),
            None => targets.clone(),
        }
    }

    /// The place of a quantity in the ratios, if these are known and it has one.
    fn ratio_of(&self, quantity: AnyFunctional) -> Option<usize> {
        let places = [AnyFunctional::Area, AnyFunctional::Volume];
        let place = places.iter().position(|&place| place == quantity);
        place.filter(|_| !self.ratios.is_empty())
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

/// A target for each component, from its target and its ratios.
fn each(
    targets: &Targets<f64>,
    ratios: &[[f64; 2]],
    of: impl Fn(f64, [f64; 2]) -> f64,
) -> Targets<f64> {
    let parts = ratios.iter().enumerate();
    let parts = parts.map(|(component, &ratios)| of(targets.at(component), ratios));
    Targets::PerComponent(parts.collect())
}
