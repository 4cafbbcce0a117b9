//! Viscosities of nodes.

use crate::flow::lattice_boltzmann::setup::checked_viscosity;
use crate::flow::lattice_boltzmann::stencil::Layout;
use crate::flow::lattice_boltzmann::{Lattice, LatticeError, Precision};
use helfrich::Surface;

/// Viscosities of single nodes. Rows along x without any are not read.
#[derive(Clone, Debug)]
pub(super) struct NodalViscosities<T> {
    /// Nodes in a row.
    length: usize,
    /// 3ν of each node, in the rows that have viscosities.
    tripled: Vec<T>,
    /// Whether a row has viscosities; rows are counted along y, then z.
    own: Vec<bool>,
}

impl<T: Precision> NodalViscosities<T> {
    fn new(layout: &Layout) -> Self {
        let [length, rows, planes] = layout.cells;
        Self {
            length,
            tripled: vec![T::zero(); layout.nodes()],
            own: vec![false; rows * planes],
        }
    }

    /// 3ν of the nodes in a row, if it has any.
    pub(super) fn row(&self, row: usize) -> Option<&[T]> {
        let nodes = row * self.length..(row + 1) * self.length;
        self.own[row].then(|| &self.tripled[nodes])
    }

    /// 3ν of the nodes in a row, mutable. A row without viscosities is filled with `others`.
    fn row_mut(&mut self, row: usize, others: T) -> &mut [T] {
        let nodes = row * self.length..(row + 1) * self.length;
        let tripled = &mut self.tripled[nodes];
        if !std::mem::replace(&mut self.own[row], true) {
            tripled.fill(others);
        }
        tripled
    }
}

impl<T: Precision> Lattice<T> {
    /// Gives each node a viscosity of its own.
    ///
    /// # Errors
    /// If a viscosity is not above 0; then nothing changes.
    pub fn set_viscosities(
        &mut self,
        mut viscosity: impl FnMut([usize; 3]) -> f64,
    ) -> Result<(), LatticeError> {
        // The old state is kept until all values are known to be valid.
        let mut viscosities = NodalViscosities::new(&self.layout);
        viscosities.own.fill(true);
        for (node, tripled) in viscosities.tripled.iter_mut().enumerate() {
            let viscosity = checked_viscosity(viscosity(self.layout.cell(node)))?;
            *tripled = T::constant(3.0 * viscosity);
        }
        self.viscosities = Some(viscosities);
        Ok(())
    }

    /// Gives the nodes inside each closed surface its viscosity, and all others that of the setup.
    /// With nested surfaces, the innermost one that contains a node counts. Where surfaces cross,
    /// the one counts whose two crossings with the line through the node along x are nearer to each
    /// other. The order of the surfaces does not matter. Has to be called again when surfaces have
    /// moved, which takes a small fraction of a step. Memory is kept between calls.
    ///
    /// # Errors
    /// If a viscosity is not above 0, or a surface has no interior: see [`Self::inside`]. Then
    /// nothing changes.
    pub fn set_inner_viscosities(
        &mut self,
        surfaces: &[(Surface<'_, f64>, f64)],
    ) -> Result<(), LatticeError> {
        let mut inner = Vec::new();
        for &(surface, viscosity) in surfaces {
            let viscosity = checked_viscosity(viscosity)?;
            self.for_each_row_inside(surface, |row, nodes, distance| {
                inner.push((distance, viscosity, row, nodes));
            })?;
        }
        // What lies within another row of nodes is shorter, and comes after it.
        inner.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
        let others = T::constant(3.0 * self.setup.viscosity);
        let layout = &self.layout;
        let viscosities = (self.viscosities).get_or_insert_with(|| NodalViscosities::new(layout));
        viscosities.own.fill(false);
        let [_, rows, _] = layout.cells;
        let own = self.parts.own();
        let inner = (inner.into_iter()).filter(|&(_, _, row, _)| own.contains(&(row / rows)));
        for (_, viscosity, row, nodes) in inner {
            let tripled = T::constant(3.0 * viscosity);
            viscosities.row_mut(row, others)[nodes].fill(tripled);
        }
        Ok(())
    }
}
