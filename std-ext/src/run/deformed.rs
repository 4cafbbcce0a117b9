//! What a flow does to surfaces: the numbers by which capsules are judged.

use crate::deformation::{
    Deformation, ShearPlane, TankTreading, extremes, taylor, wrinkle_indicator,
};
use crate::simulation::{Body, Simulation};
use serde::{Deserialize, Serialize};

/// The columns of closed surfaces, and what has to be followed from step to step for them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Deformed {
    plane: Option<ShearPlane>,
    /// Of each surface that has a shear plane.
    turning: Vec<Option<TankTreading>>,
}

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
        Self {
            plane,
            turning: turning.collect(),
        }
    }

    /// To be called after every step.
    pub(super) fn follow(&mut self, time: f64, simulation: &Simulation, positions: &[[f64; 3]]) {
        for (turning, body) in self.turning.iter_mut().zip(simulation.bodies()) {
            if let (Some(turning), Some(surface)) = (turning, body.surface(positions))
                && let Some(deformation) = Deformation::new(surface)
            {
                turning.update(time, surface, &deformation);
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

fn is_closed(body: &Body) -> bool {
    body.mesh().is_closed()
}
