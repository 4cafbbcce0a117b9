//! The immediate response of the velocities of points to forces on points.

use super::{Immersed, Kernel};
use crate::flow::lattice_boltzmann::{Lattice, Precision};

impl Immersed {
    /// Sets velocities to the immediate change by these forces on the points, relative to the
    /// result of [`Self::interpolate`]: half of the change in a step, which is `1/(2ρ) Σ φ F` on
    /// each node, or half of the sum without inertia. The lattice is not changed.
    ///
    /// The response is symmetric in the points, `Σ F·u(G) = Σ G·u(F)`, and `Σ F·u(F)` is not negative.
    ///
    /// # Panics
    /// If there is not one force and one velocity per point, or [`Self::interpolate`] has not been asked
    /// since they were placed, or they were placed in a lattice of another size.
    pub fn respond<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        forces: &[[f64; 3]],
        velocities: &mut [[f64; 3]],
    ) {
        assert_eq!(forces.len(), self.count(), "one force a point");
        assert_eq!(velocities.len(), self.count(), "one velocity a point");
        self.assert_size(lattice);
        let read = self.responses.len() == self.nodes.len() || self.stencils.is_empty();
        assert!(read, "velocities are interpolated before forces are added");
        self.nodes.fill([0.0; 3]);
        match self.kernel {
            Kernel::Two => self.push_nodes::<2>(forces),
            Kernel::Three => self.push_nodes::<3>(forces),
            Kernel::Four => self.push_nodes::<4>(forces),
        }
        for (node, response) in self.nodes.iter_mut().zip(&self.responses) {
            *node = node.map(|force| response * force);
        }
        self.interpolate_nodes(self.threads(lattice), velocities);
    }

    /// Adds the forces on the points to their nodes, in the order of the points.
    fn push_nodes<const POINTS: usize>(&mut self, forces: &[[f64; 3]]) {
        for (stencil, force) in self.stencils.iter().zip(forces) {
            let [x, y, z] = stencil.nodes::<POINTS>(self.cells);
            let [across_x, across_y, across_z] = stencil.weights;
            for k in 0..POINTS {
                for j in 0..POINTS {
                    let weight = across_y[j] * across_z[k];
                    let part = self.rows.part(x[0], y[j] + self.cells[1] * z[k]);
                    for i in 0..POINTS {
                        let weight = weight * across_x[i];
                        let node = &mut self.nodes[part.offset + x[i] - part.start];
                        for (sum, force) in node.iter_mut().zip(force) {
                            *sum += weight * force;
                        }
                    }
                }
            }
        }
    }
}
