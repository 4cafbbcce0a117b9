//! Nodes inside closed surfaces, and obstacles.

use crate::flow::lattice_boltzmann::boundary::{FIRST_OBSTACLE, Links, wall};
use crate::flow::lattice_boltzmann::stencil::Q;
use crate::flow::lattice_boltzmann::voxel::for_each_row_inside;
use crate::flow::lattice_boltzmann::{Lattice, LatticeError, Precision};
use helfrich::{Surface, TriangleMesh};
use std::ops::Range;

impl<T: Precision> Lattice<T> {
    /// The numbers of the nodes inside a closed surface; x runs fastest, then y. On periodic axes
    /// the surface may lie anywhere, and continues at the other side.
    ///
    /// # Errors
    /// If the positions do not fit the mesh or are not finite, if they reach more than a box beyond
    /// walls, or over more than two periods, or if the mesh is open.
    pub fn inside(
        &self,
        mesh: &TriangleMesh,
        positions: &[[f64; 3]],
    ) -> Result<Vec<bool>, LatticeError> {
        let length = self.layout.cells[0];
        let mut inside = vec![false; self.layout.nodes()];
        self.for_each_row_inside(Surface::new(mesh, positions)?, |row, nodes, _| {
            inside[row * length..][nodes].fill(true);
        })?;
        Ok(inside)
    }

    /// Calls `inside` for each row along x of nodes inside a closed surface, with the number of the
    /// row, counted along y, then z, the range of its nodes, and the distance between the two
    /// crossings of the line through them with the surface.
    pub(super) fn for_each_row_inside(
        &self,
        surface: Surface<'_, f64>,
        mut inside: impl FnMut(usize, Range<usize>, f64),
    ) -> Result<(), LatticeError> {
        if !surface.mesh().is_closed() {
            return Err(LatticeError::Open {
                boundary_edges: surface.mesh().boundary_edge_count(),
            });
        }
        let cells = self.layout.cells;
        let mut positions = surface.positions().to_vec();
        for axis in 0..3 {
            let length = cells[axis] as f64;
            if self.is_periodic(axis) {
                let low = (positions.iter().map(|x| x[axis])).fold(f64::INFINITY, f64::min);
                let periods = (low / length).floor() * length;
                positions.iter_mut().for_each(|x| x[axis] -= periods);
            }
            for position in &positions {
                if !(-length..=2.0 * length).contains(&position[axis]) {
                    return Err(LatticeError::FarAway {
                        axis,
                        coordinate: position[axis],
                        cells: cells[axis],
                    });
                }
            }
        }
        let in_box = |axis: usize, index: i64| {
            let count = cells[axis] as i64;
            (self.is_periodic(axis) || (0..count).contains(&index))
                .then(|| index.rem_euclid(count) as usize)
        };
        let length = cells[0] as i64;
        for_each_row_inside(
            surface.mesh().triangles(),
            &positions,
            |row, j, k, distance| {
                let (Some(y), Some(z)) = (in_box(1, j), in_box(2, k)) else {
                    return;
                };
                // What lies in the box, and in its image behind if there is one.
                let images = if self.is_periodic(0) { 0..2 } else { 0..1 };
                for shift in images.map(|image| image * length) {
                    let (start, end) = (row.start.max(shift), row.end.min(shift + length));
                    if start < end {
                        let nodes = (start - shift) as usize..(end - shift) as usize;
                        inside(y + cells[1] * z, nodes, distance);
                    }
                }
            },
        );
        Ok(())
    }

    /// Adds an obstacle at rest to the fluid, and returns its number. Its surface lies half-way
    /// between nodes inside and outside of the mesh; the fluid inside stays there.
    ///
    /// # Errors
    /// As [`Self::inside`], and if there is no node inside.
    pub fn add_obstacle(
        &mut self,
        mesh: &TriangleMesh,
        positions: &[[f64; 3]],
    ) -> Result<usize, LatticeError> {
        let inside = self.inside(mesh, positions)?;
        if !inside.contains(&true) {
            return Err(LatticeError::NothingInside);
        }
        let limit = usize::from(u16::MAX) - FIRST_OBSTACLE;
        if self.obstacles == limit {
            return Err(LatticeError::TooManyObstacles { limit });
        }
        let odd = self.odd();
        let label = (FIRST_OBSTACLE + self.obstacles) as u16;
        let labels = (self.labels).get_or_insert_with(|| vec![0; self.layout.nodes()]);
        let own = self.parts.own();
        for (node, _) in inside.iter().enumerate().filter(|&(_, &inside)| inside) {
            labels[node] = label;
            let cell = self.layout.cell(node);
            if !own.contains(&cell[2]) {
                continue;
            }
            for direction in 0..Q {
                self.state.populations[self.layout.place(odd, direction, cell)] = T::zero();
            }
        }
        self.links = Links::new(&self.layout, &self.parts, &self.setup.sides, Some(labels));
        self.obstacles += 1;
        Ok(self.obstacles - 1)
    }

    /// Whether a node lies inside an obstacle.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn is_solid(&self, cell: [usize; 3]) -> bool {
        self.assert_inside(cell);
        self.is_labelled(self.layout.node(cell))
    }

    pub(super) fn is_labelled(&self, node: usize) -> bool {
        (self.labels.as_ref()).is_some_and(|labels| labels[node] != 0)
    }

    /// Forces of the fluid on the walls at the start and the end of an axis in the last step,
    /// without the pressure of the fluid at rest, which is 1/3. 0 if there are no walls.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn wall_forces(&self, axis: usize) -> [[f64; 3]; 2] {
        assert!(axis < 3, "there is no axis {axis}");
        [false, true].map(|high| self.links.force(wall(axis, high)).unwrap_or_default())
    }

    /// Force of the fluid on an obstacle in the last step, by bounce-back only: an external force
    /// on every node does not act on the obstacle itself.
    ///
    /// # Panics
    /// If there is no such obstacle.
    pub fn obstacle_force(&self, obstacle: usize) -> [f64; 3] {
        assert!(obstacle < self.obstacles, "there is no obstacle {obstacle}");
        // An obstacle completely inside others has no links.
        self.links
            .force(FIRST_OBSTACLE + obstacle)
            .unwrap_or_default()
    }
}
