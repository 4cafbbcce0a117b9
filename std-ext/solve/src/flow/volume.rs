//! Conservation of volumes.

use crate::dynamics::Held;
use glam::DVec3;
use helfrich::{AnyFunctional, Constraint, Constraints, Surface, TriangleMesh};
use helfrich_execute::execute::Shares;
use helfrich_shape::held::Quantity;
use std::ops::Range;
use std::sync::Arc;

/// Constant volumes of closed membranes, separately for each component.
///
/// A flow keeps them up to discretisation errors. Velocities are corrected along the normals n
/// of the vertices, so that the volume V of the polyhedron has no rate of change,
/// `u_i −= n_i (Σ_j ∂V/∂x_j·u_j)/(Σ_j ∂V/∂x_j·n_j)`; after each step positions are corrected for
/// the rest, which is of the order of the step's error.
#[derive(Debug, Default)]
pub struct KeptVolumes {
    volumes: Vec<KeptVolume>,
    shares: Shares,
}

/// The volume of one surface's components.
#[derive(Debug)]
struct KeptVolume {
    vertices: Range<usize>,
    held: Held,
    components: usize,
    gradient: Vec<[f64; 3]>,
}

impl KeptVolumes {
    /// Keeps the volume of each component of the closed meshes that are to be `kept`, at its value for
    /// these positions of all meshes, one after the other. Volumes of positions that are not finite are
    /// not kept.
    ///
    /// # Panics
    /// If there are fewer positions than vertices.
    pub fn new(
        meshes: &[Arc<TriangleMesh>],
        kept: &dyn Fn(usize) -> bool,
        positions: &[[f64; 3]],
    ) -> Self {
        let mut volumes = Vec::new();
        let mut first = 0;
        for (number, mesh) in meshes.iter().enumerate() {
            let vertices = first..first + mesh.vertex_count();
            first = vertices.end;
            let Ok(surface) = Surface::new(mesh, &positions[vertices.clone()]) else {
                continue;
            };
            if !(kept(number) && mesh.is_closed()) {
                continue;
            }
            let constraints = vec![Constraint {
                functional: AnyFunctional::Volume,
                targets: Quantity::targets(AnyFunctional::Volume, surface),
            }];
            let (_, components) = mesh.components();
            volumes.push(KeptVolume {
                held: Held::new(Arc::clone(mesh), Constraints { constraints }),
                components,
                gradient: vec![[0.0; 3]; vertices.len()],
                vertices,
            });
        }
        Self {
            volumes,
            shares: Shares::default(),
        }
    }

    /// Does `work` for the volumes that are `chosen` by their vertices, each with its part of some vectors.
    fn each(
        &mut self,
        chosen: &dyn Fn(&Range<usize>) -> bool,
        vectors: &mut [[f64; 3]],
        work: impl Fn(&mut KeptVolume, &mut [[f64; 3]]) + Sync,
    ) {
        let mut rest = vectors;
        let mut first = 0;
        let volumes = self.volumes.iter_mut();
        let parts = volumes
            .filter(|volume| chosen(&volume.vertices))
            .map(|volume| {
                let Range { start, end } = volume.vertices;
                let (_, after) = std::mem::take(&mut rest).split_at_mut(start - first);
                let (own, after) = after.split_at_mut(end - start);
                (rest, first) = (after, end);
                (end - start, (volume, own))
            });
        self.shares.each(parts, |(volume, own)| work(volume, own));
    }

    /// Removes the part of velocities that changes volumes.
    ///
    /// # Panics
    /// If there is not one position and one velocity per vertex.
    pub fn correct(&mut self, positions: &[[f64; 3]], velocities: &mut [[f64; 3]]) {
        self.correct_some(&|_| true, positions, velocities);
    }

    /// As [`Self::correct`], of the membranes that are `chosen` by their vertices alone.
    ///
    /// # Panics
    /// As there.
    pub(super) fn correct_some(
        &mut self,
        chosen: &dyn Fn(&Range<usize>) -> bool,
        positions: &[[f64; 3]],
        velocities: &mut [[f64; 3]],
    ) {
        self.each(chosen, velocities, |volume, velocities| {
            volume.correct(&positions[volume.vertices.clone()], velocities);
        });
    }

    /// Removes a uniform pressure from the nodal forces on each component: p ∂V/∂x_i with the mean p of the normal forces.
    /// Incompressible fluid inside carries a uniform pressure without any motion, but flat triangles make velocities of it,
    /// of second order in their edges; and in a drop it is 1/Ca times larger than the forces that move the drop.
    ///
    /// # Panics
    /// If there is not one position and one force per vertex.
    pub fn balance(&mut self, positions: &[[f64; 3]], forces: &mut [[f64; 3]]) {
        self.each(&|_| true, forces, |volume, forces| {
            volume.balance(&positions[volume.vertices.clone()], forces);
        });
    }

    /// Moves positions so that volumes have their initial values. If that fails, positions are
    /// unchanged, and the volume shows the error.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn restore(&mut self, positions: &mut [[f64; 3]]) {
        self.each(&|_| true, positions, |volume, positions| {
            let _ = volume.held.restore(positions);
        });
    }
}

impl KeptVolume {
    fn balance(&mut self, positions: &[[f64; 3]], forces: &mut [[f64; 3]]) {
        let normal = |gradient: DVec3, force: DVec3| gradient.normalize_or_zero().dot(force);
        let pressures = self.means(positions, forces, normal);
        let groups = self.held.groups().iter().zip(&self.gradient);
        for ((&group, &gradient), force) in groups.zip(forces) {
            let pressure = pressures[group as usize];
            *force = (DVec3::from(*force) - pressure * DVec3::from(gradient)).to_array();
        }
    }

    fn correct(&mut self, positions: &[[f64; 3]], velocities: &mut [[f64; 3]]) {
        let speeds = self.means(positions, velocities, DVec3::dot);
        let groups = self.held.groups().iter().zip(&self.gradient);
        for ((&group, &gradient), velocity) in groups.zip(velocities) {
            let normal = DVec3::from(gradient).normalize_or_zero();
            let speed = speeds[group as usize];
            *velocity = (DVec3::from(*velocity) - speed * normal).to_array();
        }
    }

    /// For each component, the sum over its vertices of a product of the gradient of the volume and a vector there, over the
    /// sum of the lengths of the gradients, which is its area; 0 without area.
    fn means(
        &mut self,
        positions: &[[f64; 3]],
        vectors: &[[f64; 3]],
        product: impl Fn(DVec3, DVec3) -> f64,
    ) -> Vec<f64> {
        self.held.gradient(0, positions, &mut self.gradient);
        let mut sums = vec![[0.0; 2]; self.components];
        let groups = self.held.groups().iter().zip(&self.gradient);
        for ((&group, &gradient), &vector) in groups.zip(vectors) {
            let gradient = DVec3::from(gradient);
            let [sum, area] = &mut sums[group as usize];
            *sum += product(gradient, vector.into());
            *area += gradient.length();
        }
        let means = sums.into_iter();
        let means = means.map(|[sum, area]| if area > 0.0 { sum / area } else { 0.0 });
        means.collect()
    }
}
