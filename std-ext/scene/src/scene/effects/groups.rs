//! Dimensionless groups that effects form with each other, the mesh and the driver.

use super::Effects;
use crate::info::MeshInfo;
use crate::scene::Driver;
use serde::Serialize;
use std::f64::consts::PI;

/// A dimensionless group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// Its name.
    pub name: &'static str,
    /// Its formula.
    pub formula: &'static str,
    /// The number.
    pub value: f64,
}

/// The dimensionless groups of a surface, and the quantities in them.
pub(crate) struct Groups<'a> {
    /// All effects of the surface.
    pub(crate) effects: &'a Effects,
    /// The mesh, scaled as the scene says.
    pub(crate) mesh: &'a MeshInfo,
    /// The driver.
    pub(crate) driver: &'a Driver,
    pub(crate) found: Vec<Group>,
}

impl Groups<'_> {
    pub(crate) fn add(&mut self, name: &'static str, formula: &'static str, value: f64) {
        self.found.push(Group {
            name,
            formula,
            value,
        });
    }

    /// R, the radius of the sphere of the same area.
    pub(super) fn radius(&self) -> f64 {
        (self.mesh.area / (4.0 * PI)).sqrt()
    }

    /// The bending modulus κ, if the surface bends and it is the same everywhere.
    pub(super) fn bending_modulus(&self) -> Option<f64> {
        self.effects.bending.as_ref()?.modulus.uniform()
    }
}

/// `Ca_G = μγ̇a/G` of an elastic surface in a flow that has a rate.
pub(crate) fn capillary_number(effects: &Effects, mesh: &MeshInfo, driver: &Driver) -> Option<f64> {
    let elasticity = effects.elasticity.as_ref()?;
    let viscous = driver.viscosity()? * driver.flow()?.rate()? * mesh.enclosed_radius();
    Some(viscous / elasticity.law.shear_modulus())
}
