//! Forces on nodes, and velocities of these nodes.

use crate::flow::lattice_boltzmann::stencil::Layout;
use crate::flow::lattice_boltzmann::{Lattice, LatticeError, Precision, number};
use std::array;
use std::ops::Range;

/// Forces on single nodes. Rows along x without forces are not read.
#[derive(Clone, Debug)]
pub(super) struct NodalForces<T> {
    /// Nodes in a row, and rows in a plane.
    length: usize,
    rows: usize,
    axes: [Vec<T>; 3],
    /// Whether a row has been touched since it was cleared.
    touched: Vec<bool>,
}

impl<T: Precision> NodalForces<T> {
    pub(super) fn new(layout: &Layout) -> Self {
        let [length, rows, planes] = layout.cells;
        Self {
            length,
            rows,
            axes: [(); 3].map(|()| vec![T::zero(); layout.nodes()]),
            touched: vec![false; rows * planes],
        }
    }

    /// The forces of a row, if it has any; rows are counted along y, then z.
    pub(super) fn row(&self, row: usize) -> Option<[&[T]; 3]> {
        let nodes = row * self.length..(row + 1) * self.length;
        self.touched[row].then(|| self.axes.each_ref().map(|axis| &axis[nodes.clone()]))
    }

    pub(super) fn at(&self, node: usize) -> [T; 3] {
        self.axes.each_ref().map(|axis| axis[node])
    }

    pub(super) fn add(&mut self, node: usize, force: [T; 3]) {
        self.touched[node / self.length] = true;
        for (axis, force) in self.axes.iter_mut().zip(force) {
            axis[node] += force;
        }
    }

    pub(super) fn clear(&mut self) {
        for (row, touched) in self.touched.iter_mut().enumerate() {
            if std::mem::take(touched) {
                for axis in &mut self.axes {
                    axis[row * self.length..(row + 1) * self.length].fill(T::zero());
                }
            }
        }
    }

    /// Calls `change` with each component of all forces.
    pub(super) fn each_array(&mut self, change: impl FnMut(&mut [T])) {
        self.axes
            .each_mut()
            .map(Vec::as_mut_slice)
            .into_iter()
            .for_each(change);
    }

    /// Whether each row has forces.
    pub(super) fn touched_mut(&mut self) -> &mut [bool] {
        &mut self.touched
    }

    /// Parts of `own` planes with this many planes, to which threads can add in parallel.
    pub(super) fn slabs(&mut self, own: Range<usize>, planes: usize) -> Vec<ForceSlab<'_, T>> {
        let rows = own.start * self.rows..own.end * self.rows;
        let nodes = rows.start * self.length..rows.end * self.length;
        let axes = self.axes.each_mut().map(|axis| &mut axis[nodes.clone()]);
        let [x, y, z] = axes.map(|axis| axis.chunks_mut(self.length * self.rows * planes));
        let touched = self.touched[rows].chunks_mut(self.rows * planes);
        let parts = x.zip(y).zip(z).zip(touched).enumerate();
        let first = |number| own.start + number * planes;
        parts
            .map(|(number, (((x, y), z), touched))| ForceSlab {
                planes: first(number)..first(number + 1),
                length: self.length,
                rows: self.rows,
                axes: [x, y, z],
                touched,
            })
            .collect()
    }
}

/// The velocities of nodes in rows along x.
#[derive(Clone, Debug)]
pub(super) struct NodalVelocities<T> {
    /// Nodes in a row, and rows in a plane.
    length: usize,
    rows: usize,
    axes: [Vec<T>; 3],
    /// Which rows have been kept.
    kept: Vec<bool>,
}

impl<T: Precision> NodalVelocities<T> {
    pub(super) fn new(layout: &Layout) -> Self {
        let [length, rows, planes] = layout.cells;
        Self {
            length,
            rows,
            axes: [(); 3].map(|()| vec![T::zero(); layout.nodes()]),
            kept: vec![false; rows * planes],
        }
    }

    /// Prepares for the rows that have forces.
    pub(super) fn keep(&mut self, forces: Option<&NodalForces<T>>) {
        match forces {
            Some(forces) => self.kept.copy_from_slice(&forces.touched),
            None => self.kept.fill(false),
        }
    }

    /// Parts of `own` planes with this many planes, which threads can set in parallel.
    pub(super) fn slabs(
        &mut self,
        own: Range<usize>,
        planes: usize,
    ) -> impl Iterator<Item = [&mut [T]; 3]> {
        let plane = self.length * self.rows;
        let nodes = own.start * plane..own.end * plane;
        let axes = self.axes.each_mut().map(|axis| &mut axis[nodes.clone()]);
        let [x, y, z] = axes.map(|axis| axis.chunks_mut(plane * planes));
        x.zip(y).zip(z).map(|((x, y), z)| [x, y, z])
    }

    /// The velocities of a row, if they were kept; rows are counted along y, then z.
    pub(super) fn row(&self, row: usize) -> Option<[&[T]; 3]> {
        let nodes = row * self.length..(row + 1) * self.length;
        self.kept[row].then(|| self.axes.each_ref().map(|axis| &axis[nodes.clone()]))
    }
}

/// The forces in some consecutive planes.
pub(super) struct ForceSlab<'a, T> {
    /// z of the planes; the last slab may have fewer.
    pub(super) planes: Range<usize>,
    length: usize,
    rows: usize,
    axes: [&'a mut [T]; 3],
    touched: &'a mut [bool],
}

impl<T: Precision> ForceSlab<'_, T> {
    /// The forces of the row at (y, z), which counts as touched.
    pub(super) fn row(&mut self, y: usize, z: usize) -> [&mut [T]; 3] {
        let row = y + self.rows * (z - self.planes.start);
        self.touched[row] = true;
        let nodes = row * self.length..(row + 1) * self.length;
        self.axes.each_mut().map(|axis| &mut axis[nodes.clone()])
    }
}

impl<T: Precision> Lattice<T> {
    /// Sets a force on every node: a pressure gradient, or gravity.
    ///
    /// # Errors
    /// If it is not finite.
    pub fn set_force(&mut self, force: [f64; 3]) -> Result<(), LatticeError> {
        self.force = checked_force(force)?;
        Ok(())
    }

    /// Adds to the forces on single nodes, which exist from then on. They act in every step until
    /// they are cleared.
    ///
    /// # Errors
    /// If the force is not finite.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn add_force(&mut self, cell: [usize; 3], force: [f64; 3]) -> Result<(), LatticeError> {
        self.assert_inside(cell);
        let force = checked_force(force)?.map(T::constant);
        let node = self.layout.node(cell);
        self.nodal_forces().add(node, force);
        Ok(())
    }

    pub(super) fn nodal_forces(&mut self) -> &mut NodalForces<T> {
        (self.forces).get_or_insert_with(|| NodalForces::new(&self.layout))
    }

    /// Removes all forces on single nodes.
    pub fn clear_forces(&mut self) {
        if let Some(forces) = &mut self.forces {
            forces.clear();
        }
    }

    /// The force on a node.
    pub(super) fn force_at(&self, node: usize) -> [f64; 3] {
        match &self.forces {
            None => self.force,
            Some(forces) => {
                let own = forces.at(node);
                array::from_fn(|axis| self.force[axis] + number(own[axis]))
            }
        }
    }
}

pub(super) fn checked_force(force: [f64; 3]) -> Result<[f64; 3], LatticeError> {
    if force.iter().all(|component| component.is_finite()) {
        Ok(force)
    } else {
        Err(LatticeError::Force { force })
    }
}
