//! A surface of a scene, and the effects that act on it.

use crate::generate::{AnyShape, Family};
use crate::method::BendingMethod;
use serde::Serialize;
use std::path::PathBuf;

/// One surface and the effects that act on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceScene {
    /// The surface's name; `surface-1` and so on for those without one.
    pub name: String,
    /// Where its mesh comes from.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is turned and moved.
    pub scale: f64,
    /// Where the mesh's origin is put.
    pub position: [f64; 3],
    /// How the mesh is turned about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
    /// Viscosity inside over viscosity outside, λ. Only flow drivers know viscosities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscosity_ratio: Option<f64>,
    /// Bending.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bending: Option<Bending>,
    /// Elasticity in the surface's plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elasticity: Option<Elasticity>,
    /// Total area of each connected component.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<Held<Target>>,
    /// Area of each triangle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub local_area: Option<LocalArea>,
    /// Enclosed volume of each connected component.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<Held<VolumeTarget>>,
    /// Difference of the areas of the bilayer's leaflets, through ∫H dS of each component.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_difference: Option<Held<AreaDifferenceTarget>>,
    /// Surface tension σ, force per length: `E = σ A`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tension: Option<f64>,
    /// Pressure inside minus pressure outside, Δp: `E = −Δp V`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// Weight of what is inside, less that of what it displaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
    /// Viscosity of the membrane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub membrane_viscosity: Option<MembraneViscosity>,
    /// Opposite forces at the surface's two ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretching: Option<Stretching>,
}

impl SurfaceScene {
    /// Whether the membrane has no memory of where its material was: vertices may be moved along
    /// it.
    pub fn is_fluid(&self) -> bool {
        self.elasticity.is_none() && self.local_area.is_none()
    }

    /// Whether anything acts on the surface by itself.
    pub fn has_effects(&self) -> bool {
        self.bending.is_some()
            || self.elasticity.is_some()
            || self.area.is_some()
            || self.local_area.is_some()
            || self.volume.is_some()
            || self.area_difference.is_some()
            || self.tension.is_some()
            || self.pressure.is_some()
            || self.gravity.is_some()
            || self.membrane_viscosity.is_some()
            || self.stretching.is_some()
    }

    /// Whether all effects are gradients of energies: bending by a method in strong form is not.
    pub fn is_conservative(&self) -> bool {
        self.bending
            .is_none_or(|bending| bending.method.is_conservative())
    }
}

/// A closed body at rest in the fluid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Obstacle {
    /// The obstacle's name; `obstacle-1` and so on for those without one.
    pub name: String,
    /// Where its mesh comes from.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is turned and moved.
    pub scale: f64,
    /// Where the mesh's origin is put.
    pub position: [f64; 3],
    /// How the mesh is turned about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
}

/// Where a mesh comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeshSource {
    /// Generated on an exact shape: [`crate::generate::generate`].
    Shape {
        /// The shape.
        #[serde(serialize_with = "as_text")]
        shape: AnyShape,
        /// How vertices are spread over it.
        #[serde(serialize_with = "as_text")]
        family: Family,
        /// How many there are.
        vertices: usize,
        /// Seed of the families that are random.
        seed: u64,
        /// Whether the mesh is scaled so that it encloses the shape's volume.
        match_volume: bool,
    },
    /// Read from a mesh file: [`crate::io::read`].
    File(PathBuf),
}

fn as_text<S: serde::Serializer>(
    value: &impl std::fmt::Display,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Orientation {
    /// The axis, of any length above 0.
    pub axis: [f64; 3],
    /// The angle in degrees, right-handed about the axis.
    pub angle: f64,
}

/// Bending, `E = 2κ ∫ (H − H0)² dS`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bending {
    /// The method.
    pub method: BendingMethod,
    /// Bending modulus κ, an energy.
    pub modulus: f64,
    /// Spontaneous curvature H0 = c0/2, 1/length, positive on a sphere; 0 if there is none.
    pub spontaneous_curvature: f64,
}

