//! One step of the linearly implicit scheme ROS34PW2 of J. Rang and L. Angermann, BIT Numer. Math. 45
//! (2005) 761: third order with any matrix A, and stiffly accurate where A is ∂v/∂x.

use super::{Checked, Failure, Start, Work};
use crate::dynamics::vector::{Vector, add_scaled, root_mean_square};

/// γ, the diagonal of [`IMPLICIT`].
const DIAGONAL: f64 = 0.435_866_521_508_459;

/// α_ij, by which stages depend on earlier ones.
const EXPLICIT: Rows = [
    [0.0; 4],
    [0.871_733_043_016_918, 0.0, 0.0, 0.0],
    [0.844_570_600_153_694_2, -0.112_990_642_364_841_85, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

/// γ_ij, by which A acts on the stages.
const IMPLICIT: Rows = [
    [DIAGONAL, 0.0, 0.0, 0.0],
    [-0.871_733_043_016_918, DIAGONAL, 0.0, 0.0],
    [
        -0.903_380_570_130_440_8,
        0.054_180_672_388_095_326,
        DIAGONAL,
        0.0,
    ],
    [
        0.242_123_807_060_953_46,
        -1.223_250_583_904_514_7,
        0.545_260_255_335_102_1,
        DIAGONAL,
    ],
];

/// b_i, the weights of the stages.
const WEIGHTS: [f64; 4] = [
    0.242_123_807_060_953_46,
    -1.223_250_583_904_514_7,
    1.545_260_255_335_102,
    DIAGONAL,
];

/// The weights of the solution of second order.
const SECOND: [f64; 4] = [
    0.378_109_031_458_193_7,
    -0.096_042_292_212_423_18,
    0.5,
    0.217_933_260_754_229_5,
];

type Rows = [[f64; 4]; 4];

/// Takes a step; returns the root mean square of the error estimate.
///
/// The unknowns are `U_i = Δt Σ_j γ_ij k_j`, E. Hairer and G. Wanner, Solving Ordinary Differential
/// Equations II, Springer 1996, section IV.7, so that no product with A is needed:
/// `(1 − γ Δt A) U_i = γ (Δt v(x + Σ_j a_ij U_j) + Σ_j c_ij U_j)`.
pub(super) fn advance(
    rhs: &mut Checked<'_>,
    start: Start<'_>,
    end_time: f64,
    work: &mut Work,
) -> Result<f64, Failure> {
    let step = end_time - start.time;
    let x = start.positions;
    rhs.linearise(start)?;
    for stage in 0..4 {
        let velocities = &mut work.end_velocities;
        if stage == 0 {
            velocities.copy_from_slice(start.velocities);
        } else {
            let end = &mut work.end;
            end.copy_from_slice(x);
            combine(end, transformed(&EXPLICIT[stage]), &work.stages);
            let share: f64 = EXPLICIT[stage].iter().sum();
            rhs.evaluate(end, start.time + share * step, velocities)?;
        }
        let (known, new) = work.stages.split_at_mut(stage);
        let new = &mut new[0];
        new.fill([0.0; 3]);
        add_scaled(
            new.as_flattened_mut(),
            DIAGONAL * step,
            velocities.as_flattened(),
        );
        // The diagonal part of 1/γ − Γ⁻¹ is 0.
        let mut unit = [0.0; 4];
        unit[stage] = 1.0;
        let inverse = transformed(&unit);
        for (stage, factor) in known.iter().zip(inverse) {
            let factor = -DIAGONAL * factor;
            add_scaled(new.as_flattened_mut(), factor, stage.as_flattened());
        }
        rhs.solve(DIAGONAL * step, start.time, new)?;
    }
    let errors = [0, 1, 2, 3].map(|i| WEIGHTS[i] - SECOND[i]);
    work.end.fill([0.0; 3]);
    combine(&mut work.end, transformed(&errors), &work.stages);
    let error = root_mean_square(work.end.iter().copied());
    work.end.copy_from_slice(x);
    combine(&mut work.end, transformed(&WEIGHTS), &work.stages);
    rhs.arrive(&mut work.end, end_time, &mut work.end_velocities)?;
    Ok(error)
}

/// Adds a combination of stages.
fn combine(field: &mut [Vector], factors: [f64; 4], stages: &[Vec<Vector>; 4]) {
    for (factor, stage) in factors.into_iter().zip(stages) {
        if factor != 0.0 {
            add_scaled(field.as_flattened_mut(), factor, stage.as_flattened());
        }
    }
}

/// `row Γ⁻¹`, the factors of U_i that stand for these factors of Δt k_i.
fn transformed(row: &[f64; 4]) -> [f64; 4] {
    let mut factors = [0.0; 4];
    for column in (0..4).rev() {
        let later: f64 = (column + 1..4)
            .map(|k| factors[k] * IMPLICIT[k][column])
            .sum();
        factors[column] = (row[column] - later) / DIAGONAL;
    }
    factors
}
