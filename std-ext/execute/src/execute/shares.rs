//! Many independent parts of work, one after the other on each thread.

use super::{HAS_THREADS, Parallel, WORTH_A_THREAD, in_parts, with_threads};
use crate::clock;
use std::num::NonZeroUsize;
use std::time::Duration;

/// Work that is done again and again on many independent parts, for example surfaces: consecutive parts on one thread,
/// where that is worth starting threads. Loops over vertices then start no threads of their own.
///
/// No result depends on the division.
#[derive(Clone, Debug, Default)]
pub struct Shares {
    execution: Parallel,
    /// The time that the work took the last time, of all threads.
    last: Duration,
}

/// Largest share of a thread, over the mean share, with which the loops within parts are not better divided.
const MOST_UNEVEN: f64 = 1.4;

impl Shares {
    /// Does `work` for each part. Parts take times in proportion to their weights.
    ///
    /// # Panics
    /// If `work` does.
    pub fn each<P: Send>(
        &mut self,
        parts: impl Iterator<Item = (usize, P)>,
        work: impl Fn(P) + Sync,
    ) {
        let start = clock::now();
        let most = self.execution.allowed().get();
        let worth = (self.last.as_secs_f64() / WORTH_A_THREAD.as_secs_f64()) as usize;
        let threads = if HAS_THREADS { most.min(worth) } else { 1 };
        // One thread needs no memory.
        if threads <= 1 {
            parts.for_each(|(_, part)| work(part));
        } else {
            let mut parts = Vec::from_iter(parts);
            let shares = shares(&parts, threads).into_iter().rev();
            let shares = Vec::from_iter(shares.map(|first| parts.split_off(first)));
            parts.into_iter().for_each(|(_, part)| work(part));
            in_parts(shares.into_iter(), &|share: Vec<(usize, P)>| {
                with_threads(NonZeroUsize::MIN, || {
                    share.into_iter().for_each(|(_, part)| work(part));
                });
            });
        }
        self.last = clock::since(start) * threads.max(1) as u32;
    }
}

/// The first part of each share; none if shares would be too uneven.
fn shares<P>(parts: &[(usize, P)], threads: usize) -> Vec<usize> {
    let total = parts.iter().map(|(weight, _)| weight).sum::<usize>();
    let mean = total as f64 / threads as f64;
    let mut shares = Vec::new();
    let (mut before, mut own, mut largest) = (0, 0, 0);
    for (number, (weight, _)) in parts.iter().enumerate() {
        // Each part belongs to the share in which its middle is.
        let middle = before as f64 + 0.5 * *weight as f64;
        if middle >= mean * shares.len() as f64 {
            shares.push(number);
            own = 0;
        }
        before += weight;
        own += weight;
        largest = largest.max(own);
    }
    if largest as f64 > MOST_UNEVEN * mean {
        shares.clear();
    }
    shares
}
