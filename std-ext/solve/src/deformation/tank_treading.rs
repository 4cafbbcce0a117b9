//! Tank-treading: rotation of a membrane around the fluid inside.

use super::{Deformation, ShearPlane};
use glam::DVec3;
use helfrich::Surface;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Turns of the material of a membrane around the centroid, relative to the long axis of the body: whole
/// turns for a tank-treading capsule, none for a capsule that tumbles like a rigid body.
///
/// The mean of the angles of vertices near the shear plane is followed from call to call. Turns
/// from the gradient to the flow are positive, as in simple shear. The long axis is followed only
/// from D = 0.01 in the plane on, because before that its direction depends on the mesh.
///
/// Vertices that slide along the membrane, as on fluid membranes, do not mark its material. In this
/// case the angles of markers that start at the vertices are advanced with the velocities of the
/// material.
///
/// The state is plain data, so that a resumed run continues with the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TankTreading {
    plane: ShearPlane,
    vertices: Vec<u32>,
    /// The last angle from the flow, in radians, of each of these vertices, or of the marker that
    /// started there.
    phases: Vec<f64>,
    /// The last rates of rotation of the material, if vertices slide: ascending angles, and their
    /// rates.
    rates: Vec<[f64; 2]>,
    /// Turns of the material, and of the long axis.
    material: f64,
    axis: f64,
    /// The last inclination, once defined.
    inclination: Option<f64>,
    time: f64,
    /// The last completed whole turn, and its time.
    passed: (f64, f64),
    period: Option<f64>,
}

impl TankTreading {
    /// Least D in the plane for which there is a long axis.
    const LEAST_DEFORMATION: f64 = 0.01;
    /// Largest distance from the shear plane of followed vertices, in units of the farthest vertex.
    const BAND: f64 = 0.3;
    /// Least distance from the centroid of followed vertices, in units of the farthest vertex.
    const HUB: f64 = 0.1;

