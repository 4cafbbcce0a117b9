//! Sums over all pairs of targets and sources: the loop that takes the time.

use super::kernel::Kernel;
use pulp::{Arch, Simd, WithSimd};
use std::num::NonZeroUsize;

/// A multiple of every width of vectors.
const LANES: usize = 8;

/// Numbers of sources that stay in the first cache while all targets pass.
const TILE: usize = 2304;

/// Adds to each entry `factor` times the sum over all sources at `target(entry)`, and over
/// `correction(entry)`.
///
/// One source meets a vector of targets at a time, so that every target adds its sources in their
/// order; the numbers of a source are read together and spread over the vector.
pub(super) fn add<K, const TARGET: usize, const SOURCE: usize, const SUM: usize>(
    kernel: K,
    threads: NonZeroUsize,
    sources: &[[f64; SOURCE]],
    factor: f64,
    entries: &mut [[f64; SUM]],
    target: impl Fn(usize) -> [f64; TARGET] + Sync,
    correction: impl Fn(usize) -> [f64; SUM] + Sync,
) where
    K: Kernel<TARGET, SOURCE, SUM>,
{
    let run = |first: usize, entries: &mut [[f64; SUM]]| {
        let count = entries.len().next_multiple_of(LANES);
        let mut targets = [(); TARGET].map(|()| vec![0.0; count]);
        for k in 0..entries.len() {
            let numbers = target(first + k);
            for (axis, number) in targets.iter_mut().zip(numbers) {
                axis[k] = number;
            }
        }
        let mut sums = [(); SUM].map(|()| vec![0.0; count]);
        Arch::new().dispatch(Task {
            kernel,
            targets: targets.each_ref().map(Vec::as_slice),
            sources,
            sums: sums.each_mut().map(Vec::as_mut_slice),
        });
        for (k, entry) in entries.iter_mut().enumerate() {
            let correction = correction(first + k);
            for axis in 0..SUM {
                entry[axis] += factor * (sums[axis][k] + correction[axis]);
            }
        }
    };
    let share = entries.len().div_ceil(threads.get());
    let share = share.next_multiple_of(LANES).max(LANES);
    std::thread::scope(|scope| {
        let mut shares = entries.chunks_mut(share).enumerate();
        let own = shares.next();
        for (number, entries) in shares {
            let run = &run;
            scope.spawn(move || run(number * share, entries));
        }
        if let Some((_, entries)) = own {
            run(0, entries);
        }
    });
}

struct Task<'a, K, const TARGET: usize, const SOURCE: usize, const SUM: usize> {
    kernel: K,
    targets: [&'a [f64]; TARGET],
    sources: &'a [[f64; SOURCE]],
    sums: [&'a mut [f64]; SUM],
}

impl<K, const TARGET: usize, const SOURCE: usize, const SUM: usize> WithSimd
    for Task<'_, K, TARGET, SOURCE, SUM>
where
    K: Kernel<TARGET, SOURCE, SUM>,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let targets = self.targets.map(|axis| S::as_simd_f64s(axis).0);
        let sums = self.sums.map(|axis| S::as_mut_simd_f64s(axis).0);
        let zero = simd.splat_f64s(0.0);
        for tile in self.sources.chunks(TILE / SOURCE) {
            for k in 0..targets[0].len() {
                let (mut target, mut sum) = ([zero; TARGET], [zero; SUM]);
                for axis in 0..TARGET {
                    target[axis] = targets[axis][k];
                }
                for axis in 0..SUM {
                    sum[axis] = sums[axis][k];
                }
                for source in tile {
                    sum = self.kernel.add(simd, target, source, sum);
                }
                for axis in 0..SUM {
                    sums[axis][k] = sum[axis];
                }
            }
        }
    }
}
