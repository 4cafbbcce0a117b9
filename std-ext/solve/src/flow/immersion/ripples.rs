//! Ripples of fluid membranes that are too short for the kernel.

use crate::dynamics::vector::{self, Vector};
use helfrich::{TriangleMesh, VertexKind};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// The response of the fluid to forces that cancel on the nodes around vertices.
///
/// The kernel spreads the force of a vertex over the nodes around it. Of waves shorter than about two nodes
/// the forces cancel there, so that neither surface tension nor bending resists them, and what the flow and
/// the motion of vertices along the membrane add to them stays and grows. The fluid's response to so short
/// waves is local: a pressure p of wave number k on a plane between fluids of viscosities μ and λμ moves it
/// with `p/(2(1 + λ)μk)`. Vertices move with this velocity as well, for the shortest waves of the mesh, k =
/// 4π/3ℓ with the mean edge ℓ. The part of p that varies from vertex to vertex is found by the operator
/// `(1 − M)ᵀ(1 − M)`, where M is the mean over the neighbours of a vertex; it has no negative eigenvalue, so
/// that energy only decreases. On smooth pressures it is of fourth order in ℓ.
#[derive(Debug, Default)]
pub struct Ripples {
    membranes: Vec<Rippling>,
    velocities: Vec<Vector>,
}

/// The largest eigenvalue of 1 − M on a triangular lattice.
const LARGEST: f64 = 1.5;

/// One fluid membrane.
#[derive(Debug)]
struct Rippling {
    mesh: Arc<TriangleMesh>,
    /// The vertices of the mesh, among those of all meshes.
    vertices: Range<usize>,
    /// 2(1 + λ)μ.
    viscosity: f64,
    /// The reciprocal number of neighbours of each vertex; 0 at a boundary, where nothing is moved.
    shares: Vec<f64>,
}

impl Ripples {
    /// Acts on the meshes that are `fluid`; all meshes follow one after the other, with their viscosity
    /// ratios, in a fluid of this viscosity.
    ///
    /// # Panics
    /// If there is not one ratio per mesh.
    pub fn new(
        meshes: &[Arc<TriangleMesh>],
        fluid: &dyn Fn(usize) -> bool,
        ratios: &[f64],
        viscosity: f64,
    ) -> Self {
        assert_eq!(meshes.len(), ratios.len(), "one viscosity ratio a mesh");
        let mut membranes = Vec::new();
        let mut first = 0;
        for (number, (mesh, ratio)) in meshes.iter().zip(ratios).enumerate() {
            let vertices = first..first + mesh.vertex_count();
            first = vertices.end;
            if !fluid(number) {
                continue;
            }
            let mut counts = vec![0.0; mesh.vertex_count()];
            for end in mesh.edges().as_flattened() {
                counts[*end as usize] += 1.0;
            }
            let share = |(vertex, count): (usize, &f64)| match mesh.vertex_kind(vertex) {
                VertexKind::Interior => f64::recip(*count),
                _ => 0.0,
            };
            membranes.push(Rippling {
                mesh: Arc::clone(mesh),
                vertices,
                viscosity: 2.0 * (1.0 + ratio) * viscosity,
                shares: counts.iter().enumerate().map(share).collect(),
            });
        }
        Self {
            membranes,
            velocities: Vec::new(),
        }
    }

    /// Finds the velocities at these positions under these nodal forces.
    pub(super) fn respond(&mut self, positions: &[Vector], forces: &[Vector]) {
        self.velocities.clear();
        self.velocities.resize(positions.len(), [0.0; 3]);
        for membrane in &self.membranes {
            let own = membrane.vertices.clone();
            let velocities = &mut self.velocities[own.clone()];
            membrane.respond(&positions[own.clone()], &forces[own], velocities);
        }
    }

    /// Adds the velocities that were found last.
    pub(super) fn add_to(&self, velocities: &mut [Vector]) {
        for (sum, velocity) in velocities.iter_mut().zip(&self.velocities) {
            *sum = vector::add(*sum, *velocity);
        }
    }
}

