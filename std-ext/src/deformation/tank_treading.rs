//! How often a membrane has gone around its inside.

use super::{Deformation, ShearPlane};
use glam::DVec3;
use helfrich::Surface;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// How often the material of a membrane has gone around the centroid, seen from the body's long
/// axis: whole turns for a tank-treading capsule, none for one that tumbles as if it were rigid.
///
/// The angles of vertices near the shear plane are followed from call to call and their mean is
/// taken, turns from the gradient to the flow positive, as simple shear goes. The long axis counts
/// from when D in the plane is 0.01: before that its direction is an accident of the mesh.
///
/// It is plain data, so that a run that is stopped goes on with the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TankTreading {
    plane: ShearPlane,
    vertices: Vec<u32>,
    /// Of each of them, the angle against the flow in radians, as it was last.
    phases: Vec<f64>,
    /// Turns of the material, and of the long axis.
    material: f64,
    axis: f64,
    /// The inclination as it was last, once there is one.
    inclination: Option<f64>,
    time: f64,
    /// The whole number of turns that was passed last, and when.
    passed: (f64, f64),
    period: Option<f64>,
}

impl TankTreading {
    /// Least D in the plane for which there is a long axis.
    const LEAST_DEFORMATION: f64 = 0.01;
    /// How far from the shear plane vertices are followed, in units of the farthest.
    const BAND: f64 = 0.3;
    /// How near to the centroid, in units of the farthest.
    const HUB: f64 = 0.1;

    /// Begins to follow a surface that is there at a time; `deformation` is its own.
    pub fn new(
        surface: Surface<'_, f64>,
        deformation: &Deformation,
        plane: ShearPlane,
        time: f64,
    ) -> Self {
        let centre = DVec3::from(deformation.centroid);
        let normal = DVec3::from(plane.normal());
        let offsets = surface.positions().iter();
        // Distance from the plane and, in it, from the centroid.
        let offsets = Vec::from_iter(offsets.map(|&position| {
            let offset = DVec3::from(position) - centre;
            let [x, y] = plane.coordinates(offset);
            [offset.dot(normal).abs(), x.hypot(y)]
        }));
        let [farthest, widest] = [0, 1].map(|part| {
            let distances = offsets.iter().map(|offset| offset[part]);
            distances.fold(0.0, f64::max)
        });
        let followed = |&vertex: &u32| {
            let [away, radius] = offsets[vertex as usize];
            away <= Self::BAND * farthest && radius > Self::HUB * widest
        };
        let all = 0..offsets.len() as u32;
        let mut vertices = Vec::from_iter(all.clone().filter(followed));
        if vertices.is_empty() {
            // A few vertices, none near the plane: the widest goes around for all.
            let radius = |&vertex: &u32| offsets[vertex as usize][1];
            vertices.extend(all.max_by(|a, b| radius(a).total_cmp(&radius(b))));
        }
        let mut state = Self {
            plane,
            vertices,
            phases: Vec::new(),
            material: 0.0,
            axis: 0.0,
            inclination: None,
            time,
            passed: (0.0, time),
            period: None,
        };
        state.phases = state.phases_of(surface, deformation);
        state.inclination = state.inclination_of(deformation);
        state
    }

    /// Follows the surface to a later time. Between two calls no vertex may turn by half a turn about
    /// the centroid, nor the long axis by a quarter: at most a radian of shear, γ̇ Δt ≤ 1, is safe.
    ///
    /// # Panics
    /// If the surface has fewer vertices than it had.
    pub fn update(&mut self, time: f64, surface: Surface<'_, f64>, deformation: &Deformation) {
        let before = self.turns();
        let phases = self.phases_of(surface, deformation);
        let angles = self.phases.iter().zip(&phases);
        let turned: f64 = angles.map(|(old, new)| nearest(old - new, TAU)).sum();
        self.material += turned / (TAU * phases.len() as f64);
        self.phases = phases;
        let inclination = self.inclination_of(deformation);
        if let (Some(old), Some(new)) = (self.inclination, inclination) {
            self.axis += nearest(old - new, PI) / TAU;
        }
        self.inclination = inclination.or(self.inclination);
        let after = self.turns();
        let (last, since) = self.passed;
        let next = last + (after - last).signum();
        if (after - last).abs() >= 1.0 {
            let at = self.time + (next - before) / (after - before) * (time - self.time);
            self.period = Some(at - since);
            self.passed = (next, at);
        }
        self.time = time;
    }

    /// Turns of the material against the long axis since the beginning.
    pub fn turns(&self) -> f64 {
        self.material - self.axis
    }

    /// Turns of the long axis since the beginning: those of a body that tumbles.
    pub fn axis_turns(&self) -> f64 {
        self.axis
    }

    /// How long the last whole turn took, between calls in proportion; NaN before the first is done,
    /// which has the start in it.
    pub fn period(&self) -> f64 {
        self.period.unwrap_or(f64::NAN)
    }

    fn phases_of(&self, surface: Surface<'_, f64>, deformation: &Deformation) -> Vec<f64> {
        let centre = DVec3::from(deformation.centroid);
        let phase = |&vertex: &u32| {
            let offset = DVec3::from(surface.positions()[vertex as usize]) - centre;
            let [x, y] = self.plane.coordinates(offset);
            y.atan2(x)
        };
        self.vertices.iter().map(phase).collect()
    }

    /// In radians; none for what is as good as round.
    fn inclination_of(&self, deformation: &Deformation) -> Option<f64> {
        let body = deformation.in_plane(self.plane);
        let is_long = body.taylor() >= Self::LEAST_DEFORMATION;
        is_long.then(|| body.inclination.to_radians())
    }
}

/// An angle, less as many times `whole` as bring it nearest to 0.
fn nearest(angle: f64, whole: f64) -> f64 {
    angle - whole * (angle / whole).round()
}
