//! Values and derivatives of polynomials in two variables, without constant term.

use super::plan::{COUNT, DEGREE};
use crate::fit::place_of;
use crate::lane::Lane;

/// Places of coefficients in the order of Horner's scheme, by falling powers of u, then of v: the constant, at
/// place 0, is the last.
const ORDER: [usize; COUNT + 1] = {
    let mut order = [0; COUNT + 1];
    let (mut next, mut a) = (0, DEGREE + 1);
    while a > 0 {
        a -= 1;
        let mut b = DEGREE - a + 1;
        while b > 0 {
            b -= 1;
            order[next] = place_of(a + b, b);
            next += 1;
        }
    }
    order
};

/// A polynomial that is evaluated at many points.
pub(super) struct Polynomial<L>([L; COUNT + 1]);

impl<L: Lane> Polynomial<L> {
    /// The polynomial with these coefficients, in order of the monomials.
    #[inline(always)]
    pub(super) fn new(coefficients: &[L; COUNT]) -> Self {
        let mut ordered = [L::zero(); COUNT + 1];
        for (entry, &place) in ordered.iter_mut().zip(&ORDER[..COUNT]) {
            *entry = coefficients[place - 1];
        }
        Self(ordered)
    }

    /// The coefficients of each power of u, falling: of one power of v for the highest, and of one more for each
    /// that follows.
    #[inline(always)]
    fn rows(&self) -> impl Iterator<Item = &[L]> {
        let mut rest = &self.0[..];
        (1..=DEGREE + 1).map(move |length| {
            let (row, others) = rest.split_at(length);
            rest = others;
            row
        })
    }

    /// The value at (u, v).
    #[inline(always)]
    pub(super) fn value(&self, u: L, v: L) -> L {
        let mut value = L::zero();
        for row in self.rows() {
            let mut part = row[0];
            for &coefficient in &row[1..] {
                part = part * v + coefficient;
            }
            value = value * u + part;
        }
        value
    }

    /// Value, ∂u and ∂v at (u, v).
    #[inline(always)]
    pub(super) fn with_slopes(&self, u: L, v: L) -> [L; 3] {
        let [mut value, mut by_u, mut by_v] = [L::zero(); 3];
        for row in self.rows() {
            let (mut part, mut slope) = (row[0], L::zero());
            for &coefficient in &row[1..] {
                slope = slope * v + part;
                part = part * v + coefficient;
            }
            by_u = by_u * u + value;
            value = value * u + part;
            by_v = by_v * u + slope;
        }
        [value, by_u, by_v]
    }
}

/// Adds `factor` times the monomials at (u, v).
#[inline(always)]
pub(super) fn add_monomials<L: Lane>(sums: &mut [L; COUNT], factor: L, u: L, v: L) {
    let mut power = factor;
    for b in 0..=DEGREE {
        let mut term = power;
        for a in 0..=DEGREE - b {
            let place = place_of(a + b, b);
            if place > 0 {
                sums[place - 1] = sums[place - 1] + term;
            }
            term = term * u;
        }
        power = power * v;
    }
}
