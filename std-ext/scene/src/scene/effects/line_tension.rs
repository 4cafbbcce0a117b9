//! Line tension of an open edge.

use super::super::keys::{Keys, any, plain, required};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, SurfaceEffect,
};
use helfrich::LineTension as EdgeTension;
use serde::Serialize;

/// Line tension of an open edge, `E = Λ L`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LineTension {
    /// Λ, a force.
    pub value: f64,
}

impl Described for LineTension {
    const SUMMARY: &'static str = "Line tension of the edge of an open surface, E = Λ L.";

    const KEYS: &'static Keys = &plain(&[required(
        "value",
        any(Dimension::FORCE),
        "Line tension Λ, energy per length of the edge; positive if it contracts.",
    )]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        Self {
            value: table.needed("value"),
        }
    }
}

impl SurfaceEffect for LineTension {
    fn check(&self, check: &mut Check<'_, '_>) {
        super::refuse_on_lattice(Self::NAME, check);
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        if check.mesh.boundary_edges == 0 {
            let message = format!(
                "`line_tension` acts at an edge, and \"{}\" is closed: leave it out, or open the mesh",
                check.name
            );
            check.contradiction(Self::NAME, message);
        } else if !check.boundary.is_free() {
            let message = format!(
                "`line_tension` does nothing to \"{}\", whose edge is held in place: leave it out, or \
                 choose `boundary = \"free\"`",
                check.name
            );
            check.doubt(Self::NAME, message);
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let value = number.of("value", self.value, Dimension::FORCE);
        (String::new(), vec![value])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(modulus) = groups.bending_modulus() {
            // That of the flat disc of this area, twice the radius of the sphere.
            let radius = 2.0 * groups.radius();
            groups.add(
                "reduced line tension",
                "Λ √(A/π)/κ",
                self.value * radius / modulus,
            );
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        preparation.conservative(Self::NAME, EdgeTension::new(self.value))
    }
}
