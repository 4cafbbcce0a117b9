//! Where a curve first comes to rest.

/// Where a curve first comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// When.
    pub time: f64,
    /// The curve there.
    pub value: f64,
}

/// The first plateau of a curve that rises fast and creeps on: where its slope first falls below
/// `fraction` of the steepest one before, or turns; else where it is least before it doubles. None
/// if there is no such place, or fewer than five points. Points that are not finite are left out.
///
/// A slope is that of the straight line that fits five points around best (fewer at the ends), so
/// that the last digits of a time step do not end the rise. Of `D∞ (1 − e^(−t/τ))` the value found is
/// short of D∞ by `fraction`, relative: 10⁻³ leaves the limit to three digits, if the curve creeps
/// more slowly than that.
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
        // Measured along the rise: what turns is below 0.
        let along = slopes[at] * steepest.signum();
        let enough = fraction * steepest.abs();
        if along <= enough {
            let before = slopes[at - 1] * steepest.signum();
            // A curve that never moves is at rest where it begins.
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
