//! Parts of the rows of a lattice, which points reach.

use super::kernel::{Kernel, Stencil};
use crate::flow::lattice_boltzmann::reading::NodeRow;
use std::ops::Range;

/// The least gap, in nodes, between two parts of a row. Smaller gaps are bridged, because they
/// share cache lines with the parts.
const NODES_LEFT_OUT: usize = 16;

/// Parts of rows along x that contain all nodes of all points.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// For each row of the lattice, counted along y, then z, its parts: two, where the row enters
    /// and leaves a closed membrane.
    parts: Vec<[RowSpan; 2]>,
    /// All parts, in their order.
    pub(super) runs: Vec<NodeRow>,
    /// Number of nodes in all parts.
    pub(super) nodes: usize,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct RowSpan {
    pub(super) start: usize,
    end: usize,
    /// The start of its velocities among those of all parts.
    pub(super) offset: usize,
}

impl RowSpan {
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

impl Rows {
    /// The part of a row with this node of a stencil: all of the stencil's nodes in the row are in
    /// the same one.
    pub(super) fn part(&self, x: usize, row: usize) -> RowSpan {
        let parts = self.parts[row];
        parts[usize::from(x >= parts[1].start)]
    }

    /// The runs in some planes, and their nodes among those of all.
    pub(super) fn of_planes(&self, planes: Range<usize>) -> (Range<usize>, Range<usize>) {
        let first = |plane| self.runs.partition_point(|run| run.start[2] < plane);
        let runs = first(planes.start)..first(planes.end);
        let before = self.runs[..runs.start]
            .iter()
            .map(|run| run.count)
            .sum::<usize>();
        let within = self.runs[runs.clone()]
            .iter()
            .map(|run| run.count)
            .sum::<usize>();
        (runs, before..before + within)
    }

    /// Rebuilds the parts.
    pub(super) fn cover(&mut self, cells: [usize; 3], kernel: Kernel, stencils: &[Stencil]) {
        let [length, rows, planes] = cells;
        let count = kernel.points();
        self.parts.clear();
        self.parts.resize(rows * planes, [RowSpan::NONE; 2]);
        for stencil in stencils {
            let [_, y, z] = stencil.nodes::<4>(cells);
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
                self.runs.push(NodeRow {
                    start: [part.start, row % rows, row / rows],
                    count,
                });
            }
        }
    }
}

/// Has nodes covered by parts in their order, with something between them.
fn cover([first, second]: &mut [RowSpan; 2], start: usize, end: usize) {
    let own = RowSpan {
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
            *second = RowSpan::NONE;
        }
    }
}
