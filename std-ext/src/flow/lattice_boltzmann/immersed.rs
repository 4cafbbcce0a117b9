//! Points that move with the fluid, and the forces on it that they carry.
//!
//! C. S. Peskin, Acta Numerica 11 (2002) 479; the kernel of three points: A. M. Roma, C. S. Peskin,
//! M. J. Berger, J. Comput. Phys. 153 (1999) 509.

use crate::flow::lattice_boltzmann::force::{ForceSlab, checked_force};
use crate::flow::lattice_boltzmann::reading::{Moments, Row};
use crate::flow::lattice_boltzmann::{Lattice, LatticeError, Precision};
use serde::{Deserialize, Serialize};
use std::array;

/// Fewer points than this take less time than to start a thread.
const POINTS_A_THREAD: usize = 1024;

/// Fewer nodes than this between two parts of a row take less time than another part: they share
/// cache lines with them.
const NODES_LEFT_OUT: usize = 16;

/// How a point is spread over the nodes around it: a product φ(x) φ(y) φ(z) of the distances.
///
/// Of each, Σ φ = 1 and Σ r φ = 0 over the nodes wherever the point lies: forces and torques are
/// kept, and linear fields are interpolated exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// 1 − |r|: linear interpolation. The sharpest; edges of membranes at most 1.5 nodes long.
    Two,
    /// Continuously differentiable, with Σ φ² = 1/2.
    Three,
    /// Continuously differentiable, with Σ φ² = 3/8, and as much on even nodes as on odd ones.
    Four,
}

impl Kernel {
    /// Number of nodes along each axis.
    pub fn points(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
            Self::Four => 4,
        }
    }

    /// φ at a distance in units of the distance of nodes; 0 beyond half of [`Self::points`].
    pub fn weight(self, distance: f64) -> f64 {
        let r = distance.abs();
        match self {
            Self::Two => (1.0 - r).max(0.0),
            Self::Three if r <= 0.5 => (1.0 + (1.0 - 3.0 * r * r).sqrt()) / 3.0,
            Self::Three if r <= 1.5 => {
                let s = 1.0 - r;
                (5.0 - 3.0 * r - (1.0 - 3.0 * s * s).sqrt()) / 6.0
            }
            Self::Four if r <= 1.0 => (3.0 - 2.0 * r + (1.0 + 4.0 * r * (1.0 - r)).sqrt()) / 8.0,
            Self::Four if r <= 2.0 => {
                let squared = 12.0 * r - 7.0 - 4.0 * r * r;
                (5.0 - 2.0 * r - squared.sqrt()) / 8.0
            }
            Self::Three | Self::Four => 0.0,
        }
    }

    /// The first node that a coordinate reaches.
    fn first(self, coordinate: f64) -> f64 {
        match self {
            Self::Two => (coordinate - 0.5).floor(),
            Self::Three => coordinate.floor() - 1.0,
            Self::Four => (coordinate - 0.5).floor() - 1.0,
        }
    }
}

/// Points in the fluid, such as the vertices of membranes.
///
/// A step of membranes is: [`Self::place`] the vertices, [`Lattice::clear_forces`],
/// [`Self::spread`] their forces, [`Self::interpolate`] velocities, [`Lattice::advance`] by one, and
/// move the vertices.
///
/// Points may lie anywhere on periodic axes. Between walls all of their nodes must be there: half a
/// node of distance from the wall for two points, 1 for three, 3/2 for four. Nodes inside obstacles
/// are nodes like any others: what is spread to them does not reach the fluid.
#[derive(Clone, Debug)]
pub struct Immersed {
    kernel: Kernel,
    /// Of the lattice that points have been placed in.
    cells: [usize; 3],
    stencils: Vec<Stencil>,
    rows: Rows,
    velocities: Vec<[f64; 3]>,
}

/// The nodes of a point.
#[derive(Clone, Copy, Debug)]
struct Stencil {
    /// The first along each axis, in the lattice.
    first: [usize; 3],
    weights: [[f64; 4]; 3],
}

/// Parts of rows along x that contain all nodes of all points.
#[derive(Clone, Debug, Default)]
struct Rows {
    /// For each row of the lattice, counted along y, then z, its parts: two, for where a closed
    /// membrane goes in and out.
    parts: Vec<[Part; 2]>,
    /// All parts, in their order.
    runs: Vec<Row>,
    /// Number of nodes in all parts.
    nodes: usize,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    end: usize,
    /// Where its velocities start among those of all parts.
    offset: usize,
}

impl Part {
    /// Behind all others.
    const NONE: Self = Self {
        start: usize::MAX,
        end: usize::MAX,
        offset: 0,
    };

    fn extend(&mut self, start: usize, end: usize) {
        (self.start, self.end) = (self.start.min(start), self.end.max(end));
    }
}

