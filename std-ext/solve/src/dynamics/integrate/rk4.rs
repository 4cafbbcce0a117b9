//! One step of the classical Runge–Kutta scheme of fourth order: W. Kutta, Z. Math. Phys. 46 (1901)
//! 435.

use super::{Checked, Failure, Start, Work};
use crate::dynamics::vector::{add, scale};

/// Length of the stability interval on the negative real axis: `1 + z + … + z⁴/24 = 1`.
pub(super) const STABILITY: f64 = 2.7852;

/// Takes a step.
pub(super) fn advance(
    rhs: &mut Checked<'_>,
    start: Start<'_>,
    end_time: f64,
    work: &mut Work,
) -> Result<(), Failure> {
    let step = end_time - start.time;
    let (x, v1) = (start.positions, start.velocities);
    let [v2, v3, v4, _] = &mut work.stages;
    let end = &mut work.end;
    let middle = start.time + 0.5 * step;
    for (end, (x, v)) in end.iter_mut().zip(x.iter().zip(v1)) {
        *end = add(*x, scale(0.5 * step, *v));
    }
    rhs.evaluate(end, middle, v2)?;
    for (end, (x, v)) in end.iter_mut().zip(x.iter().zip(&*v2)) {
        *end = add(*x, scale(0.5 * step, *v));
    }
    rhs.evaluate(end, middle, v3)?;
    for (end, (x, v)) in end.iter_mut().zip(x.iter().zip(&*v3)) {
        *end = add(*x, scale(step, *v));
    }
    rhs.evaluate(end, end_time, v4)?;
    for (i, end) in end.iter_mut().enumerate() {
        let inner = scale(2.0, add(v2[i], v3[i]));
        *end = add(x[i], scale(step / 6.0, add(add(v1[i], v4[i]), inner)));
    }
    rhs.arrive(end, end_time, &mut work.end_velocities)
}
