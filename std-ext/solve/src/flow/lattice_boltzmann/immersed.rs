//! Points that move with the fluid, and their forces on it.
//!
//! C. S. Peskin, Acta Numerica 11 (2002) 479; the kernel of three points: A. M. Roma, C. S. Peskin,
//! M. J. Berger, J. Comput. Phys. 153 (1999) 509.

mod kernel;
mod points;
mod response;
mod rows;

pub use kernel::Kernel;

use crate::flow::lattice_boltzmann::force::{ForceSlab, NodalVelocities, checked_force};
use crate::flow::lattice_boltzmann::reading::{Moments, NodeRow};
use crate::flow::lattice_boltzmann::{Lattice, LatticeError, Precision, number};
use helfrich_execute::execute::in_parts;
use kernel::Stencil;
use points::RankedPoints;
use rows::Rows;
use std::ops::Range;

/// The least number of points that is worth starting a thread.
const POINTS_A_THREAD: usize = 1024;

/// Points in the fluid, such as the vertices of membranes.
///
/// A step of membranes consists of [`Self::place`] for the vertices, [`Lattice::clear_forces`],
/// [`Self::spread`] for their forces, [`Lattice::advance_keeping_velocities`],
/// [`Self::interpolate_kept`], and the motion of the vertices.
///
/// Points may lie anywhere on periodic axes. Between walls all nodes of a point must exist, which
/// requires a distance from the wall of half a node for kernels of two points, 1 for three, and 3/2
/// for four. Nodes inside obstacles are treated like all others, but forces on them do not reach
/// the fluid.
#[derive(Clone, Debug)]
pub struct Immersed {
    kernel: Kernel,
    /// The size of the lattice in which the points were placed.
    cells: [usize; 3],
    /// The first plane of each point.
    planes: Vec<u32>,
    /// The nodes of points that matter here, and the numbers of these points.
    stencils: Vec<Stencil>,
    numbers: Vec<u32>,
    rows: Rows,
    /// The values at the nodes of all parts of rows.
    nodes: Vec<[f64; 3]>,
    /// ½/ρ of each: the velocity that a unit force adds.
    responses: Vec<f64>,
    /// The division of the points among ranks.
    points: RankedPoints,
}

impl Immersed {
    /// An empty set of points.
    pub fn new(kernel: Kernel) -> Self {
        Self {
            kernel,
            cells: [0; 3],
            planes: Vec::new(),
            stencils: Vec::new(),
            numbers: Vec::new(),
            rows: Rows::default(),
            nodes: Vec::new(),
            responses: Vec::new(),
            points: RankedPoints::default(),
        }
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.planes.len()
    }