/// In-plane elasticity over a reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Elasticity {
    /// The law.
    pub law: InPlaneLaw,
    /// The mesh without stress.
    pub reference: Reference,
}

/// A law of in-plane elasticity, with its moduli in force per length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "name")]
pub enum InPlaneLaw {
    /// `W = G/2 (I1 − 1 + 1/(I2 + 1))`.
    NeoHookean {
        /// G.
        shear_modulus: f64,
    },
    /// `W = G/4 (I1² + 2 I1 − 2 I2 + C I2²)`.
    Skalak {
        /// G.
        shear_modulus: f64,
        /// C.
        area_ratio: f64,
    },
}

impl InPlaneLaw {
    /// Shear modulus G.
    pub fn shear_modulus(&self) -> f64 {
        match *self {
            Self::NeoHookean { shear_modulus } | Self::Skalak { shear_modulus, .. } => {
                shear_modulus
            }
        }
    }

    /// Area dilatation modulus at small strain: 3 G of neo-Hookean, (1 + 2 C) G of Skalak.
    pub fn area_modulus(&self) -> f64 {
        match *self {
            Self::NeoHookean { shear_modulus } => 3.0 * shear_modulus,
            Self::Skalak {
                shear_modulus,
                area_ratio,
            } => (1.0 + 2.0 * area_ratio) * shear_modulus,
        }
    }
}

/// The positions at which a mesh is without stress.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Where they come from.
    pub source: ReferenceSource,
    /// Factor by which they are scaled: a reference smaller than the surface stretches it.
    pub scale: f64,
}

/// Where the positions of a reference come from. It is not turned or moved: stress does not care.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceSource {
    /// The surface as it is at the start, with the surface's own scale.
    Initial,
    /// The surface's mesh generated on another shape, with its family, vertices and seed.
    Shape(#[serde(serialize_with = "as_text")] AnyShape),
    /// A mesh file with the triangles of the surface.
    File(PathBuf),
}

/// A quantity of each connected component that is held at a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Held<T> {
    /// How it is held.
    pub hold: Hold,
    /// At what.
    pub target: T,
}

/// How a quantity is held at its target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// As a constraint.
    Exact,
    /// By a penalty with this modulus. Area and volume F: `E = k/2 (F − F0)²/F0`, k a force per
    /// length or a pressure. Area difference: `E = 2π k (M − M0)²/A` with `M = ∫H dS`, k an energy.
    Penalty(f64),
}

/// A target area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// What it is at the start.
    Initial,
    /// This number, of each connected component.
    Value(f64),
}

/// A target volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VolumeTarget {
    /// What it is at the start.
    Initial,
    /// This number, of each connected component.
    Value(f64),
    /// The reduced volume `v = 6√π V/A^{3/2}`, with the target area, or the initial area if the area
    /// is not held.
    Reduced(f64),
}

/// A target of ∫H dS.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AreaDifferenceTarget {
    /// What it is at the start.
    Initial,
    /// This number, a length, of each connected component.
    Value(f64),
    /// `∫H dS/√(4πA)`, 1 for a sphere, with the target area, or the initial area if the area is not
    /// held.
    Reduced(f64),
}

/// A penalty on the area of each triangle, `E = k/2 Σ (A − A0)²/A0`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LocalArea {
    /// k, force per length.
    pub modulus: f64,
    /// Where A0 is measured.
    pub reference: Reference,
}

/// Gravity and buoyancy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gravity {
    /// Mass density inside minus outside.
    pub density_difference: f64,
    /// Acceleration, pointing down.
    pub acceleration: [f64; 3],
}

/// Viscosities of the membrane: force times time over length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MembraneViscosity {
    /// Of shear.
    pub shear: f64,
    /// Of dilation.
    pub dilational: f64,
}

/// Opposite forces at the two ends of a surface, as by optical tweezers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stretching {
    /// The direction of the forces, of any length above 0.
    pub axis: [f64; 3],
    /// Total force on each end. Several are a sequence: each from the equilibrium under the one
    /// before it.
    pub forces: Vec<f64>,
    /// Fraction of the vertices over which the force on an end is spread.
    pub fraction: f64,
}
