//! Factorisations `A = L D Lᵀ` of symmetric matrices, one or several at once, and their solutions.
//!
//! L has 1 on its diagonal; what lies below is stored row by row without gaps. A column whose pivot is not
//! positive contributes nothing: `1/D` counts as 0 there.
//!
//! G. H. Golub and C. F. Van Loan, Matrix Computations, sections 4.1 and 4.2.8.

use crate::lane::Wide;

/// Number of rows that are computed together, and of partial sums: none waits for another.
const TOGETHER: usize = 4;

/// Largest number of rows: of a polynomial of degree 8 with a constant.
const MOST: usize = 45;

/// Start of row i of L.
#[inline(always)]
pub(crate) const fn row_start(i: usize) -> usize {
    i * i.saturating_sub(1) / 2
}

/// Sets L, D and 1/D from the entries (i, j), i ≥ j, of a matrix with as many rows as `pivots` has entries.
#[inline(always)]
pub(crate) fn factorise<L: Wide>(
    entry: impl Fn(usize, usize) -> L,
    lower: &mut [L],
    pivots: &mut [L],
    over_pivots: &mut [L],
) {
    let count = pivots.len();
    for (i, pivot) in pivots.iter_mut().enumerate() {
        *pivot = entry(i, i);
    }
    // One row of L D.
    let mut scaled = [L::zero(); MOST];
    for j in 0..count {
        let positive = L::zero().less(pivots[j]);
        let over = L::select(positive, pivots[j].reciprocal_or_zero(), L::zero());
        over_pivots[j] = over;
        let row = lower[row_start(j)..][..j].iter().zip(&*pivots);
        for (scaled, (&entry, &pivot)) in scaled.iter_mut().zip(row) {
            *scaled = entry * pivot;
        }
        let scaled = &scaled[..j];
        let mut i = j + 1;
        while i < count {
            let together = TOGETHER.min(count - i);
            let mut sums = [L::zero(); TOGETHER];
            for (c, sum) in sums.iter_mut().enumerate().take(together) {
                *sum = entry(i + c, j);
            }
            let row = |c: usize| &lower[row_start(i + c.min(together - 1))..][..j];
            let known = [row(0), row(1), row(2), row(3)];
            for k in 0..j {
                for c in 0..TOGETHER {
                    sums[c] = sums[c].minus(known[c][k].times(scaled[k]));
                }
            }
            for (c, &sum) in sums.iter().enumerate().take(together) {
                let entry = sum * over;
                lower[row_start(i + c) + j] = entry;
                pivots[i + c] = pivots[i + c] - entry * sum;
            }
            i += TOGETHER;
        }
    }
}

/// Replaces r by the solution y of `L y = r`.
#[inline(always)]
pub(crate) fn substitute<L: Wide>(lower: &[L], right: &mut [L]) {
    for i in 1..right.len() {
        right[i] = right[i] - dot(&lower[row_start(i)..][..i], &right[..i]);
    }
}

/// Replaces r by the solution x of `A x = r`.
#[inline(always)]
pub(crate) fn solve<L: Wide>(lower: &[L], over_pivots: &[L], right: &mut [L]) {
    substitute(lower, right);
    for (entry, &over) in right.iter_mut().zip(over_pivots) {
        *entry = *entry * over;
    }
    for i in (1..right.len()).rev() {
        let last = right[i];
        let row = &lower[row_start(i)..][..i];
        for (entry, &factor) in right.iter_mut().zip(row) {
            *entry = entry.minus(factor.times(last));
        }
    }
}

/// Scalar products.
#[inline(always)]
pub(super) fn dot<L: Wide>(a: &[L], b: &[L]) -> L {
    let mut sums = [L::zero(); TOGETHER];
    let (whole_a, rest_a) = a.as_chunks::<TOGETHER>();
    let (whole_b, rest_b) = b.as_chunks::<TOGETHER>();
    for (a, b) in whole_a.iter().zip(whole_b) {
        for k in 0..TOGETHER {
            sums[k] = sums[k].plus(a[k].times(b[k]));
        }
    }
    for (k, (&a, &b)) in rest_a.iter().zip(rest_b).enumerate() {
        sums[k] = sums[k] + a * b;
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}
