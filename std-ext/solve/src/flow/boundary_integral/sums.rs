//! Sums over all pairs of targets and sources: the most expensive loop.

use super::kernel::{Kernel, splat};
use crate::flow::vectors::{Vector, Vectors};
use helfrich_execute::execute::in_parts;
use pulp::{Arch, Simd, WithSimd};
use std::num::NonZeroUsize;

/// Bytes of the widest vectors.
const WIDEST: usize = 64;

/// Number of entries of the widest vectors of double precision.
const LANES: usize = WIDEST / size_of::<f64>();

/// Number of sources per tile: these stay in the first-level cache while all targets are processed.
const TILE: usize = 2304;

/// Adds to each entry `factor` times the sum over all sources at `target(entry)`, and over
/// `correction(entry)`.
///
/// Each step adds one source to a vector of targets, so that every target adds its sources in their
/// order. The numbers of a source are broadcast over the vector.
pub(super) fn add<K, const TARGET: usize, const SOURCE: usize, const SUM: usize>(
    kernel: K,
    threads: NonZeroUsize,
    sources: &[[f64; SOURCE]],
    factor: f64,
    entries: &mut [[f64; SUM]],
    target: impl Fn(usize) -> [f64; TARGET] + Sync,
    correction: impl Fn(usize) -> [f64; SUM] + Sync,
) where
    K: Kernel<f64, TARGET, SOURCE, SUM>,
{
    distribute(threads, entries, |first, entries| {
        let targets = Columns::from_rows(entries.len(), |k| target(first + k));
        let mut sums = Columns::new(entries.len());
        Arch::new().dispatch(Task {
            kernel,
            targets: &targets,
            sources,
            sums: &mut sums,
        });
        for (k, entry) in entries.iter_mut().enumerate() {
            let (sum, correction) = (sums.row(k), correction(first + k));
            for axis in 0..SUM {
                entry[axis] += factor * (sum[axis] + correction[axis]);
            }
        }
    });
}

/// Calls `run` with consecutive shares of the entries and the number of entries before, one a thread.
pub(super) fn distribute<T: Send>(
    threads: NonZeroUsize,
    entries: &mut [T],
    run: impl Fn(usize, &mut [T]) + Sync,
) {
    let share = entries.len().div_ceil(threads.get());
    let share = share.next_multiple_of(LANES).max(LANES);
    let shares = entries.chunks_mut(share).enumerate();
    in_parts(shares, &|(number, entries)| run(number * share, entries));
}

/// The numbers of points, one slice a number, in whole vectors.
#[derive(Clone, Debug)]
pub(super) struct Columns<T, const N: usize>([Vec<T>; N]);

impl<T: Vectors, const N: usize> Columns<T, N> {
    /// Zeros for each of so many points.
    pub(super) fn new(count: usize) -> Self {
        Self([(); N].map(|()| vec![T::zero(); count.next_multiple_of(WIDEST / size_of::<T>())]))
    }

    /// The numbers of each point.
    pub(super) fn from_rows(count: usize, row: impl Fn(usize) -> [T; N]) -> Self {
        let mut columns = Self::new(count);
        for k in 0..count {
            columns.set(k, row(k));
        }
        columns
    }

    /// Number of points, in whole vectors.
    pub(super) fn len(&self) -> usize {
        self.0[0].len()
    }

    /// The numbers of a point.
    pub(super) fn row(&self, point: usize) -> [T; N] {
        self.0.each_ref().map(|column| column[point])
    }

    /// Sets the numbers of a point.
    pub(super) fn set(&mut self, point: usize, numbers: [T; N]) {
        for (column, number) in self.0.iter_mut().zip(numbers) {
            column[point] = number;
        }
    }

    /// Sets all numbers to zero.
    pub(super) fn clear(&mut self) {
        for column in &mut self.0 {
            column.fill(T::zero());
        }
    }
}

impl<const N: usize> Columns<f64, N> {
    /// Adds the numbers of each point.
    pub(super) fn add<T: Vectors>(&mut self, other: &Columns<T, N>) {
        for (column, other) in self.0.iter_mut().zip(&other.0) {
            for (number, &other) in column.iter_mut().zip(other) {
                *number += other.to_f64().unwrap_or(f64::NAN);
            }
        }
    }
}

/// Adds all sources to each target.
pub(super) struct Task<'a, T, K, const TARGET: usize, const SOURCE: usize, const SUM: usize> {
    pub(super) kernel: K,
    pub(super) targets: &'a Columns<T, TARGET>,
    pub(super) sources: &'a [[T; SOURCE]],
    pub(super) sums: &'a mut Columns<T, SUM>,
}

