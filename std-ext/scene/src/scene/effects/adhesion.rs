//! Adhesion to a wall.

use super::super::keys::{Form, Keys, optional, plain, positive, required};
use super::super::units::Dimension;
use super::{
    Builder, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter, Parameters,
    Preparation, Reader, SurfaceEffect,
};
use crate::six::Six;
use glam::DVec3;
use helfrich::WallAdhesion;
use serde::Serialize;

/// Adhesion to a plane wall, `E = ∫ W (q² − 2 q) dS` with `q = exp(−(z − d)/λ)` at the height z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Adhesion {
    /// Adhesion energy per area W, force per length.
    pub strength: f64,
    /// Height d of the minimum above the wall.
    pub distance: f64,
    /// Length λ over which the attraction falls off.
    pub range: f64,
    /// A point of the wall.
    pub wall: [f64; 3],
    /// Normal of the wall towards the membrane, of any length above 0.
    pub normal: [f64; 3],
}

impl Described for Adhesion {
    const SUMMARY: &'static str =
        "Adhesion to a plane wall, E = ∫ W (q² − 2 q) dS with q = exp(−(z − d)/λ) at the height z.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "strength",
            positive(Dimension::TENSION),
            "Adhesion energy per area W.",
        ),
        required(
            "distance",
            positive(Dimension::LENGTH),
            "Height d above the wall at which the energy is least.",
        ),
        optional(
            "range",
            positive(Dimension::LENGTH),
            "Length λ over which the attraction falls off; by default a third of the distance.",
        ),
        optional(
            "wall",
            Form::Vector(Dimension::LENGTH),
            "A point of the wall; by default the origin.",
        ),
        optional(
            "normal",
            Form::Direction,
            "Normal of the wall, towards the membrane; by default [0, 0, 1].",
        ),
    ]);

    fn read(table: Reader<'_>, _: &MeshSource, _: &mut Builder<'_>) -> Self {
        let distance = table.needed("distance");
        Self {
            strength: table.needed("strength"),
            distance,
            range: table.number("range").unwrap_or(distance / 3.0),
            wall: table.vector("wall").unwrap_or_default(),
            normal: table.vector("normal").unwrap_or([0.0, 0.0, 1.0]),
        }
    }
}

impl Adhesion {
    /// Radius of curvature √(κ/(2W)) where a membrane meets the wall, in the limit λ → 0.
    fn contact_radius(&self, bending_modulus: f64) -> f64 {
        (0.5 * bending_modulus / self.strength).sqrt()
    }
}

impl SurfaceEffect for Adhesion {
    /// Where a curve of radius r leaves the wall, an edge of length h along it rises by about h²/(2r).
    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        let Some(bending) = &check.effects.bending else {
            return;
        };
        let radius = self.contact_radius(bending.modulus.least());
        let longest = check.mesh.edge_lengths[1];
        if longest * longest > radius * self.range {
            let message = format!(
                "where \"{}\" meets the wall its radius of curvature is √(κ/(2W)) = {}, and edges up to {} \
                 long rise there by more than half of the `range` {}: choose more vertices, or a longer \
                 `range`",
                check.name,
                Six(radius),
                Six(longest),
                Six(self.range)
            );
            check.doubt("adhesion.range", message);
        }
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let [x, y, z] = self.normal;
        let parameters = vec![
            number.of("strength", self.strength, Dimension::TENSION),
            number.of("distance", self.distance, Dimension::LENGTH),
            number.of("range", self.range, Dimension::LENGTH),
        ];
        (
            format!("to a wall with the normal [{x}, {y}, {z}]"),
            parameters,
        )
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let radius = groups.radius();
        groups.add("range of adhesion", "λ/R", self.range / radius);
        if let Some(modulus) = groups.bending_modulus() {
            let reduced = self.strength * radius * radius / modulus;
            groups.add("reduced adhesion", "w = W R²/κ", reduced);
            let contact = radius / self.contact_radius(modulus);
            groups.add("contact curvature for λ → 0", "R √(2W/κ)", contact);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let normal = DVec3::from(self.normal).normalize();
        let wall = DVec3::from(self.wall);
        let positions = preparation.surface.positions();
        for (vertex, &position) in positions.iter().enumerate() {
            let height = normal.dot(DVec3::from(position) - wall);
            if height <= 0.0 {
                return Err(EffectError::Misplaced(format!(
                    "vertex {vertex} starts at the height {height:.6} above the wall of `adhesion`: place \
                     the surface in front of the wall, on the side of its `normal`"
                )));
            }
        }
        preparation.conservative(
            Self::NAME,
            WallAdhesion {
                strength: self.strength,
                distance: self.distance,
                range: self.range,
                wall: self.wall,
                normal: normal.to_array(),
            },
        )
    }
}
