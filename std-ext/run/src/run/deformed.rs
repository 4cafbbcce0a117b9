//! Deformation of surfaces in a flow, in the numbers that are common for capsules.

use crate::deformation::{
    Deformation, ShearPlane, TankTreading, extremes, roughness, taylor, wrinkle_indicator,
};
use crate::enclosure::Inside;
use crate::execute::Shares;
use crate::simulation::{Body, Crossing, NARROW, Simulation};
use helfrich::Surface;
use serde::{Deserialize, Serialize};

/// The deformation columns of closed surfaces, with the state that they need from step to step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Deformed {
    plane: Option<ShearPlane>,
    /// Tank-treading of each surface that has a shear plane.
    turning: Vec<Option<TankTreading>>,
    /// Roughness of each surface at the start.
    roughness: Vec<f64>,
    /// Smallest angle of each surface at the start, in degrees.
    angles: Vec<f64>,
    /// The division of surfaces among threads.
    #[serde(skip)]
    following: Shares,
}

/// Roughness above which a surface counts as rough at the scale of its mesh, if it also exceeds twice
/// the initial roughness. Smooth capsules stay below 0.1, and wrinkled ones reach 0.3 to 2.
const ROUGH: f64 = 0.25;

impl Deformed {
    pub(super) fn new(
        plane: Option<[[f64; 3]; 2]>,
        simulation: &Simulation,
        positions: &[[f64; 3]],
    ) -> Self {
        let plane = plane.and_then(|[flow, gradient]| ShearPlane::new(flow, gradient));
        let turning = simulation.bodies().iter().map(|body| {
            let surface = body.surface(positions)?;
            let deformation = Deformation::new(surface)?;
            Some(TankTreading::new(surface, &deformation, plane?, 0.0))
        });
        let roughnesses = simulation.bodies().iter().map(|body| {
            let surface = body.surface(positions);
            surface.map_or(f64::NAN, roughness)
        });
        let angles = simulation.bodies().iter().map(|body| {
            let surface = body.surface(positions);
            surface.map_or(f64::NAN, smallest_angle)
        });
        Self {
            plane,
            turning: turning.collect(),
            roughness: roughnesses.collect(),
            angles: angles.collect(),
            following: Shares::default(),
        }
    }

    /// Adds untrustworthy results to the notes, each once: fluid surfaces whose triangles have become
    /// narrow, surfaces that are wrinkled at the scale of their mesh, and surfaces that have entered
    /// each other. `caption` names the time.
    pub(super) fn note(
        &self,
        simulation: &Simulation,
        positions: &[[f64; 3]],
        caption: &str,
        notes: &mut Vec<String>,
    ) {
        let mut add = |what: String, why: String| {
            if !notes.iter().any(|note| note.contains(&what)) {
                notes.push(format!("from {caption}: {what}{why}"));
            }
        };
        let bodies = simulation.bodies().iter().zip(&self.angles);
        for (body, start) in bodies.filter(|(body, _)| body.slides()) {
            let found = body.surface(positions).map_or(f64::NAN, smallest_angle);
            if found < start.min(NARROW) {
                add(
                    format!("triangles of \"{}\" have become narrow", body.name()),
                    format!(
                        " (an angle of {found:.1}°, {start:.1}° at the start): its mesh no longer fits \
                         its shape, and numbers are less and less accurate from here; `redistribution` \
                         keeps meshes even as long as it can, beyond that a mesh whose start is nearer \
                         to this shape would help"
                    ),
                );
            }
        }
        for (body, start) in simulation.bodies().iter().zip(&self.roughness) {
            let found = body.surface(positions).map_or(f64::NAN, roughness);
            if found > f64::max(ROUGH, 2.0 * start) {
                add(
                    format!(
                        "surface \"{}\" is wrinkled at the scale of its mesh",
                        body.name()
                    ),
                    format!(
                        " (curvature changes by {:.0} % from vertex to vertex, {:.0} % at the start): \
                         more bending, or a finer mesh, would show whether the wrinkles are real",
                        100.0 * found,
                        100.0 * start
                    ),
                );
            }
        }
        for crossing in simulation.crossings(positions) {
            let into = crossing.into.as_ref();
            let into = into.map_or("its own image".to_owned(), |name| format!("\"{name}\""));
            add(
                format!("surface \"{}\" has gone into {into}", crossing.surface),
                gone_into(&crossing.inside, simulation.is_repelled(&crossing)),
            );
        }
    }

