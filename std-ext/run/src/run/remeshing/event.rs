//! Events: what a new mesh has changed.

use super::super::deformed::smallest_angle;
use super::super::measure::{HeldExtents, extents};
use crate::held::Geometry;
use crate::parting::Break;
use crate::simulation::Simulation;
use serde::{Deserialize, Serialize};

/// One new mesh of a surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Remeshing {
    /// The surface's name.
    pub surface: String,
    /// Iteration or time.
    pub at: f64,
    /// The change of its topology, if it has changed.
    pub broke: Option<Break>,
    /// Numbers of vertices before and after.
    pub vertices: [usize; 2],
    /// Numbers of vertices minus edges plus triangles before and after: 2 for a sphere.
    pub euler_number: [i64; 2],
    /// Smallest angles before and after, in degrees.
    pub smallest_angle: [f64; 2],
    /// Energies of all effects before and after.
    pub energy: [f64; 2],
    /// Areas before and after, as in the series.
    pub area: [f64; 2],
    /// Enclosed volumes before and after, as in the series; null for open surfaces.
    pub volume: [f64; 2],
}

impl Remeshing {
    pub(super) fn of(
        name: &str,
        at: f64,
        broke: Option<Break>,
        measures: [SurfaceMeasures; 2],
    ) -> Self {
        Self {
            surface: name.to_owned(),
            at,
            broke,
            vertices: measures.each_ref().map(|own| own.vertices),
            euler_number: measures.each_ref().map(|own| own.euler_number),
            smallest_angle: measures.each_ref().map(|own| own.angle),
            energy: measures.each_ref().map(|own| own.energy),
            area: measures.each_ref().map(|own| own.area),
            volume: measures.each_ref().map(|own| own.volume),
        }
    }
}

/// Measures of a surface before or after an event.
pub(super) struct SurfaceMeasures {
    vertices: usize,
    euler_number: i64,
    pub(super) angle: f64,
    energy: f64,
    area: f64,
    volume: f64,
}

pub(super) fn measured(
    simulation: &mut Simulation,
    index: usize,
    geometry: Geometry,
    positions: &[[f64; 3]],
) -> SurfaceMeasures {
    let acting = simulation.resolve(positions);
    let body = &simulation.bodies()[index];
    let surface = body.surface(positions);
    let mut held = HeldExtents::new(body, geometry);
    let extents = surface.map(|surface| extents(surface, held.as_mut()));
    let [area, volume] = extents.unwrap_or([f64::NAN; 2]);
    SurfaceMeasures {
        vertices: body.mesh().vertex_count(),
        euler_number: body.mesh().euler_characteristic(),
        angle: surface.map_or(f64::NAN, smallest_angle),
        energy: acting.iter().map(|acting| acting.energy).sum(),
        area,
        volume,
    }
}
