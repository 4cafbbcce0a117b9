//! Points of several ranks.

use super::Kernel;
use crate::flow::lattice_boltzmann::{Lattice, Precision};
use std::ops::Range;

/// The points by the ranks of their last planes.
#[derive(Clone, Debug, Default)]
pub(super) struct RankedPoints {
    /// The numbers of all points: those of each rank in their order, rank by rank.
    pub(super) order: Vec<u32>,
    /// The ranges of the ranks in `order`.
    pub(super) parts: Vec<Range<usize>>,
    /// The places, among the points that matter here, of those whose first planes belong to this rank, and the last ones to
    /// the next.
    pub(super) leaving: Vec<u32>,
    /// The places of the points of this rank, and whether their first planes belong to the rank before.
    pub(super) own: Vec<u32>,
    pub(super) come: Vec<bool>,
    /// The velocities, in the order of `order`.
    pub(super) found: Vec<[f64; 3]>,
}

impl RankedPoints {
    /// Divides points with these first planes; those with some numbers matter here.
    pub(super) fn divide<T: Precision>(
        &mut self,
        lattice: &Lattice<T>,
        kernel: Kernel,
        first_planes: &[u32],
        numbers: &[u32],
    ) {
        let planes = lattice.cells()[2];
        let here = lattice.rank();
        let ranks = Vec::from_iter((0..planes).map(|plane| lattice.rank_of(plane)));
        let last = |first: u32| ranks[(first as usize + kernel.points() - 1) % planes];
        self.leaving.clear();
        self.own.clear();
        self.come.clear();
        for (place, &number) in numbers.iter().enumerate() {
            let first = first_planes[number as usize];
            let begins_here = ranks[first as usize] == here;
            if last(first) == here {
                self.own.push(place as u32);
                self.come.push(!begins_here);
            } else if begins_here {
                self.leaving.push(place as u32);
            }
        }
        let mut counts = vec![0; ranks.last().map_or(0, |last| last + 1)];
        first_planes
            .iter()
            .for_each(|&first| counts[last(first)] += 1);
        self.parts.clear();
        let mut places = Vec::with_capacity(counts.len());
        let mut start = 0;
        for count in counts {
            self.parts.push(start..start + count);
            places.push(start);
            start += count;
        }
        self.order.resize(first_planes.len(), 0);
        for (number, &first) in first_planes.iter().enumerate() {
            let place = &mut places[last(first)];
            self.order[*place] = number as u32;
            *place += 1;
        }
    }
}
