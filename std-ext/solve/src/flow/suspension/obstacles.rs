//! Rigid bodies at rest in the fluid.

use glam::DVec3;
use helfrich::TriangleMesh;
use std::f64::consts::PI;
use std::ops::Range;

/// Closed rigid bodies at rest, around which the fluid flows without slipping. The tractions by which they hold it are
/// unknowns of the linear system of a suspension; a uniform pressure on a body, which moves nothing, is left out.
#[derive(Clone, Debug, Default)]
pub(super) struct Obstacles {
    /// Positions of all vertices.
    pub(super) positions: Vec<[f64; 3]>,
    /// A third of the area vectors of the triangles around each vertex.
    areas: Vec<DVec3>,
    /// A third of the areas of these triangles.
    weights: Vec<f64>,
    /// Vertices, area, and the traction that stands for a velocity, μ/a, with the radius a of a sphere of this area.
    bodies: Vec<(Range<usize>, f64, f64)>,
}

impl Obstacles {
    pub(super) fn new(bodies: &[(&TriangleMesh, &[[f64; 3]])], viscosity: f64) -> Self {
        let mut all = Self::default();
        for (mesh, positions) in bodies {
            let start = all.positions.len();
            all.positions.extend_from_slice(positions);
            all.areas.resize(all.positions.len(), DVec3::ZERO);
            all.weights.resize(all.positions.len(), 0.0);
            for corners in mesh.triangles() {
                let [a, b, c] = corners.map(|corner| DVec3::from(positions[corner as usize]));
                let third = (b - a).cross(c - a) / 6.0;
                for &corner in corners {
                    all.areas[start + corner as usize] += third;
                    all.weights[start + corner as usize] += third.length();
                }
            }
            let area: f64 = all.weights[start..].iter().sum();
            let over_radius = (4.0 * PI / area).sqrt();
            all.bodies
                .push((start..all.positions.len(), area, viscosity * over_radius));
        }
        all
    }

    /// Sets nodal forces on the fluid from tractions in units of velocities.
    pub(super) fn set_forces(&self, tractions: &[[f64; 3]], forces: &mut [[f64; 3]]) {
        for (vertices, _, unit) in &self.bodies {
            for vertex in vertices.clone() {
                let factor = unit * self.weights[vertex];
                forces[vertex] = tractions[vertex].map(|component| factor * component);
            }
        }
    }

    /// Adds to the velocities on each body the mean normal traction there, along the normal: the system then has one
    /// solution.
    pub(super) fn add_mean_pressure(&self, tractions: &[[f64; 3]], velocities: &mut [[f64; 3]]) {
        for (vertices, area, _) in &self.bodies {
            let outward = |vertex: usize| self.areas[vertex].dot(DVec3::from(tractions[vertex]));
            let mean = vertices.clone().map(outward).sum::<f64>() / area;
            for vertex in vertices.clone() {
                let normal = self.areas[vertex].normalize_or_zero();
                let sum = DVec3::from(velocities[vertex]) + mean * normal;
                velocities[vertex] = sum.to_array();
            }
        }
    }
}
