//! Monomials of two variables in order of their degrees, and their sums over weighted points.

use crate::lane::{Lane, Several, Wide};
use crate::real::Real;
use alloc::vec::Vec;

/// Highest degree: beyond it, rounding errors outweigh the gain.
pub(crate) const HIGHEST_DEGREE: usize = 8;

/// Number of sums that are computed together: none waits for another.
pub(super) const SUMS: usize = 4;

/// Number of points whose values are computed together, for the same reason; a number of points is a
/// multiple of it.
pub(crate) const TOGETHER: usize = 4;

/// Number of monomials `x^a y^b` with 1 ≤ a + b ≤ `degree`.
#[inline(always)]
pub(crate) const fn coefficient_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2 - 1
}

/// The place of `x^(degree − power) y^power` among monomials in order of their degrees, 1 first.
#[inline(always)]
pub(crate) const fn place_of(degree: usize, power: usize) -> usize {
    degree * (degree + 1) / 2 + power
}

/// Degree, and power of y, of each monomial without 1.
pub(crate) const MONOMIALS: [(usize, usize); coefficient_count(HIGHEST_DEGREE)] = {
    let mut monomials = [(0, 0); coefficient_count(HIGHEST_DEGREE)];
    let mut degree = 1;
    while degree <= HIGHEST_DEGREE {
        let mut power = 0;
        while power <= degree {
            monomials[place_of(degree, power) - 1] = (degree, power);
            power += 1;
        }
        degree += 1;
    }
    monomials
};

/// Points with weights: coordinates along two axes.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a, T> {
    pub(crate) x: &'a [Several<T>],
    pub(crate) y: &'a [Several<T>],
    pub(crate) weights: &'a [Several<T>],
}

/// Sets `moments` to `Σ c x^a y^b` up to a degree, in order of the monomials. The column c is
/// overwritten; `powers` is scratch memory.
#[inline(always)]
pub(crate) fn set_moments<T: Real>(
    moments: &mut [Several<T>],
    degree: usize,
    points: Points<'_, T>,
    column: &mut [Several<T>],
    powers: &mut Vec<Several<T>>,
) {
    powers.resize(column.len(), Several::zero());
    for a in 0..=degree {
        let mut sums = [Several::zero(); SUMS];
        let next = powers.iter_mut().zip(column.iter_mut());
        for ((power, entry), (&x, &y)) in next.zip(points.x.iter().zip(points.y)) {
            *power = add_powers(&mut sums, *entry, y);
            *entry = entry.times(x);
        }
        store(moments, (degree, a, 0), sums);
        for b in (SUMS..degree + 1 - a).step_by(SUMS) {
            let mut sums = [Several::zero(); SUMS];
            for (power, &y) in powers.iter_mut().zip(points.y) {
                *power = add_powers(&mut sums, *power, y);
            }
            store(moments, (degree, a, b), sums);
        }
    }
}

/// Stores the sums for x^a and y^b, y^(b + 1) …, up to a degree.
#[inline(always)]
fn store<T: Real>(
    moments: &mut [Several<T>],
    (degree, a, b): (usize, usize, usize),
    sums: [Several<T>; SUMS],
) {
    for (c, &sum) in sums.iter().enumerate().take(degree + 1 - a - b) {
        moments[place_of(a + b + c, b + c)] = sum;
    }
}

/// Adds c, c y, c y² … to the sums, and returns the power after those.
#[inline(always)]
fn add_powers<T: Real>(
    sums: &mut [Several<T>; SUMS],
    mut power: Several<T>,
    y: Several<T>,
) -> Several<T> {
    for sum in sums {
        *sum = sum.plus(power);
        power = power.times(y);
    }
    power
}

/// Sets `values` to those of polynomials without constant term at the points.
#[inline(always)]
pub(crate) fn evaluate<T: Real>(
    degree: usize,
    points: Points<'_, T>,
    coefficients: &[Several<T>],
    values: &mut Vec<Several<T>>,
) {
    values.resize(points.x.len(), Several::zero());
    let (x, y) = (
        points.x.as_chunks::<TOGETHER>().0,
        points.y.as_chunks::<TOGETHER>().0,
    );
    let places = x.iter().zip(y);
    for (values, (x, y)) in values.as_chunks_mut().0.iter_mut().zip(places) {
        *values = [Several::zero(); TOGETHER];
        for a in (0..=degree).rev() {
            let mut parts = [Several::zero(); TOGETHER];
            for b in (0..=degree - a).rev() {
                let place = place_of(a + b, b);
                // The polynomials have no constant term.
                let coefficient = if place > 0 {
                    coefficients[place - 1]
                } else {
                    Several::zero()
                };
                for k in 0..TOGETHER {
                    parts[k] = parts[k].times(y[k]).plus(coefficient);
                }
            }
            for k in 0..TOGETHER {
                values[k] = values[k].times(x[k]).plus(parts[k]);
            }
        }
    }
}

/// `e^x` for −16 < x ≤ 0, to rounding: the 64th power of the series of `e^(x/64)`. There is no
/// function call, which would prevent vectorisation.
#[inline(always)]
pub(crate) fn exponential<L: Lane>(x: L) -> L {
    let y = x * L::literal(1.0 / 64.0);
    let mut factorial = 362_880.0;
    let mut sum = L::literal(1.0 / factorial);
    for factor in [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        factorial /= factor;
        sum = L::literal(1.0 / factorial) + sum * y;
    }
    let fourth = (sum * sum) * (sum * sum);
    let sixteenth = (fourth * fourth) * (fourth * fourth);
    (sixteenth * sixteenth) * (sixteenth * sixteenth)
}