/// Has nodes covered by parts in their order, with something between them.
fn cover([first, second]: &mut [Part; 2], start: usize, end: usize) {
    let own = Part {
        start,
        end,
        offset: 0,
    };
    if first.start == usize::MAX {
        *first = own;
    } else if second.start == usize::MAX && start > first.end + NODES_LEFT_OUT {
        *second = own;
    } else if second.start == usize::MAX && end + NODES_LEFT_OUT < first.start {
        (*first, *second) = (own, *first);
    } else {
        let before = start.saturating_sub(first.end);
        let behind = second.start.saturating_sub(end);
        if before <= behind {
            first.extend(start, end);
        } else {
            second.extend(start, end);
        }
        if second.start != usize::MAX && first.end + NODES_LEFT_OUT >= second.start {
            first.extend(second.start, second.end);
            *second = Part::NONE;
        }
    }
}

impl Immersed {
    /// No points as yet.
    pub fn new(kernel: Kernel) -> Self {
        Self {
            kernel,
            cells: [0; 3],
            stencils: Vec::new(),
            rows: Rows::default(),
            velocities: Vec::new(),
        }
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.stencils.len()
    }

    /// Puts the points where they are, in lattice units.
    ///
    /// # Errors
    /// If a coordinate is not finite, or a point is too near to a wall. Then there are no points.
    pub fn place<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        points: &[[f64; 3]],
    ) -> Result<(), LatticeError> {
        self.cells = lattice.cells();
        self.stencils.clear();
        for (number, &point) in points.iter().enumerate() {
            match self.stencil(lattice, number, point) {
                Ok(stencil) => self.stencils.push(stencil),
                Err(error) => {
                    self.stencils.clear();
                    return Err(error);
                }
            }
        }
        self.rows.cover(self.cells, self.kernel, &self.stencils);
        Ok(())
    }

    fn stencil<T: Precision>(
        &self,
        lattice: &Lattice<T>,
        point: usize,
        position: [f64; 3],
    ) -> Result<Stencil, LatticeError> {
        let count = self.kernel.points();
        let mut stencil = Stencil {
            first: [0; 3],
            weights: [[0.0; 4]; 3],
        };
        for (axis, coordinate) in position.into_iter().enumerate() {
            let cells = self.cells[axis];
            if !coordinate.is_finite() {
                return Err(LatticeError::PointNotFinite { point, axis });
            }
            let first = self.kernel.first(coordinate);
            for (k, weight) in stencil.weights[axis][..count].iter_mut().enumerate() {
                *weight = self.kernel.weight(coordinate - 0.5 - (first + k as f64));
            }
            stencil.first[axis] = if lattice.is_periodic(axis) {
                first.rem_euclid(cells as f64) as usize % cells
            } else if first >= 0.0 && first + count as f64 <= cells as f64 {
                first as usize
            } else {
                return Err(LatticeError::NearWall {
                    point,
                    axis,
                    coordinate,
                    cells,
                    distance: 0.5 * (count - 1) as f64,
                });
            };
        }
        Ok(stencil)
    }

    /// Adds to the forces on nodes those that the points exert on the fluid.
    ///
    /// # Errors
    /// If one is not finite; then nothing is added.
    ///
    /// # Panics
    /// If there is not one force a point, or they were placed in a lattice of another size.
    pub fn spread<T: Precision>(
        &self,
        lattice: &mut Lattice<T>,
        forces: &[[f64; 3]],
    ) -> Result<(), LatticeError> {
        assert_eq!(forces.len(), self.count(), "one force a point");
        self.assert_size(lattice);
        for &force in forces {
            checked_force(force)?;
        }
        let share = lattice.cells()[2].div_ceil(self.threads(lattice));
        let slabs = lattice.nodal_forces().slabs(share);
        // Each thread takes from all points, in their order, what falls into its planes: sums do not
        // depend on the number of threads.
        std::thread::scope(|scope| {
            let mut slabs = slabs.into_iter();
            let own = slabs.next();
            for slab in slabs {
                scope.spawn(move || self.spread_into(slab, forces));
            }
            if let Some(slab) = own {
                self.spread_into(slab, forces);
            }
        });
        Ok(())
    }

    fn spread_into<T: Precision>(&self, mut slab: ForceSlab<'_, T>, forces: &[[f64; 3]]) {
        let count = self.kernel.points();
        for (stencil, force) in self.stencils.iter().zip(forces) {
            let [x, y, z] = stencil.nodes(self.cells);
            let [across_x, across_y, across_z] = stencil.weights;
            for k in 0..count {
                if !slab.planes.contains(&z[k]) {
                    continue;
                }
                for j in 0..count {
                    let weight = across_y[j] * across_z[k];
                    let mut row = slab.row(y[j], z[k]);
                    for i in 0..count {
                        let weight = weight * across_x[i];
                        row.add(x[i], force.map(|force| T::constant(weight * force)));
                    }
                }
            }
        }
    }

    /// Sets the velocities of the fluid at the points, with the half of all forces that a
    /// [`Node`](super::Node) has.
    ///
    /// # Panics
    /// If there is not one velocity a point, or they were placed in a lattice of another size.
    pub fn interpolate<T: Precision>(&mut self, lattice: &Lattice<T>, velocities: &mut [[f64; 3]]) {
        assert_eq!(velocities.len(), self.count(), "one velocity a point");
        self.assert_size(lattice);
        let threads = self.threads(lattice);
        self.velocities.resize(self.rows.nodes, [0.0; 3]);
        let share = self.rows.runs.len().div_ceil(threads).max(1);
        std::thread::scope(|scope| {
            let mut left = self.velocities.as_mut_slice();
            for runs in self.rows.runs.chunks(share) {
                let nodes = runs.iter().map(|run| run.count).sum();
                let (own, rest) = left.split_at_mut(nodes);
                left = rest;
                let mut run = move || read_velocities(lattice, runs, own);
                // The last share is this thread's own.
                if left.is_empty() {
                    run();
                } else {
                    scope.spawn(run);
                }
            }
        });
        let share = velocities.len().div_ceil(threads).max(1);
        std::thread::scope(|scope| {
            let this = &*self;
            let mut shares = velocities
                .chunks_mut(share)
                .zip(self.stencils.chunks(share));
            let own = shares.next();
            for (velocities, stencils) in shares {
                scope.spawn(move || this.interpolate_at(stencils, velocities));
            }
            if let Some((velocities, stencils)) = own {
                this.interpolate_at(stencils, velocities);
            }
        });
    }

    fn interpolate_at(&self, stencils: &[Stencil], velocities: &mut [[f64; 3]]) {
        let count = self.kernel.points();
        for (stencil, velocity) in stencils.iter().zip(velocities) {
            let [x, y, z] = stencil.nodes(self.cells);
            let [across_x, across_y, across_z] = stencil.weights;
            let mut sum = [0.0; 3];
            for k in 0..count {
                for j in 0..count {
                    let weight = across_y[j] * across_z[k];
                    let parts = self.rows.parts[y[j] + self.cells[1] * z[k]];
                    // All of a stencil's nodes in a row are in the same one.
                    let part = parts[usize::from(x[0] >= parts[1].start)];
                    for i in 0..count {
                        let weight = weight * across_x[i];
                        let node = self.velocities[part.offset + x[i] - part.start];
                        for (sum, node) in sum.iter_mut().zip(node) {
                            *sum += weight * node;
                        }
                    }
                }
            }
            *velocity = sum;
        }
    }

    /// As many threads as are worth starting.
    fn threads<T: Precision>(&self, lattice: &Lattice<T>) -> usize {
        let most = self.count() / POINTS_A_THREAD;
        most.clamp(1, lattice.setup.threads.get())
    }

    fn assert_size<T: Precision>(&self, lattice: &Lattice<T>) {
        // Without points there is nothing that could lie elsewhere.
        assert!(
            self.stencils.is_empty() || self.cells == lattice.cells(),
            "the points were placed in a lattice of {:?} nodes, not of {:?}",
            self.cells,
            lattice.cells()
        );
    }
}

