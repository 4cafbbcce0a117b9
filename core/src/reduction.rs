//! Sums whose grouping depends on the number of terms only.

use crate::real::Real;

/// Number of terms that are added sequentially before partial sums are paired.
const BLOCK: usize = 128;

/// Σ `term(k)` for k in 0 … `count` − 1, by pairwise summation of blocks: the rounding error grows
/// with the logarithm of the count, and the result does not depend on the division of work.
pub(crate) fn sum<T: Real>(count: usize, term: &impl Fn(usize) -> T) -> T {
    pairwise(0, count, term)
}

fn pairwise<T: Real>(start: usize, end: usize, term: &impl Fn(usize) -> T) -> T {
    if end - start <= BLOCK {
        return (start..end).fold(T::zero(), |sum, k| sum + term(k));
    }
    let blocks = (end - start).div_ceil(BLOCK);
    let middle = start + blocks / 2 * BLOCK;
    pairwise(start, middle, term) + pairwise(middle, end, term)
}