    /// Places the points at positions in lattice units.
    ///
    /// # Errors
    /// If a coordinate is not finite, or a point is too near to a wall. Then there are no points.
    pub fn place<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        points: &[[f64; 3]],
    ) -> Result<(), LatticeError> {
        self.place_where(lattice, points, |_| true)
    }

    /// As [`Self::place`], for [`Self::spread`] and [`Self::interpolate_kept`] only: of several ranks, each then needs only the
    /// points in its planes.
    ///
    /// # Errors
    /// As [`Self::place`], on all ranks.
    pub fn place_own<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        points: &[[f64; 3]],
    ) -> Result<(), LatticeError> {
        let planes = lattice.cells()[2];
        let own = lattice.own_planes();
        let last = self.kernel.points() - 1;
        self.place_where(lattice, points, |first| {
            own.contains(&first) || own.contains(&((first + last) % planes))
        })
    }

    /// Places the points, and finds the nodes of those whose first plane matters.
    fn place_where<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        points: &[[f64; 3]],
        matters: impl Fn(usize) -> bool,
    ) -> Result<(), LatticeError> {
        self.cells = lattice.cells();
        self.planes.clear();
        self.stencils.clear();
        self.numbers.clear();
        self.responses.clear();
        for (number, &point) in points.iter().enumerate() {
            let found = self.first_nodes(lattice, number, point);
            let (coordinates, first) = found.inspect_err(|_| {
                self.planes.clear();
                self.stencils.clear();
                self.numbers.clear();
            })?;
            self.planes.push(first[2] as u32);
            if matters(first[2]) {
                let weights = |axis: usize| self.kernel.weights(point[axis], coordinates[axis]);
                let weights = std::array::from_fn(weights);
                self.stencils.push(Stencil { first, weights });
                self.numbers.push(number as u32);
            }
        }
        Ok(())
    }

    /// The first nodes of a point along each axis: as they follow from its coordinates, and in the lattice.
    fn first_nodes<T: Precision>(
        &self,
        lattice: &Lattice<T>,
        point: usize,
        position: [f64; 3],
    ) -> Result<([f64; 3], [usize; 3]), LatticeError> {
        let count = self.kernel.points();
        let (mut coordinates, mut nodes) = ([0.0; 3], [0; 3]);
        for (axis, coordinate) in position.into_iter().enumerate() {
            let cells = self.cells[axis];
            if !coordinate.is_finite() {
                return Err(LatticeError::PointNotFinite { point, axis });
            }
            let first = self.kernel.first(coordinate);
            coordinates[axis] = first;
            nodes[axis] = if first >= 0.0 && first + count as f64 <= cells as f64 {
                first as usize
            } else if lattice.is_periodic(axis) {
                first.rem_euclid(cells as f64) as usize % cells
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
        Ok((coordinates, nodes))
    }

    /// Adds the forces that the points exert on the fluid to the forces on nodes.
    ///
    /// # Errors
    /// If a force is not finite; then nothing is added.
    ///
    /// # Panics
    /// If there is not one force per point, or they were placed in a lattice of another size.
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
        let own = lattice.own_planes();
        let share = own.len().div_ceil(self.threads(lattice));
        let slabs = lattice.nodal_forces().slabs(own, share);
        // Each thread visits all points in their order and adds the part in its planes, so that
        // sums do not depend on the number of threads.
        in_parts(slabs.into_iter(), &|slab| self.spread_into(slab, forces));
        Ok(())
    }

    fn spread_into<T: Precision>(&self, slab: ForceSlab<'_, T>, forces: &[[f64; 3]]) {
        match self.kernel {
            Kernel::Two => self.spread_by::<T, 2>(slab, forces),
            Kernel::Three => self.spread_by::<T, 3>(slab, forces),
            Kernel::Four => self.spread_by::<T, 4>(slab, forces),
        }
    }

    fn spread_by<T: Precision, const POINTS: usize>(
        &self,
        mut slab: ForceSlab<'_, T>,
        forces: &[[f64; 3]],
    ) {
        for (stencil, &number) in self.stencils.iter().zip(&self.numbers) {
            let force = forces[number as usize];
            let [x, y, z] = stencil.nodes::<POINTS>(self.cells);
            let [across_x, across_y, across_z] = stencil.weights;
            for (z, across_z) in z.into_iter().zip(across_z) {
                if !slab.planes.contains(&z) {
                    continue;
                }
                for (y, across_y) in y.into_iter().zip(across_y) {
                    let weight = across_y * across_z;
                    for (row, force) in slab.row(y, z).into_iter().zip(force) {
                        let share = weight * force;
                        let add = |node: &mut T, across| *node += T::constant(share * across);
                        match row.get_mut(x[0]..x[0] + POINTS) {
                            Some(nodes) => {
                                for (node, across) in nodes.iter_mut().zip(across_x) {
                                    add(node, across);
                                }
                            }
                            // Round the end of the row.
                            None => {
                                for (x, across) in x.into_iter().zip(across_x) {
                                    add(&mut row[x], across);
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Sets the velocities of the fluid at the points, with the half of all forces that a
    /// [`Node`](super::Node) has: from the populations, node by node. Ranks read those of their planes, and all know the
    /// result.
    ///
    /// # Panics
    /// If there is not one velocity per point, or they were not [placed](Self::place) in a lattice of this size.
    pub fn interpolate<T: Precision>(
        &mut self,
        lattice: &mut Lattice<T>,
        velocities: &mut [[f64; 3]],
    ) {
        assert_eq!(velocities.len(), self.count(), "one velocity a point");
        self.assert_size(lattice);
        assert_eq!(self.stencils.len(), self.count(), "all points are placed");
        lattice.prepare_reading();
        self.rows.cover(self.cells, self.kernel, &self.stencils);
        let threads = self.threads(lattice);
        self.nodes.resize(self.rows.nodes, [0.0; 3]);
        self.responses.resize(self.rows.nodes, 0.0);
        let known = (lattice.each_part()).map(|planes| self.rows.of_planes(planes));
        let known = Vec::from_iter(known);
        let (runs, nodes) = known[lattice.rank()].clone();
        let runs = &self.rows.runs[runs];
        let share = runs.len().div_ceil(threads).max(1);
        let mut left = &mut self.nodes[nodes.clone()];
        let mut responses = &mut self.responses[nodes];
        let lattice = &*lattice;
        let parts = runs.chunks(share).map(|runs| {
            let nodes = runs.iter().map(|run| run.count).sum();
            let own = left.split_off_mut(..nodes).unwrap_or_default();
            let own_responses = responses.split_off_mut(..nodes).unwrap_or_default();
            (runs, own, own_responses)
        });
        in_parts(parts, &|(runs, velocities, responses)| {
            read_velocities(lattice, runs, velocities, responses);
        });
        let known = Vec::from_iter(known.into_iter().map(|(_, nodes)| nodes));
        lattice.gather(&mut self.nodes, &known);
        lattice.gather(&mut self.responses, &known);
        self.interpolate_nodes(threads, velocities);
    }

    /// Interpolates values at the points from the nodes around them.
    fn interpolate_nodes(&self, threads: usize, velocities: &mut [[f64; 3]]) {
        share_points(
            threads,
            velocities,
            &self.stencils,
            |stencils, velocities| match self.kernel {
                Kernel::Two => self.interpolate_by::<2>(stencils, velocities),
                Kernel::Three => self.interpolate_by::<3>(stencils, velocities),
                Kernel::Four => self.interpolate_by::<4>(stencils, velocities),
            },
        );
    }

    fn interpolate_by<const POINTS: usize>(
        &self,
        stencils: &[Stencil],
        velocities: &mut [[f64; 3]],
    ) {
        for (stencil, velocity) in stencils.iter().zip(velocities) {
            let [x, y, z] = stencil.nodes::<POINTS>(self.cells);
            let [across_x, across_y, across_z] = stencil.weights;
            let mut sum = [0.0; 3];
            for k in 0..POINTS {
                for j in 0..POINTS {
                    let weight = across_y[j] * across_z[k];
                    let part = self.rows.part(x[0], y[j] + self.cells[1] * z[k]);
                    for i in 0..POINTS {
                        let weight = weight * across_x[i];
                        let node = self.nodes[part.offset + x[i] - part.start];
                        for (sum, node) in sum.iter_mut().zip(node) {
                            *sum += weight * node;
                        }
                    }
                }
            }
            *velocity = sum;
        }
    }

    /// Sets the velocities at the points with which the last step began, which was
    /// [`Lattice::advance_keeping_velocities`]: those that [`Self::interpolate`] would have found
    /// before it, to the rounding of the lattice's numbers, in less time. Each rank finds those of points in its planes, and all
    /// know the result.
    ///
    /// # Panics
    /// If there is not one velocity per point, they were placed in a lattice of another size, or their
    /// forces were not [spread](Self::spread) before that step.
    pub fn interpolate_kept<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        velocities: &mut [[f64; 3]],
    ) {
        assert_eq!(velocities.len(), self.count(), "one velocity a point");
        self.assert_size(lattice);
        let Some(kept) = lattice.kept_velocities() else {
            assert!(self.planes.is_empty(), "no step has kept velocities");
            return;
        };
        let threads = self.threads(lattice);
        if lattice.is_alone() {
            let planes = 0..self.cells[2];
            share_points(
                threads,
                velocities,
                &self.stencils,
                |stencils, velocities| {
                    velocities.fill([0.0; 3]);
                    self.add_kept(kept, &planes, stencils, velocities);
                },
            );
        } else {
            self.interpolate_in_parts(lattice, kept, threads, velocities);
        }
    }

    /// As [`Self::interpolate_kept`], on several ranks. Nodes of a point are added in their order: if they belong to two ranks,
    /// the first of them sends its sum to the other.
    fn interpolate_in_parts<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        kept: &NodalVelocities<T>,
        threads: usize,
        velocities: &mut [[f64; 3]],
    ) {
        let mut points = std::mem::take(&mut self.points);
        points.divide(lattice, self.kernel, &self.planes, &self.numbers);
        let planes = lattice.own_planes();
        let sum = |places: &[u32], sums: &mut [[f64; 3]]| {
            let stencils = places.iter().map(|&place| self.stencils[place as usize]);
            let stencils = Vec::from_iter(stencils);
            share_points(threads, sums, &stencils, |stencils, sums| {
                self.add_kept(kept, &planes, stencils, sums);
            });
        };
        let mut begun = vec![[0.0; 3]; points.leaving.len()];
        sum(&points.leaving, &mut begun);
        let coming = points.come.iter().filter(|come| **come).count();
        let mut coming = vec![[0.0; 3]; coming];
        lattice.pass_on(&begun, &mut coming);
        let mut coming = coming.into_iter();
        let begun = points.come.iter().map(|come| match come {
            true => coming.next().unwrap_or_default(),
            false => [0.0; 3],
        });
        points.found.resize(velocities.len(), [0.0; 3]);
        let own = points.parts[lattice.rank()].clone();
        let sums = &mut points.found[own];
        sums.iter_mut()
            .zip(begun)
            .for_each(|(sum, begun)| *sum = begun);
        sum(&points.own, sums);
        lattice.gather(&mut points.found, &points.parts);
        for (&number, found) in points.order.iter().zip(&points.found) {
            velocities[number as usize] = *found;
        }
        self.points = points;
    }

    /// Adds what nodes in some planes contribute to the velocities at points.
    fn add_kept<T: Precision>(
        &self,
        kept: &NodalVelocities<T>,
        planes: &Range<usize>,
        stencils: &[Stencil],
        velocities: &mut [[f64; 3]],
    ) {
        match self.kernel {
            Kernel::Two => self.add_kept_by::<T, 2>(kept, planes, stencils, velocities),
            Kernel::Three => self.add_kept_by::<T, 3>(kept, planes, stencils, velocities),
            Kernel::Four => self.add_kept_by::<T, 4>(kept, planes, stencils, velocities),
        }
    }

    fn add_kept_by<T: Precision, const POINTS: usize>(
        &self,
        kept: &NodalVelocities<T>,
        planes: &Range<usize>,
        stencils: &[Stencil],
        velocities: &mut [[f64; 3]],
    ) {
        for (stencil, velocity) in stencils.iter().zip(velocities) {
            let [x, y, z] = stencil.nodes::<POINTS>(self.cells);
            let [across_x, across_y, across_z] = stencil.weights;
            for (z, across_z) in z.into_iter().zip(across_z) {
                if !planes.contains(&z) {
                    continue;
                }
                for (y, across_y) in y.into_iter().zip(across_y) {
                    let weight = across_y * across_z;
                    let Some(axes) = kept.row(y + self.cells[1] * z) else {
                        panic!("velocities have not been kept at the points");
                    };
                    for (sum, row) in velocity.iter_mut().zip(axes) {
                        let mut along = 0.0;
                        match row.get(x[0]..x[0] + POINTS) {
                            Some(nodes) => {
                                for (&node, across) in nodes.iter().zip(across_x) {
                                    along += across * number(node);
                                }
                            }
                            // Round the end of the row.
                            None => {
                                for (x, across) in x.into_iter().zip(across_x) {
                                    along += across * number(row[x]);
                                }
                            }
                        }
                        *sum += weight * along;
                    }
                }
            }
        }
    }

    /// The number of threads worth starting.
    fn threads<T: Precision>(&self, lattice: &Lattice<T>) -> usize {
        let most = self.count() / POINTS_A_THREAD;
        most.clamp(1, lattice.setup.threads.get())
    }

    fn assert_size<T: Precision>(&self, lattice: &Lattice<T>) {
        // Without points there is no lattice to compare with.
        assert!(
            self.planes.is_empty() || self.cells == lattice.cells(),
            "the points were placed in a lattice of {:?} nodes, not of {:?}",
            self.cells,
            lattice.cells()
        );
    }
}

/// Sets the velocities of points, a share on each thread.
fn share_points(
    threads: usize,
    velocities: &mut [[f64; 3]],
    stencils: &[Stencil],
    set: impl Fn(&[Stencil], &mut [[f64; 3]]) + Sync,
) {
    let share = velocities.len().div_ceil(threads).max(1);
    let shares = velocities.chunks_mut(share).zip(stencils.chunks(share));
    in_parts(shares, &|(velocities, stencils)| set(stencils, velocities));
}

/// The velocities of some rows, one after the other, and what a force adds to them.
fn read_velocities<T: Precision>(
    lattice: &Lattice<T>,
    runs: &[NodeRow],
    velocities: &mut [[f64; 3]],
    responses: &mut [f64],
) {
    let mut moments = vec![Moments::default(); velocities.len()];
    let mut left = moments.as_mut_slice();
    for &run in runs {
        let own = left.split_off_mut(..run.count).unwrap_or_default();
        lattice.read(run, own);
    }
    for ((velocity, response), moments) in velocities.iter_mut().zip(responses).zip(&moments) {
        *velocity = lattice.velocity(moments);
        *response = 0.5 / lattice.inertial_density(moments);
    }
}
