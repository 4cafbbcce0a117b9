//! The bending force density by the fourth derivatives of one polynomial.
//!
//! Near a boundary the neighbours' fits are one-sided themselves: their H is less accurate than the
//! derivatives of one fit.

use crate::real::Real;
use core::array::from_fn;
use core::ops::{Add, Mul};

/// A power series to second order: coefficients of 1, x, y, x², xy, y².
#[derive(Clone, Copy)]
struct Series<T>([T; 6]);

impl<T: Real> Add for Series<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<T: Real> Mul for Series<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let [a, b] = [self.0, other.0];
        Self([
            a[0] * b[0],
            a[0] * b[1] + a[1] * b[0],
            a[0] * b[2] + a[2] * b[0],
            a[0] * b[3] + a[1] * b[1] + a[3] * b[0],
            a[0] * b[4] + a[1] * b[2] + a[2] * b[1] + a[4] * b[0],
            a[0] * b[5] + a[2] * b[2] + a[5] * b[0],
        ])
    }
}

impl<T: Real> Series<T> {
    fn times(self, factor: T) -> Self {
        Self(self.0.map(|entry| factor * entry))
    }

    /// The series 1 + self.
    fn more(mut self) -> Self {
        self.0[0] += T::one();
        self
    }

    /// self^(−3/2).
    fn over_cube_of_root(self) -> Self {
        let first = self.0[0];
        let mut rest = self.times(first.recip());
        rest.0[0] = T::zero();
        let series = rest.times(T::constant(-1.5)) + (rest * rest).times(T::constant(1.875));
        series.more().times((first * first.sqrt()).recip())
    }
}

/// f = 2[Δ_S H + 2H(H² − K)] at the origin of a height function, times the radius cubed, by its
/// coefficients of x, y, x², xy, y², x³, … y⁴ in radii.
pub(super) fn force_density<T: Real>(coefficients: &[T]) -> T {
    let times = |number: f64, place: usize| T::constant(number) * coefficients[place];
    // Derivatives of the height.
    let x = Series([
        times(1.0, 0),
        times(2.0, 2),
        times(1.0, 3),
        times(3.0, 5),
        times(2.0, 6),
        times(1.0, 7),
    ]);
    let y = Series([
        times(1.0, 1),
        times(1.0, 3),
        times(2.0, 4),
        times(1.0, 6),
        times(2.0, 7),
        times(3.0, 8),
    ]);
    let xx = Series([
        times(2.0, 2),
        times(6.0, 5),
        times(2.0, 6),
        times(12.0, 9),
        times(6.0, 10),
        times(2.0, 11),
    ]);
    let xy = Series([
        times(1.0, 3),
        times(2.0, 6),
        times(2.0, 7),
        times(3.0, 10),
        times(4.0, 11),
        times(3.0, 12),
    ]);
    let yy = Series([
        times(2.0, 4),
        times(2.0, 7),
        times(6.0, 8),
        times(2.0, 11),
        times(6.0, 12),
        times(12.0, 13),
    ]);
    let two = T::constant(2.0);
    let metric = (x * x + y * y).more();
    let bend = (y * y).more() * xx + (x * y * xy).times(-two) + (x * x).more() * yy;
    let mean = (bend * metric.over_cube_of_root())
        .times(T::constant(-0.5))
        .0;
    let [p, q] = [x.0[0], y.0[0]];
    let square = metric.0[0];
    let [along_x, across, along_y] = [
        T::one() - p * p / square,
        -p * q / square,
        T::one() - q * q / square,
    ];
    let slopes = two * mean[0] / square.sqrt() * (p * mean[1] + q * mean[2]);
    let laplacian = two * (along_x * mean[3] + across * mean[4] + along_y * mean[5]) + slopes;
    let gaussian = (xx.0[0] * yy.0[0] - xy.0[0] * xy.0[0]) / (square * square);
    two * (laplacian + two * mean[0] * (mean[0] * mean[0] - gaussian))
}