    /// Starts to follow a surface at a time, with its deformation at that time.
    pub fn new(
        surface: Surface<'_, f64>,
        deformation: &Deformation,
        plane: ShearPlane,
        time: f64,
    ) -> Self {
        let mut state = Self {
            plane,
            vertices: Self::near(plane, surface, deformation),
            phases: Vec::new(),
            rates: Vec::new(),
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

    /// The vertices near the plane and not near the centroid; at least one.
    fn near(plane: ShearPlane, surface: Surface<'_, f64>, deformation: &Deformation) -> Vec<u32> {
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
            // If there are only a few vertices and none is near the plane, the vertex farthest from the
            // centroid represents all.
            let radius = |&vertex: &u32| offsets[vertex as usize][1];
            vertices.extend(all.max_by(|a, b| radius(a).total_cmp(&radius(b))));
        }
        vertices
    }

    /// Continues on a new mesh of the surface at the same time: follows its vertices from where they are. Markers that move
    /// with the velocities of the material stay where they are.
    pub fn on_new_mesh(&mut self, surface: Surface<'_, f64>, deformation: &Deformation) {
        self.vertices = Self::near(self.plane, surface, deformation);
        if self.rates.is_empty() {
            self.phases = self.phases_of(surface, deformation);
        }
    }

    /// Follows the surface to a later time. Between two calls no vertex may rotate by half a turn about
    /// the centroid, nor the long axis by a quarter turn: a strain of one between calls, γ̇ Δt ≤ 1, is
    /// safe.
    ///
    /// # Panics
    /// If the surface has fewer vertices than at the start.
    pub fn update(&mut self, time: f64, surface: Surface<'_, f64>, deformation: &Deformation) {
        let phases = self.phases_of(surface, deformation);
        self.turn(time, phases, deformation);
    }

    /// Follows the material of a surface whose vertices slide along it, by the velocities of the
    /// material at the vertices at this later time. The rotation between two calls is limited as for
    /// [`Self::update`].
    ///
    /// # Panics
    /// If there is not one velocity per vertex.
    pub fn update_by_velocities(
        &mut self,
        time: f64,
        surface: Surface<'_, f64>,
        deformation: &Deformation,
        velocities: &[[f64; 3]],
    ) {
        let rates = self.rates_of(surface, deformation, velocities);
        let before = if self.rates.is_empty() {
            &rates
        } else {
            &self.rates
        };
        let step = time - self.time;
        let moved = self.phases.iter().map(|&phase| {
            let first = rate_at(before, phase);
            let second = rate_at(&rates, phase + step * first);
            phase + 0.5 * step * (first + second)
        });
        let phases = moved.collect();
        self.rates = rates;
        self.turn(time, phases, deformation);
    }

    /// Advances to a later time and new angles.
    fn turn(&mut self, time: f64, phases: Vec<f64>, deformation: &Deformation) {
        let before = self.turns();
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

    /// Turns of the material relative to the long axis since the start.
    pub fn turns(&self) -> f64 {
        self.material - self.axis
    }

    /// Turns of the long axis since the start, as of a tumbling body.
    pub fn axis_turns(&self) -> f64 {
        self.axis
    }

    /// The duration of the last whole turn, interpolated between calls; NaN until the first turn is
    /// complete, which includes the start.
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

    /// The angles of vertices near the plane, from −π to π and ascending, and the rates at which they
    /// change by these velocities.
    fn rates_of(
        &self,
        surface: Surface<'_, f64>,
        deformation: &Deformation,
        velocities: &[[f64; 3]],
    ) -> Vec<[f64; 2]> {
        let centre = DVec3::from(deformation.centroid);
        let offset = |vertex: u32| DVec3::from(surface.positions()[vertex as usize]) - centre;
        let velocity = |vertex: u32| DVec3::from(velocities[vertex as usize]);
        // Subtracts the velocity of the centroid: ∮ (x − c) u·dS/V.
        let mut drift = DVec3::ZERO;
        for &[a, b, c] in surface.mesh().triangles() {
            let [p, q, r] = [a, b, c].map(offset);
            let through = (q - p)
                .cross(r - p)
                .dot(velocity(a) + velocity(b) + velocity(c));
            drift += through / 18.0 * (p + q + r);
        }
        drift /= deformation.volume;
        let vertices = Self::near(self.plane, surface, deformation).into_iter();
        let rates = vertices.map(|vertex| {
            let [x, y] = self.plane.coordinates(offset(vertex));
            let [u, v] = self.plane.coordinates(velocity(vertex) - drift);
            [y.atan2(x), (x * v - y * u) / (x * x + y * y)]
        });
        let mut rates = Vec::from_iter(rates);
        rates.sort_by(|[a, _], [b, _]| a.total_cmp(b));
        rates
    }

    /// The inclination in radians; none for a nearly circular section.
    fn inclination_of(&self, deformation: &Deformation) -> Option<f64> {
        let body = deformation.in_plane(self.plane);
        let is_long = body.taylor() >= Self::LEAST_DEFORMATION;
        is_long.then(|| body.inclination.to_radians())
    }
}

/// The rate at some angle, linear between ascending ones.
fn rate_at(rates: &[[f64; 2]], phase: f64) -> f64 {
    let phase = nearest(phase, TAU);
    let after = rates.partition_point(|&[angle, _]| angle <= phase);
    let (Some(&first), Some(&last)) = (rates.first(), rates.last()) else {
        return 0.0;
    };
    let before = match after {
        0 => [last[0] - TAU, last[1]],
        _ => rates[after - 1],
    };
    let next = rates.get(after);
    let next = next.copied().unwrap_or([first[0] + TAU, first[1]]);
    let share = (phase - before[0]) / (next[0] - before[0]);
    if share.is_finite() {
        before[1] + share * (next[1] - before[1])
    } else {
        before[1]
    }
}

/// An angle modulo `whole`, nearest to 0.
fn nearest(angle: f64, whole: f64) -> f64 {
    angle - whole * (angle / whole).round()
}
