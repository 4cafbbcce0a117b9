//! The effects that act on one surface: one file each, and one line each in the list below.
//!
//! The file of an effect holds everything about its keys in scenes: reading, contradictions,
//! requirements on the mesh, explanation and preparation. The table of keys, the schema, the messages,
//! `explain` and the simulation follow from the list.

mod adhesion;
mod area;
mod area_difference;
mod aspiration;
mod bending;
mod border_tension;
mod elasticity;
mod gaussian_bending;
mod gravity;
mod groups;
mod held;
mod line_tension;
mod local_area;
mod membrane_viscosity;
mod prepare;
mod pressure;
mod reference;
mod stretching;
mod tension;
mod volume;

pub use adhesion::Adhesion;
pub use area::{HeldArea, Target};
pub use area_difference::{AreaDifferenceTarget, HeldAreaDifference};
pub use aspiration::Aspiration;
pub use bending::Bending;
pub use border_tension::BorderTension;
pub use elasticity::{Elasticity, InPlaneLaw};
pub use gaussian_bending::GaussianBending;
pub use gravity::Gravity;
pub use groups::Group;
pub(crate) use groups::{Groups, capillary_number};
pub use held::{HeldTargets, Hold};
pub use line_tension::LineTension;
pub use local_area::LocalArea;
pub use membrane_viscosity::MembraneViscosity;
pub use prepare::EffectError;
pub(crate) use prepare::Preparation;
pub use pressure::Pressure;
pub use reference::{Reference, ReferenceSource};
pub(crate) use stretching::Stretch;
pub use stretching::{Ends, Pull, Stretching};
pub use tension::Tension;
pub(crate) use volume::reduced_volume;
pub use volume::{HeldVolume, VolumeTarget};

use super::builder::Builder;
use super::keys::{Form, Key, Keys, optional};
use super::reader::Reader;
use super::{Boundary, Driver, MeshSource, Parameter, Parameters};
pub(crate) use crate::held::Geometry;
use crate::info::MeshInfo;
use crate::io::Column;
use helfrich::AnyFunctional;
use serde::Serialize;
use std::fmt;
use std::sync::Arc;

