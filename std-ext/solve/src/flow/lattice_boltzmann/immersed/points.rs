//! Points of several ranks.

use super::Kernel;
use super::kernel::Stencil;
use crate::flow::lattice_boltzmann::{Lattice, Precision};
use std::ops::Range;

/// The points by the ranks of their last nodes along z.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    /// The numbers of all points: those of each rank in their order, rank by rank.
    pub(super) order: Vec<u32>,
    /// The ranges of the ranks in `order`.
    pub(super) parts: Vec<Range<usize>>,
    /// The points whose first nodes belong to this rank, and the last ones to the next.
    pub(super) leaving: Vec<u32>,
    /// The points of this rank whose first nodes belong to the one before.
    pub(super) coming: Vec<u32>,
    /// The velocities, in the order of `order`.
    pub(super) found: Vec<[f64; 3]>,
}

impl Points {
    /// Divides the points of a lattice.
    pub(super) fn divide<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        kernel: Kernel,
        stencils: &[Stencil],
    ) {
        let planes = lattice.cells()[2];
        let own = lattice.rank();
        let ranks = Vec::from_iter((0..planes).map(|plane| lattice.rank_of(plane)));
        // Points of kernels that reach fewer nodes than planes of a rank: twice the same plane is impossible.
        let ends = |stencil: &Stencil| {
            let first = stencil.first[2];
            [first, (first + kernel.points() - 1) % planes].map(|plane| ranks[plane])
        };
        self.leaving.clear();
        self.coming.clear();
        let mut counts = vec![0; ranks.last().map_or(0, |last| last + 1)];
        for (number, stencil) in stencils.iter().enumerate() {
            let [first, last] = ends(stencil);
            counts[last] += 1;
            if first != last && first == own {
                self.leaving.push(number as u32);
            } else if first != last && last == own {
                self.coming.push(number as u32);
            }
        }
        self.parts.clear();
        let mut places = Vec::with_capacity(counts.len());
        let mut start = 0;
        for count in counts {
            self.parts.push(start..start + count);
            places.push(start);
            start += count;
        }
        self.order.resize(stencils.len(), 0);
        for (number, stencil) in stencils.iter().enumerate() {
            let place = &mut places[ends(stencil)[1]];
            self.order[*place] = number as u32;
            *place += 1;
        }
    }

    /// The points of a rank.
    pub(super) fn own(&self, rank: usize) -> Range<usize> {
        self.parts[rank].clone()
    }
}