impl<T, K, const TARGET: usize, const SOURCE: usize, const SUM: usize> WithSimd
    for Task<'_, T, K, TARGET, SOURCE, SUM>
where
    T: Vectors,
    K: Kernel<T, TARGET, SOURCE, SUM>,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let targets = (self.targets.0.each_ref()).map(|axis| T::rows::<S>(axis).0);
        let sums = (self.sums.0.each_mut()).map(|axis| T::rows_mut::<S>(axis).0);
        let zero = Vector::splat(simd, T::zero());
        for tile in self.sources.chunks(TILE / SOURCE) {
            for k in 0..targets[0].len() {
                let (mut target, mut sum) = ([zero; TARGET], [zero; SUM]);
                for axis in 0..TARGET {
                    target[axis] = Vector::new(simd, targets[axis][k]);
                }
                for axis in 0..SUM {
                    sum[axis] = Vector::new(simd, sums[axis][k]);
                }
                for source in tile {
                    sum = self.kernel.add(target, splat(simd, *source), sum);
                }
                for axis in 0..SUM {
                    sums[axis][k] = sum[axis].entries();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Columns, Kernel, LANES, Task, Vectors};
    use crate::flow::boundary_integral::kernel::{Stokeslet, Stresslet};
    use pulp::{Arch, Scalar, Scalar128b, Scalar256b, Scalar512b, WithSimd};

    /// Numbers of some points, here and there.
    fn numbers<T: Vectors, const N: usize>(count: usize, seed: f64) -> Vec<[T; N]> {
        let number = |k: usize, axis: usize| T::constant((seed + (7 * k + 3 * axis) as f64).sin());
        (0..count)
            .map(|k| std::array::from_fn(|axis| number(k, axis)))
            .collect()
    }

    /// The sums that one way of running the loop finds.
    fn sums<'a, T, K, const TARGET: usize, const SOURCE: usize, const SUM: usize>(
        kernel: K,
        targets: &'a Columns<T, TARGET>,
        sources: &'a [[T; SOURCE]],
        run: impl for<'b> FnOnce(Task<'b, T, K, TARGET, SOURCE, SUM>),
    ) -> [Vec<T>; SUM]
    where
        T: Vectors,
        K: Kernel<T, TARGET, SOURCE, SUM>,
    {
        let mut sums = Columns::new(targets.0[0].len());
        run(Task {
            kernel,
            targets,
            sources,
            sums: &mut sums,
        });
        sums.0
    }

    fn widths_agree<T, K, const TARGET: usize, const SOURCE: usize, const SUM: usize>(kernel: K)
    where
        T: Vectors,
        K: Kernel<T, TARGET, SOURCE, SUM>,
    {
        // One target is at a source; there are several tiles of sources.
        let mut sources = numbers::<T, SOURCE>(700, 0.1);
        let places = numbers::<T, TARGET>(3 * LANES, 0.7);
        sources[5][..3].copy_from_slice(&places[2][..3]);
        let targets = Columns::from_rows(places.len(), |point| places[point]);
        let narrow = sums(kernel, &targets, &sources, |task| {
            task.with_simd(Scalar128b)
        });
        let wide = sums(kernel, &targets, &sources, |task| {
            task.with_simd(Scalar256b)
        });
        let widest = sums(kernel, &targets, &sources, |task| {
            task.with_simd(Scalar512b)
        });
        assert_eq!(narrow, wide);
        assert_eq!(narrow, widest);
        let own = sums(kernel, &targets, &sources, |task| {
            Arch::new().dispatch(task)
        });
        let scalar = sums(kernel, &targets, &sources, |task| task.with_simd(Scalar));
        // Without vectors of its own, a processor rounds products before it adds them.
        match Arch::new() {
            Arch::Scalar => assert_eq!(own, scalar),
            _ => assert_eq!(own, narrow),
        }
        // A rounding for each source, of the largest sum.
        let largest = (scalar.iter().flatten()).fold(T::zero(), |most, sum| most.max(sum.abs()));
        let allowed = T::constant(sources.len() as f64) * T::epsilon() * largest;
        for (one, other) in scalar.iter().flatten().zip(narrow.iter().flatten()) {
            assert!((*one - *other).abs() <= allowed, "{one:?} and {other:?}");
        }
    }

    #[test]
    fn vectors_of_every_width_find_the_same_bits() {
        widths_agree::<f64, _, _, _, _>(Stokeslet);
        widths_agree::<f64, _, _, _, _>(Stresslet);
        widths_agree::<f32, _, _, _, _>(Stokeslet);
    }
}
