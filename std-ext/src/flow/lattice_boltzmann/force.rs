//! Forces on nodes.

use crate::flow::lattice_boltzmann::Precision;
use crate::flow::lattice_boltzmann::stencil::Layout;
use std::ops::Range;

/// Forces on some nodes. Rows along x without any are not read.
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

    /// Parts of this many planes, to be added to at once.
    pub(super) fn slabs(&mut self, planes: usize) -> Vec<ForceSlab<'_, T>> {
        let nodes = self.length * self.rows * planes;
        let [x, y, z] = self.axes.each_mut().map(|axis| axis.chunks_mut(nodes));
        let touched = self.touched.chunks_mut(self.rows * planes);
        let parts = x.zip(y).zip(z).zip(touched).enumerate();
        parts
            .map(|(number, (((x, y), z), touched))| ForceSlab {
                planes: number * planes..(number + 1) * planes,
                length: self.length,
                rows: self.rows,
                axes: [x, y, z],
                touched,
            })
            .collect()
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
    pub(super) fn row(&mut self, y: usize, z: usize) -> ForceRow<'_, T> {
        let row = y + self.rows * (z - self.planes.start);
        self.touched[row] = true;
        let nodes = row * self.length..(row + 1) * self.length;
        ForceRow {
            axes: self.axes.each_mut().map(|axis| &mut axis[nodes.clone()]),
        }
    }
}

/// The forces in a row.
pub(super) struct ForceRow<'a, T> {
    axes: [&'a mut [T]; 3],
}

impl<T: Precision> ForceRow<'_, T> {
    pub(super) fn add(&mut self, x: usize, force: [T; 3]) {
        for (axis, force) in self.axes.iter_mut().zip(force) {
            axis[x] += force;
        }
    }
}
