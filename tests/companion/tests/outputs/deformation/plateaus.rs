//! First plateaus of known curves.

use super::assert_close;
use helfrich_std::deformation::first_plateau;
use helfrich_tests::meshes::SplitMix64;
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::PI;

/// First plateaus of known curves, relative to the plateau.
const PLATEAU: Tolerance = Tolerance::new(
    2e-3,
    "the slope over five points of a coarse curve is wrong by up to a quarter",
);

/// Time at which a slope is least, relative.
const PLATEAU_TIME: Tolerance = Tolerance::new(5e-2, "one sample of twenty up to the least slope");

fn sampled(step: f64, end: f64, curve: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let count = (end / step).round() as usize;
    let times = Vec::from_iter((0..=count).map(|at| at as f64 * step));
    let values = times.iter().map(|&time| curve(time)).collect();
    (times, values)
}

/// D∞ (1 − e^(−t/τ)) at its plateau is below D∞ by the fraction at which a slope counts as zero.
#[test]
fn plateaus_are_found_before_curves_creep_on() {
    let limit = 0.0104;
    let rise = |time: f64| limit * (1.0 - (-time / 0.4).exp());
    let creep = |time: f64| rise(time) + 1e-4 * limit * time;
    let upturn = |time: f64| rise(time) + 2e-3 * limit * time * time;
    let overshoot = |time: f64| limit * (1.0 - (-time / 0.4).exp() * (2.0 * time).cos());
    for (step, what) in [(0.01, "fine"), (0.1, "coarse")] {
        let first = |curve: &dyn Fn(f64) -> f64| {
            let (times, values) = sampled(step, 10.0, curve);
            first_plateau(&times, &values, 2e-3).unwrap()
        };
        let plain = first(&rise);
        PLATEAU.assert(plain.value, limit * (1.0 - 2e-3), limit, what);
        PLATEAU.assert(first(&creep).value, limit, limit, what);
        // The slope is least where its derivative vanishes: 2 · 2·10⁻³ = e^(−t/τ)/τ².
        let turn = 0.4 * (1.0 / (4e-3 * 0.16_f64)).ln();
        let turned = first(&upturn);
        PLATEAU_TIME.assert(turned.time, turn, turn, what);
        // The first maximum is at tan 2t = −1/(2τ).
        let peak = 0.5 * (PI - (1.25_f64).atan());
        PLATEAU.assert(first(&overshoot).value, overshoot(peak), limit, what);
    }
}

/// The slope over five points is exact for a parabola at their centre; between samples, slope and curve are
/// interpolated linearly.
#[test]
fn plateaus_are_between_samples() {
    let (times, values) = sampled(0.1, 1.5, |time| time - 0.5 * time * time);
    // The steepest slope is that of the first three points, 0.9; a quarter of it is reached at 0.775.
    let found = first_plateau(&times, &values, 0.25).unwrap();
    assert_close(found.time, 0.775, 1.0, "time");
    assert_close(found.value, 0.455 + 0.75 * 0.025, 1.0, "value");
}

#[test]
fn plateaus_survive_the_last_digits_of_a_time_step() {
    let mut random = SplitMix64::new(11);
    let (mut times, mut values) = sampled(0.02, 8.0, |time| 0.1 * (1.0 - (-time / 0.5).exp()));
    for value in &mut values {
        *value += 1e-6 * random.symmetric();
    }
    let found = first_plateau(&times, &values, 2e-3).unwrap();
    PLATEAU.assert(found.value, 0.1, 0.1, "with noise");
    times.insert(7, 0.131);
    values.insert(7, f64::NAN);
    assert_eq!(first_plateau(&times, &values, 2e-3), Some(found));
    // Falling curves, curves that never settle, and constant curves.
    let fallen = Vec::from_iter(values.iter().map(|value| -value));
    let fallen = first_plateau(&times, &fallen, 2e-3).unwrap();
    assert_eq!(fallen.value, -found.value);
    let (times, values) = sampled(0.1, 5.0, |time| 3.0 * time);
    assert_eq!(first_plateau(&times, &values, 1e-2), None);
    let rest = first_plateau(&times, &vec![2.0; times.len()], 1e-2).unwrap();
    assert_eq!(rest.value, 2.0);
    assert_eq!(first_plateau(&times[..4], &values[..4], 0.9), None);
}
