//! Forces on nodes.

use crate::flow::lattice_boltzmann::Precision;
use crate::flow::lattice_boltzmann::stencil::Layout;

/// Forces on some nodes. Rows along x without any are not read.
#[derive(Clone, Debug)]
pub(super) struct NodalForces<T> {
    /// Nodes in a row.
    length: usize,
    axes: [Vec<T>; 3],
    /// Whether a row has been touched since it was cleared.
    touched: Vec<bool>,
}

impl<T: Precision> NodalForces<T> {
    pub(super) fn new(layout: &Layout) -> Self {
        let [length, rows, planes] = layout.cells;
        Self {
            length,
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
}
