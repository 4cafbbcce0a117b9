//! Accumulation of partial sums in f32 or f64 into sums in f64.

use super::kernel::Kernel;
use super::sums::{Columns, Task};
use crate::flow::vectors::Vectors;
use pulp::Arch;

/// Number of sources of a part: few enough for the rounding errors of single precision, and enough to repay the
/// start of a loop.
pub(super) const PART: usize = 128;

/// Sources that are to be added to sums, a part at a time.
pub(super) struct PartialSums<'a, T, const TARGET: usize, const SOURCE: usize, const SUM: usize> {
    targets: Columns<T, TARGET>,
    sources: Vec<[T; SOURCE]>,
    part: Columns<T, SUM>,
    sums: &'a mut Columns<f64, SUM>,
}

impl<'a, T: Vectors, const TARGET: usize, const SOURCE: usize, const SUM: usize>
    PartialSums<'a, T, TARGET, SOURCE, SUM>
{
    pub(super) fn new(targets: Columns<T, TARGET>, sums: &'a mut Columns<f64, SUM>) -> Self {
        Self {
            part: Columns::new(targets.len()),
            targets,
            sources: Vec::new(),
            sums,
        }
    }

    /// Adds sources, now or later.
    pub(super) fn add<K: Kernel<T, TARGET, SOURCE, SUM>>(
        &mut self,
        kernel: K,
        sources: impl Iterator<Item = [T; SOURCE]>,
    ) {
        self.sources.extend(sources);
        if self.sources.len() >= PART {
            self.finish(kernel);
        }
    }

    /// Adds the sources of the last part.
    pub(super) fn finish<K: Kernel<T, TARGET, SOURCE, SUM>>(&mut self, kernel: K) {
        self.part.clear();
        Arch::new().dispatch(Task {
            kernel,
            targets: &self.targets,
            sources: &self.sources,
            sums: &mut self.part,
        });
        self.sums.add(&self.part);
        self.sources.clear();
    }
}