impl Stencil {
    /// The nodes along each axis; of more than the kernel has, the last do not count.
    fn nodes(&self, cells: [usize; 3]) -> [[usize; 4]; 3] {
        array::from_fn(|axis| {
            array::from_fn(|k| {
                let mut node = self.first[axis] + k;
                // Once at most, but on an axis with fewer nodes than the kernel; no division.
                while node >= cells[axis] {
                    node -= cells[axis];
                }
                node
            })
        })
    }
}

impl Rows {
    /// Finds the parts anew.
    fn cover(&mut self, cells: [usize; 3], kernel: Kernel, stencils: &[Stencil]) {
        let [length, rows, planes] = cells;
        let count = kernel.points();
        self.parts.clear();
        self.parts.resize(rows * planes, [Part::NONE; 2]);
        for stencil in stencils {
            let [_, y, z] = stencil.nodes(cells);
            let first = stencil.first[0];
            let (start, end) = if first + count <= length {
                (first, first + count)
            } else {
                (0, length)
            };
            for &z in &z[..count] {
                for &y in &y[..count] {
                    cover(&mut self.parts[y + rows * z], start, end);
                }
            }
        }
        self.runs.clear();
        self.nodes = 0;
        for (row, parts) in self.parts.iter_mut().enumerate() {
            for part in parts.iter_mut().filter(|part| part.start != usize::MAX) {
                part.offset = self.nodes;
                let count = part.end - part.start;
                self.nodes += count;
                self.runs.push(Row {
                    start: [part.start, row % rows, row / rows],
                    count,
                });
            }
        }
    }
}

/// The velocities of some rows, one after the other.
fn read_velocities<T: Precision>(lattice: &Lattice<T>, runs: &[Row], velocities: &mut [[f64; 3]]) {
    let mut moments = vec![Moments::default(); velocities.len()];
    let mut left = moments.as_mut_slice();
    for &run in runs {
        let own = left.split_off_mut(..run.count).unwrap_or_default();
        lattice.read(run, own);
    }
    for (velocity, moments) in velocities.iter_mut().zip(&moments) {
        *velocity = lattice.velocity(moments);
    }
}