    /// Updates tank-treading; has to be called after every step. `velocities` are the velocities of the
    /// material, if vertices of fluid surfaces do not follow it.
    pub(super) fn follow(
        &mut self,
        time: f64,
        simulation: &Simulation,
        positions: &[[f64; 3]],
        material: Option<&[[f64; 3]]>,
    ) {
        let parts = self.turning.iter_mut().zip(simulation.bodies());
        let parts = parts.filter_map(|(turning, body)| {
            let (turning, surface) = (turning.as_mut()?, body.surface(positions)?);
            let material = material.filter(|_| body.slides());
            let velocities = material.map(|all| &all[body.vertices()]);
            Some((body.vertices().len(), (turning, surface, velocities)))
        });
        let follow = |(turning, surface, velocities): (&mut TankTreading, _, Option<&[_]>)| {
            let Some(deformation) = Deformation::new(surface) else {
                return;
            };
            match velocities {
                None => turning.update(time, surface, &deformation),
                Some(velocities) => {
                    turning.update_by_velocities(time, surface, &deformation, velocities);
                }
            }
        };
        self.following.each(parts, follow);
    }

    /// Must be called when surfaces have got new meshes, with their positions.
    pub(super) fn meshes_changed(&mut self, simulation: &Simulation, positions: &[[f64; 3]]) {
        for (turning, body) in self.turning.iter_mut().zip(simulation.bodies()) {
            if let (Some(turning), Some(surface)) = (turning, body.surface(positions))
                && let Some(deformation) = Deformation::new(surface)
            {
                turning.on_new_mesh(surface, &deformation);
            }
        }
    }

    pub(super) fn columns(&self, simulation: &Simulation) -> Vec<String> {
        let mut columns = Vec::new();
        for body in simulation.bodies().iter().filter(|body| is_closed(body)) {
            let mut names = vec!["deformation"];
            if self.plane.is_some() {
                names.extend([
                    "deformation_extreme",
                    "inclination",
                    "tank_treading_turns",
                    "tank_treading_period",
                ]);
            }
            names.extend(["wrinkles", "centroid_x", "centroid_y", "centroid_z"]);
            columns.extend(names.into_iter().map(|name| simulation.label(name, body)));
        }
        columns
    }

    pub(super) fn numbers(&self, simulation: &Simulation, positions: &[[f64; 3]]) -> Vec<f64> {
        let mut numbers = Vec::new();
        let bodies = simulation.bodies().iter().zip(&self.turning);
        for (body, turning) in bodies.filter(|(body, _)| is_closed(body)) {
            let surface = body.surface(positions);
            let Some((surface, found)) = surface.and_then(|s| Some((s, Deformation::new(s)?)))
            else {
                let count = if self.plane.is_some() { 9 } else { 5 };
                numbers.extend(std::iter::repeat_n(f64::NAN, count));
                continue;
            };
            match self.plane {
                Some(plane) => {
                    let ellipse = found.in_plane(plane);
                    let extremes = extremes(surface, found.centroid, plane);
                    numbers.extend([
                        ellipse.taylor(),
                        extremes.map_or(f64::NAN, taylor),
                        ellipse.inclination,
                        turning.as_ref().map_or(f64::NAN, TankTreading::turns),
                        turning.as_ref().map_or(f64::NAN, TankTreading::period),
                    ]);
                }
                None => numbers.push(found.taylor()),
            }
            numbers.push(wrinkle_indicator(surface));
            numbers.extend(found.centroid);
        }
        numbers
    }
}

/// The smallest angle of a surface, in degrees.
pub(super) fn smallest_angle(surface: Surface<'_, f64>) -> f64 {
    let triangles = 0..surface.mesh().triangles().len();
    let angles = triangles.flat_map(|triangle| surface.triangle_angles(triangle));
    angles.fold(f64::INFINITY, f64::min).to_degrees()
}

/// The end of a message about a run that has failed while surfaces overlap, which is then the reason;
/// empty if none do.
pub(super) fn overlap(simulation: &Simulation, positions: &[[f64; 3]]) -> Option<String> {
    let crossings = simulation.crossings(positions);
    let Crossing {
        surface,
        into,
        inside,
    } = crossings.first()?;
    let into = into.as_ref();
    let into = into.map_or("its own image".to_owned(), |name| format!("\"{name}\""));
    Some(format!(
        ": \"{surface}\" overlaps {into}, with {} vertices inside, {} the first: begin with surfaces that \
         are apart",
        inside.count, inside.first
    ))
}

/// Message about surfaces that are inside each other, with a remedy.
fn gone_into(inside: &Inside, is_repelled: bool) -> String {
    let through = if inside.is_by_image() {
        " through the ends of the periodic box"
    } else {
        ""
    };
    let remedy = match is_repelled {
        true => {
            "their `repulsion` has not kept them apart: surfaces that are apart at the start, a larger \
             `strength`, a longer `cutoff` or a finer mesh would"
        }
        false => {
            "a `repulsion` between them, a finer mesh or a smaller tolerance would keep them apart"
        }
    };
    format!(
        " (vertex {} is the first of {}{through}): {remedy}",
        inside.first, inside.count
    )
}

fn is_closed(body: &Body) -> bool {
    body.mesh().is_closed()
}
