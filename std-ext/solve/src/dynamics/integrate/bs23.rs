//! One step of the pair of third and second order of P. Bogacki and L. F. Shampine, Appl. Math.
//! Lett. 2 (1989) 321, whose last velocity is the first of the next step.

use super::{Checked, Failure, Start, Work};
use crate::dynamics::vector::{add, root_mean_square, scale};

/// Length of the stability interval on the negative real axis: `1 + z + z²/2 + z³/6 = −1`.
pub(super) const STABILITY: f64 = 2.5127;

/// Takes a step; returns the root mean square of the error estimate.
pub(super) fn advance(
    rhs: &mut Checked<'_>,
    start: Start<'_>,
    end_time: f64,
    work: &mut Work,
) -> Result<f64, Failure> {
    let step = end_time - start.time;
    let (x, v1) = (start.positions, start.velocities);
    let [v2, v3, ..] = &mut work.stages;
    let end = &mut work.end;
    for (end, (x, v)) in end.iter_mut().zip(x.iter().zip(v1)) {
        *end = add(*x, scale(0.5 * step, *v));
    }
    rhs.evaluate(end, start.time + 0.5 * step, v2)?;
    for (end, (x, v)) in end.iter_mut().zip(x.iter().zip(&*v2)) {
        *end = add(*x, scale(0.75 * step, *v));
    }
    rhs.evaluate(end, start.time + 0.75 * step, v3)?;
    for (i, end) in end.iter_mut().enumerate() {
        let early = add(scale(2.0, v1[i]), scale(3.0, v2[i]));
        *end = add(x[i], scale(step / 9.0, add(early, scale(4.0, v3[i]))));
    }
    rhs.arrive(end, end_time, &mut work.end_velocities)?;
    let v4 = &work.end_velocities;
    Ok(root_mean_square((0..x.len()).map(|i| {
        let early = add(scale(-5.0, v1[i]), scale(6.0, v2[i]));
        let late = add(scale(8.0, v3[i]), scale(-9.0, v4[i]));
        scale(step / 72.0, add(early, late))
    })))
}