impl Rippling {
    fn respond(&self, positions: &[Vector], forces: &[Vector], velocities: &mut [Vector]) {
        // Six times the vertex areas along normals, and the mean edge from the total area.
        let mut doubled = vec![[0.0; 3]; positions.len()];
        for triangle in self.mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let normal = vector::cross(vector::sub(b, a), vector::sub(c, a));
            for &vertex in triangle {
                let sum = &mut doubled[vertex as usize];
                *sum = vector::add(*sum, normal);
            }
        }
        let areas = Vec::from_iter(doubled.iter().map(|&normal| vector::norm(normal) / 6.0));
        let mean = areas.iter().sum::<f64>() / self.mesh.triangles().len() as f64;
        let edge = (4.0 / 3f64.sqrt() * mean).sqrt();
        let normals = Vec::from_iter(doubled.into_iter().map(vector::unit));
        let pressures = forces.iter().zip(&normals).zip(&areas);
        let pressures = pressures.map(|((&force, &normal), &area)| match area > 0.0 {
            true => vector::dot(force, normal) / area,
            false => 0.0,
        });
        let pressures = Vec::from_iter(pressures);
        // (1 − M) p, and then (1 − M)ᵀ of that.
        let mut rough = pressures.clone();
        for &[a, b] in self.mesh.edges() {
            let [a, b] = [a as usize, b as usize];
            rough[a] -= self.shares[a] * pressures[b];
            rough[b] -= self.shares[b] * pressures[a];
        }
        for (rough, share) in rough.iter_mut().zip(&self.shares) {
            *rough = if *share > 0.0 { *rough } else { 0.0 };
        }
        let mut short = rough.clone();
        for &[a, b] in self.mesh.edges() {
            let [a, b] = [a as usize, b as usize];
            short[a] -= self.shares[b] * rough[b];
            short[b] -= self.shares[a] * rough[a];
        }
        let mobility = 3.0 * edge / (4.0 * PI * self.viscosity * LARGEST * LARGEST);
        for ((velocity, normal), (short, share)) in velocities
            .iter_mut()
            .zip(normals)
            .zip(short.iter().zip(&self.shares))
        {
            if *share > 0.0 {
                *velocity = vector::scale(mobility * short, normal);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ripples;
    use crate::dynamics::vector;
    use helfrich_mesh::generate::{AnyShape, Family, generate};
    use std::sync::Arc;

    /// Velocities along normals on a sphere under pressures along normals.
    fn responses<const N: usize>(pressures: [&dyn Fn(usize) -> f64; N]) -> [Vec<f64>; N] {
        let shape: AnyShape = "sphere".parse().expect("a shape");
        let made = generate(&shape, Family::Irregular, 162, 1).expect("a mesh");
        let (mesh, positions) = (Arc::new(made.mesh), made.positions);
        let mut thirds = vec![[0.0; 3]; positions.len()];
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let doubled = vector::cross(vector::sub(b, a), vector::sub(c, a));
            for &vertex in triangle {
                let sum = &mut thirds[vertex as usize];
                *sum = vector::add(*sum, vector::scale(1.0 / 6.0, doubled));
            }
        }
        let mut ripples = Ripples::new(&[mesh], &|_| true, &[1.0], 0.7);
        pressures.map(|pressure| {
            let forces = thirds.iter().enumerate();
            let forces = forces.map(|(vertex, &third)| vector::scale(pressure(vertex), third));
            ripples.respond(&positions, &Vec::from_iter(forces));
            let speeds = ripples.velocities.iter().zip(&thirds);
            let along = |(&velocity, &third)| vector::dot(velocity, vector::unit(third));
            speeds.map(along).collect()
        })
    }

    /// (1 − M)ᵀ(1 − M) is symmetric, has no negative eigenvalue, and leaves nothing of a constant.
    #[test]
    fn responses_to_pressures_are_symmetric_positive_and_to_differences_alone() {
        let one = |vertex: usize| (7.0 * vertex as f64).sin();
        let other = |vertex: usize| (vertex as f64 * vertex as f64).cos();
        let [by_one, by_other, by_none] = responses([&one, &other, &|_| 1.0]);
        let work = |pressure: &dyn Fn(usize) -> f64, speeds: &[f64]| -> f64 {
            let terms = speeds.iter().enumerate();
            terms.map(|(vertex, speed)| pressure(vertex) * speed).sum()
        };
        let size = work(&one, &by_one);
        assert!(size > 0.0 && work(&other, &by_other) > 0.0);
        let [there, back] = [work(&other, &by_one), work(&one, &by_other)];
        assert!((there - back).abs() < 1e-12 * size, "{there} and {back}");
        let most = by_none
            .iter()
            .fold(0.0_f64, |most, speed| most.max(speed.abs()));
        assert!(most < 1e-13 * size, "{most:e}");
    }
}
