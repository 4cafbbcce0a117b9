//! A surface of a scene: its mesh, position and effects.

use super::boundary::Boundary;
use super::effects::Effects;
use super::mesh_source::MeshSource;
use super::remesh::{Remesh, Topology};
use crate::flow::AdhesiveWall;
use crate::flow::lattice_boltzmann::limits::ImmersedMembrane;
use crate::info::{MeshInfo, mean_edge};
use serde::Serialize;

/// Seconds per vertex of an evaluation of elasticity, or of method B.
const VERTEX_SECONDS: f64 = 1e-7;

/// One surface and the effects that act on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceScene {
    /// The surface's name; `surface-1` and so on for those without one.
    pub name: String,
    /// The source of its mesh.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is rotated and moved.
    pub scale: f64,
    /// Position of the mesh's origin.
    pub position: [f64; 3],
    /// Rotation of the mesh about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
    /// Support of its edge, if it is open.
    #[serde(skip_serializing_if = "Boundary::is_free")]
    pub boundary: Boundary,
    /// Edges of the new meshes that it gets when its triangles have become narrow; `None` if its mesh stays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remesh: Option<Remesh>,
    /// Changes of its topology; `None` if it stays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topology: Option<Topology>,
    /// Viscosity ratio λ of the fluid inside to the fluid of the driver, which is outside of all
    /// surfaces. Only flow drivers use viscosities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscosity_ratio: Option<f64>,
    /// The effects that act on it.
    #[serde(flatten)]
    pub effects: Effects,
}

impl SurfaceScene {
    /// Whether the membrane has no memory of the positions of its material, so that vertices may be
    /// moved along it.
    pub fn is_fluid(&self) -> bool {
        !self.effects.iter().any(|(_, effect)| effect.is_solid())
    }

    /// Whether vertices may slide along the surface in a flow: the surface is fluid, no vertex is
    /// loaded, and none has parameters of its own.
    pub fn slides(&self) -> bool {
        let alike = self.effects.columns().is_empty();
        self.is_fluid() && self.effects.stretching.is_none() && alike
    }

    /// Whether its vertices may be anywhere on the surface, so that it may have another mesh.
    pub fn can_have_new_meshes(&self) -> bool {
        self.is_fluid() && self.boundary.is_free()
    }

    /// Whether bending or surface tension limits explicit steps in a flow.
    pub fn is_stiff(&self) -> bool {
        self.effects.bending.is_some() || self.effects.tension.is_some()
    }

    /// Whether all effects are gradients of energies, unlike bending by a method in strong form.
    pub fn is_conservative(&self) -> bool {
        let bending = self.effects.bending.as_ref();
        bending.is_none_or(|bending| bending.method.is_conservative())
    }

    /// Whether its bending method chooses its scale from the noise of the mesh file.
    pub(crate) fn averages_noise(&self) -> bool {
        let bending = self.effects.bending.as_ref();
        bending.is_some_and(|bending| bending.method.has_error_bars())
    }

    /// Estimate of the seconds that an evaluation of elasticity and bending takes on this number of
    /// vertices, and of those of elasticity alone.
    #[doc(hidden)]
    pub fn evaluation_seconds(&self, vertices: usize) -> [f64; 2] {
        let bending = self.effects.bending.as_ref();
        let bending = bending.map_or(0.0, |bending| bending.method.cost().relative);
        [1.0 + bending, 1.0].map(|relative| relative * VERTEX_SECONDS * vertices as f64)
    }

    /// Size and stiffness of the surface, whose mesh has this radius, area and number of triangles.
    pub(super) fn membrane(&self, radius: f64, area: f64, triangles: usize) -> ImmersedMembrane {
        let stiffness = self.effects.stiffness();
        ImmersedMembrane {
            radius,
            edge: mean_edge(area, triangles),
            bending: stiffness.bending,
            shear: stiffness.shear,
            dilation: stiffness.area,
            tension: stiffness.tension.abs(),
            wall: self.effects.adhesion.map(|adhesion| AdhesiveWall {
                strength: adhesion.strength,
                range: adhesion.range,
            }),
        }
    }

    /// The same of a surface with this mesh.
    #[doc(hidden)]
    pub fn membrane_on(&self, mesh: &MeshInfo) -> ImmersedMembrane {
        self.membrane(mesh.enclosed_radius(), mesh.area, mesh.triangles)
    }
}

/// A closed body at rest in the fluid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObstacleScene {
    /// The obstacle's name; `obstacle-1` and so on for those without one.
    pub name: String,
    /// The source of its mesh.
    pub source: MeshSource,
    /// Factor by which the mesh is scaled, before it is rotated and moved.
    pub scale: f64,
    /// Position of the mesh's origin.
    pub position: [f64; 3],
    /// Rotation of the mesh about its origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
}

/// A rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Orientation {
    /// The axis, of any length above 0.
    pub axis: [f64; 3],
    /// The angle in degrees, right-handed about the axis.
    pub angle: f64,
}
