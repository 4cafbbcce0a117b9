//! The first plateau of a curve.

/// The first plateau of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// The time of the plateau.
    pub time: f64,
    /// The value of the curve there.
    pub value: f64,
}

/// The first plateau of a curve that rises fast and then creeps: the point where its slope first
/// falls below `fraction` of the steepest slope before, or changes sign; otherwise the point of
/// least slope before the slope doubles. `None` if there is no such point, or fewer than five
/// points. Points that are not finite are left out.
///
/// Slopes are those of straight lines fitted to five neighbouring points (fewer at the ends), so
/// that rounding errors do not end the rise. For `D∞ (1 − e^(−t/τ))` the value is below D∞ by the
/// relative amount `fraction`: 10⁻³ gives three correct digits, if the curve creeps more slowly
/// than that.
///
/// # Panics
/// If there are more or fewer times than values.
pub fn first_plateau(times: &[f64], values: &[f64], fraction: f64) -> Option<Plateau> {
    assert_eq!(times.len(), values.len(), "one time a value");
    let points = times.iter().copied().zip(values.iter().copied());
    let points = points.filter(|(time, value)| time.is_finite() && value.is_finite());
    let points = Vec::from_iter(points);
    if points.len() < 5 {
        return None;
    }
    let slopes = Vec::from_iter((0..points.len()).map(|at| slope(&points, at)));
    let mut steepest = slopes[0];
    let mut least = 0;
    for at in 1..points.len() {
        // Slopes are relative to the direction of the rise: after a change of sign they are
        // negative.
        let along = slopes[at] * steepest.signum();
        let enough = fraction * steepest.abs();
        if along <= enough {
            let before = slopes[at - 1] * steepest.signum();
            // A constant curve has its plateau at the start.
            let share = if before > along {
                ((before - enough) / (before - along)).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let between = |a: f64, b: f64| a + share * (b - a);
            return Some(Plateau {
                time: between(points[at - 1].0, points[at].0),
                value: between(points[at - 1].1, points[at].1),
            });
        }
        if slopes[at].abs() > steepest.abs() {
            (steepest, least) = (slopes[at], at);
        } else if slopes[at].abs() < slopes[least].abs() {
            least = at;
        } else if slopes[at].abs() > 2.0 * slopes[least].abs() {
            let (time, value) = points[least];
            return Some(Plateau { time, value });
        }
    }
    None
}

/// Slope of the line that fits the points around one best.
fn slope(points: &[(f64, f64)], at: usize) -> f64 {
    let near = &points[at.saturating_sub(2)..points.len().min(at + 3)];
    let count = near.len() as f64;
    let [time, value] = near
        .iter()
        .fold([0.0; 2], |[times, values], (time, value)| {
            [times + time / count, values + value / count]
        });
    let [mixed, squared] = near.iter().fold([0.0; 2], |[mixed, squared], (t, v)| {
        let away = t - time;
        [mixed + away * (v - value), squared + away * away]
    });
    mixed / squared
}
