//! One step of the damped Runge–Kutta–Chebyshev scheme of second order: B. P. Sommeijer,
//! L. F. Shampine and J. G. Verwer, J. Comput. Appl. Math. 88 (1998) 315.

use super::{Checked, Failure, Start, Work};
use crate::dynamics::vector::{add, root_mean_square, scale, sub};

/// Damping ε of that paper: inside the stability interval |R| ≤ 1 − ε/3 but near 0.
const DAMPING: f64 = 2.0 / 13.0;

/// `(s² − 1)/Δtρ` at the end of the stability interval, rounded up by that paper.
pub(super) const STABILITY: f64 = 1.54;

/// T_j, T_j' and T_j'' at w0.
#[derive(Clone, Copy)]
struct Chebyshev([f64; 3]);

impl Chebyshev {
    const ZEROTH: Self = Self([1.0, 0.0, 0.0]);

    fn first(w0: f64) -> Self {
        Self([w0, 1.0, 0.0])
    }

    /// T_j from T_(j−1) and T_(j−2).
    fn next(self, before: Self, w0: f64) -> Self {
        let (Self([t1, d1, e1]), Self([t2, d2, e2])) = (self, before);
        Self([
            2.0 * w0 * t1 - t2,
            2.0 * t1 + 2.0 * w0 * d1 - d2,
            4.0 * d1 + 2.0 * w0 * e1 - e2,
        ])
    }
}

/// The number of stages that makes a step stable.
pub(super) fn stages(step: f64, radius: f64) -> usize {
    // The tolerance avoids an additional stage because of rounding.
    let stages = (1.0 + STABILITY * step * radius).sqrt() * (1.0 - 1e-12);
    (stages.ceil() as usize).max(2)
}

/// Takes a step with this number of stages; returns the root mean square of the error estimate.
pub(super) fn advance(
    rhs: &mut Checked<'_>,
    start: Start<'_>,
    end_time: f64,
    stages: usize,
    work: &mut Work,
) -> Result<f64, Failure> {
    let step = end_time - start.time;
    let degree = stages as f64;
    let w0 = 1.0 + DAMPING / (degree * degree);
    let (mut before, mut last) = (Chebyshev::ZEROTH, Chebyshev::first(w0));
    for _ in 2..=stages {
        (before, last) = (last, last.next(before, w0));
    }
    let w1 = last.0[1] / last.0[2];

    let (x, v) = (start.positions, start.velocities);
    let [earlier, velocities, ..] = &mut work.stages;
    let end = &mut work.end;
    // b_0 = b_1 = b_2.
    let b = 0.25 / (w0 * w0);
    let (mut b_before, mut b_last) = (b, b);
    earlier.copy_from_slice(x);
    for (end, (x, v)) in end.iter_mut().zip(x.iter().zip(v)) {
        *end = add(*x, scale(b * w1 * step, *v));
    }
    let mut share = b * w1;
    (before, last) = (Chebyshev::ZEROTH, Chebyshev::first(w0));
    for _ in 2..=stages {
        rhs.evaluate(end, start.time + share * step, velocities)?;
        let a = 1.0 - b_last * last.0[0];
        (before, last) = (last, last.next(before, w0));
        let [_, first, second] = last.0;
        let b = second / (first * first);
        let mu = 2.0 * b * w0 / b_last;
        let nu = -b / b_before;
        let forward = 2.0 * b * w1 / b_last;
        for (i, earlier) in earlier.iter_mut().enumerate() {
            // Differences from the start are stored, because they lose less to rounding far from
            // the origin.
            let d1 = scale(mu, sub(end[i], x[i]));
            let d2 = scale(nu, sub(*earlier, x[i]));
            let f = sub(velocities[i], scale(a, v[i]));
            *earlier = add(x[i], add(add(d1, d2), scale(forward * step, f)));
        }
        std::mem::swap(earlier, end);
        (b_before, b_last) = (b_last, b);
        share = w1 * second / first;
    }
    rhs.arrive(end, end_time, &mut work.end_velocities)?;
    let w = &work.end_velocities;
    Ok(root_mean_square((0..x.len()).map(|i| {
        let moved = scale(0.8, sub(x[i], end[i]));
        add(moved, scale(0.4 * step, add(v[i], w[i])))
    })))
}