/// Defines [`Effects`] and everything that follows from the list of effects. The order of the list
/// is the order of keys, of `explain`, of forces and of columns.
macro_rules! effects {
    ($($(#[$documentation:meta])* $name:ident: $effect:ty,)*) => {
        /// The effects that act on a surface. An absent effect is `None` and costs nothing.
        #[derive(Clone, Debug, Default, PartialEq, Serialize)]
        pub struct Effects {
            $($(#[$documentation])*
            #[serde(skip_serializing_if = "Option::is_none")]
            pub $name: Option<$effect>,)*
        }

        $(impl Named for $effect {
            const NAME: &'static str = stringify!($name);
        })*

        /// The keys of the effects in the table of a surface.
        pub(super) const KEYS: &[Key] = &[$(key::<$effect>()),*];

        impl Effects {
            /// The names of all effects: their keys in a scene.
            pub const NAMES: &[&str] = &[$(stringify!($name)),*];

            /// Reads the effects of a surface with this mesh.
            pub(super) fn read(
                surface: Reader<'_>,
                source: &MeshSource,
                builder: &mut Builder<'_>,
            ) -> Self {
                Self {
                    $($name: surface
                        .table(stringify!($name))
                        .map(|table| Described::read(table, source, builder)),)*
                }
            }

            /// The effects that are on, each with its name.
            pub(crate) fn iter(&self) -> impl Iterator<Item = (&'static str, &dyn SurfaceEffect)> {
                let all: [(&'static str, Option<&dyn SurfaceEffect>); Self::NAMES.len()] = [
                    $((stringify!($name), self.$name.as_ref().map(|effect| effect as _))),*
                ];
                all.into_iter().filter_map(|(name, effect)| Some((name, effect?)))
            }

            /// The effects that are on, mutable.
            pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut dyn SurfaceEffect> {
                let all: [Option<&mut dyn SurfaceEffect>; Self::NAMES.len()] = [
                    $(self.$name.as_mut().map(|effect| effect as _)),*
                ];
                all.into_iter().flatten()
            }
        }
    };
}

effects! {
    /// Bending.
    bending: Bending,
    /// Bending by the Gaussian modulus.
    gaussian_bending: GaussianBending,
    /// Elasticity in the surface's plane.
    elasticity: Elasticity,
    /// Area of each triangle.
    local_area: LocalArea,
    /// Total area of each connected component.
    area: HeldArea,
    /// Enclosed volume of each connected component.
    volume: HeldVolume,
    /// Difference of the areas of the bilayer's leaflets, through ∫H dS of each component.
    area_difference: HeldAreaDifference,
    /// Surface tension.
    tension: Tension,
    /// Line tension of the edge of an open surface.
    line_tension: LineTension,
    /// Line tension of the borders between domains.
    border_tension: BorderTension,
    /// Pressure inside minus pressure outside.
    pressure: Pressure,
    /// Weight of the enclosed fluid minus that of the fluid that it displaces.
    gravity: Gravity,
    /// Suction into a pipette.
    aspiration: Aspiration,
    /// Adhesion to a wall.
    adhesion: Adhesion,
    /// Viscosity of the membrane.
    membrane_viscosity: MembraneViscosity,
    /// Opposite forces at the surface's two ends.
    stretching: Stretching,
}

/// The key of an effect in a scene; it also ends the names of its columns.
pub trait Named {
    /// The key.
    const NAME: &'static str;
}

/// The table of an effect in a scene file.
trait Described: Named + Sized {
    /// The description of the table in the schema.
    const SUMMARY: &'static str;
    /// The keys of the table.
    const KEYS: &'static Keys;

    /// Reads a table that has been compared with [`Self::KEYS`], for a surface with this mesh.
    fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self;
}

const fn key<E: Described>() -> Key {
    optional(E::NAME, Form::Table(E::KEYS), E::SUMMARY)
}

/// An effect of a scene. Methods that do not apply to every effect have defaults.
pub(crate) trait SurfaceEffect: fmt::Debug {
    /// Reports contradictions and doubts about the effect before any mesh is known.
    fn check(&self, _check: &mut Check<'_, '_>) {}

    /// Reports contradictions and doubts about the effect on the mesh of the surface.
    fn check_mesh(&self, _check: &mut MeshCheck<'_>) {}

    /// Whether the effect needs an enclosed volume.
    fn needs_volume(&self) -> bool {
        false
    }

    /// The columns of the mesh file that belong to its material.
    fn columns(&self) -> Vec<&Arc<Column>> {
        Vec::new()
    }

    /// [`Self::columns`], mutable.
    fn columns_mut(&mut self) -> Vec<&mut Arc<Column>> {
        Vec::new()
    }

    /// The stress-free positions; `None` for effects without reference.
    fn reference(&self) -> Option<&Reference> {
        None
    }

    /// [`Self::reference`], mutable.
    fn reference_mut(&mut self) -> Option<&mut Reference> {
        None
    }

    /// Whether the effect depends on the history of the material, so that vertices must follow it.
    fn is_solid(&self) -> bool {
        false
    }

    /// The quantity of each component on which its energy depends, or which it constrains. Area and volume
    /// that are held are those of `geometry`.
    fn quantity(&self, _geometry: Geometry) -> Option<AnyFunctional> {
        None
    }

    /// Moduli against deformation.
    fn stiffness(&self) -> Stiffness {
        Stiffness::default()
    }

    /// Memory of the prepared effect in bytes, for each vertex.
    fn bytes(&self, _mesh: &MeshInfo) -> u64 {
        0
    }

    /// The law or method, and the parameters.
    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>);

    /// Adds the dimensionless groups that the effect forms with the others.
    fn groups(&self, _groups: &mut Groups<'_>) {}

    /// Prepares the effect for the mesh of its surface.
    ///
    /// # Errors
    /// If the mesh or its positions do not allow it.
    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError>;
}

/// Moduli by which an effect resists deformation; 0 where it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stiffness {
    /// Bending modulus, an energy.
    pub(crate) bending: f64,
    /// Area modulus, force per length.
    pub(crate) area: f64,
    /// In-plane shear modulus, force per length.
    pub(crate) shear: f64,
    /// Surface tension, force per length; it may be negative.
    pub(crate) tension: f64,
}

impl Effects {
    /// The names of the effects that are on.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.iter().map(|(name, _)| name)
    }

    /// Whether no effect is on.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// The names of the effects that depend on the history of the material.
    #[doc(hidden)]
    pub fn solid(&self) -> impl Iterator<Item = &'static str> {
        let solid = self.iter().filter(|(_, effect)| effect.is_solid());
        solid.map(|(name, _)| name)
    }

    /// The effects that are on, each with its name and the quantity on which its energy depends, or which it
    /// constrains.
    #[doc(hidden)]
    pub fn quantities(
        &self,
        geometry: Geometry,
    ) -> impl Iterator<Item = (&'static str, Option<AnyFunctional>)> {
        self.iter()
            .map(move |(name, effect)| (name, effect.quantity(geometry)))
    }

    /// The references of the effects that have one.
    #[doc(hidden)]
    pub fn references(&self) -> impl Iterator<Item = &Reference> {
        self.iter().filter_map(|(_, effect)| effect.reference())
    }

    /// [`Self::references`], mutable.
    #[doc(hidden)]
    pub fn references_mut(&mut self) -> impl Iterator<Item = &mut Reference> {
        self.iter_mut().filter_map(SurfaceEffect::reference_mut)
    }

    /// The columns of the mesh file that belong to the material, each once.
    #[doc(hidden)]
    pub fn columns(&self) -> Vec<&Arc<Column>> {
        let mut columns: Vec<&Arc<Column>> = Vec::new();
        for column in self.iter().flat_map(|(_, effect)| effect.columns()) {
            if !columns
                .iter()
                .any(|known| (&known.name, known.place) == (&column.name, column.place))
            {
                columns.push(column);
            }
        }
        columns
    }

    /// The same effects with other numbers in these columns.
    pub(crate) fn with_columns(&self, columns: &[Arc<Column>]) -> Self {
        let mut effects = self.clone();
        for column in effects.iter_mut().flat_map(SurfaceEffect::columns_mut) {
            let mut others = columns.iter();
            let other =
                others.find(|other| (&other.name, other.place) == (&column.name, column.place));
            if let Some(other) = other {
                *column = Arc::clone(other);
            }
        }
        effects
    }

    /// The moduli of all effects together.
    pub(crate) fn stiffness(&self) -> Stiffness {
        self.iter().fold(Stiffness::default(), |sum, (_, effect)| {
            let own = effect.stiffness();
            Stiffness {
                bending: sum.bending + own.bending,
                area: sum.area + own.area,
                shear: sum.shear + own.shear,
                tension: sum.tension + own.tension,
            }
        })
    }
}

/// The context of checks of effects before any mesh is known.
pub(crate) struct Check<'a, 'b> {
    pub(super) builder: &'a mut Builder<'b>,
    /// The name of the surface.
    pub(super) name: &'a str,
    /// All effects of the surface.
    pub(super) effects: &'a Effects,
    /// The table of the surface.
    pub(super) surface: Reader<'a>,
    /// The driver, if it could be read.
    pub(super) driver: Option<&'a Driver>,
}

impl Check<'_, '_> {
    /// The driver, if it has a fluid.
    fn fluid(&self) -> Option<&Driver> {
        self.driver
            .filter(|driver| !matches!(driver, Driver::Relax(_)))
    }

    /// Whether the driver has neither time nor fluid.
    fn relaxes(&self) -> bool {
        matches!(self.driver, Some(Driver::Relax(_)))
    }

    /// Reports parts of the surface that can grow at the cost of each other.
    fn doubt_unheld_parts(&mut self, path: &str) {
        if self.effects.local_area.is_none() && self.effects.elasticity.is_none() {
            let message = format!(
                "parts of \"{}\" are different, and nothing keeps one from growing at the cost of another: \
                 add `elasticity` or `local_area`",
                self.name
            );
            self.doubt(path, message);
        }
    }

    /// Reports a contradiction at a key `effect` or `effect.key`.
    fn contradiction(&mut self, path: &str, message: String) {
        let origin = self.origin(path);
        self.builder.contradiction(&origin, message);
    }

    /// Reports a doubt at a key `effect` or `effect.key`.
    fn doubt(&mut self, path: &str, message: String) {
        let origin = self.origin(path);
        self.builder.doubt(&origin, message);
    }

    fn origin(&self, path: &str) -> super::value::Origin {
        match path.split_once('.') {
            Some((effect, key)) => match self.surface.table(effect) {
                Some(table) => table.origin_of(key),
                None => self.surface.origin_of(effect),
            },
            None => self.surface.origin_of(path),
        }
    }
}

/// The context of checks of effects once the mesh is known.
pub(crate) struct MeshCheck<'a> {
    /// The name of the surface.
    pub(crate) name: &'a str,
    /// All effects of the surface.
    pub(crate) effects: &'a Effects,
    /// The source of the mesh.
    pub(crate) source: &'a MeshSource,
    /// The support of its edge, if it is open.
    pub(crate) boundary: Boundary,
    /// The mesh, scaled as the scene says.
    pub(crate) mesh: &'a MeshInfo,
    /// The driver.
    pub(crate) driver: &'a Driver,
    /// Contradictions, each with its key below the surface.
    pub(crate) contradictions: Vec<(String, String)>,
    /// Doubts, each with its key below the surface.
    pub(crate) doubts: Vec<(String, String)>,
}

impl MeshCheck<'_> {
    /// Whether some vertices are fixed.
    fn is_supported(&self) -> bool {
        self.mesh.boundary_edges > 0 && !self.boundary.is_free()
    }

    fn contradiction(&mut self, path: &str, message: String) {
        self.contradictions.push((path.to_owned(), message));
    }

    fn doubt(&mut self, path: &str, message: String) {
        self.doubts.push((path.to_owned(), message));
    }
}

/// Refuses an effect at an edge on a lattice, whose steps are chosen before any force is known.
fn refuse_on_lattice(effect: &'static str, check: &mut Check<'_, '_>) {
    if matches!(check.driver, Some(Driver::LatticeBoltzmann(_))) {
        let message = format!(
            "`{effect}` is not among the forces by which the driver \"lattice-boltzmann\" limits its \
             steps: choose the driver \"relax\" or \"boundary-integral\""
        );
        check.contradiction(effect, message);
    }
}
